"""Inertias of bodies, as formats need them that refuse what no body has."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from eurdf.exporting.coordinates import rotation_matrix
from eurdf.mechanism.body import Inertia

Matrix = npt.NDArray[np.float64]


def about_centre(inertia: Inertia) -> Matrix:
    """The rotational inertia (3, 3) about the centre of mass along the axes of the body, kg·m²."""
    xx, xy, xz, yy, yz, zz = inertia.moments
    moments = np.array(((xx, xy, xz), (xy, yy, yz), (xz, yz, zz)))
    R = rotation_matrix(inertia.pose.quaternion)
    turned = R @ moments @ R.T
    return np.asarray((turned + turned.T) / 2.0)


def physical(moments: Matrix, least: float) -> tuple[Matrix, float]:
    """The inertia with each principal moment at least ``least``, and the largest at most the sum of the others.

    Args:
        moments: Rotational inertia (3, 3) about the centre of mass, kg·m².
        least: kg·m².

    Returns:
        The same matrix if it is such an inertia, else a near one; and the largest change of a principal moment.
    """
    principal, axes = np.linalg.eigh(moments)
    wanted = np.maximum(principal, least)
    short = wanted[2] - wanted[0] - wanted[1]
    if short > 0.0:
        wanted[:2] += 0.5 * short * (1.0 + 1e-9) + 1e-15 * wanted[2]
    change = float(np.abs(wanted - principal).max())
    if change == 0.0:
        return moments, 0.0
    return np.asarray(axes @ np.diag(wanted) @ axes.T), change
