"""Velocities of the closed mechanism that give a frame a twist."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike

from eurdf.kinematics.array import Matrix, Vector
from eurdf.kinematics.assembly import start
from eurdf.kinematics.frame_index import frame_index
from eurdf.kinematics.rank import numerical_rank
from eurdf.kinematics.residual import residual_and_jacobian
from eurdf.kinematics.tangent_space import TangentSpaces

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot


class FrameVelocity(NamedTuple):
    """The velocity of a robot whose frame moves as asked, or as near to it as it can.

    Attributes:
        v: Velocity (nv,), rad/s and m/s, with K v = 0.
        actuated: Velocities (nu,) of the actuators, Sᵀ v, in the order of ``robot.actuation``.
        twist: Twist (6,) that the frame gets, linear (m/s), then angular (rad/s), in the axes asked for.
        rank: Number of independent motions of the frame that are used, 6 at most.
    """

    v: Vector
    actuated: Vector
    twist: Vector
    rank: int


def differential_inverse_kinematics(
    robot: Robot,
    q: Vector,
    frame: str,
    twist: ArrayLike,
    reference: Any = pin.LOCAL,
    *,
    singular: float = 1e-3,
) -> FrameVelocity:
    """The velocity of the closed mechanism that gives a frame a twist.

    With C (nv, r) a basis of the motions that the actuators decide, K C = 0, in which the motions that no actuator
    decides are as small as can be, and J the Jacobian of the frame, it is v = C (J C)⁺ twist: of all velocities that
    bring the twist nearest to the one asked for, the one whose actuators are the slowest. Lengths are counted in
    characteristic lengths. In the pseudoinverse, singular values of J C below a part ``singular`` of the largest count
    as zero: motions that would take so much faster actuators are left out, and so velocities stay bounded near a
    singular configuration, |v_a| ≤ |twist| / (``singular`` σ₁).

    Source: `inverseConstraintKinematicsSpeed` of the toolbox of Batto, De Matteïs and Mansard, 2025, there without a
    decision on the rank.

    Args:
        robot: The robot. Its actuators may depend on one another.
        q: A closed configuration (nq,).
        frame: Name of a link, a joint (its frame on the child's side), or a frame of the description.
        twist: Twist (6,) of the frame against the world: linear (m/s), then angular (rad/s).
        reference: In which axes: ``pin.LOCAL``, ``pin.WORLD`` or ``pin.LOCAL_WORLD_ALIGNED``.
        singular: Part of the largest singular value below which one counts as zero, above 0 and below 1.

    Returns:
        The velocity, and the twist that it gives. Where that is not the one asked for, the frame cannot move so, or
        could only with much faster actuators.

    Raises:
        ValueError: There is no such frame, or its name is that of two; ``q`` is no configuration; ``twist`` is not six
            finite numbers; ``singular`` is not between 0 and 1.
    """
    wanted = np.asarray(twist, dtype=np.float64)
    if wanted.shape != (6,) or not np.isfinite(wanted).all():
        raise ValueError(f"a twist is six finite numbers, linear (m/s), then angular (rad/s), not {twist!r}")
    if not 0.0 < singular < 1.0:
        raise ValueError(f"singular is {singular!r}; it must be between 0 and 1")
    model, index = robot.model, frame_index(robot.model, frame)
    q = start(robot, q)
    spaces = TangentSpaces(robot)
    C = _actuated_motions(robot, q, spaces)
    J = pin.computeFrameJacobian(model, model.createData(), q, index, reference).reshape(6, -1)
    scale = np.array((1.0 / spaces.length,) * 3 + (1.0,) * 3)
    left, values, right = np.linalg.svd(scale[:, None] * (J @ C), full_matrices=False)
    rank = int(np.count_nonzero(values > singular * values.max(initial=0.0)))
    v = C @ (right[:rank].T @ ((left[:, :rank].T @ (scale * wanted)) / values[:rank]))
    return FrameVelocity(v, v[robot.actuation.idx_v], J @ v, rank)


def _actuated_motions(robot: Robot, q: Vector, spaces: TangentSpaces) -> Matrix:
    """C (nv, r): motions that keep the loops closed and that the actuators decide; Sᵀ C is orthonormal."""
    _, K = residual_and_jacobian(robot, q)
    free, _ = np.linalg.qr(spaces.at(K).basis / spaces.scale[:, None])
    _, values, right = np.linalg.svd(free[robot.actuation.idx_v], full_matrices=False)
    rank = numerical_rank(values, 1.0)
    return np.asarray(spaces.scale[:, None] * free @ (right[:rank].T / values[:rank]))
