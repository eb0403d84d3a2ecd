"""Advice on actuation: no actuator, actuators that depend on one another, motions that no actuator decides."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import compress, zip_longest

import numpy as np

from eurdf.advice.hinges import LikelyHinge, are_aligned, closures_of, likely_hinge, with_closures
from eurdf.advice.likely_closures import forgotten_closures, retyped
from eurdf.advice.likely_joints import is_planar, needless_types, other_joints
from eurdf.advice.likely_motors import LikelyMotors
from eurdf.advice.passive import PassiveMotions
from eurdf.array import Vector
from eurdf.closures.frame import FrameClosure
from eurdf.closures.point import PointClosure
from eurdf.diagnostics import Diagnostics, Fix, Place, enumerated, plural, quoted
from eurdf.kinematics.analysis import Analysis, analyze
from eurdf.kinematics.loop_analysis import LoopAnalysis, Motion, sparse_basis
from eurdf.kinematics.residual import residual_and_jacobian
from eurdf.linking.robot_files import ReadRobot
from eurdf.mechanism.mechanism import Mechanism
from eurdf.pinocchio.robot import Robot, build_robot

# Warnings of what changes which joints are actuated or constrained.
_REASONS = frozenset({"near-miss-key", "closure-type-unknown", "urdf-closure-ignored"})

# Of a group of loops, so many closures at most are tried one by one.
_MOST_TRIED = 12

# At a dead point, the smallest singular value of the dimensionless K, stacked with the rows that select the actuated
# velocities, is at most this. In the collection it is 1e-3 and more.
_DEAD = 1e-6

# Names that a message lists, and motions.
_NAMES_LISTED = 6
_MOTIONS_LISTED = 3


def advise_on_actuation(
    read: ReadRobot, robot: Robot, analysis: Analysis | None, diagnostics: Diagnostics, *, causes: bool = True
) -> None:
    """Report loops without an actuator; else actuators that depend on one another, and motions left uncontrolled.

    The analysis is None for a robot without actuators. Nothing is reported where an earlier warning may be the reason:
    a misspelt key, or a closure that is left out. Causes are looked for only if they are asked for: it takes time.
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
            f"list the joints that its motors drive under '{read.description.actuators_key}'",
            lambda: _motors(read, [joint.name for joint in mechanism.joints]) if causes else (),
        )
        return
    _report_several(read, analysis, diagnostics, causes)
    if analysis.left_out:
        place = _place_of_key(read, _closures_key(mechanism))
        diagnostics.report("x-loops-not-checked", analysis.left_out, place, "analyze parts of the robot separately")
        return
    _report_rigid(read, robot, analysis, diagnostics, causes)
    shaky = [loop for loop in analysis.loops if loop.mobility and loop.finite_mobility == 0]
    if shaky:  # what actuators do there says little about another configuration
        for loop in shaky:
            diagnostics.report(
                "x-shaky-loops",
                f"the loops of {_constraints(mechanism, loop)} have {plural(loop.mobility, 'motion')} to first order, "
                "but are rigid",
                read.place_of_constraint(loop.closures[0]),
                "check the lengths at this configuration, or state another one as 'assembled'",
                other_joints(read, robot, analysis.q, loop) if causes else (),
            )
        return
    dependent = [loop for loop in analysis.loops if loop.dependent_actuators]
    locking = _locking(robot, analysis.q, dependent) if causes and dependent else [None] * len(dependent)
    for loop, closures in zip(dependent, locking, strict=True):
        _report_dependent(read, robot, analysis.q, loop, closures, diagnostics)
    _report_uncontrolled(read, robot, analysis, diagnostics, causes)
    _report_exchanged(read, robot, analysis, diagnostics)
    if not dependent:
        _report_dead_points(read, robot, analysis, diagnostics)


