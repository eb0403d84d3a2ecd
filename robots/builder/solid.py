"""What shapes weigh together."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from robots.builder.shape import Matrix3, Shape, Vector3


@dataclass(frozen=True, slots=True)
class Solid:
    """Mass, centre of mass and inertia of a rigid body.

    Attributes:
        mass: kg.
        center: Centre of mass in the world, m.
        inertia: About the centre of mass, in world axes, kg·m², 3 x 3.
    """

    mass: float
    center: Vector3
    inertia: Matrix3

    def without(self, parts: Sequence[Solid]) -> Solid:
        """What remains of it without its parts."""
        return solid_of((self, *(Solid(-part.mass, part.center, -part.inertia) for part in parts)))


def solid_of(shapes: Sequence[Shape | Solid]) -> Solid:
    """The sum of shapes or solids, by the theorem of parallel axes; where they overlap, both count."""
    mass = sum(shape.mass for shape in shapes)
    center = np.array([shape.mass for shape in shapes]) @ np.array([shape.center for shape in shapes]) / mass
    inertia = np.zeros((3, 3))
    for shape in shapes:
        lever = np.array(shape.center) - center
        inertia += shape.inertia + shape.mass * (lever @ lever * np.eye(3) - np.outer(lever, lever))
    return Solid(mass, (float(center[0]), float(center[1]), float(center[2])), inertia)
