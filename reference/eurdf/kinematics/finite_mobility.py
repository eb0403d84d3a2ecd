"""Finite mobility: whether the motions that are free to first order continue.

At a closed configuration q, K Z = 0 and Yᵀ K = 0, in units of the characteristic length. A motion can start along Z z
only if Q_k(z) = y_kᵀ r″(Z z, Z z) = 0 for every k. Where this does not decide, each root z is followed by continuation.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from typing import Literal, NamedTuple

import numpy as np

from eurdf.array import Matrix, Vector
from eurdf.kinematics.descend import descend
from eurdf.kinematics.problem import Group, Problem
from eurdf.kinematics.quadratic_forms import common_roots
from eurdf.kinematics.rank import null_space, numerical_rank, singular_values
from eurdf.kinematics.tolerances import CONTINUED, FILE_ROUNDING, FLOOR

#: What decides the finite mobility: the rank of K is the same at all configurations around q, closed or not (a proof);
#: no velocity passes the second-order test (a proof); or motions were followed step by step (numerical evidence).
Evidence = Literal["constant rank", "second order", "continuation"]

# Distances of the open configurations at which the rank is compared (rad, or characteristic lengths).
_AROUND = (0.05, 0.2)

# Steps of the continuation from q, in the same units.
_STEPS = (0.08, 0.04, 0.02, 0.01)

# Half the step of the central difference for second derivatives: they are exact to about 1e-8.
_DIFFERENCE = 1e-4

# Velocities that are free to first order, at most; with more, the answer is unknown.
_MOST_FREE = 20


# Bound of the multiplications in all steps for one robot: one or two seconds.
_MOST_WORK = 2e9

# How far loops that are closed to rounding are moved, in the same units: in so many steps.
_FAR, _FAR_STEPS = 0.2, 4


class FiniteMobility(NamedTuple):
    """How far the free velocities of a group of loops continue, as `LoopAnalysis` has it.

    Attributes:
        infinitesimal: nv - rank K at q.
        finite: Dimension of the largest branch of closed configurations around q; None if undecided.
        evidence: What decides it; None if undecided.
        branches: Dimension of each branch; empty where q is isolated, or undecided.
        rigid_order: Order of rigidity where q is isolated, else None.
    """

    infinitesimal: int
    finite: int | None
    evidence: Evidence | None
    branches: tuple[int, ...] = ()
    rigid_order: int | None = None


class _Path(NamedTuple):
    """What continuation finds along one direction.

    Attributes:
        q: The configuration (nq,) at the end, where the loops stay closed; else None.
        order: The order p at which they open, where it is clear; else None.
    """

    q: Vector | None
    order: int | None


class _OutOfWork(Exception):  # noqa: N818 - caught here, and no error
    """The bound of the work is reached."""


class MobilityTest:
    """Decides the finite mobility of each group of loops of one robot; the work is bounded."""

    def __init__(self, problem: Problem) -> None:
        """Take a robot."""
        self._problem = problem
        self._work = 0.0

    @np.errstate(over="ignore", invalid="ignore")  # a path on which numbers overflow does not close
    def finite(self, q: Vector) -> list[FiniteMobility]:
        """The finite mobility of each group at a closed configuration q (nq,)."""
        groups = self._problem.groups
        at = [_jacobian(group, q) for group in groups]
        ranks = [_rank(A) for A in at]
        constant = [True] * len(ranks)
        if any(0 < rank < min(A.shape) for rank, A in zip(ranks, at, strict=True)):
            random = np.random.default_rng(0)
            for length in _AROUND:
                steps = [random.uniform(-length, length, (1, len(group.unit))) for group in groups]
                near = self._problem.moved(q[None], groups, steps)[0]
                for index, (group, rank) in enumerate(zip(groups, ranks, strict=True)):
                    if constant[index] and rank < min(at[index].shape):
                        constant[index] = _rank(_jacobian(group, near)) <= rank
        found = []
        for group, rank, regular in zip(groups, ranks, constant, strict=True):
            free = len(group.unit) - rank
            if regular or free == 0:
                found.append(_regular(free))
            else:
                found.append(self._bounded(group, q))
        return found

    @np.errstate(over="ignore", invalid="ignore")  # a path on which numbers overflow does not close
    def rounded(self, q: Vector) -> tuple[int, float] | None:
        """Mobility of loops that are closed only to rounding, and their residual, at the least open q (nq,).

        Singular values of K below ten times the dimensionless residual ε count as zero. The motions that this frees
        must stay open by at most 10 ε over 0.2 rad, or characteristic lengths.

        Returns:
            The sum over all groups and the largest ε; None if a group is open by more than rounding, or undecided.
        """
        total, widest = 0, 0.0
        for group in self._problem.groups:
            try:
                here, error = self._close(group, q)
                free = self._rounded_group(group, here, error)
            except _OutOfWork:
                return None
            if free is None:
                return None
            total, widest = total + free, max(widest, error)
        return total, widest

    def _rounded_group(self, group: Group, q: Vector, error: float) -> int | None:
        if not error <= FILE_ROUNDING:
            return None
        A = _jacobian(group, q)
        values, right = np.linalg.svd(A, full_matrices=True)[1:]
        threshold = max(math.sqrt(FLOOR), 10.0 * error)
        rank = int((values > threshold * values.max(initial=0.0)).sum())
        basis = right[rank:]
        if 0 < len(basis) <= _MOST_FREE and rank < len(A):
            mixed = np.random.default_rng(0).normal(size=len(basis)) @ basis
            for direction in [*basis, mixed / np.linalg.norm(mixed)]:
                if self._opens(group, q, direction, rank, 10.0 * max(error, CONTINUED)):
                    return None
        return len(basis) if len(basis) <= _MOST_FREE or rank == len(A) else None

    def _opens(self, group: Group, q: Vector, direction: Vector, rank: int, bound: float) -> bool:
        """Whether the loops open by more than a bound along a direction (n,), which turns with the free velocities."""
        for _ in range(_FAR_STEPS):
            q = self._moved(group, q, (_FAR / _FAR_STEPS) * direction)
            q, error = self._close(group, q, direction)
            if not error <= bound:
                return True
            basis = np.linalg.svd(_jacobian(group, q), full_matrices=True)[2][rank:]
            direction = direction @ basis.T @ basis
            direction = direction / np.linalg.norm(direction)
        return False

    def _bounded(self, group: Group, q: Vector) -> FiniteMobility:
        """The finite mobility of one group whose rank is not the same around q (nq,)."""
        try:
            return self._decide(group, *self._close(group, q), deeper=True)
        except _OutOfWork:
            return FiniteMobility(len(group.unit) - _rank(_jacobian(group, q)), None, None)

    def _decide(self, group: Group, q: Vector, error: float, *, deeper: bool) -> FiniteMobility:
        """The same; ``error`` is the dimensionless residual at q, and ``deeper`` whether branches may be examined."""
        A = _jacobian(group, q)
        left, values, right = np.linalg.svd(A, full_matrices=True)
        rank = numerical_rank(values)
        Z, Y = right[rank:].T, left[:, rank:]
        free = Z.shape[1]
        if not free or not Y.shape[1]:
            return _regular(free)
        if free > _MOST_FREE:
            return FiniteMobility(free, None, None)
        roots = common_roots(self._second_derivatives(group, q, Y, Z))
        if roots.none:
            return FiniteMobility(free, 0, "second order", rigid_order=2)
        floor = max(CONTINUED, 10.0 * error)
        paths = [self._follow(group, q, Z @ root, floor) for root in roots.directions]
        if not roots.count:  # every direction is a root, so that one in general position decides
            if paths[0].q is not None:
                return FiniteMobility(free, free, "continuation", (free,))
            order = paths[0].order if free == 1 else None
            if order is None:
                return FiniteMobility(free, None, None)
            return FiniteMobility(free, 0, "continuation", rigid_order=order)
        return self._of_branches(group, free, roots.complete, paths, floor, deeper=deeper)

    def _of_branches(
        self, group: Group, free: int, complete: bool, paths: Sequence[_Path], floor: float, *, deeper: bool
    ) -> FiniteMobility:
        """The finite mobility from the roots of the second-order test, each followed."""
        undecided = any(path.q is None and path.order is None for path in paths) or not paths
        branches: list[tuple[int, Matrix]] = []
        for path in paths:
            if path.q is None:
                continue
            basis = null_space(_jacobian(group, path.q))
            dimension: int | None = len(basis)
            if len(basis) > 1 and not self._is_constant(group, path.q):
                dimension = self._decide(group, path.q, floor, deeper=False).finite if deeper else None
            if dimension is None:
                undecided = True
            else:
                branches.append((dimension, basis))
        largest = max((dimension for dimension, _ in branches), default=0)
        # A form that is not zero leaves at most free - 1 dimensions.
        if largest < free - 1 and (undecided or (not complete and not branches)):
            return FiniteMobility(free, None, None)
        if not branches:
            order = max(path.order for path in paths if path.order)
            return FiniteMobility(free, 0, "continuation", rigid_order=order)
        # The roots of more than two variables are a sample: two of them may be on one branch.
        dimensions = tuple(sorted({dimension for dimension, _ in branches}, reverse=True))
        return FiniteMobility(free, largest, "continuation", _distinct(branches) if free == 2 else dimensions)

    def _is_constant(self, group: Group, q: Vector) -> bool:
        """Whether the rank of K at q (nq,) is that of all configurations around it."""
        rank, random = _rank(_jacobian(group, q)), np.random.default_rng(0)
        return all(
            _rank(_jacobian(group, self._moved(group, q, random.uniform(-length, length, len(group.unit))))) <= rank
            for length in _AROUND
        )

    def _second_derivatives(self, group: Group, q: Vector, Y: Matrix, Z: Matrix) -> Matrix:
        """Symmetric matrices Q_k (κ, m, m) with zᵀ Q_k z = y_kᵀ r″(Z z, Z z), which is y_kᵀ times the drift at Z z."""
        forms = np.empty((Y.shape[1], Z.shape[1], Z.shape[1]))
        for index, direction in enumerate(Z.T):
            ends = [_jacobian(group, self._moved(group, q, h * direction)) for h in (_DIFFERENCE, -_DIFFERENCE)]
            forms[:, index] = Y.T @ ((ends[0] - ends[1]) / (2.0 * _DIFFERENCE)) @ Z
        return np.asarray((forms + np.swapaxes(forms, 1, 2)) / 2.0)

    def _follow(self, group: Group, q: Vector, direction: Vector, floor: float) -> _Path:
        """Follow a direction (n,) from q (nq,), or the opposite one where the first ends."""
        orders = []
        for sign in (1.0, -1.0):
            errors = []
            end = q
            for length in _STEPS:
                start = self._moved(group, q, sign * length * direction)
                there, error = self._close(group, start, direction)
                errors.append(error)
                end = there if len(errors) == 1 else end
            if max(errors) <= floor:
                return _Path(end, None)
            orders.append(_order(errors, floor))
        clear = [order for order in orders if order is not None]
        return _Path(None, min(clear) if len(clear) == len(orders) else None)

    def _close(self, group: Group, q: Vector, held: Vector | None = None) -> tuple[Vector, float]:
        """Close one group from q (nq,), with no motion along a unit direction (n,): where it ends, and its residual."""
        found = descend(self._problem, [group if held is None else group.holding(held)], q[None], 1e-15)
        self._spend(group, q, int(found.steps[0]))
        return found.q[0], math.sqrt(found.scaled_square[0])

    def _moved(self, group: Group, q: Vector, step: Vector) -> Vector:
        self._spend(group, q, 1)
        return np.asarray(self._problem.moved(q[None], [group], [step[None]])[0])

    def _spend(self, group: Group, q: Vector, steps: int) -> None:
        self._work += steps * (group.work + 10.0 * len(q))
        if self._work > _MOST_WORK:
            raise _OutOfWork


def _regular(free: int) -> FiniteMobility:
    return FiniteMobility(free, free, "constant rank", (free,) if free else (), rigid_order=None if free else 1)


def _jacobian(group: Group, q: Vector) -> Matrix:
    return np.asarray(group.jacobian_at(q[None])[0])


def _rank(A: Matrix) -> int:
    return numerical_rank(singular_values(A))


def _order(errors: Sequence[float], floor: float) -> int | None:
    """The p with errors ∝ hᵖ at steps h that are halved each time; None if it is not clear."""
    above = [error for error in errors if error > 10.0 * floor]
    if len(above) < 2:
        return None
    slopes = [math.log2(one / other) for one, other in itertools.pairwise(above)]
    order = round(slopes[-1])
    return order if order >= 2 and all(abs(slope - order) < 0.4 for slope in slopes[-2:]) else None


def _distinct(branches: Sequence[tuple[int, Matrix]]) -> tuple[int, ...]:
    """Dimensions of the branches, of those with the same tangent space only the first, largest first."""
    kept: list[tuple[int, Matrix]] = []
    for dimension, basis in branches:
        same = (
            len(other) == len(basis) and np.linalg.svd(basis @ other.T, compute_uv=False)[-1] > 0.95
            for _, other in kept
        )
        if not any(same):
            kept.append((dimension, basis))
    return tuple(sorted((dimension for dimension, _ in kept), reverse=True))
