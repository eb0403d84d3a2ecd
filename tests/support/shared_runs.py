"""Runs of ``eurdf certify`` that several tests look at: each is made once a session, whichever worker asks first."""

from __future__ import annotations

import fcntl
import hashlib
import json
from dataclasses import asdict, dataclass
from pathlib import Path

from support.warm import run_module


@dataclass(frozen=True)
class SharedRun:
    """A run of ``eurdf certify`` that has ended."""

    returncode: int
    stdout: str
    stderr: str
    #: The folder with its certificate: not to be written to.
    certificate: str


def certify_once(session: Path, *argv: str) -> SharedRun:
    """Run ``eurdf certify`` with some arguments, unless that was done in this session.

    Args:
        session: A folder that all workers of the session share.
        argv: The arguments.
    """
    folder = session / f"certify-{hashlib.sha256(json.dumps(argv).encode()).hexdigest()[:16]}"
    folder.mkdir(exist_ok=True)
    done = folder / "run.json"
    with (folder / "lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not done.exists():
            certificate = str(folder / "certificate")
            ended = run_module("eurdf", ["certify", *argv, "--certificate", certificate], cwd=folder)
            made = SharedRun(ended.returncode, ended.stdout, ended.stderr, certificate)
            done.write_text(json.dumps(asdict(made)), encoding="utf-8")
    return SharedRun(**json.loads(done.read_text(encoding="utf-8")))
