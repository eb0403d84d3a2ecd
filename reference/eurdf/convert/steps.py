"""A joint as joints of a format that lacks its type, and the type that remains of one whose limits decide it.

It becomes joints in series, each with one axis or the rotations of a ball.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass, fields, replace

from eurdf.convert.losses import Losses
from eurdf.mechanism.joint import Joint, JointProperties, is_no_range
from eurdf.mechanism.joint_types import JointType
from eurdf.mechanism.pose import AXES, Vector3, direction

#: Largest cosine of the axes of a universal joint that are perpendicular but for rounding.
_SKEW = 1e-9

#: The properties of coordinates; the others are of velocities.
_OF_COORDINATES = {"lower", "upper", "stiffness", "rest"}


@dataclass(frozen=True, slots=True)
class ExportedJoint:
    """One joint of those, from the parent outwards, that a joint becomes.

    Attributes:
        joint: It, with its own name, type, axes and properties.
        velocities: Indices of the velocities that it has, and of its coordinates unless it is a ball.
        lead: Of the slide that follows the turn of a screw, its length for 1 rad, m; 0 for others.
    """

    joint: Joint
    velocities: tuple[int, ...]
    lead: float = 0.0

    def of(self, coordinates: Sequence[float]) -> tuple[float, ...]:
        """Its coordinates, of those of the joint that becomes it."""
        if self.joint.type.quaternion is not None:
            return tuple(coordinates[-len(self.joint.type.coordinates) :])
        return tuple(coordinates[index] for index in self.velocities)


def turn_type(joint: Joint, index: int = 0) -> JointType:
    """The type of URDF for a turn of a joint, which a limit of its coordinate decides."""
    return JointType.REVOLUTE if any(map(math.isfinite, joint.ranges[index])) else JointType.CONTINUOUS


def without_locks(joint: Joint, losses: Losses) -> Joint:
    """The joint, without each coordinate that limits of 0 and 0 lock; only a universal joint has a second one."""
    properties = joint.properties
    limits = list(zip(properties.lower, properties.upper, strict=True))
    free = [index for index, pair in enumerate(limits) if not is_no_range(*pair)]
    if len(free) == len(limits):
        return joint
    losses.add("import-locked-joint", joint.name)
    if not free:
        return joint.fixed()
    (index,) = free
    values = {field.name: getattr(properties, field.name)[index : index + 1] for field in fields(properties)}
    axes, properties = (joint.axes[index],), JointProperties(**values)
    return replace(joint, type=JointType.REVOLUTE, axes=axes, properties=properties)


def continuous_if_unlimited(joint: Joint) -> Joint:
    """The joint, continuous if it is revolute and has no position limits."""
    limits = (*joint.properties.lower, *joint.properties.upper)
    if joint.type is not JointType.REVOLUTE or any(map(math.isfinite, limits)):
        return joint
    return replace(joint, type=JointType.CONTINUOUS)


def is_skew(joint: Joint) -> bool:
    """Whether the axes of a universal joint are not perpendicular."""
    (ax, ay, az), (bx, by, bz) = map(direction, joint.axes)
    return abs(ax * bx + ay * by + az * bz) > _SKEW


def suffixes(kind: JointType) -> tuple[str, ...]:
    """What the names of the joints that a joint of a type becomes add to its own, for each motion of the type.

    A screw becomes a turn with the name of the joint, after a slide with that of `SCREW_SLIDE`.
    """
    kinds = [step.kind for step in kind.steps]
    if len(kinds) == 1:
        return ("",)
    if any(not isinstance(step.axis, int) for step in kind.steps):
        names = zip(kinds, kind.coordinates, strict=False)
        return tuple("_ball" if motion == "ball" else f"_{name}" for motion, name in names)
    return ("_1", "_2") if kinds == ["turn", "turn"] else tuple(f"_{motion}" for motion in kinds)


#: What the slide of a screw adds to the name of the joint.
SCREW_SLIDE = "_slide"


def in_series(
    joint: Joint, whole: Collection[str], *, turns_have_properties: bool = False
) -> tuple[ExportedJoint, ...]:
    """The joints that a joint becomes.

    Args:
        joint: The joint.
        whole: Types, beside those of one turn or slide, that the format has: a joint of one is itself. Universal ones
            are those with perpendicular axes. Without spherical ones, a ball becomes turns about x, y and z.
        turns_have_properties: Whether each of these turns has the velocity and the properties of its axis; if not, it
            has none.
    """
    kind = joint.type
    if kind.is_axial or kind.is_fixed or (kind in whole and not (kind == "universal" and is_skew(joint))):
        return (ExportedJoint(joint, tuple(range(kind.nv))),)
    return tuple(_elementary(joint, "spherical" in whole, turns_have_properties))


def _elementary(joint: Joint, has_balls: bool, turns_have_properties: bool) -> Iterator[ExportedJoint]:
    for index, (motion, end) in enumerate(zip(joint.type.steps, suffixes(joint.type), strict=True)):
        if motion.kind == "ball":
            indices = (index, index + 1, index + 2)
            if has_balls:
                yield ExportedJoint(_part(joint, end, JointType.SPHERICAL, (), indices), indices)
                continue
            for letter, axis, mine in zip("xyz", AXES, indices, strict=True):
                own = (mine,) if turns_have_properties else ()
                yield ExportedJoint(_part(joint, f"{end}_{letter}", JointType.CONTINUOUS, (axis,), own), own)
            continue
        axes = (joint.axes[motion.axis] if isinstance(motion.axis, int) else motion.axis,)
        turn = turn_type(joint, index)
        if motion.kind == "screw":
            slide = _part(joint, end + SCREW_SLIDE, JointType.PRISMATIC, axes, ())
            yield ExportedJoint(slide, (index,), joint.pitch / (2.0 * math.pi))
            turn = JointType.REVOLUTE  # its full turns count
        kind = JointType.PRISMATIC if motion.kind == "slide" else turn
        yield ExportedJoint(_part(joint, end, kind, axes, (index,)), (index,))


def _part(joint: Joint, suffix: str, kind: JointType, axes: tuple[Vector3, ...], velocities: tuple[int, ...]) -> Joint:
    def own(name: str) -> tuple[float, ...]:
        values: tuple[float, ...] = getattr(joint.properties, name)
        if not values or (kind.quaternion is not None and name in _OF_COORDINATES):
            return ()
        return tuple(values[index] for index in velocities)

    properties = JointProperties(*(own(field.name) for field in fields(JointProperties)))
    return replace(joint, name=joint.name + suffix, type=kind, axes=axes, pitch=0.0, properties=properties, mimic=None)
