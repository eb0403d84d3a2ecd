"""Joints of a drawing."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np

from robots.builder.shape import Matrix3, Vector3

#: The world's own axes: those of every joint frame that is not turned.
WORLD: tuple[Vector3, Vector3, Vector3] = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))

#: Cosine of the angle of two axes below which they count as perpendicular.
_PERPENDICULAR = 1e-9


@dataclass(frozen=True, slots=True)
class Motor:
    """What drives a joint.

    Attributes:
        effort: Largest torque at the joint, N·m; force in N at one that slides.
        velocity: Largest velocity of the joint, rad/s; m/s at one that slides.
        damping: N·m·s/rad; N·s/m.
        friction: N·m; N.
        gear_ratio: Revolutions of the rotor per revolution of the joint; rad/m at a joint that slides.
        rotor_inertia: Of the rotor, before the gear, kg·m².
        armature: Reflected inertia, kg·m²; kg. None: that of the rotor through the gear.
        name: Of the actuator; empty for the name of the joint.
        control: Smallest and largest torque (N·m) or force (N) to control it with; None where unknown.
    """

    effort: float
    velocity: float
    damping: float = 0.0
    friction: float = 0.0
    gear_ratio: float = 1.0
    rotor_inertia: float = 0.0
    armature: float | None = None
    name: str = ""
    control: tuple[float, float] | None = None

    @property
    def reflected_inertia(self) -> float:
        """The armature, stated or from the rotor, kg·m²; kg."""
        return self.gear_ratio**2 * self.rotor_inertia if self.armature is None else self.armature


#: Of a joint that nothing drives; the velocity is there because URDF requires one for every joint with stops.
PASSIVE = Motor(effort=0.0, velocity=20.0)


@dataclass(frozen=True, slots=True)
class Spring:
    """A spring on the coordinate of a joint.

    Attributes:
        stiffness: N·m/rad, N/m.
        rest: Angle (rad) or travel (m) at which it has no force, seen from the drawn pose.
        damping: Of the damper beside it, N·m·s/rad; N·s/m.
    """

    stiffness: float
    rest: float = 0.0
    damping: float = 0.0


@dataclass(frozen=True, slots=True)
class Joint:
    """A joint, in the drawn pose, in world coordinates.

    Attributes:
        name: Unique among the joints.
        type: What the joint is. In the URDF, a spherical or universal one is continuous, about ``axis``.
        parent: Body that it hangs the next one from.
        at: Its centre, m.
        axis: Unit vector; of a universal joint the first axis, fixed to the parent.
        axes: Unit vectors x, y, z of its frame. A universal joint turns about x, then y; others keep the world's axes.
        stops: Lowest and highest angle (rad) or travel (m), seen from the drawn pose; None where nothing stops it.
        motor: What drives it; None if nothing does.
        spring: A spring on it, or None.
    """

    name: str
    type: Literal["revolute", "prismatic", "spherical", "universal"]
    parent: str
    at: Vector3
    axis: Vector3
    axes: tuple[Vector3, Vector3, Vector3] = WORLD
    stops: tuple[float, float] | None = None
    motor: Motor | None = None
    spring: Spring | None = None

    @property
    def rotation(self) -> Matrix3:
        """Orientation of its frame in the world, 3 x 3: the columns are its axes."""
        return np.array(self.axes).T

    @property
    def damping(self) -> float:
        """That of its motor and of its damper, N·m·s/rad; N·s/m."""
        return (self.motor.damping if self.motor else 0.0) + (self.spring.damping if self.spring else 0.0)

    @property
    def friction(self) -> float:
        """That of its motor, N·m; N."""
        return self.motor.friction if self.motor else 0.0


def revolute(
    name: str,
    parent: str,
    at: Vector3,
    axis: Vector3,
    *,
    degrees: tuple[float, float] | None = None,
    drawn: float = 0.0,
    motor: Motor | None = None,
    spring: Spring | None = None,
) -> Joint:
    """A revolute joint.

    Args:
        name: Unique among the joints.
        parent: Body that it hangs the next one from.
        at: Its centre in the world, m.
        axis: Its axis in the world; any length.
        degrees: Lowest and highest angle on the maker's scale, degrees; None where nothing stops it.
        drawn: Angle of the drawn pose on that scale, degrees.
        motor: What drives it.
        spring: A spring on it.
    """
    stops = degrees and (round(math.radians(degrees[0] - drawn), 4), round(math.radians(degrees[1] - drawn), 4))
    return Joint(name, "revolute", parent, at, unit(axis), stops=stops, motor=motor, spring=spring)


def prismatic(
    name: str,
    parent: str,
    at: Vector3,
    axis: Vector3,
    *,
    metres: tuple[float, float],
    drawn: float = 0.0,
    motor: Motor | None = None,
    spring: Spring | None = None,
) -> Joint:
    """A prismatic joint.

    Args:
        name: Unique among the joints.
        parent: Body that it hangs the next one from.
        at: Origin of the next body in the world, m.
        axis: Direction in which it slides, in the world; any length.
        metres: Shortest and longest travel on the maker's scale, m.
        drawn: Travel of the drawn pose on that scale, m.
        motor: What drives it.
        spring: A spring on it.
    """
    stops = (round(metres[0] - drawn, 6), round(metres[1] - drawn, 6))
    return Joint(name, "prismatic", parent, at, unit(axis), stops=stops, motor=motor, spring=spring)


def ball(name: str, parent: str, at: Vector3) -> Joint:
    """A ball joint that nothing drives and nothing stops, at a point of the world (m)."""
    return Joint(name, "spherical", parent, at, (0.0, 0.0, 1.0))


def universal(name: str, parent: str, at: Vector3, first: Vector3, second: Vector3) -> Joint:
    """A universal joint (Cardan's) that nothing drives and nothing stops.

    Args:
        name: Unique among the joints.
        parent: Body that it hangs the next one from.
        at: Its centre in the world, m.
        first: Axis fixed to the parent, in the world; any length.
        second: Axis fixed to the next body, in the drawn pose, in the world; any length.

    Raises:
        ValueError: If the two axes are not perpendicular.
    """
    x, y = unit(first), unit(second)
    if abs(float(np.dot(x, y))) > _PERPENDICULAR:
        raise ValueError(f"the axes of universal joint '{name}' are not perpendicular")
    return Joint(name, "universal", parent, at, x, axes=(x, y, cross(x, y)))


def unit(vector: Vector3) -> Vector3:
    """The unit vector in a direction."""
    length = math.hypot(*vector)
    return (vector[0] / length, vector[1] / length, vector[2] / length)


def cross(a: Vector3, b: Vector3) -> Vector3:
    """The vector product of two."""
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])
