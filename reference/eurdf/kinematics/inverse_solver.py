"""Motor torques of a closed mechanism whose constraints and motors are independent beyond doubt.

With the motors locked, K_o are the columns of K of the other velocities. If its rows are independent, the equation

    M a + h - τ = S u + Kᵀ λ

has one solution in the least-squares sense: the rows of the other velocities give λ, and those of the motors then u. It
is that of the slower way by a basis of the free motions, whether or not the motion is possible: the remainder lies in
the motions that no motor controls. Whether it is possible, forward dynamics decide: with these torques they return a.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from eurdf.array import Vector
from eurdf.kinematics.forward_solver import ForwardSolver
from eurdf.kinematics.independence import norm
from eurdf.kinematics.rank import certain_inverse
from eurdf.kinematics.tangent_space import TangentSpaces
from eurdf.kinematics.tolerances import CLOSED_FOR_FORCES
from eurdf.pinocchio.tree_dynamics import TreeDynamics

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot

# Bounds of the deviations up to this fraction of the tolerance are below it beyond doubt.
_CERTAIN = 0.5


class InverseSolver:
    """Solves the equation of motion of one robot for the motor torques, at one state after the other."""

    def __init__(self, robot: Robot) -> None:
        # No reference to the robot: the cache would keep it alive.
        nv, spaces = robot.tree.nv, robot.cached(TangentSpaces)
        self._scale, self._row_scale, self._dimensionless = spaces.scale, spaces.row_scale, spaces.dimensionless
        self._driven = robot.actuation.idx_v
        self._others = np.setdiff1d(np.arange(nv), self._driven)
        self._no_gains = [(0.0, 0.0)] * len(robot.constraints)
        # How many motions are left with the motors locked, if the rows of K_o are independent.
        self._uncontrolled = len(self._others) - len(self._row_scale)
        self._is_possible = self._uncontrolled >= 0 and len(self._others) + len(self._driven) == nv

    def solve(
        self,
        solver: ForwardSolver,
        q: Vector,
        v: Vector,
        a: Vector,
        force: Vector,
        tolerance: float,
        dynamics: TreeDynamics,
    ) -> tuple[Vector, Vector] | None:
        """Solve M a + h = S u + τ + Kᵀ λ for u (nu,) and λ (nc,); None if the rank of K_o, or the motion, is in doubt.

        The arguments are those of `inverse_dynamics`, with q (nq,) normalized and τ (nv,) in ``force``; ``solver``
        solves forward dynamics.
        """
        if not self._is_possible:
            return None
        closures = solver.closures_of_tree(q, dynamics)
        if closures is None:
            return None
        r, K = closures
        opening = K.dot(v)
        if not (norm(r) <= CLOSED_FOR_FORCES and norm(opening) <= CLOSED_FOR_FORCES * (1.0 + norm(v))):
            return None
        A = K * self._dimensionless
        locked = A[:, self._others]
        (inverse,), (certain,) = certain_inverse((locked @ locked.T)[None], np.array([norm(A.ravel())]))
        if not certain:
            return None
        taken = dynamics.inverse_dynamics(q, v, a)
        required = taken - force
        needed = self._scale * required
        others = needed[self._others]
        multipliers = inverse.dot(locked.dot(others))
        multipliers += inverse.dot(locked.dot(others - multipliers.dot(locked)))  # what rounding left
        lambdas = self._row_scale * multipliers
        u = required[self._driven] - lambdas.dot(K[:, self._driven])
        applied = np.array(force)
        applied[self._driven] += u
        forward = solver.beyond_doubt(q, v, applied, self._no_gains, dynamics)
        if forward is None:
            return None
        # The motion with the motors at rest that closes what v opens: the least one that does is no longer.
        opened = norm(inverse.dot(self._row_scale * opening).dot(locked))
        change = forward.a - a
        accepted = self._accepted(a, tolerance)
        if not (opened <= self._accepted(v, tolerance) and norm(change / self._scale) <= accepted):
            return None
        if self._uncontrolled and not self._uncontrolled_part(q, v, forward.a, change, taken, dynamics) <= accepted:
            return None
        return u, lambdas

    def _uncontrolled_part(
        self, q: Vector, v: Vector, a: Vector, change: Vector, before: Vector, dynamics: TreeDynamics
    ) -> float:
        """A bound of the part of a change of the acceleration along motions that no motor controls.

        That part is a projection in the metric of the mass matrix, so that its energy is at most that of the change.
        a (nv,) is the acceleration after the change, and ``before`` is M a + h (nv,) before it.
        """
        energy = change.dot(dynamics.inverse_dynamics(q, v, a) - before)
        lightest = (dynamics.inverse_mass_diagonal(q) / self._scale**2).max()
        return math.sqrt(abs(energy) * lightest)

    def _accepted(self, given: Vector, tolerance: float) -> float:
        """What a velocity or acceleration (nv,) may differ by beyond doubt."""
        return _CERTAIN * tolerance * (1.0 + float(np.abs(given / self._scale).max()))