def _report_rigid(read: ReadRobot, robot: Robot, analysis: Analysis, diagnostics: Diagnostics, causes: bool) -> None:
    """Report loops without an actuator and without a motion, except of a body that floats and is welded on purpose."""
    floating = {joint.name for joint in robot.mechanism.joints if joint.type.nv == 6}
    for loop in analysis.loops:
        if not loop.mobility and not loop.actuated and floating.isdisjoint(loop.joints):
            diagnostics.report(
                "x-shaky-loops",
                f"the loops of {_constraints(robot.mechanism, loop)} are rigid: {quoted(loop.joints, _NAMES_LISTED)} "
                "cannot move",
                read.place_of_constraint(loop.closures[0]),
                "is a joint missing in these loops, or has one another parent?",
                other_joints(read, robot, analysis.q, loop) if causes else (),
            )


def _report_dead_points(read: ReadRobot, robot: Robot, analysis: Analysis, diagnostics: Diagnostics) -> None:
    """Report the motions that the actuators do not hold to first order, at 'assembled' but not beside it."""
    for loop in analysis.loops if "assembled" in robot.configurations else ():
        if not loop.actuated or loop.actuation_singularity > _DEAD:
            continue
        passive = PassiveMotions(robot)
        if passive.needing_actuators(loop):  # also beside it
            continue
        actuated, names = frozenset(robot.actuation.idx_v), robot.tree.velocity_names
        free = np.array([v for name in loop.joints for v in robot.tree.velocities_of(name) if v not in actuated])
        _, values, vectors = np.linalg.svd(residual_and_jacobian(robot, analysis.q)[1][:, free])
        motions = []
        for row in sparse_basis(vectors[int((values > _DEAD * values[0]).sum()) :]):
            moving = free[np.flatnonzero(row)]
            joints = tuple(dict.fromkeys(names[v] for v in moving.tolist()))
            motions.append(Motion(joints, moving, row[np.flatnonzero(row)], analysis.q))
        if motions := passive.needing_actuators(replace(loop, motions=tuple(motions))):
            moved = quoted(list(dict.fromkeys(name for motion in motions for name in motion.joints)), _NAMES_LISTED)
            diagnostics.report(
                "x-uncontrolled-motion",
                f"at 'assembled' the actuators are at a dead point: when they are held, {moved} can still move to "
                "first order",
                read.place_of_configuration("assembled"),
                "is the axis of one of these joints wrong, or is 'assembled' to be another configuration?",
            )


def _report_exchanged(read: ReadRobot, robot: Robot, analysis: Analysis, diagnostics: Diagnostics) -> None:
    """Report actuators of loops that are not named as motors, if joints that are could be actuated in their place."""
    mechanism, motors = robot.mechanism, LikelyMotors(read)
    if not motors.named.difference(mechanism.actuators):
        return
    for loop in analysis.loops:
        named = [name for name in motors.could_be(loop.joints) if name in motors.named]
        others = [name for name in mechanism.actuators if name in loop.joints and name not in motors.named]
        if not named or len(named) != len(others):
            continue
        new = dict(zip(others, named, strict=True))
        actuators = tuple(new.get(name, name) for name in mechanism.actuators)
        trial = build_robot(replace(mechanism, actuators=actuators, motors={}), geometry=False)
        after = next(each for each in analyze(trial, analysis.q).loops if each.closures == loop.closures)
        if after.controlled < loop.controlled or after.dependent_actuators:
            continue
        verb = "is" if len(others) == 1 else "are"
        entries = [entry for entry in read.description.actuators if entry.joint in new]
        diagnostics.report(
            "x-motor-not-actuated",
            f"{enumerated(others)} {verb} actuated; {enumerated(named)} {verb} named as motors are, and {verb} not",
            read.description.document.place(entries[0].pointer),
            None,
            [motors.exchange(new)],
        )


def _motors(read: ReadRobot, moved: Sequence[str]) -> Iterator[Fix]:
    motors = LikelyMotors(read)
    yield from motors.by_name(moved)
    yield from motors.by_rating(moved)


