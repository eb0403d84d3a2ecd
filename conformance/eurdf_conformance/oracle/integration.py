"""q ⊕ v: where a joint gets to in unit time, if its velocity is constant: chapter Scope and terms."""

from __future__ import annotations

import numpy as np

from eurdf_conformance.oracle.spatial import Array, from_quaternion, quaternion_product, rotation, skew

Z = np.array([0.0, 0.0, 1.0])

#: Of (φ − sin φ)/φ³ by powers of φ², the highest first: at small angles the quotient would have no digits left.
SERIES = (-1 / 362880, 1 / 5040, -1 / 120, 1 / 6)


def integrate(kind: str, q: Array, v: Array) -> Array:
    """The coordinates of a joint that was at q, after 1 s of the velocity v of the table of chapter Joints."""
    match kind:
        case "planar":
            w = v[2] * Z
            x, y, _ = rotation(Z, q[2]) @ exp_translation(np.array([v[0], v[1], 0.0]), w)
            return np.array([q[0] + x, q[1] + y, q[2] + v[2]])
        case "spherical":
            return quaternion_product(q, exp_quaternion(v))
        case "floating":
            p = q[:3] + from_quaternion(q[3:]) @ exp_translation(v[:3], v[3:])
            return np.concatenate([p, quaternion_product(q[3:], exp_quaternion(v[3:]))])
    return q + v


def exp_quaternion(w: Array) -> Array:
    """The quaternion (x, y, z, w) of the rotation vector ω: (sin(φ/2)/φ ω, cos(φ/2)), φ = |ω|."""
    half = float(np.linalg.norm(w)) / 2.0
    return np.array([*(np.sinc(half / np.pi) / 2.0 * w), np.cos(half)])


def exp_translation(v: Array, w: Array) -> Array:
    """V(ω) v: how far a frame comes in unit time, seen from where it was."""
    angle = float(np.linalg.norm(w))
    W = skew(w)
    cubic = (angle - np.sin(angle)) / angle**3 if angle > 0.1 else np.polyval(SERIES, angle**2)
    return np.asarray(v + np.sinc(angle / 2.0 / np.pi) ** 2 / 2.0 * W @ v + cubic * W @ W @ v)
