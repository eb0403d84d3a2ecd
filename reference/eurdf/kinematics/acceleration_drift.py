"""K̇ v: what accelerates the residual of the closures while every joint keeps its velocity."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import pinocchio as pin

from eurdf.kinematics.array import Vector
from eurdf.kinematics.loop import find_loops

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot

# Terms of the series of the derivative of exp6: the last is below 1e-17 for rotations of up to half a turn.
_TERMS = 32


def acceleration_drift(robot: Robot, q: Vector, v: Vector, data: Any = None) -> Vector:
    """The drift d = K̇ v of the closures, exact at every configuration, closed or not.

    It is d²/dt² r(q ⊕ t v) at t = 0, so that r̈ = K a + d. With V_A, V_B the twists and A_A, A_B the spatial
    accelerations of the frames A and B, each in its own axes, without joint accelerations, and M = ᴬM_B:

    - 3d: d = R a_B - a_A - ω̇_A × p - ω_A × (ω_A × p) - 2 ω_A × ṗ, where p is the origin of B in A, R the rotation of M,
      ω̇_A the angular part of A_A, and a = A_linear + ω × V_linear the classical acceleration of an origin.
    - 6d: ξ = V_B - Ad(M⁻¹) V_A is the twist of B in A, and ξ̇ = A_B - Ad(M⁻¹) A_A + ξ × Ad(M⁻¹) V_A. From
      ξ = J(r) ṙ, J the right Jacobian of exp6, follows d = J⁻¹ (ξ̇ - J̇ ṙ), where J̇ vanishes at a closed closure.

    Source: the residuals of EU-CLO-008 and EU-CLO-009, differentiated twice.

    Args:
        robot: The robot.
        q: Configuration (nq,).
        v: Velocity (nv,), rad/s or m/s.
        data: A `pin.Data` of the model to compute in; without one, one is made.

    Returns:
        d (nc,), m/s² and rad/s², in the rows of the residual.
    """
    model = robot.model
    data = model.createData() if data is None else data
    pin.forwardKinematics(model, data, q, v, np.zeros(model.nv))
    loops = find_loops(robot)
    drift = np.empty(loops[-1].rows.stop if loops else 0)
    for loop, constraint in zip(loops, robot.constraint_models, strict=True):
        oMa, twist_a, acceleration_a = _motion(data, constraint.joint1_id, constraint.joint1_placement)
        oMb, twist_b, acceleration_b = _motion(data, constraint.joint2_id, constraint.joint2_placement)
        aMb = oMa.actInv(oMb)
        if loop.spatial:
            carried = aMb.actInv(twist_a)
            twist = twist_b - carried
            acceleration = acceleration_b - aMb.actInv(acceleration_a) + twist.cross(carried)
            to_log = pin.Jlog6(aMb)
            bend = _bend(pin.log6(aMb), pin.Motion(to_log @ twist.vector))
            drift[loop.rows] = to_log @ (acceleration.vector - bend)
        else:
            p, omega = aMb.translation, twist_a.angular
            turning = np.cross(omega, p)
            velocity = aMb.rotation @ twist_b.linear - twist_a.linear - turning
            drift[loop.rows] = (
                aMb.rotation @ _classical(twist_b, acceleration_b)
                - _classical(twist_a, acceleration_a)
                - np.cross(acceleration_a.angular, p)
                - np.cross(omega, turning)
                - 2.0 * np.cross(omega, velocity)
            )
    return drift


def _motion(data: Any, joint: int, placement: Any) -> tuple[Any, Any, Any]:
    """Placement in the world of a frame of a joint, and its twist and spatial acceleration in its own axes."""
    return data.oMi[joint] * placement, placement.actInv(data.v[joint]), placement.actInv(data.a[joint])


def _classical(twist: Any, acceleration: Any) -> Vector:
    return np.asarray(acceleration.linear + np.cross(twist.angular, twist.linear), dtype=np.float64)


def _bend(r: Any, rate: Any) -> Vector:
    """J̇ ṙ (6,), with J(r) = Σ (-ad r)ⁿ / (n + 1)!, term by term: each is (-ad r) of the one before, over n + 1."""
    term, derivative, total = rate, pin.Motion.Zero(), np.zeros(6)
    for n in range(1, _TERMS + 1):
        derivative = -(rate.cross(term) + r.cross(derivative)) * (1.0 / (n + 1))
        term = -r.cross(term) * (1.0 / (n + 1))
        total += derivative.vector
        if max(np.abs(term.vector).max(), np.abs(derivative.vector).max()) < 1e-17:  # soon, where it is closed
            break
    return total
