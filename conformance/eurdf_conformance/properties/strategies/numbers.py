"""Numbers with few digits, and vectors, poses and axes made of them.

A strategy is made once: to make one takes longer than to draw from it.
"""

from __future__ import annotations

from functools import cache

import numpy as np
from hypothesis import strategies as st
from hypothesis.strategies import SearchStrategy

from eurdf_conformance.properties.mechanism import Pose, Vector

#: Sine of the angle between two axes that are not to be parallel.
_APART = 0.3


@cache
def decimals(low: float, high: float, digits: int = 2) -> SearchStrategy[float]:
    """Numbers with this many decimals."""
    scale = 10**digits
    return st.integers(round(low * scale), round(high * scale)).map(lambda number: number / scale)


@cache
def vectors(limit: float) -> SearchStrategy[Vector]:
    """Three numbers within a limit."""
    scale = 100
    numbers = st.integers(round(-limit * scale), round(limit * scale))
    return st.tuples(numbers, numbers, numbers).map(lambda v: (v[0] / scale, v[1] / scale, v[2] / scale))


@cache
def poses() -> SearchStrategy[Pose]:
    """A pose within half a metre, often along the axes."""
    turned = st.tuples(vectors(0.5), vectors(3.1)).map(lambda pose: Pose(xyz=pose[0], rpy=pose[1]))
    return vectors(0.5).map(lambda xyz: Pose(xyz=xyz)) | turned


@cache
def axes() -> SearchStrategy[Vector]:
    """Vectors of any length except zero."""
    steps = st.integers(-3, 3)
    return st.tuples(steps, steps, steps).filter(any).map(lambda v: (float(v[0]), float(v[1]), float(v[2])))


@cache
def axis_pairs() -> SearchStrategy[tuple[Vector, Vector]]:
    """Two vectors that are far from parallel."""
    return st.tuples(axes(), axes()).filter(_are_apart)


@cache
def quaternions() -> SearchStrategy[tuple[float, float, float, float]]:
    """Unit quaternions x, y, z, w."""
    return st.tuples(*[st.integers(-4, 4)] * 3, st.integers(-4, 4).map(lambda w: w or 5)).map(_unit)


def _unit(numbers: tuple[float, ...]) -> tuple[float, float, float, float]:
    x, y, z, w = (np.array(numbers) / np.linalg.norm(numbers)).tolist()
    return x, y, z, w


def _are_apart(pair: tuple[Vector, Vector]) -> bool:
    a, b = (np.array(axis) / np.linalg.norm(axis) for axis in pair)
    return float(np.linalg.norm(np.cross(a, b))) > _APART
