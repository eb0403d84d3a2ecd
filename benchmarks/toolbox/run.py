"""Compare with the published toolbox: call its functions and ours, and say what is otherwise than the page states.

`EURDF_PUBLISHED_LOADER` names the folders of checkouts of example-parallel-robots and toolbox-parallel-robots, as for
the adapter of the conformance suite. Their side runs with the Pinocchio of this Python and, if `EURDF_TOOLBOX_PYTHON`
names the Python of an environment with ``pin==3.4.0 cmeel-urdfdom==4.0.1 cmeel-tinyxml2==10.0.0``, with that one, for
which it was written. Both need CasADi, SciPy, qpsolvers, proxsuite and PyYAML. Ours runs with this Python.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from dataclasses import dataclass

import pinocchio as pin

import eurdf
from benchmarks.toolbox.calls import Version, called, checkout, pythons
from benchmarks.toolbox.checks import CHECKS, FRAMES
from benchmarks.toolbox.outcome import Found, case, judged
from benchmarks.toolbox.robots import PUBLISHED, Published
from eurdf_conformance.adapters.published_loader import FOLDERS


@dataclass(frozen=True)
class Seen:
    """One call with one version of Pinocchio, and what was seen otherwise than the page says, if anything."""

    version: Version
    robot: str
    call: str
    otherwise: str | None


def reruns(version: Version) -> Iterator[Seen]:
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
        found = called(version, [call for _, call in here], of)
        for (check, call), each in zip(here, found, strict=True):
            expected = (check.new if version == "4.1" else None) or check.old
            yield Seen(version, robot, call, judged(expected, check.compare, of, each))
    for theirs in PUBLISHED:
        call = f"size_of(load({theirs.name!r}))"
        yield Seen(version, theirs.name, call, _otherwise(theirs, version, *called(version, [call])))


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
    for version in pythons():
        for seen in reruns(version):
            failed |= seen.otherwise is not None
            otherwise = " ".join((seen.otherwise or "as stated").split())
            print(f"{otherwise:40.120} Pinocchio {version} {seen.robot:14}{seen.call}", flush=True)
    return failed
