"""Advice on actuation: no actuator, actuators that depend on one another, motions that no actuator decides."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import zip_longest

from eurdf.advice.hinges import LikelyHinge, likely_hinge
from eurdf.advice.passive import PassiveMotions
from eurdf.array import Vector
from eurdf.diagnostics import Diagnostics, Place, plural, quoted
from eurdf.kinematics.analysis import Analysis, analyze
from eurdf.kinematics.loop_analysis import LoopAnalysis
from eurdf.linking.robot_files import ReadRobot
from eurdf.mechanism.mechanism import Mechanism
from eurdf.pinocchio.robot import Robot, build_robot

# Warnings of what changes which joints are actuated or constrained.
_REASONS = frozenset({"near-miss-key", "closure-type-unknown", "urdf-closure-ignored"})

# Of a group of loops, so many closures at most are tried one by one.
_MOST_TRIED = 12

# Names that a message lists, and motions.
_NAMES_LISTED = 6
_MOTIONS_LISTED = 3


def advise_on_actuation(read: ReadRobot, robot: Robot, analysis: Analysis | None, diagnostics: Diagnostics) -> None:
    """Report loops without an actuator; else actuators that depend on one another, and motions left uncontrolled.

    The analysis is None for a robot without actuators. Nothing is reported where an earlier warning may be the reason:
    a misspelt key, or a closure that is left out.
    """
    mechanism = robot.mechanism
    if any(found.code in _REASONS for found in read.diagnostics):
        return
    if analysis is None:
        key = _closures_key(mechanism)
        noun = "coupling" if key == "couplings" else "closure"
        diagnostics.report(
            "x-no-actuator",
            f"the robot has {plural(len(mechanism.constraints), noun)} and no actuator",
            _place_of_key(read, key),
            f"list the joints that its motors drive under '{_actuators_key(mechanism)}'",
        )
        return
    if analysis.left_out:
        place = _place_of_key(read, _closures_key(mechanism))
        diagnostics.report("x-loops-not-checked", analysis.left_out, place, "analyze parts of the robot separately")
        return
    shaky = [loop for loop in analysis.loops if loop.mobility and loop.finite_mobility == 0]
    if shaky:  # what actuators do there says little about another configuration
        for loop in shaky:
            diagnostics.report(
                "x-shaky-loops",
                f"the loops of {_constraints(mechanism, loop)} have {plural(loop.mobility, 'motion')} to first order, "
                "but are rigid",
                read.place_of_constraint(loop.closures[0]),
                "check the lengths at this configuration, or state another one as 'assembled'",
            )
        return
    dependent = [loop for loop in analysis.loops if loop.dependent_actuators]
    if dependent:
        for loop, locking in zip(dependent, _locking(robot, analysis.q, dependent), strict=True):
            hinge = None if locking else _freeing_hinge(robot, analysis.q, loop)
            _report_dependent(read, robot, loop, locking, hinge, diagnostics)
    _report_uncontrolled(read, robot, analysis, diagnostics)


def _report_dependent(
    read: ReadRobot,
    robot: Robot,
    loop: LoopAnalysis,
    locking: Sequence[str],
    hinge: LikelyHinge | None,
    diagnostics: Diagnostics,
) -> None:
    """Report the dependent actuators of a group of loops, and the closures whose orientation locks them, if found."""
    dependent = [name for together in loop.dependent_actuators for name in together]
    # Each is alone in its set, and has one velocity: of several, others may be free.
    one_each = len(frozenset(loop.joints).intersection(robot.actuation.joints)) == loop.actuated
    locked = one_each and len(dependent) == len(loop.dependent_actuators)
    message = (
        f"{_counted('actuator', dependent)} cannot move{'' if locked else ' independently'}: "
        f"{'locked' if locked else 'coupled'} by {_constraints(robot.mechanism, loop)}"
    )
    if locking:
        place = read.place_of_constraint(locking[0])
        hint = (
            f"type 3d for {_counted('closure', locking)} frees the actuators; use it for a ball joint, or for a pin "
            "of a planar loop"
        )
    elif hinge is not None:
        place = read.place_of_constraint(hinge.closure)
        hint = f"if closure '{hinge.closure}' is a pin, {hinge} frees the actuators"
    else:
        # Of several actuators the one that is listed last, as what was added most likely.
        entry = next(entry for entry in reversed(read.description.actuators) if entry.joint in dependent)
        place = read.description.document.place(entry.pointer)
        hint = f"list only actuators that can move{'' if locked else ' independently'}, or correct the closures"
    diagnostics.report("x-dependent-actuators", message, place, hint)


def _locking(robot: Robot, q: Vector, loops: Sequence[LoopAnalysis]) -> list[tuple[str, ...]]:
    """For each group, the closures that free its dependent actuators, and no other motion, if they hold positions only.

    Found by trial: each alone, then all of the group; of all groups at once, since none changes another.
    """
    mechanism, passive = robot.mechanism, PassiveMotions(robot)
    members = {name for loop in loops for name in loop.closures}
    group = [closure for closure in mechanism.closures if closure.name in members]
    freer = {closure.name: closure.with_orientation_free() for closure in group}
    spatial = {closure.name for closure in group if freer[closure.name] is not closure}
    uncontrolled = [len(passive.needing_actuators(loop)) for loop in loops]
    trials = [_trials([name for name in loop.closures if name in spatial]) for loop in loops]
    found: list[tuple[str, ...]] = [()] * len(loops)
    for tried in zip_longest(*trials, fillvalue=()):
        pending = [index for index, names in enumerate(tried) if names and not found[index]]
        if not pending:
            continue
        changed = {name for index in pending for name in tried[index]}
        closures = tuple(freer[each.name] if each.name in changed else each for each in group)
        trial = build_robot(replace(mechanism, closures=closures), geometry=False)
        after = {loop.closures: loop for loop in analyze(trial, q).loops}
        passive = PassiveMotions(trial)
        for index in pending:
            loop, freed = loops[index], after.get(loops[index].closures)
            if freed is None:  # not even so do the loops close
                continue
            still = {name for together in freed.dependent_actuators for name in together}
            if still.isdisjoint(name for together in loop.dependent_actuators for name in together) and (
                len(passive.needing_actuators(freed)) <= uncontrolled[index]
            ):
                found[index] = tried[index]
    return found


def _freeing_hinge(robot: Robot, q: Vector, loop: LoopAnalysis) -> LikelyHinge | None:
    """A closure that as a hinge makes actuators independent, and leaves no more motions without one."""
    before = _uncontrolled(robot, loop)
    return likely_hinge(
        robot, q, loop, lambda trial, found: not found.dependent_actuators and _uncontrolled(trial, found) <= before
    )


def _controlling_hinge(robot: Robot, q: Vector, loop: LoopAnalysis) -> LikelyHinge | None:
    """A closure that as a hinge leaves the controlled motions as they are, and fewer without an actuator."""
    before, controlled = _uncontrolled(robot, loop), loop.controlled
    return likely_hinge(
        robot, q, loop, lambda trial, found: found.controlled == controlled and _uncontrolled(trial, found) < before
    )


def _uncontrolled(robot: Robot, loop: LoopAnalysis) -> int:
    return len(PassiveMotions(robot).needing_actuators(loop))


def _trials(names: Sequence[str]) -> list[tuple[str, ...]]:
    """Each name alone, where they are not many, then all together."""
    alone: list[tuple[str, ...]] = [(name,) for name in names] if len(names) <= _MOST_TRIED else []
    return [*alone, tuple(names)] if len(names) > 1 else alone


def _report_uncontrolled(read: ReadRobot, robot: Robot, analysis: Analysis, diagnostics: Diagnostics) -> None:
    """Report the motions that are possible with every actuator held, except those that need no actuator."""
    if not analysis.motions:
        return
    passive = PassiveMotions(robot)
    in_loops = sum(len(loop.motions) for loop in analysis.loops)
    motions = [motion for loop in analysis.loops for motion in passive.needing_actuators(loop)]
    motions += [motion for motion in analysis.motions[in_loops:] if passive.needs_actuator(motion)]
    if motions:
        count = len(motions)
        moved = list(dict.fromkeys(quoted(motion.joints, _NAMES_LISTED) for motion in motions))
        hint = (
            "actuate a joint of each motion, add the missing closure, or use type 6d if it also fixes the orientation"
        )
        loose = (loop for loop in analysis.loops if loop.actuated and passive.needing_actuators(loop))
        hinges = (_controlling_hinge(robot, analysis.q, loop) for loop in loose)
        if (hinge := next(filter(None, hinges), None)) is not None:
            hint = f"if closure '{hinge.closure}' is a pin, {hinge} leaves fewer; else {hint}"
        shown = "; ".join(moved[:_MOTIONS_LISTED]) + ("; ..." if len(moved) > _MOTIONS_LISTED else "")
        diagnostics.report(
            "x-uncontrolled-motion",
            f"{count} {'motion remains' if count == 1 else 'motions remain'} when every actuator is held: {shown}",
            _place_of_key(read, _actuators_key(robot.mechanism)),
            hint,
        )


def _closures_key(mechanism: Mechanism) -> str:
    if mechanism.version == "1":
        return "closed_loop"
    return "closures" if mechanism.closures else "couplings"


def _actuators_key(mechanism: Mechanism) -> str:
    return "name_mot" if mechanism.version == "1" else "actuators"


def _place_of_key(read: ReadRobot, key: str) -> Place:
    return read.description.document.place((key,), True)


def _constraints(mechanism: Mechanism, loop: LoopAnalysis) -> str:
    """The closures and the couplings of a group of loops."""
    kinds = {"closure": mechanism.closures, "coupling": mechanism.couplings}
    named = {noun: [each.name for each in kind if each.name in loop.closures] for noun, kind in kinds.items()}
    return " and ".join(_counted(noun, names) for noun, names in named.items() if names)


def _counted(noun: str, names: Sequence[str]) -> str:
    """A noun, in the plural where there are several, and the names in quotes."""
    return f"{noun if len(names) == 1 else noun + 's'} {quoted(names, _NAMES_LISTED)}"
