"""Sessions with processes that are wrong, and what came of them."""

from __future__ import annotations

import os
import shlex
import sys
import time
from pathlib import Path

from eurdf_conformance.protocol.message import Accepted
from eurdf_conformance.runner.outcome import Answered, Outcome
from eurdf_conformance.runner.session import Session

PARSERS = Path(__file__).parent


def fake(way: str) -> str:
    """The parser with one misbehaviour; see `process.py`."""
    return "cmd:" + shlex.join([sys.executable, "-I", "-S", str(PARSERS / "process.py"), way])


def load(session: Session, name: str, **options: float) -> Outcome:
    return session.load(Path(f"/{name}.yaml"), Path("/robot.urdf"), **options)


def accepts(outcome: Outcome, name: str) -> bool:
    """Whether a fake has accepted that description, and not another."""
    answer = outcome.answer if isinstance(outcome, Answered) else None
    return isinstance(answer, Accepted) and [issue.message for issue in answer.issues] == [f"/{name}.yaml"]


def runs(pid: int) -> bool:
    """Whether a process runs; one that is dead, and that nobody has asked after, does not."""
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    stat = Path(f"/proc/{pid}/stat")
    return not stat.exists() or stat.read_text().rpartition(")")[2].split()[0] != "Z"


def has_ended(pid: int) -> bool:
    """Whether a process ends within a moment."""
    for _ in range(50):
        if not runs(pid):
            return True
        time.sleep(0.05)
    return False
