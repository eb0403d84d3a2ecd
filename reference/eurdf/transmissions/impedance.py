"""Stiffness and damping of joints as those of motors, and back."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from typing import TYPE_CHECKING, Literal

import numpy as np

from eurdf.array import Matrix, Vector, numbers
from eurdf.kinematics.closing import start
from eurdf.kinematics.named import Named, vector_of
from eurdf.loading import of_any_robot
from eurdf.pinocchio.arguments import checked_array
from eurdf.transmissions.motors import sides
from eurdf.transmissions.transmission import at_one, require

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot

Side = Literal["joints", "motors"]


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Impedance:
    """Gains of joints and the equal gains of motors, as `impedance_map` returns them.

    Stiffness is in N·m/rad, N or N/m, damping in N·m·s/rad, N·s or N·s/m. Matrices of joints are (nJ, nJ), those of
    motors (nm, nm); they can be full and need not be definite.

    Attributes:
        joints: Names of the joints, nJ.
        motors: Names of the motors, nm.
        joint_stiffness: K_J = -∂τ_J/∂q_J.
        joint_damping: C_J.
        motor_stiffness: K_m = -∂τ_m/∂q_m.
        motor_damping: C_m.
        motor_torque: τ_m (nm,), the motor torques at the configuration, N·m or N.
        geometric_stiffness: -Σ τ_mi ∂²q_mi/∂q_J² (nJ, nJ), the part of K_J due to the motor torques.
        drive_stiffness: The gains k ≥ 0 (nm,) of independent drives whose joint stiffness is nearest to K_J.
        drive_damping: The same (nm,) of the damping.
        joint_stiffness_of_drives: Gᵀ diag(k) G plus the geometric stiffness: what the drives make of K_J.
        joint_damping_of_drives: What they make of C_J.
    """

    joints: tuple[str, ...]
    motors: tuple[str, ...]
    joint_stiffness: Matrix
    joint_damping: Matrix
    motor_stiffness: Matrix
    motor_damping: Matrix
    motor_torque: Vector
    geometric_stiffness: Matrix
    drive_stiffness: Vector
    drive_damping: Vector
    joint_stiffness_of_drives: Matrix
    joint_damping_of_drives: Matrix

    def __repr__(self) -> str:
        joints, motors = (numbers(np.diagonal(each)) for each in (self.joint_stiffness, self.motor_stiffness))
        return (
            f"<Impedance: stiffness of {', '.join(self.joints)} {joints}, of {', '.join(self.motors)} {motors}, "
            "N·m/rad or N/m>"
        )


@of_any_robot
def impedance_map(
    robot: Robot,
    joints: str | Iterable[str],
    q: Named | None,
    stiffness: Named | Matrix,
    *,
    damping: Named | Matrix | None = None,
    tau: Named | None = None,
    side: Side = "joints",
    motors: str | Iterable[str] | None = None,
) -> Impedance:
    """Gains at the joints as gains at the motors, and back.

    With τ_J = Gᵀ τ_m and the motors at τ_m - K_m Δq_m - C_m v_m, the joints have the stiffness
    K_J = Gᵀ K_m G - Σ τ_mi H_i, H_i = ∂²q_mi/∂q_J², and the damping C_J = Gᵀ C_m G. The other way,
    K_m = B_Jᵀ (K_J + Σ τ_mi H_i) B_J and C_m = B_Jᵀ C_J B_J.

    A drive that controls one motor has one gain, so that only a diagonal K_m can be set. The result has the nearest
    such gains, and what they make of the joints. Nearest is the least Σ (ΔK_ij)² / (K_ii K_jj) (with 1 in place of a
    K_ii that is not positive).

    Args:
        robot: The robot.
        joints: As in `transmission`.
        q: A closed configuration (nq,); None for the `assembled` configuration, or the neutral one if there is none.
        stiffness: The given stiffness: its diagonal (n,), also by name, or a symmetric matrix (n, n).
        damping: The given damping, likewise; zero by default.
        tau: The torques (n,) at the configuration, N·m or N; zero by default. At the joints, the motors balance them.
        side: Whether stiffness, damping and ``tau`` are those of the joints or those of the motors.
        motors: As in `transmission`.

    Raises:
        NoTransmission: G or B_J does not exist, or the joints depend on each other.
        NotClosable: The loops are open at q.
        ValueError: An argument is wrong, as in `transmission`, or a matrix is not symmetric.
    """
    if side not in ("joints", "motors"):
        raise ValueError(f"side is {side!r}; use 'joints' or 'motors'")
    chosen, by = sides(robot, joints, motors)
    at = at_one(robot, chosen, start(robot, q, "q"), by)
    names = at.joints if side == "joints" else at.motors
    K, C = _symmetric("stiffness", stiffness, names), _symmetric("damping", {} if damping is None else damping, names)
    torque = vector_of({} if tau is None else tau, names, "tau")
    G, B = require(at, "G", "B_J")
    tau_m = at.motor_torque(torque) if side == "joints" else torque
    geometric = -np.tensordot(tau_m, at.hessian, axes=1)
    if side == "joints":
        K_J, C_J = K, C
        K_m, C_m = B.T @ (K - geometric) @ B, B.T @ C @ B
    else:
        K_m, C_m = K, C
        K_J, C_J = G.T @ K @ G + geometric, G.T @ C @ G
    stiff, damped = _nearest_drives(G, K_J - geometric, K_J), _nearest_drives(G, C_J, C_J)
    made = (G.T * stiff) @ G + geometric, (G.T * damped) @ G
    return Impedance(at.joints, at.motors, K_J, C_J, K_m, C_m, tau_m, geometric, stiff, damped, *made)


def _symmetric(name: str, given: Named | Matrix, names: Sequence[str]) -> Matrix:
    n = len(names)
    values = checked_array(name, vector_of(given, names, name) if isinstance(given, Mapping) else given, (n,), (n, n))
    matrix = np.diag(values) if values.ndim == 1 else values
    if np.abs(matrix - matrix.T).max(initial=0.0) > 1e-9 * np.abs(matrix).max(initial=0.0):
        raise ValueError(f"{name} is not a symmetric matrix")
    return matrix


def _nearest_drives(G: Matrix, wanted: Matrix, weights: Matrix) -> Vector:
    """The k ≥ 0 (nm,) with the least Σ (Gᵀ diag(k) G - wanted)²_ij / (weights_ii weights_jj)."""
    size = np.diagonal(weights)
    scale = 1.0 / np.sqrt(np.where(size > 0.0, size, 1.0))
    columns = np.array([np.outer(row * scale, row * scale).ravel() for row in G]).T
    b = (scale[:, None] * wanted * scale).ravel()
    best, least = np.zeros(len(G)), float(b @ b)
    for used in product((False, True), repeat=len(G)):
        if any(used):
            k = np.zeros(len(G))
            k[list(used)] = np.linalg.lstsq(columns[:, used], b, rcond=None)[0]
            missed = columns @ k - b
            if (k >= 0.0).all() and missed @ missed < least:
                best, least = k, float(missed @ missed)
    return best