def _report_several(read: ReadRobot, analysis: Analysis, diagnostics: Diagnostics, causes: bool) -> None:
    """Report actuated joints with several velocities, of loops or named as a motor, which has one."""
    actuated = frozenset(read.mechanism.actuators)
    joints = {joint.name: joint for joint in read.mechanism.joints if joint.type.nv > 1 and joint.name in actuated}
    if not joints:
        return
    motors = LikelyMotors(read)
    suspect = motors.named.union(*(loop.joints for loop in analysis.loops))
    for entry in read.description.actuators:
        if (joint := joints.get(entry.joint)) is not None and joint.name in suspect:
            diagnostics.report(
                "x-actuator-several",
                f"actuator '{joint.name}' has {joint.type.nv} velocities: the joint is {joint.type}",
                read.description.document.place(entry.pointer),
                None,
                motors.of_several(joint) if causes else (),
            )


def _report_dependent(
    read: ReadRobot,
    robot: Robot,
    q: Vector,
    loop: LoopAnalysis,
    locking: Sequence[str] | None,
    diagnostics: Diagnostics,
) -> None:
    """Report the dependent actuators of a group of loops, and the closures whose orientation locks them, if found.

    No cause is looked for if ``locking`` is None.
    """
    dependent = [name for together in loop.dependent_actuators for name in together]
    # Each is alone in its set, and has one velocity: of several, others may be free.
    one_each = len(frozenset(loop.joints).intersection(robot.actuation.joints)) == loop.actuated
    locked = one_each and len(dependent) == len(loop.dependent_actuators)
    message = (
        f"{_counted('actuator', dependent)} cannot move{'' if locked else ' independently'}: "
        f"{'locked' if locked else 'coupled'} by {_constraints(robot.mechanism, loop)}"
    )
    # Of several actuators the one that is listed last, as what was added most likely.
    entry = next(entry for entry in reversed(read.description.actuators) if entry.joint in dependent)
    place = read.description.document.place(entry.pointer)
    if locking is None:
        diagnostics.report("x-dependent-actuators", message, place)
        return
    motors = LikelyMotors(read)
    fixes = [*other_joints(read, robot, q, loop)]
    fixes[:0] = (fix for together in loop.dependent_actuators for fix in motors.superfluous(together))
    is_hinge = any(closure.name in locking and closure.type == "hinge" for closure in robot.mechanism.closures)
    hinge = _freeing_hinge(robot, q, loop) if is_hinge or not locking else None
    if hinge is not None:
        place = read.place_of_constraint(hinge.closure)
        fixes.append(Fix("", (), f"is closure '{hinge.closure}' a pin, of {hinge}, which frees the actuators?"))
    if locking:
        place = read.place_of_constraint(locking[0])
        free = retyped(read, locking, "3d", f"{'their' if len(locking) > 1 else 'its'} orientation locks the actuators")
        asked = (
            f"type 3d for {_counted('closure', locking)} frees the actuators: is each a ball joint, or a pin of a "
            "planar loop?"
        )
        # Of motors that only depend on one another, one may be none. In space, a ball may be missing in its place.
        kinds = [closure.type for closure in robot.mechanism.closures if closure.name not in locking]
        usual = kinds.count("3d") > kinds.count("6d") or is_planar(robot, q, loop)
        sure = usual and hinge is None and (locked or motors.named.issuperset(dependent))
        fixes.append(replace(free, summary=free.summary if sure else "", question=asked))
    if not fixes:
        asked = "is a joint of these loops locked, or its axis wrong"
        asked += "?" if locked else f", or one of {enumerated(dependent)} no motor?"
        fixes.append(Fix("", (), asked))
    diagnostics.report("x-dependent-actuators", message, place, None, fixes)


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


