"""The residual of the constraints, r(q), and its derivative, the constraint Jacobian K(q).

A 6d closure has the six rows log6(ᴬM_B), (linear, angular) (EU-CLO-008), and a 3d closure has the three of the origin
of B in A (EU-CLO-009); `eurdf.closures` has the rows of every kind. K is the exact derivative,
K v = d/dt r(q ⊕ t v) at t = 0 (EU-CLO-010), at every configuration, closed or not.
"""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING

import numpy as np

from eurdf.array import Matrix, Vector
from eurdf.kinematics.evaluate import Evaluator, State, evaluator
from eurdf.kinematics.finite import finite
from eurdf.kinematics.named import Named, configuration_of, velocity_of
from eurdf.kinematics.opening import Opening
from eurdf.pinocchio.memory import working_memory

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot


def residual(robot: Robot, q: Named) -> Vector:
    """Residual of all constraints, stacked in their order.

    Args:
        robot: The robot.
        q: Configuration (nq,).

    Returns:
        r (nc,): m and rad.

    Raises:
        ValueError: ``q`` has another shape or is not finite.
        NumericalOverflow: Coordinates or lengths are so large that the residual is not finite.
    """
    q = configuration_of(robot, q)
    with working_memory(robot, all_constraints) as constraints:
        r = np.array(constraints.residual(constraints.at(q[None]))[0])
    finite("the residual", r)
    return r


def residual_and_jacobian(robot: Robot, q: Named) -> tuple[Vector, Matrix]:
    """Residual of all constraints and its derivative (EU-CLO-010).

    Args:
        robot: The robot.
        q: Configuration (nq,).

    Returns:
        r (nc,), and K (nc, nv), in m and rad over the units of v.

    Raises:
        ValueError: As in `residual`.
        NumericalOverflow: As in `residual`, also of the derivative.
    """
    q = configuration_of(robot, q)
    with working_memory(robot, all_constraints) as constraints:
        at = constraints.at(q[None])
        r, K = np.array(constraints.residual(at)[0]), constraints.jacobian(at)[0]
    finite("the residual and its derivative", r, K)
    return r, K


def constraint_acceleration(robot: Robot, q: Named, v: Named) -> Vector:
    """The k of K a = k: the accelerations a of the joints with K a = k keep the constraints met, where K v = 0.

    k = -K̇ v is what the third equation of the paper (Batto, De Matteïs, Mansard, 2025) has on its right. It is exact
    at every configuration, closed or not, and for any v: r̈ = K a - k. The drift of dynamics, r̈ at a = 0, is -k.

    Args:
        robot: The robot.
        q: Configuration (nq,).
        v: Velocity (nv,), rad/s and m/s.

    Returns:
        k (nc,), m/s² and rad/s², in the rows of the residual.

    Raises:
        ValueError: As in `residual`, also for ``v``.
        NumericalOverflow: The result is not finite.
    """
    k = -acceleration_drift(robot, q, v)
    finite("the acceleration of the constraints", k)
    return k


def acceleration_drift(robot: Robot, q: Named, v: Named) -> Vector:
    """The drift d = K̇ v of the constraints, exact at every configuration, closed or not.

    It is d²/dt² r(q ⊕ t v) at t = 0, so that r̈ = K a + d.

    Args:
        robot: The robot.
        q: Configuration (nq,).
        v: Velocity (nv,), rad/s or m/s.

    Returns:
        d (nc,), m/s² and rad/s², in the rows of the residual.

    Raises:
        ValueError: As in `residual`, also for ``v``.
    """
    q, v = configuration_of(robot, q), velocity_of(robot, v)
    with working_memory(robot, all_constraints) as constraints:
        return np.asarray(constraints.drift(q[None], v[None])[0])


def drift_of_pairs(robot: Robot, q: Vector, V: Matrix) -> Matrix:
    """The symmetric D (nc, k, k) with K̇ v = Σ D_ij w_i w_j for the velocities v = V w, with V (nv, k)."""
    count, pairs = V.shape[1], list(itertools.combinations(range(V.shape[1]), 2))
    moves = np.array([*V.T, *(V[:, i] + V[:, j] for i, j in pairs)]).reshape(-1, len(V))
    with working_memory(robot, all_constraints) as constraints:
        drift = constraints.drift(np.repeat(q[None], len(moves), axis=0), moves)
    D = np.zeros((robot.mechanism.nc, count, count))
    for i in range(count):
        D[:, i, i] = drift[i]
    for (i, j), both in zip(pairs, drift[count:], strict=True):
        D[:, i, j] = D[:, j, i] = 0.5 * (both - drift[i] - drift[j])
    return D


def closure_openings(robot: Robot, q: Named) -> tuple[Opening, ...]:
    """How far each constraint is open, in their order.

    Args:
        robot: The robot.
        q: Configuration (nq,).

    Raises:
        ValueError: As in `residual`.
        NumericalOverflow: As in `residual`.
    """
    found = all_openings(robot, q)
    finite("the opening of a closure", np.array([(each.position, each.angle) for each in found]))
    return found


def all_openings(robot: Robot, q: Named) -> tuple[Opening, ...]:
    """As `closure_openings`, also where they are not finite: such a constraint is open."""
    q = configuration_of(robot, q)
    with working_memory(robot, all_constraints) as constraints:
        return _named(robot, constraints, constraints.at(q[None]))


def openings_once(robot: Robot, q: Vector) -> tuple[Opening, ...]:
    """As `all_openings`, sooner if nothing else is evaluated of the robot."""
    constraints = all_constraints(robot)
    return _named(robot, constraints, constraints.at_once(q[None]))


def _named(robot: Robot, constraints: Evaluator, at: State) -> tuple[Opening, ...]:
    (lengths,), (angles,) = constraints.openings(at)
    found = zip(robot.constraints, lengths.tolist(), angles.tolist(), strict=True)
    return tuple(Opening(of.name, length, angle) for of, length, angle in found)


def all_constraints(robot: Robot) -> Evaluator:
    """An evaluator of all constraints, for few configurations."""
    return evaluator(robot, few=True)
