"""Damaged robots, meshes and foreign files, and wrong arguments, for as long as you like; it keeps what goes wrong."""

from __future__ import annotations

import argparse
import hashlib
import json
import secrets
import sys
import time
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

from benchmarks.fuzz.case import KINDS, OUTCOME, case_of
from benchmarks.fuzz.finding import Finding, minimized
from benchmarks.fuzz.parsers import why_not
from benchmarks.fuzz.watched import Watched

#: Findings of one cause that are kept.
_KEPT = 2

#: Time for making a finding smaller, s.
_SHRINKING = 60.0

_PROGRESS = 60.0


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the campaign, or try findings again.

    Returns:
        0 if no promise was broken, else 1.
    """
    parser = argparse.ArgumentParser(prog="python -m benchmarks fuzz", description=__doc__)
    parser.add_argument("--minutes", type=float, default=1.0, metavar="N", help="how long (default: 1)")
    parser.add_argument("--seed", type=int, help="what cases are drawn from (default: a new one)")
    parser.add_argument("--first", type=int, default=0, metavar="N", help="number of the first case (default: 0)")
    parser.add_argument("--count", type=int, metavar="N", help="at most so many cases")
    parser.add_argument("--kind", choices=list(KINDS), help="only cases of this kind (default: all)")
    parser.add_argument(
        "--findings", type=Path, default=Path("findings"), metavar="DIR", help="where findings are kept (findings/)"
    )
    parser.add_argument("--reproduce", type=Path, nargs="+", metavar="FOLDER", help="try these findings again")
    parser.add_argument("--guided", action="store_true", help="let atheris choose bytes by the code that they reach")
    options = parser.parse_args(arguments)
    if options.reproduce:
        return reproduce(options.reproduce)
    if options.guided:
        from benchmarks.fuzz.guided import run

        return run(options.minutes, options.findings)
    if options.kind == "parsers" and (reason := why_not()):
        parser.error(reason)
    seed = secrets.randbelow(10**9) if options.seed is None else options.seed
    return campaign(seed, options.first, options.count, options.minutes * 60.0, options.findings, options.kind)


def reproduce(folders: Sequence[Path]) -> int:
    """Try findings again, each in a process of its own."""
    broken = 0
    for folder in folders:
        with Watched() as worker:
            outcome = worker.try_folder(folder)
        broken += bool(outcome.trouble)
        print(f"{folder}: {outcome.word}{f': {outcome.trouble}' if outcome.trouble else ''}")
    return int(broken > 0)


def campaign(seed: int, first: int, count: int | None, seconds: float, folder: Path, kind: str | None = None) -> int:
    """Try cases of a seed until the time is over.

    Args:
        seed: What they are drawn from.
        first: Number of the first one.
        count: At most so many; None for any number.
        seconds: How long.
        folder: Where findings are kept.
        kind: Of the cases; None for all kinds.
    """
    print(f"seed {seed}, from case {first}")
    outcomes, causes, begin = Counter[tuple[str, str]](), Counter[str](), time.monotonic()
    told, number = begin, first
    with Watched() as worker:
        while time.monotonic() - begin < seconds and (count is None or number < first + count):
            outcome = worker.try_number(seed, number, kind)
            case = case_of(seed, number, kind) if outcome.trouble else None
            outcomes[case.kind if case else outcome.kind, outcome.word] += 1
            if case is not None:
                finding = Finding(case, outcome)
                causes[finding.signature] += 1
                if causes[finding.signature] <= _KEPT:
                    kept = keep(minimized(finding, worker, _SHRINKING), folder, seed, number)
                    print(f"case {number} ({case.title}): {outcome.word}: {outcome.trouble}\n  kept: {kept}")
            number += 1
            if time.monotonic() - told > _PROGRESS:
                told = time.monotonic()
                print(f"{number - first} cases in {told - begin:.0f} s, {len(causes)} causes", flush=True)
    print(summary(outcomes, causes, seed, first, number, time.monotonic() - begin))
    return int(bool(causes))


def keep(finding: Finding, folder: Path, seed: int, number: int) -> Path:
    """Write a finding into a folder of its own."""
    name = f"{finding.case.kind}-{hashlib.sha256(finding.signature.encode()).hexdigest()[:8]}-{seed}-{number}"
    finding.case.write(folder / name)
    said = {"seed": seed, "number": number, "outcome": finding.outcome.word, "trouble": finding.outcome.trouble}
    (folder / name / OUTCOME).write_text(json.dumps(said, indent=1) + "\n", encoding="utf-8")
    return folder / name


def summary(
    outcomes: Counter[tuple[str, str]], causes: Counter[str], seed: int, first: int, end: int, seconds: float
) -> str:
    """What the campaign came to."""
    lines = [f"seed {seed}, cases {first} to {end - 1}: {end - first} in {seconds / 60:.1f} min"]
    for kind in sorted({kind for kind, _ in outcomes}):
        counts = ", ".join(f"{count} {word}" for (of, word), count in outcomes.most_common() if of == kind)
        lines.append(f"{kind}: {counts}")
    lines.append(f"promises broken: {causes.total()} times, {len(causes)} causes")
    lines += [f"  {count} × {cause}" for cause, count in causes.most_common()]
    return "\n".join(lines)


if __name__ == "__main__":
    sys.exit(main())
