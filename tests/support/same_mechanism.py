"""Whether two mechanisms are the same but for rounding."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import fields, is_dataclass
from typing import Any

import numpy as np

from eurdf.convert.coordinates import rotation_matrix
from eurdf.mechanism.body import Inertia
from eurdf.mechanism.pose import Pose


def unlike(one: Any, other: Any, tolerance: float = 1e-12, at: str = "") -> list[str]:
    """The places where two values of the same kind differ by more than rounding."""
    if isinstance(one, Pose) and isinstance(other, Pose):
        R, S = rotation_matrix(one.quaternion), rotation_matrix(other.quaternion)
        return unlike([*one.xyz, *R.ravel().tolist()], [*other.xyz, *S.ravel().tolist()], tolerance, at)
    if isinstance(one, Inertia) and isinstance(other, Inertia):
        return unlike(_moments(one), _moments(other), tolerance, at)
    if is_dataclass(one) and type(one) is type(other):
        found = []
        for each in fields(one):
            found += unlike(getattr(one, each.name), getattr(other, each.name), tolerance, f"{at}.{each.name}")
        return found
    if isinstance(one, Mapping) and isinstance(other, Mapping):
        if one.keys() != other.keys():
            return [f"{at}: {sorted(set(one) ^ set(other))}"]
        return [place for key in one for place in unlike(one[key], other[key], tolerance, f"{at}[{key}]")]
    if isinstance(one, Sequence) and isinstance(other, Sequence) and not isinstance(one, str):
        if len(one) != len(other):
            return [f"{at}: {len(one)} and {len(other)} of them"]
        return [
            place
            for index, pair in enumerate(zip(one, other, strict=True))
            for place in unlike(*pair, tolerance, f"{at}[{getattr(pair[0], 'name', index)}]")
        ]
    if isinstance(one, float | int) and isinstance(other, float | int):
        same = one == other or abs(one - other) <= tolerance * max(1.0, abs(one))
        return [] if same else [f"{at}: {one} and {other}"]
    return [] if one == other else [f"{at}: {one} and {other}"]


def _moments(inertia: Inertia) -> list[Any]:
    """Mass, centre and moments along the axes of the body."""
    xx, xy, xz, yy, yz, zz = inertia.moments
    R = rotation_matrix(inertia.pose.quaternion)
    moments = R @ np.array(((xx, xy, xz), (xy, yy, yz), (xz, yz, zz))) @ R.T
    return [inertia.mass, *inertia.pose.xyz, *moments.ravel().tolist()]
