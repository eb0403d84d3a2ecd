"""Motors that act otherwise on their joints."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

from eurdf.linking import link
from eurdf.linking.description import Description
from eurdf.mechanism.joint import Joint
from eurdf.mechanism.mechanism import Mechanism
from eurdf_conformance.mutants.deviation import Deviation, around
from eurdf_conformance.mutants.mutant import mutant
from eurdf_conformance.mutants.of_the_reference import canonical, mechanism, refused


def _motor(change: Callable[[Joint, Joint], Joint]) -> Deviation:
    """A joint with its motor is a function of that, and of the joint without."""
    return around(
        link,
        "with_motor",
        lambda original, joint, entry, armature_given: change(
            original(joint, entry, armature_given=armature_given), joint
        ),
    )


@mutant("EU-ACT-006")
def ratio_not_squared() -> Deviation:
    """The armature of an actuated joint is gear_ratio · rotor_inertia."""
    return _motor(
        lambda new, old: replace(new, armature=tuple(a / r for a, r in zip(new.armature, new.gear_ratio, strict=True)))
    )


@mutant("EU-ACT-006")
def rotor_not_geared() -> Deviation:
    """The armature of an actuated joint is the inertia of its rotor."""
    return _motor(lambda new, old: replace(new, armature=new.rotor_inertia))


@mutant("EU-ACT-006")
def armature_stays_that_of_the_joint() -> Deviation:
    """A motor adds no armature."""
    return _motor(lambda new, old: replace(new, armature=old.armature))


@mutant("EU-ACT-006")
def motor_in_place_of_armature() -> Deviation:
    """The armature that the description states gives way to that of the motor."""
    return around(
        link, "with_motor", lambda original, joint, entry, armature_given: original(joint, entry, armature_given=False)
    )


@mutant("EU-ACT-006")
def armature_of_0_is_not_stated() -> Deviation:
    """An armature of 0 that the description states gives way to that of the motor, as where 0 counts as nothing."""
    return around(
        link,
        "with_motor",
        lambda original, joint, entry, armature_given: original(
            joint, entry, armature_given=armature_given and any(joint.armature)
        ),
    )


@mutant("EU-ACT-006")
def motor_beside_armature() -> Deviation:
    """The armature of the motor is added to the one that the description states."""

    def added(original: Any, joint: Joint, entry: Any, armature_given: bool) -> Joint:
        geared: Joint = original(joint, entry, armature_given=False)
        both = tuple(a + b for a, b in zip(joint.armature, geared.armature, strict=True))
        return replace(geared, armature=both) if armature_given and geared.rotor_inertia[0] else geared

    return around(link, "with_motor", added)


@mutant("EU-ACT-006")
def ratio_left_out_is_0() -> Deviation:
    """A rotor whose gear is not stated adds no armature."""
    return around(
        link,
        "with_motor",
        lambda original, joint, entry, armature_given: original(
            joint, entry if entry.gear_ratio else replace(entry, gear_ratio=0.0), armature_given=armature_given
        ),
    )


@mutant("EU-ACT-007", versions=("2",))  # version 1 has no gears
def motor_on_the_first_velocity() -> Deviation:
    """A motor acts along the first velocity of its joint alone."""

    def first(values: tuple[float, ...], rest: float) -> tuple[float, ...]:
        return values[:1] + (rest,) * (len(values) - 1)

    return _motor(
        lambda new, old: replace(
            new,
            gear_ratio=first(new.gear_ratio, 1.0),
            rotor_inertia=first(new.rotor_inertia, 0.0),
            armature=first(new.armature, 0.0),
        )
    )


@mutant("EU-ACT-007")
def motors_of_several_velocities_dropped() -> Deviation:
    """A motor of a joint of several velocities is dropped."""

    def without(robot: Mechanism) -> Mechanism:
        one = {joint.name for joint in robot.joints if joint.coordinates.nv == 1}
        return replace(robot, actuators=tuple(name for name in robot.actuators if name in one))

    return mechanism(without)


@mutant("EU-ACT-007")
def joints_with_effort_are_actuated() -> Deviation:
    """Every joint with a limit of effort is actuated, as in SDF."""

    def driven(robot: Mechanism) -> Mechanism:
        names = tuple(joint.name for joint in robot.joints if joint.effort and 0.0 < joint.effort[0] < float("inf"))
        return replace(robot, actuators=names)

    return mechanism(driven)


def _refused(where: Callable[[Mechanism, list[Joint]], bool]) -> Deviation:
    """A robot is rejected for its joints that have a motor."""

    def driven(read: Description) -> bool:
        robot = read.mechanism
        return robot is not None and where(robot, [joint for joint in robot.joints if joint.name in robot.actuators])

    return refused(driven)


@mutant("EU-ACT-002")
def actuated_joint_must_be_of_one_velocity() -> Deviation:
    """An actuated joint must have one velocity."""
    return _refused(lambda robot, driven: any(joint.coordinates.nv > 1 for joint in driven))


@mutant("EU-ACT-001", versions=("1",))  # version 2 splits no joint
def motor_on_both_halves() -> Deviation:
    """No joint that a universal one was split into may have a motor."""

    def half(robot: Mechanism, driven: list[Joint]) -> bool:
        virtual = {body.name for body in robot.bodies if body.virtual}
        return any({joint.child, joint.parent} & virtual for joint in driven)

    return _refused(half)


@mutant("EU-ACT-004")
def mimicked_joint_may_not_have_a_motor() -> Deviation:
    """A joint that another mimics may not be actuated."""
    return _refused(
        lambda robot, driven: any(
            joint.mimic is not None and joint.mimic.joint in robot.actuators for joint in robot.joints
        )
    )


@mutant("EU-ACT-005")
def ball_may_not_have_a_motor() -> Deviation:
    """A spherical joint may not be actuated."""
    return _refused(lambda robot, driven: any(joint.type == "spherical" for joint in driven))


@mutant("EU-CAN-001")
def actuators_are_not_said() -> Deviation:
    """Actuators are not said."""
    return canonical(lambda robot: {"actuators": []})
