"""Rules of closures that draw their line elsewhere."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import replace
from typing import Any

import pinocchio as pin

from eurdf.format.extension import ClosureEntry
from eurdf.kinematics import assembly, evaluation, residual
from eurdf.linking import closures, link
from eurdf.linking.description import Description
from eurdf.mechanism.frame import Anchor
from eurdf.mechanism.pose import Pose
from eurdf.pinocchio.placement import placement_of
from eurdf_conformance.mutants.deviation import Deviation, around, instead, result, together
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
    reason = "not closed"

    def __init__(self, openings: Any) -> None:
        self.open = openings


@mutant("EU-FIL-002", versions=("1",))  # in version 2 the file of a case would have 140 kB
def constraint_rows_without_bound() -> Deviation:
    """The closures of a robot may have any number of constraint rows."""
    return instead(link, "ROW_LIMIT", 10**9)


@mutant("EU-FIL-002", versions=("2",))  # the same bound in version 1, for which there is no case
def velocities_without_bound() -> Deviation:
    """The joints of a robot may have any number of velocities."""
    return instead(link, "VELOCITY_LIMIT", 10**9)


def _own_types(entries: Iterable[ClosureEntry]) -> tuple[list[ClosureEntry], list[ClosureEntry]]:
    """The closures of types of the user's own, and the others."""
    entries = list(entries)
    return [each for each in entries if each.type.startswith("x-")], [
        each for each in entries if not each.type.startswith("x-")
    ]


@mutant("EU-FRM-001", versions=("2",))  # version 1 has no other types
def frames_of_own_types_are_not_looked_at() -> Deviation:
    """What a closure of a type of the user's own joins is not looked at."""

    def linked(original: Any, entries: Iterable[ClosureEntry], *arguments: Any) -> Any:
        return original(_own_types(entries)[1], *arguments)

    return around(link, "link_closures", linked)


@mutant("EU-CLO-001")
def own_types_have_names_of_their_own() -> Deviation:
    """A closure of a type of the user's own may have the name of another."""

    def renamed(entry: ClosureEntry) -> ClosureEntry:
        return replace(entry, name=f"{entry.type} {entry.name}") if entry.type.startswith("x-") else entry

    return said_in_version2(lambda said: replace(said, closures=tuple(map(renamed, said.closures))))


@mutant("EU-CLO-003", versions=("2",))  # version 1 has no other types
def own_types_on_one_body() -> Deviation:
    """A closure of a type of the user's own may join two frames of one body."""
    return around(
        closures,
        "_movable",
        lambda original, entry, *arguments: entry.type.startswith("x-") or original(entry, *arguments),
    )


@mutant("EU-CLO-004", versions=("2",))  # version 1 has no other types
def own_types_join_what_is_joined() -> Deviation:
    """A closure of a type of the user's own may join frames that another joins."""

    def linked(original: Any, entries: Iterable[ClosureEntry], *arguments: Any) -> Any:
        own, others = _own_types(entries)
        for entry in own:
            original([entry], *arguments)
        return original(others, *arguments)

    return around(link, "link_closures", linked)


class _Largest:
    """The functions of `math`, but that the length of a vector is its largest number."""

    def __getattr__(self, name: str) -> Any:
        return getattr(math, name)

    @staticmethod
    def hypot(*numbers: float) -> float:
        return max(map(abs, numbers))


def _open_by_component() -> Deviation:
    return together(instead(residual, "math", _Largest()), instead(evaluation, "math", _Largest()))


@mutant("EU-CLO-005")
def open_along_an_axis() -> Deviation:
    """A closure is open where it is open by more than 1e-6 along an axis."""
    return _open_by_component()


@mutant("EU-CLO-006")
def cannot_close_along_an_axis() -> Deviation:
    """A closure cannot close where it stays open by more than 1e-6 along an axis."""
    return _open_by_component()


def _length_of_rows(position: float, angle: float) -> float:
    return math.hypot(position, angle)


def _open_by_all_rows() -> Deviation:
    """The bound holds for the length of the rows of a closure, metres and radians together."""

    def one(openings: Any) -> Any:
        return tuple(replace(each, position=_length_of_rows(each.position, each.angle)) for each in openings)

    return together(
        result(residual, "closure_openings", one),
        result(
            evaluation.Evaluation,
            "openings",
            lambda found: [(_length_of_rows(position, angle), angle) for position, angle in found],
        ),
    )


@mutant("EU-CLO-005")
def metres_and_radians_together() -> Deviation:
    """A closure is open where the length of its six rows, metres and radians together, is more than 1e-6."""
    return _open_by_all_rows()


@mutant("EU-CLO-006")
def metres_and_radians_cannot_close_together() -> Deviation:
    """A closure cannot close where the length of its six rows, metres and radians together, stays above 1e-6."""
    return _open_by_all_rows()


@mutant("EU-CLO-005")
def openings_of_all_closures_together() -> Deviation:
    """The bound of 1e-6 holds for the length of all residuals together."""

    def all_of_them(openings: Any) -> Any:
        length = math.hypot(*(each.position for each in openings))
        return tuple(replace(each, position=length) for each in openings)

    return result(residual, "closure_openings", all_of_them)


@mutant("EU-CLO-004")
def frames_at_one_place_are_one() -> Deviation:
    """Two frames are the same where they stand at one place of one body, on whatever links, to rounding."""

    def repeated(read: Description) -> bool:
        robot = read.mechanism
        assert robot is not None
        on = {robot.bodies[0].name: (robot.bodies[0].name, Pose())}
        for joint in robot.joints:
            body, pose = on[joint.parent]
            held = joint.type == "fixed"
            on[joint.child] = (body, pose * joint.placement * joint.offset) if held else (joint.child, Pose())

        def frame(anchor: Anchor) -> tuple[Any, ...]:
            body, pose = on[anchor.body]
            M = placement_of(pose * anchor.pose).homogeneous
            return body, *(M.round(9) + 0.0).ravel().tolist()

        pairs = [frozenset((frame(each.a), frame(each.b))) for each in robot.closures]
        return len(set(pairs)) < len(pairs)

    return refused(repeated)


@mutant("EU-CLO-006")
def must_close_within_limits() -> Deviation:
    """Loops that close only beyond the limits of joints are told not to close."""

    def assemble(original: Any, robot: Any, *arguments: Any, **named: Any) -> Any:
        found = original(robot, *arguments, **(named | {"limits": True}))
        return found if found.closes else _Open(found.open)

    return around(assembly, "assemble", assemble)
