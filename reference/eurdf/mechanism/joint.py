"""The joints of the spanning tree."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, replace
from functools import cache
from typing import NamedTuple

from eurdf.mechanism.joint_types import JointType
from eurdf.mechanism.pose import IDENTITY, ORIGIN, Pose, Vector3, direction

#: A coordinate may be beyond its limit by this much, rad or m (EU-CFG-004).
LIMIT_TOLERANCE = 1e-9

_NO_RANGE = (-math.inf, math.inf)


class ElementaryMotion(NamedTuple):
    """What a coordinate of a joint does, or the four of a quaternion.

    Attributes:
        axis: Unit vector in the joint's frame; None for the rotations of a ball.
        turns: Whether it turns about the axis, by the coordinate.
        advance: By how much it moves along the axis, m for each unit of the coordinate.
    """

    axis: Vector3 | None
    turns: bool
    advance: float


_BALL = ElementaryMotion(None, turns=True, advance=0.0)


class Mimic(NamedTuple):
    """q = multiplier · q_joint + offset, in rad or m."""

    joint: str
    multiplier: float = 1.0
    offset: float = 0.0


@dataclass(frozen=True, slots=True)
class JointProperties:
    """Limits, losses, motor and springs of a joint: one number per velocity; for position limits, one per coordinate.

    An empty tuple means no limit, no loss, no motor and no spring.

    Attributes:
        lower: Lower position limits as in the files, one per coordinate; -inf where there is none.
            `Joint.ranges` has what they mean.
        upper: Upper position limits as in the files; inf where there is none.
        velocity: Velocity limits, rad/s or m/s; inf where there is none.
        effort: Effort limits, N·m or N; inf where there is none.
        damping: Viscous damping, N·m·s/rad or N·s/m.
        friction: Dry friction, N·m or N.
        armature: Reflected inertia, kg·m² or kg.
        gear_ratio: Motor revolutions per joint revolution.
        rotor_inertia: Inertia of the motor's rotor about its own axis, kg·m².
        stiffness: Stiffness k of a spring on each coordinate, N·m/rad or N/m: its force is -k (q - rest), its energy
            ½ k (q - rest)². Only for joints with as many coordinates as velocities, except planar ones.
        rest: Coordinate at which each of these springs has no force, rad or m.
        acceleration: Acceleration limits, rad/s² or m/s²; inf where there is none. No equation of motion has these.
        deceleration: Deceleration limits, rad/s² or m/s².
        jerk: Jerk limits, rad/s³ or m/s³.
    """

    lower: tuple[float, ...] = ()
    upper: tuple[float, ...] = ()
    velocity: tuple[float, ...] = ()
    effort: tuple[float, ...] = ()
    damping: tuple[float, ...] = ()
    friction: tuple[float, ...] = ()
    armature: tuple[float, ...] = ()
    gear_ratio: tuple[float, ...] = ()
    rotor_inertia: tuple[float, ...] = ()
    stiffness: tuple[float, ...] = ()
    rest: tuple[float, ...] = ()
    acceleration: tuple[float, ...] = ()
    deceleration: tuple[float, ...] = ()
    jerk: tuple[float, ...] = ()

    @property
    def rates(self) -> dict[str, tuple[float, ...]]:
        """The limits of acceleration, deceleration and jerk that the joint has, by name."""
        found = {"acceleration": self.acceleration, "deceleration": self.deceleration, "jerk": self.jerk}
        return {name: values for name, values in found.items() if any(map(math.isfinite, values))}

    @classmethod
    @cache
    def unlimited(cls, kind: JointType) -> JointProperties:
        """The properties of a joint without limits, losses, motor and springs, every number written out."""
        n, nv = len(kind.coordinates), kind.nv
        infinite, zero = (math.inf,) * nv, (0.0,) * nv
        return cls((-math.inf,) * n, (math.inf,) * n, infinite, infinite, zero, zero, zero, (1.0,) * nv, zero)


@dataclass(frozen=True, slots=True)
class Joint:
    """A joint of the spanning tree.

    Attributes:
        name: Unique among the joints.
        type: One of the ten joint types.
        parent: Body it hangs from.
        child: Body it carries.
        placement: Pose of the joint in the frame of the parent body.
        offset: Pose of the child body's frame in the moving frame of the joint. The identity but for merged joints
            whose axes meet away from the last one's origin. The joint's name refers to the child's frame.
        axes: Directions in the joint's frame, as written, of any length but zero: one for revolute, continuous,
            prismatic, helical, cylindrical; two, first and second, for universal; none otherwise. Planar moves in
            the joint's xy plane.
        pitch: Advance of a helical joint along its axis, m per revolution, right-handed; 0 otherwise.
        properties: Limits, losses, motor and springs.
        mimic: The leader that this joint mimics, or None.
    """

    name: str
    type: JointType
    parent: str
    child: str
    placement: Pose = IDENTITY
    offset: Pose = IDENTITY
    axes: tuple[Vector3, ...] = ()
    pitch: float = 0.0
    properties: JointProperties = JointProperties()
    mimic: Mimic | None = None

    def with_properties(self, properties: JointProperties) -> Joint:
        """The same joint with other properties: what `dataclasses.replace` returns, in a fifth of its time."""
        return Joint(
            self.name,
            self.type,
            self.parent,
            self.child,
            self.placement,
            self.offset,
            self.axes,
            self.pitch,
            properties,
            self.mimic,
        )

    @staticmethod
    def floating(name: str, child: str) -> Joint:
        """A joint by which a body moves freely in the world."""
        return Joint(name, JointType.FLOATING, "", child)

    def universal(self, second: Joint, name: str) -> Joint:
        """The universal joint that turns as this joint, then as a second one that is fixed to its child."""
        both, names = (self.properties, second.properties), [each.name for each in fields(JointProperties)]
        return replace(
            second,
            name=name,
            type=JointType.UNIVERSAL,
            parent=self.parent,
            placement=self.placement,
            axes=self.axes + second.axes,
            properties=JointProperties(*(sum((getattr(each, name) for each in both), ()) for name in names)),
        )

    def fixed(self, placement: Pose | None = None) -> Joint:
        """The joint locked at its zero (EU-JNT-019), or with its child at a pose in the parent."""
        at = (self.placement, self.offset) if placement is None else (placement, IDENTITY)
        return Joint(self.name, JointType.FIXED, self.parent, self.child, *at)

    @property
    def motions(self) -> tuple[ElementaryMotion, ...]:
        """EU-JNT-015 to -018, EU-JNT-025: the steps of its type, with its axes and its pitch."""
        found = []
        for kind, at in self.type.steps:
            if kind == "ball":
                found.append(_BALL)
                continue
            lead = self.pitch / (2.0 * math.pi) if kind == "screw" else float(kind == "slide")
            found.append(
                ElementaryMotion(direction(self.axes[at]) if isinstance(at, int) else at, kind != "slide", lead)
            )
        return tuple(found)

    def transform(self, coordinates: Sequence[float]) -> Pose:
        """Pose of its moving frame in its frame at rest, jMj'(c): what its `motions` make, one after the other.

        Its child body is at ``placement * transform(c) * offset`` in its parent.

        Args:
            coordinates: As files have them: rad, m, quaternions x, y, z, w of any length but 0.

        Raises:
            ValueError: There are too few or too many coordinates, or a quaternion has length 0.
        """
        c = self.normalized(coordinates)
        if c == self.type.neutral:
            return IDENTITY
        shift, turns = ORIGIN, []
        for (axis, turns_about, advance), value in zip(self.motions, c, strict=False):  # slides come before turns
            if axis is None:
                x, y, z, w = c[-4:]
                turns.append(Pose(ORIGIN, (x, y, z, w)))
                continue
            if advance:
                length = advance * value
                shift = shift[0] + length * axis[0], shift[1] + length * axis[1], shift[2] + length * axis[2]
            if turns_about:
                s, cosine = math.sin(value / 2.0), math.cos(value / 2.0)
                turns.append(Pose(ORIGIN, (s * axis[0], s * axis[1], s * axis[2], cosine)))
        turned = turns[0] if turns else IDENTITY
        for turn in turns[1:]:
            turned = turned * turn
        return Pose(shift, turned.quaternion)

    def normalized(self, coordinates: Sequence[float]) -> tuple[float, ...]:
        """The coordinates as numbers, with the quaternion at unit length; the errors are those of `transform`."""
        names, c, first = self.type.coordinates, tuple(map(float, coordinates)), self.type.quaternion
        if len(c) != len(names):
            raise ValueError(
                f"joint '{self.name}' is given {len(c)} coordinates; it has {len(names)}: "
                + (", ".join(names) or "none")
            )
        if first is None:
            return c
        norm = math.hypot(*c[first:])
        if norm == 0.0:
            raise ValueError(f"the quaternion of joint '{self.name}' has length 0")
        return (*c[:first], *(value / norm for value in c[first:]))

    @property
    def ranges(self) -> tuple[tuple[float, float], ...]:
        """The least and the greatest value of each coordinate, rad or m; infinite for no limit.

        Limits that are both 0 are no range (EU-URD-025). Other equal limits lock the coordinate.
        """
        n = len(self.type.coordinates)
        lower, upper = self.properties.lower or (-math.inf,) * n, self.properties.upper or (math.inf,) * n
        return tuple(_NO_RANGE if is_no_range(*pair) else pair for pair in zip(lower, upper, strict=True))

    @property
    def lacks_range(self) -> bool:
        """Whether a coordinate has the limits 0 and 0, which are no range."""
        return any(map(is_no_range, self.properties.lower, self.properties.upper))


def is_no_range(lower: float, upper: float) -> bool:
    """EU-URD-025: whether two position limits are no range: URDF reads limits that are left out as 0."""
    return lower == upper == 0.0


def drivers(mimics: Mapping[str, Mimic]) -> dict[str, Mimic]:
    """For each mimic joint, the joint at the end of its chain, and the relation between the two.

    A chain q₂ = m₂ q₁ + o₂, q₁ = m₁ q + o₁ becomes q₂ = m₂ m₁ q + (m₂ o₁ + o₂). A joint whose chain ends in a cycle is
    skipped.

    Args:
        mimics: For each mimic joint, the joint that it names and the relation between the two, in rad or m.
    """
    resolved: dict[str, Mimic] = {}
    endless: set[str] = set()
    for name in mimics:
        chain: dict[str, None] = {}
        while name in mimics and not (name in resolved or name in chain or name in endless):
            chain[name] = None
            name = mimics[name].joint
        if name in chain or name in endless:
            endless.update(chain)
            continue
        for joint in reversed(chain):
            mimic = mimics[joint]
            step = resolved.get(mimic.joint)
            if step is not None:
                offset = mimic.multiplier * step.offset + mimic.offset
                mimic = Mimic(step.joint, mimic.multiplier * step.multiplier, offset)
            resolved[joint] = mimic
    return resolved
