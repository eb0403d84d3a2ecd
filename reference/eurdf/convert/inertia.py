"""Inertias of bodies, as formats need them that refuse, or replace, what no body has."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from eurdf.array import Matrix
from eurdf.convert.coordinates import rotation_matrix
from eurdf.convert.losses import Losses
from eurdf.errors import CannotExport
from eurdf.mechanism.body import Body, Inertia
from eurdf.mechanism.pose import IDENTITY, Pose
from eurdf.writing.xml_text import angles_with_yaw

#: A change of a principal moment by this part of the largest one is rounding.
_SAME_MOMENT = 1e-12

#: Programs find principal moments with errors up to this part of the largest one: MuJoCo's iteration stops at an angle
#: of 1e-6 rad, and the formula of gz-math loses half the digits where two of them are equal.
_UNSURE = 1e-6


def has_inertia(body: Body) -> bool:
    """Whether a body has a mass or a moment of inertia."""
    return body.inertia is not None and bool(body.inertia.mass or any(body.inertia.moments))


def accepted_inertia(body: Body, losses: Losses, least: float, least_moment: float = 0.0) -> Inertia:
    """The inertia of a body, or one near it that a format accepts; what changes is a loss.

    Args:
        body: The body; without an inertia, it has no mass.
        losses: Gets ``export-massless-link`` for less mass than ``least``, and ``export-inertia`` for another change.
        least: Least mass, and least principal moment where there is less mass, kg and kg·m².
        least_moment: Least principal moment of other bodies, kg·m².

    Raises:
        CannotExport: The mass is negative.
    """
    inertia = body.inertia or Inertia(0.0, IDENTITY, (0.0,) * 6)
    if inertia.mass < 0.0:
        raise CannotExport(f"link '{body.name}' has the mass {inertia.mass:g} kg; correct it in the URDF")
    massless = inertia.mass < least
    if massless:
        losses.add("export-massless-link", body.name)
    found, change = physical(inertia, least if massless else least_moment)
    if change > (least if massless else 0.0):
        losses.add("export-inertia", body.name, f"a principal moment changes by {change:.1e} kg·m²")
    return replace(found, mass=max(inertia.mass, least))


def about_centre(inertia: Inertia) -> Matrix:
    """The rotational inertia (3, 3) about the centre of mass along the axes of the body, kg·m²."""
    R = rotation_matrix(inertia.pose.quaternion)
    turned = R @ _matrix(inertia) @ R.T
    return np.asarray((turned + turned.T) / 2.0)


def along_principal_axes(inertia: Inertia) -> Inertia:
    """The same inertia in a frame along its principal axes: its products of inertia are 0."""
    if not any(inertia.moments[index] for index in (1, 2, 4)):
        return inertia
    principal, axes = np.linalg.eigh(_matrix(inertia))
    axes[:, 2] *= np.linalg.det(axes)
    (a, b, c), ((ax, bx, cx), (ay, by, cy), (az, bz, cz)) = principal.tolist(), axes.tolist()
    angles = angles_with_yaw(math.atan2(ay, ax), (ax, ay, az), (bx, by, bz), (cx, cy, cz))
    turn = Pose.from_xyz_rpy((0.0, 0.0, 0.0), angles)
    return Inertia(inertia.mass, inertia.pose * turn, (a, 0.0, 0.0, b, 0.0, c))


def physical(inertia: Inertia, least: float) -> tuple[Inertia, float]:
    """The inertia with each principal moment at least ``least``, and the largest at most the sum of the others.

    Args:
        inertia: Any inertia.
        least: kg·m².

    Returns:
        The same inertia if these inequalities hold for sure; one along the principal axes if they barely hold, so that
        a program has no products of inertia to compute principal moments from; else a near one along these axes. And
        the largest change of a principal moment, kg·m²; 0 if it is rounding.
    """
    found = along_principal_axes(inertia)
    given = found.moments[0], found.moments[3], found.moments[5]
    smallest, middle, largest = order = sorted(range(3), key=lambda index: given[index])
    wanted = [max(moment, least) for moment in given]
    room = wanted[smallest] + wanted[middle] - wanted[largest]
    if wanted == list(given) and min(given[smallest] - least, room) > _UNSURE * given[largest]:
        return inertia, 0.0
    if room < 0.0:
        for index in order[:2]:
            wanted[index] += -0.5 * room * (1.0 + 1e-9) + 1e-15 * wanted[largest]
    change = max(abs(one - other) for one, other in zip(wanted, given, strict=True))
    a, b, c = wanted
    return replace(found, moments=(a, 0.0, 0.0, b, 0.0, c)), change if change > _SAME_MOMENT * wanted[largest] else 0.0


def _matrix(inertia: Inertia) -> Matrix:
    """The rotational inertia (3, 3) along the axes of its own frame, kg·m²."""
    xx, xy, xz, yy, yz, zz = inertia.moments
    return np.array(((xx, xy, xz), (xy, yy, yz), (xz, yz, zz)))
