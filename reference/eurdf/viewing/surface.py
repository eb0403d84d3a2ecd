"""The surfaces of shapes as triangles."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache
from typing import Any

import coal
import numpy as np
import numpy.typing as npt

from eurdf.array import Matrix, Vector

# Vertices on a circle, and on a quarter of one.
_AROUND = 36
_QUARTER = 9

# The corners of a face of a box, as signs along two axes.
_CORNERS = ((-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0))


@dataclass(frozen=True, slots=True, eq=False)
class Surface:
    """Triangles of a shape, in its own frame; counterclockwise seen from outside.

    Attributes:
        vertices: Shape (n, 3), m. Faces that meet at an edge to be seen have vertices of their own there.
        triangles: Shape (m, 3), indices of vertices.
        smooth: Whether the triangles approximate a curved surface.
    """

    vertices: Matrix
    triangles: npt.NDArray[np.int64]
    smooth: bool

    def scaled(self, factors: Vector) -> Surface:
        """The surface, scaled along the axes by factors (3,)."""
        return Surface(self.vertices * factors, self.triangles, self.smooth)


def surface_of(geometry: Any) -> Surface:
    """The surface of a shape of a geometry model: a box, sphere, cylinder, capsule or mesh of coal."""
    if isinstance(geometry, coal.Box):
        return _box().scaled(np.asarray(geometry.halfSide))
    if isinstance(geometry, coal.Sphere):
        return sphere().scaled(np.full(3, geometry.radius))
    if isinstance(geometry, coal.Cylinder):
        r, h = geometry.radius, geometry.halfLength
        return _revolved([(0.0, -h), (r, -h)], [(r, -h), (r, h)], [(r, h), (0.0, h)])
    if isinstance(geometry, coal.Capsule):
        r, h = geometry.radius, geometry.halfLength
        quarter = [(r * math.sin(a), r * math.cos(a)) for a in np.linspace(0.0, math.pi / 2.0, _QUARTER)]
        below, above = [(x, -h - z) for x, z in quarter], [(x, h + z) for x, z in reversed(quarter)]
        return _revolved([*below, *above])
    triangles = [geometry.tri_indices(index) for index in range(geometry.num_tris)]
    faces = np.array([(each[0], each[1], each[2]) for each in triangles], dtype=np.int64)
    return Surface(np.asarray(geometry.vertices()).reshape(-1, 3), faces.reshape(-1, 3), False)


@cache
def sphere() -> Surface:
    """The sphere of radius 1 m."""
    angles = np.linspace(-math.pi / 2.0, math.pi / 2.0, 2 * _QUARTER - 1)
    return _revolved([(math.cos(a), math.sin(a)) for a in angles])


@cache
def _box() -> Surface:
    """The cube from -1 to 1 m."""
    vertices: list[list[float]] = []
    triangles: list[tuple[int, int, int]] = []
    for axis in range(3):
        for side in (-1.0, 1.0):
            first = len(vertices)
            for u, v in _CORNERS:
                corner = [0.0, 0.0, 0.0]
                corner[axis], corner[(axis + 1) % 3], corner[(axis + 2) % 3] = side, u * side, v
                vertices.append(corner)
            triangles += [(first, first + 1, first + 2), (first, first + 2, first + 3)]
    return Surface(np.array(vertices), np.array(triangles), False)


def _revolved(*profiles: list[tuple[float, float]]) -> Surface:
    """Profiles, each a list of distances from the z axis and of heights, upward outside, turned about that axis."""
    turn = np.linspace(0.0, 2.0 * math.pi, _AROUND, endpoint=False)
    circle = np.stack((np.cos(turn), np.sin(turn)), axis=1)
    following = np.roll(np.arange(_AROUND), -1)
    vertices, triangles, first = [], [], 0
    for profile in profiles:
        for level, (radius, height) in enumerate(profile):
            vertices.append(np.column_stack((radius * circle, np.full(_AROUND, height))))
            if level:
                here, above = first + np.arange(_AROUND), first + following
                triangles += [
                    np.stack((here - _AROUND, above - _AROUND, above), axis=1),
                    np.stack((here - _AROUND, above, here), axis=1),
                ]
            first += _AROUND
    return Surface(np.concatenate(vertices), _with_area(np.concatenate(vertices), np.concatenate(triangles)), True)


def _with_area(vertices: Matrix, triangles: npt.NDArray[np.int64]) -> npt.NDArray[np.int64]:
    """The triangles that are not degenerate, as at a pole."""
    a, b, c = (vertices[triangles[:, corner]] for corner in range(3))
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    return np.asarray(triangles[area > 1e-9 * area.max(initial=0.0)])
