"""The constraint Jacobian: chapter Closures, EU-CLO-010."""

from __future__ import annotations

import numpy as np

from eurdf_conformance.oracle import distance, hinge
from eurdf_conformance.oracle.kinematics import Kinematics
from eurdf_conformance.oracle.logarithm import log6, log6_derivative
from eurdf_conformance.oracle.spatial import Array, adjoint, inverse, skew
from eurdf_conformance.oracle.tree import Placed


def jacobian(at: Kinematics, sharing: Array, kind: str, a: Placed, b: Placed, axes: tuple[Array, ...] = ()) -> Array:
    """The rows of K of one closure: ṙ = K v.

    With J_A and J_B the twists of the bodies that carry the two frames, ξ = Ad(rM_A)⁻¹ (J_B − J_A) v is that of B
    relative to A, seen from A. Then ṗ = ξ_v + ξ_ω × p, and d/dt log6 = D ξ.

    Args:
        at: The configuration.
        sharing: G, which takes the velocities of the mechanism to those of every joint.
        kind: 3d, 6d, hinge or distance.
        a: Frame A.
        b: Frame B.
        axes: Those of a hinge.
    """
    rMa = at.pose(a)
    aMb = inverse(rMa) @ at.pose(b)
    between = at.columns * (at.moves[b.body].astype(float) - at.moves[a.body])
    twist = adjoint(inverse(rMa)) @ between @ sharing
    if kind == "hinge":
        return np.asarray(hinge.derivative(aMb, axes) @ twist)
    if kind == "distance":
        return np.asarray(distance.derivative(aMb) @ twist)
    if kind == "3d":
        return np.asarray(twist[:3] - skew(aMb[:3, 3]) @ twist[3:])
    return np.asarray(log6_derivative(log6(aMb)) @ twist)
