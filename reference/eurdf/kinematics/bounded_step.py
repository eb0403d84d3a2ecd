"""A small convex quadratic program: the best step within bounds."""

from __future__ import annotations

import numpy as np

from eurdf.array import Matrix, Vector
from eurdf.kinematics.rank import damped_step

# Below this, relative to the largest entry, is rounding.
_SLIGHT = 1e-12
# Maximum number of active-set changes, divided by the dimension plus one.
_MOST_CHANGES = 5


def bounded_step(H: Matrix, g: Vector, G: Matrix, h: Vector) -> Vector:
    """The y that minimises ½ yᵀ H y + gᵀ y subject to G y ≤ h.

    A primal active-set method from y = 0. Every iterate is within the bounds and not worse than the one before. If it
    cycles, which is possible where many bounds meet, it stops at the best iterate.

    Source: Nocedal and Wright, Numerical Optimization, 2006, algorithm 16.3.

    Args:
        H: Positive definite (m, m).
        g: (m,).
        G: (n, m).
        h: Nonnegative (n,), so that y = 0 is feasible.

    Returns:
        y (m,).
    """
    y, slack = np.zeros(len(g)), _SLIGHT * float(np.abs(g).max(initial=0.0))
    active: list[int] = []
    for _ in range(_MOST_CHANGES * (len(g) + 1)):
        p = _to_lowest(H, H @ y + g, G[active])
        along, room = G @ p, np.maximum(h - G @ y, 0.0)
        approached = along > _SLIGHT * np.abs(p).max(initial=0.0)
        approached[active] = False
        reach = np.full(len(h), np.inf)
        reach[approached] = room[approached] / along[approached]
        if reach.min(initial=np.inf) < 1.0:
            nearest = int(np.argmin(reach))
            y = y + reach[nearest] * p
            active.append(nearest)
            continue
        y = y + p  # minimum on the active bounds: are all multipliers nonnegative?
        pressures = -np.linalg.lstsq(G[active].T, H @ y + g, rcond=None)[0] if active else np.zeros(1)
        loosest = int(np.argmin(pressures))
        if pressures[loosest] >= -slack:
            break
        active.pop(loosest)
    return y


def damped_step_within(
    A: Matrix, e: Vector, damping: float, G: Matrix, h: Vector, free: Vector | None = None
) -> Vector:
    """The y that minimises |A y + e|² + λ|y|² subject to G y ≤ h; ``free`` is that without bounds, if it is known."""
    y = damped_step(A[None], e[None], np.array([damping]))[0] if free is None else free
    if (G @ y > h).any():
        H = A.T @ A
        H.ravel()[:: len(H) + 1] += damping
        y = bounded_step(H, A.T @ e, G, h)
    return y


def _to_lowest(H: Matrix, slope: Vector, normals: Matrix) -> Vector:
    """The step (m,) to the minimum orthogonal to the normals (k, m), from a point with the given gradient."""
    if not len(normals):
        return -np.asarray(np.linalg.solve(H, slope), dtype=np.float64)
    orthogonal, _ = np.linalg.qr(normals.T, mode="complete")
    N = orthogonal[:, len(normals) :]
    return -np.asarray(N @ np.linalg.solve(N.T @ H @ N, N.T @ slope), dtype=np.float64)
