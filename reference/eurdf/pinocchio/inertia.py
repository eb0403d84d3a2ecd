"""Inertias of bodies, to the last bit as Pinocchio's URDF parser makes them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pinocchio as pin

from eurdf.array import Matrix, Vector
from eurdf.mechanism.body import Inertia
from eurdf.mechanism.pose import IDENTITY, Quaternion

_Row = tuple[float, float, float]
_Matrix3 = tuple[_Row, _Row, _Row]


_MASSLESS = pin.Inertia.Zero()


def inertias_of(inertias: Sequence[Inertia | None]) -> list[pin.Inertia]:
    """Masses, centres of mass and rotational inertias about them, the last two in the body's frame; zero for None.

    The rotational inertia is R I Rᵀ, with R the orientation of the inertial frame in the body. Pinocchio keeps the
    lower triangle of what rounding leaves of its symmetry.
    """
    given = [inertia for inertia in inertias if inertia is not None]
    # One array from a flat list: from nested ones it takes three times as long.
    numbers = np.array([number for inertia in given for number in (*inertia.pose.xyz, *_turned(inertia))])
    rows = numbers.reshape(-1, 12)
    made = map(_inertia, given, rows[:, :3], rows[:, 3:].reshape(-1, 3, 3))
    return [_MASSLESS if inertia is None else next(made) for inertia in inertias]


def _inertia(inertia: Inertia, lever: Vector, moments: Matrix) -> pin.Inertia:
    try:
        return pin.Inertia(inertia.mass, lever, moments)
    except RuntimeError:
        # This constructor refuses moments that no body has, which Pinocchio's own URDF parser takes. `eurdf.check`
        # reports them; the kinematics are still of use.
        body = pin.Inertia(inertia.mass, lever, np.zeros((3, 3)))
        body.inertia = moments
        return body


def _turned(inertia: Inertia) -> tuple[float, ...]:
    """The nine entries of the rotational inertia, in the body's axes."""
    ixx, ixy, ixz, iyy, iyz, izz = inertia.moments
    if inertia.pose.quaternion != IDENTITY.quaternion:
        R = _rotation(inertia.pose.quaternion)
        # I is symmetric, so (R I)ᵢⱼ is row i of R by row j of I.
        RI = _rows_by_rows(R, ((ixx, ixy, ixz), (ixy, iyy, iyz), (ixz, iyz, izz)))
        (ixx, _, _), (ixy, iyy, _), (ixz, iyz, izz) = _rows_by_rows(RI, R)
    return ixx, ixy, ixz, ixy, iyy, iyz, ixz, iyz, izz


def body_regressors(poses: Matrix, twists: Matrix, accelerations: Matrix) -> Matrix:
    """The derivatives (n, 6, 10) of the forces that move bodies, by their `pin.Inertia.toDynamicParameters`.

    Poses (n, 4, 4) are in the world; forces, twists and accelerations (n, 6), against free fall, are linear, of the
    point at the origin of the world, and angular.
    """
    found = np.empty((len(poses), 6, 10))
    for index, pose in enumerate(poses):
        to_body = pin.SE3(pose).toActionMatrixInverse()
        motion = (pin.Motion(to_body @ each[index]) for each in (twists, accelerations))
        found[index] = to_body.T @ pin.bodyRegressor(*motion)
    return found


def is_zero(inertia: Inertia) -> bool:
    """Whether mass, centre of mass and moments are all exactly zero, so that Pinocchio counts no body."""
    return inertia.mass == 0.0 and not any(inertia.pose.xyz) and not any(inertia.moments)


def _rotation(quaternion: Quaternion) -> _Matrix3:
    x, y, z, w = quaternion
    tx, ty, tz = 2.0 * x, 2.0 * y, 2.0 * z
    twx, twy, twz = tx * w, ty * w, tz * w
    txx, txy, txz = tx * x, ty * x, tz * x
    tyy, tyz, tzz = ty * y, tz * y, tz * z
    return (
        (1.0 - (tyy + tzz), txy - twz, txz + twy),
        (txy + twz, 1.0 - (txx + tzz), tyz - twx),
        (txz - twy, tyz + twx, 1.0 - (txx + tyy)),
    )


def _rows_by_rows(A: _Matrix3, B: _Matrix3) -> _Matrix3:
    """A Bᵀ, each sum in the order of Eigen's 3x3 product: rows 0 and 1 go through a packet, row 2 through a halving."""
    (a, b, c), (d, e, f), (g, h, i) = A
    (p, q, r), (s, t, u), (x, y, z) = B
    return (
        (a * p + b * q + c * r, a * s + b * t + c * u, a * x + b * y + c * z),
        (d * p + e * q + f * r, d * s + e * t + f * u, d * x + e * y + f * z),
        (g * p + (h * q + i * r), g * s + (h * t + i * u), g * x + (h * y + i * z)),
    )
