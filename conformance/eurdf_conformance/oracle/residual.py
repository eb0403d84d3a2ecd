"""The residual of a 3d or 6d closure: chapter Closures, EU-CLO-008 and 009; others are in `hinge` and `distance`."""

from __future__ import annotations

from eurdf_conformance.oracle.kinematics import Kinematics
from eurdf_conformance.oracle.logarithm import log6
from eurdf_conformance.oracle.spatial import Array, inverse
from eurdf_conformance.oracle.tree import Placed


def residual(at: Kinematics, kind: str, a: Placed, b: Placed) -> Array:
    """r_3d = p, r_6d = log6 (R, p) = (v, ω), of aMb = (R, p): seen from A; m, rad."""
    aMb = inverse(at.pose(a)) @ at.pose(b)
    return aMb[:3, 3] if kind == "3d" else log6(aMb)
