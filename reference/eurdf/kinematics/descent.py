"""Levenberg-Marquardt steps towards the closed configurations of one group of loops."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from eurdf.kinematics.array import Matrix, Vector
from eurdf.kinematics.loop import LoopGroup

# A descent gives up after this many steps in a row that bring the squared residual down by less than 2%.
_MOST_IDLE_STEPS = 6


@dataclass(slots=True, eq=False)
class Descent:
    """Where the descent of one group of loops is, and how far it trusts its steps.

    A step δ solves (AᵀA + λ1) δ = -Aᵀb. With λ in proportion to |b|² it is careful far away and converges
    quadratically near a solution, also where rows are redundant.

    Attributes:
        group: The loops.
        r: Their residual here (m,), m and rad.
        A: Their block of the Jacobian here (m, n), lengths counted in characteristic lengths, ...
        b: ... and their residual (m,), counted so.
        damping: λ / |b|².
        expected: What the last step was to take off |b|².
        idle: Steps in a row that hardly brought it further.
    """

    group: LoopGroup
    r: Vector
    A: Matrix
    b: Vector
    damping: float = 1e-3
    expected: float = math.inf
    idle: int = 0

    @property
    def error(self) -> float:
        """Norm of the residual, m and rad."""
        return math.hypot(*self.r)

    @property
    def stuck(self) -> bool:
        """Whether a further step is not worth its while."""
        return self.idle > _MOST_IDLE_STEPS or not self.expected > 1e-12 * float(self.b @ self.b)

    def step(self, down: Vector, up: Vector) -> Vector:
        """The next step (n,), of at most 1 rad or characteristic length.

        Args:
            down: How far each velocity may go down (n,), at most 0.
            up: How far each may go up (n,), at least 0.
        """
        error = float(self.b @ self.b)
        step = np.zeros(len(down))
        free = np.ones(len(down), dtype=bool)
        while True:  # a coordinate that would leave at its limit stays there, and the others do its part
            step[free] = _damped(self.A[:, free], self.b, self.damping * error)
            blocked = free & (((step < 0.0) & (down == 0.0)) | ((step > 0.0) & (up == 0.0)))
            if not blocked.any():
                break
            step[blocked] = 0.0
            free &= ~blocked
        step = np.clip(step / float(np.abs(step).max(initial=1.0)), down, up)
        self.expected = error - float(np.sum(np.square(self.b + self.A @ step)))
        return step

    def accept(self, r: Vector, A: Matrix, b: Vector) -> bool:
        """Whether the step was a good one; if so, this is where it led to.

        Args:
            r: Residual after the step.
            A: Jacobian after the step, scaled.
            b: Residual after the step, scaled.
        """
        error, reached = float(self.b @ self.b), float(b @ b)
        gain = (error - reached) / self.expected if self.expected > 0.0 else 0.0
        self.idle = 0 if reached < 0.98 * error else self.idle + 1
        if not gain > 0.01:
            self.damping *= 8.0
            return False
        self.damping = max(self.damping * (0.1 if gain > 0.75 else 1.0 if gain > 0.25 else 4.0), 1e-8)
        self.r, self.A, self.b = r, A, b
        return True


def _damped(A: Matrix, b: Vector, damping: float) -> Vector:
    """The δ that minimises |A δ + b|² + λ |δ|², through the smaller one of A Aᵀ and Aᵀ A."""
    wide = A.shape[0] < A.shape[1]
    gram = A @ A.T if wide else A.T @ A
    diagonal = np.einsum("ii->i", gram)
    diagonal += max(damping, 1e-13 * float(diagonal.sum()), 1e-300)  # invertible, redundant rows or not
    return -np.asarray(A.T @ np.linalg.solve(gram, b) if wide else np.linalg.solve(gram, A.T @ b), dtype=np.float64)
