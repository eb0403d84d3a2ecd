"""Three revolute joints in a row with axes through one point, which become one spherical joint."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from hypothesis import strategies as st

from eurdf_conformance.properties.mechanism import Inertia, Joint, Limit, Link
from eurdf_conformance.properties.placement import inverse, matrix_of, pose_of, vector
from eurdf_conformance.properties.strategies.numbers import decimals, poses

#: kg, less than 1e-5, EU-JNT-012.
_LIGHT = Inertia(mass=5e-06, moments=(1e-09, 0.0, 0.0, 1e-09, 0.0, 1e-09))


@st.composite
def chains(draw: st.DrawFn, names: list[str], links: list[str]) -> tuple[list[Joint], list[Link]]:
    """Three joints, and the two links between them.

    At zero, the axes are nearly those of the last frame, each of another: which joint is nearest to which axis
    (EU-JNT-024) is then no question of rounding.

    Args:
        draw: Of Hypothesis.
        names: Of the three joints.
        links: The link before, the two in between, and the link that is carried.
    """
    order = draw(st.permutations(range(3)))
    axes = np.eye(3)[order] + np.array(draw(st.tuples(*[decimals(-0.2, 0.2, 1)] * 9))).reshape(3, 3)
    # Frames of the three joints at zero, seen from the centre, along the axes of the last frame.
    frames = [matrix_of(draw(poses())) for _ in range(2)] + [np.eye(4)]
    for frame, axis, slide in zip(frames, axes, draw(st.tuples(*[decimals(-0.3, 0.3)] * 3)), strict=True):
        frame[:3, 3] = slide * axis
    first = matrix_of(draw(poses()))
    origins = [first, *(inverse(a) @ b for a, b in pairwise(frames))]
    joints = [
        Joint(
            name=name,
            type="revolute",
            parent=ends[0],
            child=ends[1],
            origin=pose_of(origin),
            axis=vector(frame[:3, :3].T @ axis),
            limit=Limit(effort=draw(decimals(0, 50, 1)), velocity=draw(decimals(0, 9, 1)), lower=-3.0, upper=3.0),
            damping=draw(st.none() | decimals(0, 1)),
        )
        for name, ends, origin, frame, axis in zip(names, pairwise(links), origins, frames, axes, strict=True)
    ]
    between = [Link(name=name, inertia=draw(st.sampled_from([None, _LIGHT]))) for name in links[1:3]]
    return joints, between