def _report_uncontrolled(
    read: ReadRobot, robot: Robot, analysis: Analysis, diagnostics: Diagnostics, causes: bool
) -> None:
    """Report the motions that are possible with every actuator held, except those that need no actuator."""
    if not analysis.motions:
        return
    passive = PassiveMotions(robot)
    loose = [(loop, found) for loop in analysis.loops if (found := passive.needing_actuators(loop))]
    motions = [motion for _, found in loose for motion in found]
    motions += passive.outside_needing_actuators(analysis)
    if motions:
        count = len(motions)
        moved = list(dict.fromkeys(quoted(motion.joints, _NAMES_LISTED) for motion in motions))
        shown = "; ".join(moved[:_MOTIONS_LISTED]) + ("; ..." if len(moved) > _MOTIONS_LISTED else "")
        diagnostics.report(
            "x-uncontrolled-motion",
            f"{count} {'motion remains' if count == 1 else 'motions remain'} when every actuator is held: {shown}",
            _place_of_key(read, read.description.actuators_key),
            None,
            lambda: _controlling(read, robot, passive, analysis.q, loose, motions) if causes else (),
        )


def _controlling(
    read: ReadRobot,
    robot: Robot,
    passive: PassiveMotions,
    q: Vector,
    loose: Sequence[tuple[LoopAnalysis, Sequence[Motion]]],
    motions: Sequence[Motion],
) -> Iterator[Fix]:
    """Proposals that control motions; ``loose`` are the groups of loops that have some."""
    motors = LikelyMotors(read)
    moved = list(dict.fromkeys(name for motion in motions for name in motion.joints))
    if springs := motors.without_stiffness(moved):
        yield Fix("", (), f"is 'stiffness' of {enumerated(springs)} missing?")
    yield from motors.by_name(moved)
    yield from forgotten_closures(read)
    if len(motions) == sum(len(found) for _, found in loose):
        held = [_holding(robot, q, loop) for loop, _ in loose]
        if all(held):
            names = [name for closures in held for name in closures]
            fix = retyped(read, names, "6d", "then no motion is left without an actuator")
            asked = f"type 6d for {_counted('closure', names)} holds the rest: is each without a joint of its own?"
            velocities = [index for name in motors.could_be(moved) for index in robot.tree.velocities_of(name)]
            # Where motors could control all, some may be forgotten.
            sure = np.linalg.matrix_rank(passive.basis(motions)[:, velocities], 1e-3) < len(motions)
            yield replace(fix, summary=fix.summary if sure else "", question=asked)
    yield from motors.by_rating(moved)
    yield from needless_types(read, moved)
    hinges = (_controlling_hinge(robot, q, loop) for loop, _ in loose if loop.actuated)
    if (hinge := next(filter(None, hinges), None)) is not None:
        yield Fix("", (), f"is closure '{hinge.closure}' a pin, of {hinge}, which leaves fewer motions?")
    could = motors.could_be(moved)
    which = f"which of {enumerated(could)} has a motor, or which" if could else "which"
    yield Fix("", (), f"{which} closure is missing?")


def _holding(robot: Robot, q: Vector, loop: LoopAnalysis) -> list[str]:
    """The 3d closures of a group of loops, each alone or all, that as 6d leave it no motion without an actuator."""
    points = [closure for closure in closures_of(robot, loop) if type(closure) is PointClosure]
    # Without a configuration that is stated, frames have one orientation elsewhere.
    stated = "assembled" in robot.configurations
    aligned = compress(points, are_aligned(robot, q, points)) if stated else points
    frames = [FrameClosure(closure.name, closure.a, closure.b) for closure in aligned]
    for names in _trials([closure.name for closure in frames]):
        trial, found = with_closures(robot, q, loop, [closure for closure in frames if closure.name in names])
        if found is not None and found.mobility and not found.dependent_actuators and not _uncontrolled(trial, found):
            return list(names)
    return []


def _closures_key(mechanism: Mechanism) -> str:
    if mechanism.version == "1":
        return "closed_loop"
    return "closures" if mechanism.closures else "couplings"


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
