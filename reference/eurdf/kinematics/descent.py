"""Levenberg-Marquardt steps towards the closed configurations of one group of loops."""

from __future__ import annotations

import math

import numpy as np

from eurdf.kinematics.array import Matrix, Vector
from eurdf.kinematics.evaluation import Evaluation

#: A descent gives up after this many consecutive steps that each reduce the squared residual by less than 2%.
MOST_IDLE_STEPS = 6


class Descent:
    """State of the descent of one group of loops.

    A step δ solves (AᵀA + λ1) δ = -Aᵀb, with b the residual and A its derivative, in units of the characteristic
    length. Since λ is proportional to |b|², steps are small far from a solution, and convergence near it is quadratic,
    even with redundant rows.

    Attributes:
        evaluation: Evaluates the residual of the loops.
        r: Current residual (m,), m and rad.
        error: Its norm.
    """

    def __init__(self, evaluation: Evaluation, q: Vector) -> None:
        """Start at q (nq,)."""
        self.evaluation = evaluation
        self._A: Matrix | None = None
        r = evaluation.residual(q)
        b = evaluation.row_scale * r
        self._stay(r, b, float(b.dot(b)))
        self._damping = 1e-3  # λ / |b|²
        self._expected = math.inf  # expected reduction of |b|² by the last step
        self._idle = 0  # consecutive steps with little progress
        self._more = 8.0  # factor of the damping after the next rejected step

    @property
    def stuck(self) -> bool:
        """Whether further steps are not worthwhile."""
        return self._idle > MOST_IDLE_STEPS or not self._expected > 1e-12 * self._square

    @property
    def scaled_error(self) -> float:
        """Norm of the dimensionless residual."""
        return math.sqrt(self._square)

    def step(self, room: tuple[Vector, Vector] | None = None) -> Vector:
        """The next step (n,), of at most 1 rad or characteristic length.

        Args:
            room: Distances to the lower limits (n,), at most 0, and to the upper limits (n,), at least 0.
        """
        if self._A is None:
            self._A = self.evaluation.jacobian()
        A, b, damping = self._A, self._b, self._damping * self._square
        if room is None:
            step = _damped(A, b, damping)
            largest = max(map(abs, step.tolist()), default=0.0)
            if largest > 1.0:
                step /= largest
        else:
            step = _within(A, b, damping, *room)
        predicted = A.dot(step)
        predicted += b
        self._expected = self._square - float(predicted.dot(predicted))
        return step

    def arrive(self, q: Vector) -> bool:
        """Evaluate the residual at q (nq,), the end of the step; return whether the step is accepted."""
        r = self.evaluation.residual(q)
        b = self.evaluation.row_scale * r
        before, reached = self._square, float(b.dot(b))
        gain = (before - reached) / self._expected if self._expected > 0.0 else 0.0
        self._idle = 0 if reached < 0.98 * before else self._idle + 1
        if not gain > 0.01:
            self._damping *= self._more
            self._more *= 2.0
            return False
        self._more = 8.0
        self._damping = max(self._damping * (0.1 if gain > 0.75 else 1.0 if gain > 0.25 else 4.0), 1e-8)
        self._stay(r, b, reached)
        return True

    def _stay(self, r: Vector, b: Vector, square: float) -> None:
        self.r, self.error = r, math.hypot(*r.tolist())
        self._b, self._square = b, square
        self._A = None  # evaluated with the next step


def _within(A: Matrix, b: Vector, damping: float, down: Vector, up: Vector) -> Vector:
    """A damped step within the limits: joints that would exceed a limit stay at it, and the others compensate."""
    step = _damped(A, b, damping)
    if ((step >= np.maximum(down, -1.0)) & (step <= np.minimum(up, 1.0))).all():
        return step
    free = np.ones(len(down), dtype=bool)
    while True:
        blocked = free & (((step < 0.0) & (down == 0.0)) | ((step > 0.0) & (up == 0.0)))
        if not blocked.any():
            break
        step[blocked] = 0.0
        free &= ~blocked
        step[free] = _damped(A[:, free], b, damping)
    return np.minimum(np.maximum(step / float(np.abs(step).max(initial=1.0)), down), up)


def _damped(A: Matrix, b: Vector, damping: float) -> Vector:
    """The δ that minimises |A δ + b|² + λ |δ|², from the smaller of A Aᵀ and Aᵀ A."""
    wide = A.shape[0] < A.shape[1]
    gram = A.dot(A.T) if wide else A.T.dot(A)
    diagonal = gram.ravel()[:: len(gram) + 1]
    diagonal += max(damping, 1e-13 * float(diagonal.sum()), 1e-300)  # invertible even with redundant rows
    step: Vector = A.T.dot(np.linalg.solve(gram, -b)) if wide else np.linalg.solve(gram, A.T.dot(-b))
    return step
