"""Second derivatives of the closed configurations by the coordinates of joints."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from eurdf.kinematics.array import Indices, Matrix, Vector
from eurdf.kinematics.derived import derived
from eurdf.kinematics.residual import acceleration_drift, residual_and_jacobian
from eurdf.kinematics.tangent_space import TangentSpaces

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot

# A singular value below this fraction of the largest one belongs to a redundant row.
_REDUNDANT = 1e-9


def second_derivative(robot: Robot, q: Vector, Z: Matrix, joints: Indices, motors: Indices, held: Indices) -> Matrix:
    """∂²q_m/∂q_J² at a closed configuration.

    While the joints move at constant velocity w, the motors have the acceleration wᵀ H_i w. It is a_m of the a with
    K a + K̇ v = 0, in which the joints and the held ones do not accelerate, for the velocity v that w leads to.

    Args:
        robot: The robot.
        q: The configuration (nq,).
        Z: Basis (nv, m) of the motions that keep the loops closed and the held joints still.
        joints: Indices (nJ,) in v of independent joints.
        motors: Indices (nm,) in v of motors that they determine.
        held: Indices in v of held joints.

    Returns:
        H (nm, nJ, nJ), symmetric in the last two.
    """
    N = Z @ np.linalg.pinv(Z[joints])
    _, K = residual_and_jacobian(robot, q)
    space = derived(robot, TangentSpaces).at(K)
    still = np.concatenate((joints, held))
    back = space.free @ np.linalg.pinv(space.free[still], rcond=_REDUNDANT)

    def acceleration(w: Vector) -> Vector:
        a = -(space.inverse @ acceleration_drift(robot, q, N @ w))
        return np.asarray(a[motors] - back[motors] @ a[still])

    n = len(joints)
    own = [acceleration(w) for w in np.eye(n)]
    H = np.zeros((len(motors), n, n))
    for i in range(n):
        H[:, i, i] = own[i]
        for j in range(i):  # it is quadratic in the velocity
            both = np.zeros(n)
            both[[i, j]] = 1.0
            H[:, i, j] = H[:, j, i] = 0.5 * (acceleration(both) - own[i] - own[j])
    return H
