"""A closed configuration near a given one: where the rank of K is meant, chapter Closures."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from eurdf_conformance.oracle.configuration import Configuration
from eurdf_conformance.oracle.spatial import Array

#: Steps that may follow one another without the residual getting smaller.
PATIENCE = 50

#: m and rad; closer is no better than rounding.
CLOSED = 1e-13

#: Singular values below this share of the largest are redundant rows: a step along them would lead anywhere.
REDUNDANT = 1e-7

#: rad or m, the largest step.
STEP = 0.5


def closed(
    q: Configuration,
    residual: Callable[[Configuration], Array],
    jacobian: Callable[[Configuration], Array],
    moved: Callable[[Configuration, Array], Configuration],
) -> Configuration:
    """The configuration with the smallest residual that Newton's steps −K⁺ r lead to, however small that is."""
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
