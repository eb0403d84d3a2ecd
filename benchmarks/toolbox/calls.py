"""Where the published code is, and calls of its functions in processes of their own."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from subprocess import PIPE
from typing import Any, Literal

from benchmarks.toolbox.outcome import Case, Found
from eurdf_conformance.adapters.published_loader import FOLDERS

#: Names the Python of an environment with the Pinocchio for which the code was written.
PYTHON = "EURDF_TOOLBOX_PYTHON"
#: Time of a call, s, after which it is taken not to end.
LONGEST = 30.0
_HERE = Path(__file__).parent
_ROOT = _HERE.parents[1]

Version = Literal["3.4", "4.1"]


def folders() -> list[str]:
    """The checkouts."""
    return [os.path.abspath(folder) for folder in os.environ.get(FOLDERS, "").split(os.pathsep) if folder]


def checkout() -> Path:
    """That of example-parallel-robots, where `load` finds the folder ``robots``."""
    return next(Path(folder) for folder in folders() if Path(folder, "robots").is_dir())


def pythons() -> dict[Version, str]:
    """The Python of each version of Pinocchio that can be tried."""
    if FOLDERS not in os.environ:
        return {}
    found: dict[Version, str] = {"4.1": sys.executable}
    if PYTHON in os.environ:
        found["3.4"] = os.environ[PYTHON]
    return found


def called(version: Version, calls: Sequence[str], of: Case | None = None) -> list[Found]:
    """What calls of their functions do with a version of Pinocchio, for a robot or for none."""
    python, environment = pythons()[version], dict(os.environ)
    if version != "4.1":
        environment.pop("PYTHONPATH", None)  # it is for this Python
    # Only this Python has eurdf; elsewhere their loader reads the robot.
    loader = "eurdf" if version == "4.1" else "theirs"
    request: dict[str, Any] = {"folders": folders(), "loader": loader, "folder": ""}
    if of is not None:
        request |= {"folder": str(_ROOT / "robots" / of.name), "frame": of.frame}
        request |= {"arrays": {name: value.tolist() for name, value in of.arrays.items()}}
    found: list[Found] = []
    while len(found) < len(calls):
        left = json.dumps(request | {"calls": calls[len(found) :]})
        command = [python, str(_HERE / "theirs.py")]
        with subprocess.Popen(
            command, stdin=PIPE, stdout=PIPE, stderr=PIPE, text=True, cwd=checkout(), env=environment
        ) as process:
            try:
                answers, errors = process.communicate(left, timeout=LONGEST * (len(calls) - len(found)))
            except subprocess.TimeoutExpired:
                process.kill()
                answers, errors = process.communicate()
        found += [Found(**json.loads(line)) for line in answers.splitlines()]
        if process.returncode > 0:
            raise RuntimeError(f"their side cannot be run with {python}: {errors.strip().splitlines()[-1]}")
        if process.returncode < 0 and len(found) < len(calls):
            found.append(Found(signal=-process.returncode))
    return found
