"""The terms of the equation of motion at a state, and its solution by elimination."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from eurdf.array import Matrix, Vector
from eurdf.errors import InconsistentMotion, UndeterminedMotion
from eurdf.kinematics.finite import finite
from eurdf.kinematics.loop import find_loops
from eurdf.kinematics.rank import numerical_rank
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
    def free(self) -> Matrix:
        """Basis (nv, f) of the free motions, orthonormal in the units of the velocities."""
        return np.asarray(self.N / self.unit[:, None])

    @cached_property
    def N(self) -> Matrix:  # noqa: N802 - the field's own symbol
        """The same in rad/s and m/s: K N = 0."""
        return self._space.free

    @cached_property
    def by_motors(self) -> tuple[Matrix, Matrix]:
        """Orthonormal bases, (f, k) and (f, f - k), of the controlled and of the uncontrolled free motions.

        The rank k is the `numerical_rank`. With the second, Z, no motor moves along N Z.
        """
        S = self.robot.actuation.selection
        if not S.shape[1]:
            return np.zeros((self.N.shape[1], 0)), np.eye(self.N.shape[1])
        basis, values, _ = np.linalg.svd(self.free.T @ S)
        rank = numerical_rank(values)
        return basis[:, :rank], basis[:, rank:]

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
