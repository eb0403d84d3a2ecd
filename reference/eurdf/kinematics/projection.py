"""Projections onto the closures: of a configuration, a velocity and an acceleration.

Source: `configurationProjection`, `velocityProjection` and `accelerationProjection` of the toolbox of Batto, De Matteïs
and Mansard, 2025.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from eurdf.kinematics.array import Matrix, Vector
from eurdf.kinematics.assembly import Assembler, start
from eurdf.kinematics.derived import derived
from eurdf.kinematics.exceptions import NotClosable
from eurdf.kinematics.finite import finite, overflow_refused
from eurdf.kinematics.metric import metric, nearest
from eurdf.kinematics.residual import acceleration_drift, residual, residual_and_jacobian
from eurdf.kinematics.tangent_space import TangentSpaces
from eurdf.pinocchio.arguments import checked_array, checked_tolerance

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot

_MOST_STEPS = 50
_MOST_HALVINGS = 20

# Step of the finite differences for second derivatives, which only guide the search.
_DIFFERENCE = 1e-6


@overflow_refused("the configuration")
def project_configuration(
    robot: Robot, q: Vector, weights: Vector | Matrix | None = None, *, tolerance: float = 1e-10
) -> Vector:
    """The closed configuration nearest to q.

    It minimises ½ xᵀ W x subject to r(q ⊕ x) = 0, where x = q' ⊖ q is the velocity (nv,) that leads from q to q' in
    unit time: W x is normal to the closed configurations. The loops are closed first; then Newton steps move q' along
    the closed configurations to a local minimum of the distance. If W is diagonal, joints outside the loops do not
    move.

    Args:
        robot: The robot.
        q: Any configuration (nq,).
        weights: The metric W: a matrix (nv, nv), or its diagonal (nv,). The default is the identity: the sum of squares
            of all motions, in rad and m.
        tolerance: Bound of each row of the residual for closed loops, m or rad.

    Returns:
        q' (nq,); q itself if it is closed. If rounding makes redundant rows contradict each other, it is closed as far
        as `assemble` can close it.

    Raises:
        NotClosable: No closed configuration was found; the error lists the closures that stay open.
        ValueError: ``q`` is not a configuration, or ``weights`` is not a metric.
    """
    tree, W, tolerance = robot.tree, metric(weights, robot.tree.nv), checked_tolerance(tolerance)
    q = start(robot, q, "q")
    if np.abs(residual(robot, q)).max(initial=0.0) <= tolerance:
        return q
    assembler, spaces = Assembler(robot, tolerance=tolerance), derived(robot, TangentSpaces)
    assembly = assembler.assemble(q)
    if not assembly.closes:
        raise NotClosable("no closed configuration was found near the given one", assembly.open, assembly.q)

    def away(at: Vector) -> Vector:
        return tree.difference(q, at)

    def gradient(at: Vector) -> Vector:
        return np.asarray(tree.difference_derivative(q, at).T @ (W @ away(at)))

    here = assembly.q
    cost = 0.5 * float(away(here) @ W @ away(here))
    for _ in range(_MOST_STEPS):
        _, K = residual_and_jacobian(robot, here)
        space, g = spaces.at(K), gradient(here)
        Z, multipliers = space.basis, space.inverse.T @ g
        slope = Z.T @ g
        normal = g - K.T @ multipliers
        columns = []
        for direction in Z.T:
            beside = tree.integrate(here, _DIFFERENCE * direction)
            _, K_beside = residual_and_jacobian(robot, beside)
            columns.append((gradient(beside) - K_beside.T @ multipliers - normal) / _DIFFERENCE)
        H = Z.T @ np.column_stack(columns) if columns else np.zeros((0, 0))
        step = _downhill(H, slope)
        gain = -float(slope @ step)
        if not gain > 1e-14 * cost:
            break
        for halving in range(_MOST_HALVINGS):
            part = 0.5**halving
            trial = assembler.assemble(tree.integrate(here, part * (Z @ step)), restarts=0)
            reached = 0.5 * float(away(trial.q) @ W @ away(trial.q))
            if trial.closes and reached <= cost - 1e-4 * part * gain + 1e-14 * cost:
                break
        else:
            break
        here, cost = trial.q, reached
    return here


@overflow_refused("the velocity")
def project_velocity(robot: Robot, q: Vector, v: Vector, weights: Vector | Matrix | None = None) -> Vector:
    """The velocity nearest to v that keeps the loops closed.

    The orthogonal projection onto ker K(q): v' = Z (Zᵀ W Z)⁻¹ Zᵀ W v with K Z = 0, which minimises (v' - v)ᵀ W (v' - v)
    subject to K v' = 0. With the mass matrix as W it is the velocity after an impulse that closes the closures.

    Args:
        robot: The robot.
        q: Configuration (nq,), closed or open. At a singular q, motions that are free to first order count as free.
        v: Velocity (nv,), rad/s or m/s.
        weights: The metric W: a matrix (nv, nv), or its diagonal (nv,); the identity by default.

    Returns:
        v' (nv,).

    Raises:
        ValueError: ``q`` or ``v`` has another shape or is not finite, or ``weights`` is not a metric.
    """
    W = metric(weights, robot.tree.nv)
    v = checked_array("v", v, (robot.tree.nv,))
    _, K = residual_and_jacobian(robot, start(robot, q, "q"))
    projected = nearest(derived(robot, TangentSpaces).at(K).basis, W, v)
    finite("the velocity", projected)
    return projected


@overflow_refused("the acceleration")
def project_acceleration(
    robot: Robot, q: Vector, v: Vector, a: Vector, weights: Vector | Matrix | None = None
) -> Vector:
    """The acceleration nearest to a that keeps the loops closed.

    It minimises (a' - a)ᵀ W (a' - a) subject to K(q) a' + K̇ v = 0, with K̇ v from `acceleration_drift`.

    Args:
        robot: The robot.
        q: Configuration (nq,).
        v: Velocity (nv,), rad/s or m/s. It should keep the loops closed, K v = 0. If it does not, redundant rows can
            contradict each other; they are then satisfied in the least-squares sense, in units of the characteristic
            length.
        a: Acceleration (nv,), rad/s² or m/s².
        weights: The metric W: a matrix (nv, nv), such as the mass matrix (Gauss' principle of least constraint), or
            its diagonal (nv,); the identity by default.

    Returns:
        a' (nv,).

    Raises:
        ValueError: ``q``, ``v`` or ``a`` has another shape or is not finite, or ``weights`` is not a metric.
    """
    W = metric(weights, robot.tree.nv)
    v, a, q = checked_array("v", v, (robot.tree.nv,)), checked_array("a", a, (robot.tree.nv,)), start(robot, q, "q")
    _, K = residual_and_jacobian(robot, q)
    space = derived(robot, TangentSpaces).at(K)
    forced = -space.inverse @ acceleration_drift(robot, q, v)
    projected = forced + nearest(space.basis, W, a - forced)
    finite("the acceleration", projected)
    return projected


def _downhill(H: Matrix, slope: Vector) -> Vector:
    """The Newton step -H⁻¹ slope, with H made positive definite if it is not."""
    values, vectors = np.linalg.eigh(0.5 * (H + H.T))
    values = np.abs(values)
    values = np.maximum(values, max(1e-3 * values.max(initial=0.0), 1e-300))
    return -np.asarray(vectors @ ((vectors.T @ slope) / values), dtype=np.float64)
