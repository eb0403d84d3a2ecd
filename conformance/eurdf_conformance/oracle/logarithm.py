"""log3, log6, and the derivative of log6: chapter Closures.

All come from one function, (φ/2) cot(φ/2) = 1 − Σ b_k φ^2k, whose series has no cancellation at small angles and, up to
half a turn, gains a factor of 4 a term.
"""

from __future__ import annotations

import numpy as np

from eurdf_conformance.oracle.spatial import Array, skew

TERMS = 32


def _coefficients() -> Array:
    """b_1 … of (φ/2) cot(φ/2) = 1 − Σ b_k φ^2k.

    That function f meets φ f′ = f − f² − φ²/4, so (2k + 1) b_k = Σ_{i<k} b_i b_{k−i}, and 3 b_1 = 1/4.
    """
    b = np.zeros(TERMS + 1)
    b[1] = 1.0 / 12.0
    for k in range(2, TERMS + 1):
        b[k] = b[1:k] @ b[k - 1 : 0 : -1] / (2 * k + 1)
    return b[1:]


B = _coefficients()
K = np.arange(1, TERMS + 1)


def log3(R: Array) -> Array:
    """The rotation vector ω of R, |ω| ≤ π.

    By way of the quaternion, from its largest member: so it is exact near no turn and near half a turn alike.
    """
    d = np.diag(R)
    Q = np.empty((4, 4))  # 4 q qᵀ, q = (x, y, z, w)
    Q[:3, :3] = R + R.T
    Q[3, :3] = Q[:3, 3] = R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]
    np.fill_diagonal(Q, [*(1.0 + 2.0 * d - d.sum()), 1.0 + d.sum()])
    q = Q[np.argmax(np.diag(Q))]
    q = q / np.linalg.norm(q)
    if q[3] < 0.0:
        q = -q
    sine = float(np.linalg.norm(q[:3]))
    return np.asarray(q[:3] * (2.0 * np.arctan2(sine, q[3]) / sine)) if sine > 0.0 else np.zeros(3)


def log6(M: Array) -> Array:
    """(v, ω) of the pose (R, p): ω = log3 R, p = V(ω) v.

    V(ω)⁻¹ = 1 − ½ [ω]× + Σ b_k φ^(2k−2) [ω]×², φ = |ω|.
    """
    w = log3(M[:3, :3])
    W = skew(w)
    p = M[:3, 3]
    v = p - W @ p / 2.0 + (B @ (w @ w) ** (K - 1)) * (W @ W @ p)
    return np.concatenate([v, w])


def log6_derivative(x: Array) -> Array:
    """The matrix D of d/dt log6 M = D ξ, x = log6 M, where the twist ξ of M is seen from its left: Ṁ = [ξ] M.

    D = ad / (exp ad − 1) of the adjoint ad of x. As (ad² + φ²)² ad = 0, this is a polynomial, whose even part has at
    ad = iφ the value (φ/2) cot(φ/2), and its slope: D = 1 − ad/2 + c₂ ad² + c₄ ad⁴ with c₂ = Σ (2 − k) b_k φ^(2k−2)
    and c₄ = Σ (1 − k) b_k φ^(2k−4).
    """
    v, w = x[:3], x[3:]
    ad = np.zeros((6, 6))
    ad[:3, :3] = ad[3:, 3:] = skew(w)
    ad[:3, 3:] = skew(v)
    square = ad @ ad
    powers = (w @ w) ** (K - 1)
    c2 = ((2 - K) * B) @ powers
    c4 = ((1 - K) * B)[1:] @ powers[:-1]
    return np.asarray(np.eye(6) - ad / 2.0 + c2 * square + c4 * square @ square)
