"""The joints between bodies."""

from __future__ import annotations

from collections.abc import Sequence
from typing import cast

from eurdf.importing.mjcf.joint_properties import joint_properties
from eurdf.importing.mjcf.reading import MjcfReading
from eurdf.importing.mjcf.step import Step
from eurdf.importing.mjcf.steps import grouped
from eurdf.importing.mjcf.values import xyzw
from eurdf.mechanism.body import Body
from eurdf.mechanism.joint import Joint
from eurdf.mechanism.joint_types import JointType
from eurdf.mechanism.pose import IDENTITY, Pose, Quaternion


def read_joints(reading: MjcfReading, body: int) -> None:
    """The joints between a body and its parent, with links without mass between them."""
    link = reading.bodies[body].name
    parent = reading.bodies[reading.model["body_parentid"][body]].name
    steps = grouped(reading, body)
    pose = reading.pose_of(body)
    if not steps:
        name = reading.joint_names.new(f"{link}_fixed")
        reading.joints.append(Joint(name, JointType.FIXED, parent, link, pose))
        return
    before = pose
    if reading.kinds(body) == ["free"]:
        before = IDENTITY  # the coordinates of a free joint are the pose in the world
    for index, step in enumerate(steps):
        last = index == len(steps) - 1
        here = Pose(step.anchor) * step.turn
        placement = before * here
        moved = _reference(reading, step)
        if moved is not IDENTITY:
            placement = placement * moved.inverse()
        child = link
        if not last:
            child = reading.links.new(f"{step.name}_link")
            reading.extra.append(Body(child))
        offset = here.inverse() if last and here != IDENTITY else IDENTITY
        reading.joints.append(
            Joint(
                step.name,
                step.type,
                parent,
                child,
                placement,
                offset,
                step.axes,
                step.pitch,
                joint_properties(reading, step),
            )
        )
        for joint in step.joints:
            reading.steps[joint] = step
        parent, before = child, here.inverse()


def _reference(reading: MjcfReading, step: Step) -> Pose:
    """How far a joint has moved its child at qpos0."""
    if step.type in (JointType.FLOATING, JointType.SPHERICAL):
        return IDENTITY
    coordinates = coordinates_at(reading, step, reading.model["qpos0"])
    bare = Joint(step.name, step.type, "", "", axes=step.axes, pitch=step.pitch)
    return bare.transform(coordinates) if any(coordinates) else IDENTITY


def coordinates_at(reading: MjcfReading, step: Step, qpos: Sequence[float]) -> tuple[float, ...]:
    """The coordinates of a joint, as files have them, at a configuration of MuJoCo."""
    found: list[float] = []
    joints = step.joints[1:] if step.type is JointType.HELICAL else step.joints
    for joint in joints:
        at = reading.model["jnt_qposadr"][joint]
        match reading.model["jnt_type"][joint]:
            case "free":
                found += [*qpos[at : at + 3], *xyzw(qpos[at + 3 : at + 7])]
            case "ball":
                found += xyzw(qpos[at : at + 4])
            case _:
                found.append(float(qpos[at]))
    if step.type in (JointType.FLOATING, JointType.SPHERICAL) and step.turn is not IDENTITY:
        turned = step.turn.inverse() * Pose(quaternion=cast(Quaternion, tuple(found[-4:]))) * step.turn
        found[-4:] = turned.quaternion
    return tuple(found)
