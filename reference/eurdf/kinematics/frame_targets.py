"""Targets of frames, and how far the frames are from them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from eurdf.array import Indices, Mask, Matrix, Vector
from eurdf.closures.se3 import IDENTITY_ROTATION, velocity_of_origin
from eurdf.kinematics.tolerances import CLOSED


class Target(NamedTuple):
    """Where frames should be; B elements.

    Attributes:
        position: (B, 3), m.
        rotation: (B, 3, 3); None for positions.
    """

    position: Matrix
    rotation: Matrix | None = None

    def among(self, which: Indices | Mask) -> Target:
        """Those of some elements."""
        return Target(self.position[which], None if self.rotation is None else self.rotation[which])


class FrameTargets:
    """The targets of F frames, of B elements.

    Errors are stacked in the order of the frames: of each the position, in characteristic lengths, and for a pose the
    rotation vector log3(Rᵀ oMf.rotation).

    Attributes:
        near: Bounds of the squared errors of each position and rotation within which a frame is at its target.
        nearly: The same of errors that no other start would make smaller.
    """

    def __init__(self, goals: Sequence[Target], length: float, tolerance: float, count: int) -> None:
        """Take the targets of each frame, the characteristic length, m, the tolerance, m and rad, and B."""
        self._length, self._count = length, len(goals)
        self._position, self._rotation = np.empty((count, len(goals), 3)), np.empty((count, len(goals), 3, 3))
        poses = [goal.rotation is not None for goal in goals]
        for index, goal in enumerate(goals):
            self._position[:, index] = goal.position
            self._rotation[:, index] = IDENTITY_ROTATION if goal.rotation is None else goal.rotation
        bounds = tolerance / length, tolerance
        self.near = np.array([bound for is_pose in poses for bound in bounds[: 1 + is_pose]]) ** 2
        self.nearly = np.maximum(self.near, CLOSED**2)
        self._turns, self._rows = any(poses), 6 * len(poses)
        # Of the rows of a position and a rotation for each frame those that count.
        self._used: Indices | slice = slice(None)
        if not all(poses):
            self._used = np.flatnonzero([each for is_pose in poses for each in (True, is_pose) for _ in range(3)])

    def errors(self, at: Any, which: Indices | None = None) -> Matrix:
        """The errors (b, k) of some elements (b,), all if None, whose frames are there."""
        position, rotation = self._position, self._rotation
        if which is not None and len(which) < len(position):
            position, rotation = position[which], rotation[which]
        errors = np.empty((len(position), self._count, 6))
        np.divide(at.position - position, self._length, out=errors[:, :, :3])
        if self._turns:
            errors[:, :, 3:] = at.turn_from(rotation)
        return errors.reshape(len(position), self._rows)[:, self._used]

    def jacobian(self, frames: Any, at: Any, e: Matrix) -> Matrix:
        """Derivatives (b, k, n) of the errors by the velocities, where the frames are, and the errors (b, k) are e."""
        b, F = at.position.shape[:2]
        rows = np.zeros((b, F, 6, 6))
        rows[:, :, :3] = velocity_of_origin(at.position) / self._length
        if self._turns:
            rows[:, :, 3:, 3:] = at.turn_by_omega(self._by_frame(e)[:, :, 1])
        J: Matrix = frames.rows(at, rows)
        return J[:, self._used]

    def distances(self, e: Matrix) -> tuple[Matrix, Matrix]:
        """How far each frame is from its target (b, F), m and rad, by the errors."""
        both = np.sqrt(np.add.reduce(np.square(self._by_frame(e)), axis=3))
        return self._length * both[:, :, 0], both[:, :, 1]

    def reached(self, e: Matrix, near: Vector | None = None) -> Mask:
        """Whether (b,) every frame is at its target within the tolerance, or within other bounds, squared."""
        squared = np.add.reduce(np.square(e).reshape(len(e), len(self.near), 3), axis=2)
        return np.asarray(np.logical_and.reduce(squared <= (self.near if near is None else near), axis=1))

    def _by_frame(self, e: Matrix) -> Matrix:
        """The errors of each frame (b, F, 2, 3): of its position, and of its rotation, zero if that is free."""
        errors = e
        if e.shape[1] < self._rows:
            errors = np.zeros((len(e), self._rows))
            errors[:, self._used] = e
        return errors.reshape(len(e), self._count, 2, 3)
