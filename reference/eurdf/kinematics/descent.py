"""Levenberg-Marquardt steps towards the closed configurations of one group of loops."""

from __future__ import annotations

import math

import numpy as np

from eurdf.kinematics.array import Matrix, Vector
from eurdf.kinematics.evaluation import Evaluation

# A descent gives up after this many steps in a row that bring the squared residual down by less than 2%.
_MOST_IDLE_STEPS = 6


class Descent:
    """Where the descent of one group of loops is, and how far it trusts its steps.

    A step δ solves (AᵀA + λ1) δ = -Aᵀb, with b the residual and A its derivative, lengths counted in characteristic
    lengths. With λ in proportion to |b|² it is careful far away and converges quadratically near a solution, also where
    rows are redundant.

    Attributes:
        evaluation: Evaluates the residual of the loops.
        r: Residual here (m,), m and rad.
        error: Its norm.
    """

    def __init__(self, evaluation: Evaluation, q: Vector) -> None:
        """Begin at q (nq,)."""
        self.evaluation = evaluation
        self._A: Matrix | None = None
        r = evaluation.residual(q)
        b = evaluation.row_scale * r
        self._stay(r, b, float(b.dot(b)))
        self._damping = 1e-3  # λ / |b|²
        self._expected = math.inf  # what the last step was to take off |b|²
        self._idle = 0  # steps in a row that hardly brought it further
        self._more = 8.0  # how much more damping the next step that is refused brings

    @property
    def stuck(self) -> bool:
        """Whether a further step is not worth its while."""
        return self._idle > _MOST_IDLE_STEPS or not self._expected > 1e-12 * self._square

    def step(self, room: tuple[Vector, Vector] | None = None) -> Vector:
        """The next step (n,), of at most 1 rad or characteristic length.

        Args:
            room: How far each velocity may go down (n,), at most 0, and how far up (n,), at least 0.
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
        """Look at the residual at q (nq,), where the step led to, and tell whether to stay there."""
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
        self._A = None  # evaluated with the next step, if there is one


def _within(A: Matrix, b: Vector, damping: float, down: Vector, up: Vector) -> Vector:
    """A damped step that keeps its room: what would leave at its limit stays there, and the others do its part."""
    step = np.zeros(len(down))
    free = np.ones(len(down), dtype=bool)
    while True:
        step[free] = _damped(A[:, free], b, damping)
        blocked = free & (((step < 0.0) & (down == 0.0)) | ((step > 0.0) & (up == 0.0)))
        if not blocked.any():
            break
        step[blocked] = 0.0
        free &= ~blocked
    return np.clip(step / float(np.abs(step).max(initial=1.0)), down, up)


def _damped(A: Matrix, b: Vector, damping: float) -> Vector:
    """The δ that minimises |A δ + b|² + λ |δ|², through the smaller one of A Aᵀ and Aᵀ A."""
    wide = A.shape[0] < A.shape[1]
    gram = A @ A.T if wide else A.T @ A
    diagonal = gram.ravel()[:: len(gram) + 1]
    diagonal += max(damping, 1e-13 * float(diagonal.sum()), 1e-300)  # invertible, redundant rows or not
    step: Vector = A.T.dot(np.linalg.solve(gram, -b)) if wide else np.linalg.solve(gram, A.T.dot(-b))
    return step
