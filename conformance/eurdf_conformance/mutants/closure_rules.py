"""Rules of closures that draw their line elsewhere."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pinocchio as pin

from eurdf.description import Description
from eurdf.format.extension import ClosureEntry
from eurdf.kinematics import assembly, residual
from eurdf.mechanism import link
from eurdf_conformance.mutants.deviation import Deviation, around, instead
from eurdf_conformance.mutants.mutant import mutant
from eurdf_conformance.mutants.of_the_reference import refused, said_in_version2


@mutant("EU-CLO-011")
def planar_loop_in_6d_refused() -> Deviation:
    """A closure of six rows is refused where the tree has less than six velocities."""

    def redundant(read: Description) -> bool:
        robot = read.mechanism
        assert robot is not None
        short = sum(joint.coordinates.nv for joint in robot.joints) < 6
        return short and any(closure.type == "6d" for closure in robot.closures)

    return refused(redundant)


@mutant("EU-CLO-012")
def own_type_is_6d() -> Deviation:
    """A closure of a type of the user's own is 6d."""

    def known(entry: ClosureEntry) -> ClosureEntry:
        return replace(entry, type="6d") if entry.type.startswith("x-") else entry

    return said_in_version2(lambda said: replace(said, closures=tuple(map(known, said.closures))))


@mutant("EU-CLO-012")
def own_type_refused() -> Deviation:
    """A description with a closure of a type of the user's own is refused."""

    def own(read: Description) -> bool:
        return read.extension is not None and any(each.type.startswith("x-") for each in read.extension.closures)

    return refused(own)


@mutant("EU-CLO-003")
def fixed_joints_separate() -> Deviation:
    """Two links that a fixed joint holds together are two bodies."""
    return instead(
        link, "rigid_roots", lambda root, ordered: {root: root, **{each.child: each.child for each in ordered}}
    )


@mutant("EU-CLO-005")
def tolerance_of_a_tenth_of_a_millimetre() -> Deviation:
    """A closure may be open by 1e-4."""
    return instead(residual, "CLOSED", 1e-4)


@mutant("EU-CLO-005")
def tolerance_of_rounding() -> Deviation:
    """A closure may be open by 1e-10."""
    return instead(residual, "CLOSED", 1e-10)


@mutant("EU-CLO-005")
def angles_are_not_looked_at() -> Deviation:
    """A closure is closed where its origins meet."""
    return instead(residual.Opening, "is_open", property(lambda opening: opening.position > residual.CLOSED))


@mutant("EU-CLO-006")
def must_close_at_neutral() -> Deviation:
    """Loops that are open at neutral are told not to close."""

    def assemble(original: Any, robot: Any, *arguments: Any, **named: Any) -> Any:
        found = original(robot, *arguments, **named)
        openings = residual.closure_openings(robot, pin.neutral(robot.model))
        if any(each.is_open for each in openings):
            return _Open(tuple(each for each in openings if each.is_open))
        return found

    return around(assembly, "assemble", assemble)


class _Open:
    """An assembly that did not close."""

    closes = False

    def __init__(self, openings: Any) -> None:
        self.open = openings


@mutant("EU-FIL-002")
def closures_times_joints_without_bound() -> Deviation:
    """A robot may have any number of closures on any number of joints."""
    return instead(link, "CLOSURES_TIMES_JOINTS_LIMIT", 10**12)
