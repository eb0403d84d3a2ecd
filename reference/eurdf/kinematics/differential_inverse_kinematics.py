"""Velocities of the closed mechanism for a desired twist of a frame."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from pinocchio import LOCAL

from eurdf.kinematics.array import Matrix, Vector
from eurdf.kinematics.assembly import start
from eurdf.kinematics.derived import derived
from eurdf.kinematics.finite import finite, overflow_refused
from eurdf.kinematics.frame_jacobian import frame_jacobian
from eurdf.kinematics.rank import numerical_rank
from eurdf.kinematics.residual import residual_and_jacobian
from eurdf.kinematics.tangent_space import TangentSpaces
from eurdf.pinocchio.arguments import checked_array

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot


class FrameVelocity(NamedTuple):
    """The result of `differential_inverse_kinematics`.

    Attributes:
        v: Velocity (nv,), rad/s and m/s, with K v = 0.
        actuated: Velocities (nu,) of the actuators, Sᵀ v, in the order of ``robot.actuation``.
        twist: Resulting twist (6,) of the frame, linear (m/s), then angular (rad/s), in the axes of ``reference``.
        rank: Number of independent motions of the frame that are used, at most 6.
    """

    v: Vector
    actuated: Vector
    twist: Vector
    rank: int


@overflow_refused("the velocity")
def differential_inverse_kinematics(
    robot: Robot,
    q: Vector,
    frame: str,
    twist: ArrayLike,
    reference: Any = LOCAL,
    *,
    singular: float = 1e-3,
) -> FrameVelocity:
    """The velocity of the closed mechanism for a desired twist of a frame.

    Let C (nv, r) be a basis of the motions that the actuators control, K C = 0, in which uncontrolled motions are
    minimal, and J the Jacobian of the frame. The result is v = C (J C)⁺ twist: of all velocities that bring the twist
    nearest to the desired one, the one with the slowest actuators. Lengths are in characteristic lengths. In the
    pseudoinverse, singular values of J C below the fraction ``singular`` of the largest one count as zero, so motions
    that need much faster actuators are left out, and velocities stay bounded near a singular configuration:
    |v_a| ≤ |twist| / (``singular`` σ₁).

    Source: `inverseConstraintKinematicsSpeed` of the toolbox of Batto, De Matteïs and Mansard, 2025, which does not
    truncate singular values.

    Args:
        robot: The robot. Its actuators may depend on one another.
        q: A closed configuration (nq,).
        frame: Name of a link, a joint (its frame on the child side), or a frame of the description.
        twist: Desired twist (6,) of the frame relative to the world: linear (m/s), then angular (rad/s).
        reference: The axes of the twist: ``pin.LOCAL``, ``pin.WORLD`` or ``pin.LOCAL_WORLD_ALIGNED``.
        singular: Fraction of the largest singular value below which a singular value counts as zero, between 0 and 1.

    Returns:
        The velocity and the resulting twist. If that differs from the desired one, the frame cannot move so, or only
        with much faster actuators.

    Raises:
        ValueError: The frame is unknown or ambiguous; ``q`` is not a configuration; ``twist`` is not six finite
            numbers; ``singular`` is not between 0 and 1.
    """
    wanted = checked_array("twist", twist, (6,))
    if not 0.0 < singular < 1.0:
        raise ValueError(f"singular is {singular!r}; give a number between 0 and 1")
    q = start(robot, q, "q")
    spaces = derived(robot, TangentSpaces)
    C = _actuated_motions(robot, q, spaces)
    J = frame_jacobian(robot, q, frame, reference)
    scale = np.array((1.0 / spaces.length,) * 3 + (1.0,) * 3)
    left, values, right = np.linalg.svd(scale[:, None] * (J @ C), full_matrices=False)
    rank = int(np.count_nonzero(values > singular * values.max(initial=0.0)))
    v = C @ (right[:rank].T @ ((left[:, :rank].T @ (scale * wanted)) / values[:rank]))
    finite("the velocity", v, J @ v)
    return FrameVelocity(v, v[robot.actuation.idx_v], J @ v, rank)


def _actuated_motions(robot: Robot, q: Vector, spaces: TangentSpaces) -> Matrix:
    """C (nv, r): motions that keep the loops closed and that the actuators control; Sᵀ C is orthonormal."""
    _, K = residual_and_jacobian(robot, q)
    free, _ = np.linalg.qr(spaces.at(K).basis / spaces.scale[:, None])
    _, values, right = np.linalg.svd(free[robot.actuation.idx_v], full_matrices=False)
    rank = numerical_rank(values, 1.0)
    return np.asarray(spaces.scale[:, None] * free @ (right[:rank].T / values[:rank]))
