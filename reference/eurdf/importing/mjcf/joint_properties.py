"""Limits, losses, motors and springs of joints."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

from eurdf.importing.mjcf.reading import MjcfReading
from eurdf.importing.mjcf.step import Step
from eurdf.importing.mjcf.values import row
from eurdf.mechanism.joint import JointProperties
from eurdf.mechanism.joint_types import JointType

#: A bound beyond this is none, rad or m.
UNLIMITED = 1e10


def position_range(reading: MjcfReading, joint: int) -> tuple[float, float]:
    """Smallest and largest coordinate of a joint of MuJoCo, rad or m; infinite for no limit."""
    if not reading.model["jnt_limited"][joint]:
        return -math.inf, math.inf
    lower, upper = reading.model["jnt_range"][joint]
    return (lower if lower > -UNLIMITED else -math.inf), (upper if upper < UNLIMITED else math.inf)


def joint_properties(reading: MjcfReading, step: Step) -> JointProperties:
    """What a joint has beside its axes and its motor, which `actuators` reads."""
    model = reading.model
    free = JointProperties.unlimited(step.type)
    dofs = [dof for joint in step.joints for dof in _dofs(reading, joint)]
    joints, stiff = list(step.joints), {}
    if step.type is JointType.HELICAL:
        joints, dofs = joints[1:], dofs[1:]
    for joint in step.joints:
        if any(row(model["jnt_stiffnesspoly"], joint)) or any(any(row(model["dof_dampingpoly"], dof)) for dof in dofs):
            reading.losses.add("import-nonlinear-spring", step.name)
    if step.type in (JointType.SPHERICAL, JointType.FLOATING, JointType.PLANAR):
        if any(model["jnt_stiffness"][joint] for joint in joints):
            reading.losses.add("import-ball-spring", step.name)
        if any(model["jnt_limited"][joint] for joint in joints):
            reading.losses.add("import-ball-limit", step.name)
        bounds = list(zip(free.lower, free.upper, strict=True))
    else:
        bounds = [position_range(reading, joint) for joint in joints]
        stiffness = tuple(float(model["jnt_stiffness"][joint]) for joint in joints)
        if any(stiffness):
            addresses = [model["jnt_qposadr"][joint] for joint in joints]
            stiff = {"stiffness": stiffness, "rest": tuple(model["qpos_spring"][at] for at in addresses)}
    return replace(
        free,
        lower=tuple(lower for lower, _ in bounds),
        upper=tuple(upper for _, upper in bounds),
        effort=_efforts(reading, joints, len(dofs)),
        damping=tuple(float(model["dof_damping"][dof]) for dof in dofs),
        friction=tuple(float(model["dof_frictionloss"][dof]) for dof in dofs),
        armature=tuple(float(model["dof_armature"][dof]) for dof in dofs),
        **stiff,
    )


def _dofs(reading: MjcfReading, joint: int) -> range:
    start = reading.model["jnt_dofadr"][joint]
    return range(start, start + {"free": 6, "ball": 3}.get(reading.model["jnt_type"][joint], 1))


def _efforts(reading: MjcfReading, joints: Sequence[int], nv: int) -> tuple[float, ...]:
    """The effort limits that joints state."""
    found: list[float] = []
    for joint in joints:
        effort = math.inf
        if reading.model["jnt_actfrclimited"][joint]:
            bounds, name = reading.model["jnt_actfrcrange"][joint], reading.model.names["joint"][joint]
            effort = largest_effort(reading, bounds, name)
        found += [effort] * len(_dofs(reading, joint))
    return tuple(found[:nv])


def largest_effort(reading: MjcfReading, bounds: Sequence[float], name: str) -> float:
    """The effort limit, N·m or N, that a range of torques or forces is."""
    lower, upper = bounds
    if -lower != upper:
        reading.losses.add("import-unequal-effort", name, f"is {lower:g} to {upper:g}: the larger one is taken")
    return float(max(abs(lower), abs(upper)))
