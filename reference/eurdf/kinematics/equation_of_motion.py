"""The terms of the equation of motion at a state, and its solution by elimination."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from eurdf.array import Indices, Matrix, Vector
from eurdf.errors import InconsistentMotion, UndeterminedMotion
from eurdf.kinematics.finite import finite
from eurdf.kinematics.loop import find_loops
from eurdf.kinematics.rank import numerical_rank, times
from eurdf.kinematics.residual import acceleration_drift, residual_and_jacobian
from eurdf.kinematics.tangent_space import TangentSpaces
from eurdf.kinematics.tolerances import MASSLESS
from eurdf.pinocchio.tree import Tree
from eurdf.pinocchio.tree_dynamics import TreeDynamics

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot


class Acceleration(NamedTuple):
    """An acceleration a (nv,), rad/s² and m/s², with the forces λ (nc,) of all constraints."""

    a: Vector
    lambdas: Vector


class _Driven(NamedTuple):
    """Free motions of g groups that are alike, each of n velocities and f free motions.

    Attributes:
        velocities: (g, n).
        motor: Motors (g, n) of the velocities; -1 for those without.
        motions: Bases (g, n, f), orthonormal in the units of the velocities, by how much the motors move.
        values: By how much (g, f): the singular values, 0 for a motion that no motor moves.
        right: Orthonormal velocities (g, n, f) of the motors that move them so.
    """

    velocities: Indices
    motor: Indices
    motions: Matrix
    values: Matrix
    right: Matrix


class EquationOfMotion:
    """The terms of the equation of motion at a configuration and velocity.

    Attributes:
        r: Residual (nc,).
        K: Its derivative (nc, nv).
        drift: K̇ v (nc,).
        P: Pseudoinverse of K (nv, nc): P b is the x with K x = b of least norm, Pᵀ f the λ with Kᵀ λ = f of least norm,
            in units of the characteristic length.
        unit: Unit (nv,) of each velocity: a characteristic length, or 1.
        bias: h (nv,).
    """

    def __init__(self, robot: Robot, q: Vector, v: Vector, dynamics: TreeDynamics) -> None:
        """Take a normalized q (nq,) and v (nv,), and the dynamics of the tree."""
        self.robot, self.q, self.v, self._dynamics = robot, q, v, dynamics
        self.r, self.K = residual_and_jacobian(robot, q)
        self.drift = acceleration_drift(robot, q, v)
        spaces = robot.cached(TangentSpaces)
        space = spaces.at(self.K)
        self.P, self.unit, self._space = space.inverse, spaces.scale, space
        self.bias = dynamics.inverse_dynamics(q, v, np.zeros(robot.tree.nv))
        finite("the equation of motion", self.r, self.drift, self.bias, self.P)

    @cached_property
    def N(self) -> Matrix:  # noqa: N802 - the field's own symbol
        """Basis (nv, f) of the free motions, K N = 0, in rad/s and m/s; orthonormal in the units of the velocities."""
        return self._space.free

    @cached_property
    def _driven(self) -> list[_Driven]:
        """The free motions by how the motors move them; the `numerical_rank` of all of them tells which are moved."""
        motor = np.full(len(self.unit), -1)
        motor[self.robot.actuation.idx_v] = range(len(self.robot.actuation.idx_v))
        found = []
        for velocities, (free,) in self._space.free_motions():
            own = motor[velocities]
            basis, values, right = np.linalg.svd((free * (own >= 0)[:, :, None]).swapaxes(1, 2), full_matrices=False)
            found.append(_Driven(velocities, own, free @ basis, values, right.swapaxes(1, 2)))
        every = np.concatenate([np.zeros(0), *(each.values.ravel() for each in found)])
        every[::-1].sort()
        rank = numerical_rank(every)
        if rank < len(every):
            least = every[rank - 1] if rank else np.inf
            for each in found:
                each.values[each.values < least] = 0.0
        return found

    @cached_property
    def uncontrolled(self) -> Matrix:
        """Basis (nv, k) of the free motions that no motor moves, orthonormal in the units of the velocities."""
        columns = []
        for velocities, _, motions, values, _ in self._driven:
            for group, column in zip(*np.nonzero(values == 0.0), strict=True):
                columns.append(np.zeros(len(self.unit)))
                columns[-1][velocities[group]] = motions[group, :, column]
        return np.array(columns).reshape(len(columns), len(self.unit)).T

    def torques(self, required: Vector, norm: Vector) -> Vector:
        """The u (nu,) with the required force (nv,) on the free motions that motors move, and the least |u / norm|."""
        u, required = np.zeros(len(norm)), self.unit * required
        are_independent = sum(np.count_nonzero(each.values) for each in self._driven) == len(norm)
        for velocities, motor, motions, values, right in self._driven:
            moved, is_motor = values[:, :, None] > 0.0, motor >= 0
            along = times(motions.swapaxes(1, 2), required[velocities])[:, :, None]
            if are_independent:  # no other u
                own = 1.0 / self.unit[velocities]
                found = right @ np.divide(along, values[:, :, None], out=np.zeros(along.shape), where=moved)
            else:
                own = np.zeros(motor.shape)
                own[is_motor] = norm[motor[is_motor]]
                effect = moved * (values[:, :, None] * right.swapaxes(1, 2)) * (own * self.unit[velocities])[:, None]
                found = np.linalg.pinv(effect) @ (moved * along)
            u[motor[is_motor]] = (own * found[:, :, 0])[is_motor]
        return u

    def differ(self, change: Vector, given: Vector, tolerance: float) -> bool:
        """Whether a change of a velocity or acceleration (nv,) exceeds tolerance · (1 + its largest entry)."""
        largest = np.abs(change / self.unit).max(initial=0.0)
        return bool(largest > tolerance * (1.0 + np.abs(given / self.unit).max(initial=0.0)))

    def mass(self, a: Vector) -> Vector:
        """M a, including the armature."""
        return self._dynamics.inverse_dynamics(self.q, self.v, a) - self.bias

    def mass_along(self, motions: Matrix) -> Matrix:
        """M times the columns (nv, n)."""
        return self._dynamics.mass_times(self.q, motions)

    def refuse_open(self, a: Vector, tolerance: float) -> None:
        """Raise `InconsistentMotion` if v or a would open the closures."""
        for order, opening, given in (
            ("velocity", self.K @ self.v, self.v),
            ("acceleration", self.K @ a + self.drift, a),
        ):
            change = self.P @ opening  # without the rounding errors of redundant rows
            if self.differ(change, given, tolerance):
                opening = self.K @ change
                least = 1e-3 * np.abs(opening).max()
                rows = zip(self.robot.constraints, per_constraint(self.robot, opening), strict=True)
                opened = {
                    constraint.name: tuple(own.tolist()) for constraint, own in rows if (np.abs(own) > least).any()
                }
                raise InconsistentMotion(order, opened)

    def eliminate(self, force: Vector, gains: Sequence[tuple[float, float]]) -> Acceleration:
        """Solve the equation in the free motions: a = P b + N z, with Nᵀ M N z = Nᵀ (τ - h - M P b).

        Args:
            force: τ (nv,).
            gains: Baumgarte gains of each constraint: kp, 1/s², and kd, 1/s.

        Raises:
            UndeterminedMotion: A joint without inertia can move.
        """
        kp, kd = np.array(gains).reshape(-1, 2).repeat([each.rows for each in self.robot.constraints], axis=0).T
        N, P = self.N, self.P
        a = P @ (-self.drift - kd * (self.K @ self.v) - kp * self.r)
        MN = self.mass_along(N)
        required = force - self.bias - self.mass(a)
        inertia, axes = np.linalg.eigh(N.T @ MN)
        massless = inertia <= MASSLESS * inertia.max(initial=0.0)
        if massless.any():
            motions = N @ axes[:, massless]
            raise UndeterminedMotion(tuple(by_joint(self.robot.tree, np.abs(motions).max(axis=1))))
        z = axes @ ((axes.T @ (N.T @ required)) / inertia)
        return Acceleration(a + N @ z, P.T @ (MN @ z - required))


def per_constraint(robot: Robot, lambdas: Vector) -> tuple[Vector, ...]:
    """The rows (nc,) of each constraint."""
    return tuple(lambdas[loop.rows] for loop in find_loops(robot))


def by_joint(tree: Tree, values: Vector) -> dict[str, tuple[float, ...]]:
    """The values (nv,) by joint name, for the joints that have a value above rounding."""
    least = 1e-6 * np.abs(values).max(initial=0.0)
    owned: dict[str, list[float]] = {}
    for name, value in zip(tree.velocity_names, values.tolist(), strict=True):
        owned.setdefault(name, []).append(value)
    return {name: tuple(own) for name, own in owned.items() if max(map(abs, own)) > least}
