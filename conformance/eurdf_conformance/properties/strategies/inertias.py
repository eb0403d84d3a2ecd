"""Physical inertias: boxes at any pose."""

from __future__ import annotations

from functools import cache

import numpy as np
from hypothesis import strategies as st
from hypothesis.strategies import SearchStrategy

from eurdf_conformance.properties.mechanism import Inertia, Pose, Vector
from eurdf_conformance.properties.placement import matrix_of
from eurdf_conformance.properties.strategies.numbers import decimals, poses, vectors


@cache
def inertias() -> SearchStrategy[Inertia]:
    """Inertias of boxes of some decimetres, with axes along those of no frame."""
    sides = st.tuples(*[decimals(0.1, 0.4)] * 3)
    return st.builds(_of_box, decimals(0.5, 3.0, 1), sides, vectors(3.1), poses())


def _of_box(mass: float, sides: Vector, rpy: Vector, pose: Pose) -> Inertia:
    a, b, c = np.array(sides) ** 2
    R = matrix_of(Pose(rpy=rpy))[:3, :3]
    moments = R @ np.diag([b + c, c + a, a + b]) @ R.T * mass / 12.0
    xx, xy, xz, yy, yz, zz = moments[np.triu_indices(3)].tolist()
    return Inertia(mass=mass, pose=pose, moments=(xx, xy, xz, yy, yz, zz))
