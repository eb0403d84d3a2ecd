"""Advice on actuation: no actuator, actuators that depend on one another, motions that no actuator decides."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from eurdf.advice.passive import needs_no_actuator, without_spins
from eurdf.kinematics.analysis import Analysis, LoopAnalysis, analyze
from eurdf.pinocchio.robot import build_robot

if TYPE_CHECKING:
    from eurdf.description import Description
    from eurdf.diagnostics import Diagnostics, Place
    from eurdf.kinematics.array import Vector
    from eurdf.mechanism.mechanism import Mechanism
    from eurdf.pinocchio.robot import Robot

# Warnings of what changes which joints are actuated or constrained.
_REASONS = frozenset({"near-miss-key", "closure-type-unknown", "urdf-closure-ignored"})

# Of a group of loops, so many closures at most are tried one by one.
_MOST_TRIED = 12

# Names that a message lists, and motions.
_NAMES_LISTED = 6
_MOTIONS_LISTED = 3


def advise_on_actuation(description: Description, robot: Robot, q: Vector, diagnostics: Diagnostics) -> None:
    """Report loops without an actuator; else actuators that depend on one another, and motions left uncontrolled.

    Nothing is said where an earlier warning may be the reason: a misspelt key, or a closure that is left out.

    Args:
        description: The robot as read; it has closures.
        robot: The robot built from it.
        q: A closed configuration (nq,).
        diagnostics: Gets what is found.
    """
    mechanism = robot.mechanism
    if any(found.code in _REASONS for found in description.diagnostics):
        return
    if not mechanism.actuators:
        count = len(mechanism.closures)
        diagnostics.report(
            "x-no-actuator",
            f"the robot has {count} {'closure' if count == 1 else 'closures'} and no actuator",
            _place_of_key(description, "closed_loop" if mechanism.version == "1" else "closures"),
            f"list the joints that its motors drive under '{_actuators_key(mechanism)}'",
        )
        return
    analysis = analyze(robot, q)
    for loop in analysis.loops:
        if loop.fighting:
            _report_dependent(description, robot, analysis.q, loop, diagnostics)
    _report_uncontrolled(description, robot, analysis, diagnostics)


def _report_dependent(
    description: Description, robot: Robot, q: Vector, loop: LoopAnalysis, diagnostics: Diagnostics
) -> None:
    """Report the dependent actuators of a group of loops, and the 6d closures to blame where they are found."""
    dependent = [name for together in loop.fighting for name in together]
    locked = len(dependent) == len(loop.fighting)  # each alone in its set
    message = (
        f"{_counted('actuator', dependent)} cannot move{'' if locked else ' independently'}: "
        f"{'locked' if locked else 'coupled'} by {_counted('closure', loop.closures)}"
    )
    locking = _locking(robot, q, loop, dependent)
    if locking:
        place = description.place_of_closure(next(each for each in robot.mechanism.closures if each.name == locking[0]))
        hint = (
            f"type 3d for {_counted('closure', locking)} frees the actuators; use it for a ball joint, or for a pin "
            "of a planar loop"
        )
    else:
        place = _place_of_last_actuator(description, dependent)
        hint = f"list only actuators that can move{'' if locked else ' independently'}, or correct the closures"
    diagnostics.report("x-dependent-actuators", message, place, hint)


def _locking(robot: Robot, q: Vector, loop: LoopAnalysis, dependent: Sequence[str]) -> tuple[str, ...]:
    """The 6d closures of a group that, as 3d ones, let its dependent actuators move and leave no motion uncontrolled.

    Found by trial: each alone, then all of the group.
    """
    mechanism = robot.mechanism
    group = [closure for closure in mechanism.closures if closure.name in loop.closures]
    uncontrolled = len(without_spins(robot, loop))
    for names in _trials([closure.name for closure in group if closure.type == "6d"]):
        closures = tuple(replace(closure, type="3d") if closure.name in names else closure for closure in group)
        trial = build_robot(replace(mechanism, closures=closures), geometry=False)
        found = analyze(trial, q)
        still = {name for each in found.fighting for name in each}
        left = sum(len(without_spins(trial, each)) for each in found.loops)
        if found.closes and left <= uncontrolled and still.isdisjoint(dependent):
            return names
    return ()


def _trials(names: Sequence[str]) -> Iterator[tuple[str, ...]]:
    """Each name alone, where they are not many, then all together."""
    if len(names) <= _MOST_TRIED:
        yield from ((name,) for name in names)
    if len(names) > 1:
        yield tuple(names)


def _report_uncontrolled(description: Description, robot: Robot, analysis: Analysis, diagnostics: Diagnostics) -> None:
    """Report the motions that are possible with every actuator held, but for those that need none."""
    in_loops = sum(len(loop.motions) for loop in analysis.loops)
    motions = [motion for loop in analysis.loops for motion in without_spins(robot, loop)]
    motions += [motion for motion in analysis.motions[in_loops:] if not needs_no_actuator(robot, motion)]
    if motions:
        count = len(motions)
        moved = list(dict.fromkeys(_quoted(motion.joints) for motion in motions))
        shown = "; ".join(moved[:_MOTIONS_LISTED]) + ("; ..." if len(moved) > _MOTIONS_LISTED else "")
        diagnostics.report(
            "x-uncontrolled-motion",
            f"{count} {'motion is' if count == 1 else 'motions are'} possible with every actuator held, of {shown}",
            _place_of_key(description, _actuators_key(robot.mechanism)),
            "actuate a joint of each, add the closure that is missing, or use type 6d where orientation is held too",
        )


def _actuators_key(mechanism: Mechanism) -> str:
    return "name_mot" if mechanism.version == "1" else "actuators"


def _place_of_key(description: Description, key: str) -> Place:
    assert description.document is not None
    return description.document.place((key,), True)


def _place_of_last_actuator(description: Description, joints: Sequence[str]) -> Place:
    """Of several actuators the one that is listed last, as what was added most likely."""
    assert description.extension is not None
    assert description.document is not None
    entry = next(entry for entry in reversed(description.extension.actuators) if entry.joint in joints)
    return description.document.place(entry.pointer)


def _counted(noun: str, names: Sequence[str]) -> str:
    """A noun, in the plural where there are several, and the names in quotes."""
    return f"{noun if len(names) == 1 else noun + 's'} {_quoted(names)}"


def _quoted(names: Sequence[str]) -> str:
    """Names in quotes, a few at most."""
    more = ", ..." if len(names) > _NAMES_LISTED else ""
    return ", ".join(f"'{name}'" for name in names[:_NAMES_LISTED]) + more
