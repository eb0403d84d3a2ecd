"""A closed configuration near a given one, at which the rank of K is defined: chapter Closures."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from eurdf_conformance.oracle.configuration import Configuration
from eurdf_conformance.oracle.spatial import Array

#: Number of successive steps that may not reduce the residual.
PATIENCE = 50

#: m and rad; smaller residuals are rounding.
CLOSED = 1e-13

#: Singular values below this fraction of the largest are redundant rows, and steps ignore them.
REDUNDANT = 1e-7

#: rad or m, the largest step.
STEP = 0.5


def closed(
    q: Configuration,
    residual: Callable[[Configuration], Array],
    jacobian: Callable[[Configuration], Array],
    moved: Callable[[Configuration, Array], Configuration],
) -> Configuration:
    """The configuration with the smallest residual that Newton's steps −K⁺ r reach."""
    best, r = q, residual(q)
    least = np.linalg.norm(r)
    waited = 0
    while np.linalg.norm(r) > CLOSED and waited < PATIENCE:
        step = -np.linalg.pinv(jacobian(q), rcond=REDUNDANT) @ r
        q = moved(q, step * min(1.0, STEP / float(np.linalg.norm(step) or 1.0)))
        r = residual(q)
        waited += 1
        if np.linalg.norm(r) < 0.999 * least:
            best, least, waited = q, np.linalg.norm(r), 0
    return best
