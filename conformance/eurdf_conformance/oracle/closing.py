"""Closed configurations: chapter Closures."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from eurdf_conformance.oracle.configuration import Configuration
from eurdf_conformance.oracle.spatial import Array

#: m and rad: how far a closure or a coupling may be open.
BOUND = 1e-6

#: Number of successive steps that may not reduce the residual.
PATIENCE = 50

#: m and rad; smaller residuals are rounding.
CLOSED = 1e-13

#: Singular values below this fraction of the largest are redundant rows, and steps ignore them.
REDUNDANT = 1e-7

#: rad or m, the largest step.
STEP = 0.5

#: rad or m: how far each velocity moves the starts of the least search that are not the neutral configuration.
ASIDE = (0.1, -0.1)

#: Number of steps of the least search from one start.
STEPS = 100


def closed(
    q: Configuration,
    residual: Callable[[Configuration], Array],
    jacobian: Callable[[Configuration], Array],
    moved: Callable[[Configuration, Array], Configuration],
) -> Configuration:
    """The configuration with the smallest residual that the steps reach, at which the rank of K is defined."""
    best, r = q, residual(q)
    least = np.linalg.norm(r)
    waited = 0
    while np.linalg.norm(r) > CLOSED and waited < PATIENCE:
        q = moved(q, step(r, jacobian(q)))
        r = residual(q)
        waited += 1
        if np.linalg.norm(r) < 0.999 * least:
            best, least, waited = q, np.linalg.norm(r), 0
    return best


def search(
    q: Configuration,
    is_closed: Callable[[Configuration], bool],
    residual: Callable[[Configuration], Array],
    jacobian: Callable[[Configuration], Array],
    moved: Callable[[Configuration, Array], Configuration],
) -> Configuration | None:
    """EU-CLO-016: the closed configuration that the least search finds from one start."""
    for _ in range(STEPS):
        if is_closed(q):
            return q
        q = moved(q, step(residual(q), jacobian(q)))
    return q if is_closed(q) else None


def step(r: Array, K: Array) -> Array:
    """−K⁺ r, shortened to the largest step."""
    found: Array = -np.linalg.pinv(K, rcond=REDUNDANT) @ r
    return found * min(1.0, STEP / float(np.linalg.norm(found) or 1.0))
