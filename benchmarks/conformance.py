"""Time of the conformance suite on the reference: of an item in the parser and in the runner, and of the whole run."""

from __future__ import annotations

import gc
import subprocess
import sys
import time
from collections import defaultdict
from pathlib import Path

from eurdf_conformance.corpus.read import read_cases
from eurdf_conformance.judging.conversation import Conversation
from eurdf_conformance.judging.judge import judge
from eurdf_conformance.runner.command import REFERENCE
from eurdf_conformance.runner.session import Session
from eurdf_conformance.suite.item import case_items

ROOT = Path(__file__).parents[1]


def main() -> None:
    """Print a line a level, what the runner takes of each request, and the end of a run on two processes."""
    _cases()
    begin = time.perf_counter()
    command = [sys.executable, "-m", "pytest", "conformance", "-n", "2", "-q"]
    run = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    seconds = time.perf_counter() - begin
    print("\n".join(run.stdout.splitlines()[-16:]))
    print(f"{'whole run, start to end':24} {seconds:6.1f} s")


def _cases() -> None:
    """The cases alone, without pytest. The first item of a case loads it for those after."""
    items = list(case_items(read_cases()))
    gc.freeze()
    levels: defaultdict[str, list[tuple[float, float]]] = defaultdict(list)
    with Session(REFERENCE) as session:
        _ = session.started
        conversation = Conversation(session)
        for item in items:
            begin, before = time.perf_counter(), session.seconds_in_parser
            judge(item.case, item.item.level, conversation)
            in_parser = session.seconds_in_parser - before
            levels[item.item.level].append((in_parser, time.perf_counter() - begin - in_parser))
    levels["all"] = [each for times in list(levels.values()) for each in times]
    print(f"{'level':12} {'items':>6} {'parser':>8} {'runner':>8}  ms an item, mean")
    for level, times in levels.items():
        parser, runner = (1e3 * sum(each) / len(times) for each in zip(*times, strict=True))
        print(f"{level:12} {len(times):6} {parser:8.3f} {runner:8.3f}  {parser / (parser + runner):5.1%} in the parser")
    requests = sum(in_parser > 0 for in_parser, _ in levels["all"])
    print(f"a request in the runner  {1e3 * sum(runner for _, runner in levels['all']) / requests:6.3f} ms")
