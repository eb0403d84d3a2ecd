"""Compare with the published toolbox: call its functions and ours, and say what is otherwise than the page states.

`EURDF_PUBLISHED_LOADER` names the folders of checkouts of example-parallel-robots and toolbox-parallel-robots, as for
the adapter of the conformance suite. Their side runs with the Pinocchio of this Python and, if `EURDF_TOOLBOX_PYTHON`
names the Python of an environment with ``pin==3.4.0 cmeel-urdfdom==4.0.1 cmeel-tinyxml2==10.0.0``, with that one, for
which it was written. Both need CasADi, SciPy, qpsolvers, proxsuite and PyYAML. Ours runs with this Python.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from subprocess import PIPE
from typing import Any, Literal

import pinocchio as pin

import eurdf
from benchmarks.toolbox.checks import CHECKS, FRAMES
from benchmarks.toolbox.outcome import Case, Found, case, judged
from benchmarks.toolbox.robots import PUBLISHED, Published
from eurdf_conformance.adapters.published_loader import FOLDERS

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


def called(python: str, calls: Sequence[str], of: Case | None = None, loader: str = "eurdf") -> list[Found]:
    """What calls of their functions do, for a robot or for none."""
    request: dict[str, Any] = {"folders": folders(), "loader": loader, "folder": ""}
    if of is not None:
        request |= {"folder": str(_ROOT / "robots" / of.name), "frame": of.frame}
        request |= {"arrays": {name: value.tolist() for name, value in of.arrays.items()}}
    found: list[Found] = []
    while len(found) < len(calls):
        left = json.dumps(request | {"calls": calls[len(found) :]})
        with subprocess.Popen(
            [python, str(_HERE / "theirs.py")], stdin=PIPE, stdout=PIPE, stderr=PIPE, text=True, cwd=checkout()
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


@dataclass(frozen=True)
class Seen:
    """One call with one version of Pinocchio, and what was seen otherwise than the page says, if anything."""

    version: Version
    robot: str
    call: str
    otherwise: str | None


def reruns(version: Version, python: str) -> Iterator[Seen]:
    """All calls of the rows, and the loading of their robots."""
    for robot, frame in [*FRAMES.items(), ("", "")]:
        here = [
            (check, call)
            for names, checks in CHECKS.items()
            for check in checks
            if (robot in check.robots if robot else not check.robots)
            for call in dict.fromkeys(check.call.replace("{f}", name) for name in names.split())
        ]
        of = case(robot, frame) if robot else None
        found = called(python, [call for _, call in here], of, "eurdf" if version == "4.1" else "theirs")
        for (check, call), each in zip(here, found, strict=True):
            expected = (check.new if version == "4.1" else None) or check.old
            yield Seen(version, robot, call, judged(expected, check.compare, of, each))
    for theirs in PUBLISHED:
        call = f"size_of(load({theirs.name!r}))"
        yield Seen(version, theirs.name, call, _otherwise(theirs, version, *called(python, [call])))


def _otherwise(robot: Published, version: Version, found: Found) -> str | None:
    """What their loader and ours make of a robot otherwise than the page says."""
    if isinstance(robot.size, str):
        return None if robot.size in found.error else found.error or f"signal {found.signal}, {found.value}"
    if version == "4.1" and found.value is None:
        return None  # the page says that this happens in some runs
    if found.value != list(robot.size):
        return f"{found.value}, {found.error}"
    folder = checkout() / "robots" / robot.folder
    if robot.name == "disney_2legs":
        report = eurdf.check(folder)
        wrong = {each.code for each in report.diagnostics if each.severity == "error"}
        return None if wrong == {"unknown-joint"} else f"ours: {wrong}"
    ours = eurdf.load(folder, root=robot.root, geometry=False)
    size = ours.model.nv, eurdf.analyze(ours, pin.neutral(ours.model)).nc, len(ours.actuation.idx_v)
    return None if size == robot.size else f"ours: {size}"


def main(arguments: list[str]) -> int:
    """Print each call and whether it did what the page says; 1 if one did not, 2 if there is nothing to call."""
    argparse.ArgumentParser(
        prog="python -m benchmarks toolbox", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    ).parse_args(arguments)
    failed = 0
    if not pythons():
        print(f"set {FOLDERS} to the folders of checkouts of example-parallel-robots and toolbox-parallel-robots")
        return 2
    for version, python in pythons().items():
        for seen in reruns(version, python):
            failed |= seen.otherwise is not None
            otherwise = " ".join((seen.otherwise or "as stated").split())
            print(f"{otherwise:40.120} Pinocchio {version} {seen.robot:14}{seen.call}", flush=True)
    return failed
