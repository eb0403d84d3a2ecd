"""The transmission between motors and joints at closed configurations: velocities and torques both ways."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Literal

import numpy as np

from eurdf.array import Indices, Mask, Matrix, Vector
from eurdf.errors import DependentVelocities, NoTransmission
from eurdf.kinematics.blocks import blocks, checked_configurations, shape_of
from eurdf.kinematics.closing import start
from eurdf.kinematics.finite import overflow_refused
from eurdf.kinematics.named import Named, vector_of
from eurdf.kinematics.problem import for_many
from eurdf.loading import of_any_robot
from eurdf.transmissions.maps import Maps, MapsTask, maps, maps_at, pseudoinverse, reasons, second_derivative
from eurdf.transmissions.motors import sides, springs_of
from eurdf.transmissions.selection import Selection

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot

# Largest part of a velocity, relative to it, that dependent joints or motors may miss.
_MISSED = 1e-9

#: Why a map does not exist: the loops are open; springs that hold their joints block motors; the joints are fewer than
#: what the motors decide; the motors are fewer than what the joints decide; the pose is singular.
Reason = Literal["loops open", "springs block", "more motions", "singular"]


@dataclass(frozen=True, eq=False, repr=False)
class Transmission:
    """The transmission between motors and joints at one closed configuration, as `transmission` returns it.

    v_m = G v_J and τ_J = Gᵀ τ_m; v_J = B_J v_m and τ_m = B_Jᵀ τ_J. Velocities are in rad/s or m/s, torques and forces
    in N·m or N. τ_J are the torques that the motors produce at the joints of a serial robot without motors and rods:
    static, without friction, gravity and springs. Motor values are after the gear. Methods raise `NoTransmission` where
    their map does not exist, and `ValueError` where an argument has another shape or is not finite.

    Attributes:
        robot: The robot.
        q: The configuration (nq,).
        joints: Name of each joint velocity, nJ of them: the joint; of one with several velocities ``joint[0]``, ….
        motors: Name of each motor velocity, nm of them, likewise.
        G: dq_m/dq_J (nm, nJ); None where motors can move while the joints are still: see ``reason``.
        B_J: dq_J/dq_m (nJ, nm); None where joints can move while the motors are still: see ``inverse_reason``.
        rank_motors: Number of independent motor velocities.
        rank_joints: Number of independent joint velocities.
        condition: Condition number of G, in units of the characteristic length; None where G does not exist or does
            not have full rank.
        reason: Why G does not exist; None if it does.
        inverse_reason: Why B_J does not exist; None if it does.
        undetermined: The joints that the motors do not determine.
        missing: Joints to add so that G exists, where the joints do not determine the motors.
        held: Joints that their springs hold where they are, since no motor decides their motion.
        motor_index: Indices (nm,) of the motors in v.
        joint_index: Indices (nJ,) of the joints in v.
        held_index: Indices in v of the held joints.
        motions: Z (nv, m): basis of the motions that keep the loops closed and the held joints still.
    """

    robot: Robot
    q: Vector
    joints: tuple[str, ...]
    motors: tuple[str, ...]
    G: Matrix | None
    B_J: Matrix | None
    rank_motors: int
    rank_joints: int
    condition: float | None
    reason: str | None
    inverse_reason: str | None
    undetermined: tuple[str, ...]
    missing: tuple[str, ...]
    held: tuple[str, ...]
    motor_index: Indices
    joint_index: Indices
    held_index: Indices
    motions: Matrix

    def motor_velocity(self, v_J: Named) -> Vector:
        """v_m = G v_J (nm,), for joint velocities v_J (nJ,), rad/s or m/s.

        Raises:
            DependentVelocities: The loops do not allow these joint velocities together.
        """
        (G,), v = require(self, "G"), vector_of(v_J, self.joints, "v_J")
        if self.rank_joints < len(self.joints):
            self._refuse_dependent(self.joints, self.joint_index, v)
        return np.asarray(G @ v)

    def joint_velocity(self, v_m: Named) -> Vector:
        """v_J = B_J v_m (nJ,), for motor velocities v_m (nm,), rad/s or m/s.

        Raises:
            DependentVelocities: The loops do not allow these motor velocities together.
        """
        (B,), v = require(self, "B_J"), vector_of(v_m, self.motors, "v_m")
        if self.rank_motors < len(self.motors):
            self._refuse_dependent(self.motors, self.motor_index, v)
        return np.asarray(B @ v)

    def joint_torque(self, tau_m: Named) -> Vector:
        """τ_J = Gᵀ τ_m (nJ,), for motor torques or forces τ_m (nm,), N·m or N."""
        (G,) = require(self, "G")
        return np.asarray(G.T @ vector_of(tau_m, self.motors, "tau_m"))

    def motor_torque(self, tau_J: Named) -> Vector:
        """τ_m = B_Jᵀ τ_J (nm,), for joint torques or forces τ_J (nJ,), N·m or N.

        If the motors depend on each other, it is the solution with the least norm in units of the characteristic
        length; any torques of `internal` may be added.
        """
        (B,) = require(self, "B_J")
        return np.asarray(B.T @ vector_of(tau_J, self.joints, "tau_J"))

    @cached_property
    def internal(self) -> Matrix:
        """Basis (nm, k) of the motor torques that have no effect, since the motors depend on each other: ker Gᵀ."""
        left, _, _ = np.linalg.svd(self._dimensionless(self.motor_index))
        return np.asarray(left[:, self.rank_motors :] / for_many(self.robot).spaces.scale[self.motor_index, None])

    @cached_property
    def hessian(self) -> Matrix:
        """∂²q_m/∂q_J² (nm, nJ, nJ), symmetric in the last two; not unique if the joints depend on each other."""
        require(self, "G")
        if self.rank_joints < len(self.joints):
            reason = "the joints depend on each other; leave out some of them"
            raise NoTransmission("the derivative of G", reason)
        indices = self.joint_index, self.motor_index, self.held_index
        return second_derivative(self.robot, self.q, self.motions, *indices)

    def rate(self, v_J: Named) -> Matrix:
        """Ġ (nm, nJ) while the joints move at v_J (nJ,), rad/s or m/s; see `hessian`."""
        return np.asarray(self.hessian @ vector_of(v_J, self.joints, "v_J"))

    def bias(self, v_J: Named) -> Vector:
        """Ġ v_J (nm,): the motor accelerations are a_m = G a_J + Ġ v_J; see `rate`."""
        return np.asarray(self.rate(v_J) @ vector_of(v_J, self.joints, "v_J"))

    def _dimensionless(self, index: Indices) -> Matrix:
        """Rows (n, m) of the motions, dimensionless."""
        return np.asarray(self.motions[index] / for_many(self.robot).spaces.scale[index, None])

    def _refuse_dependent(self, names: tuple[str, ...], index: Indices, v: Vector) -> None:
        unit, rows = for_many(self.robot).spaces.scale[index], self._dimensionless(index)
        nearest = unit * (rows @ (pseudoinverse(rows[None])[0][0] @ (v / unit)))
        if np.linalg.norm((v - nearest) / unit) > _MISSED * np.linalg.norm(v / unit):
            raise DependentVelocities(names, v, nearest)

    def __repr__(self) -> str:
        return f"<Transmission: motors {', '.join(self.motors)}; joints {', '.join(self.joints)}>"


@dataclass(frozen=True, eq=False, repr=False)
class Transmissions:
    """The transmissions at B configurations, as `transmission` returns them.

    ``transmissions[i]`` is the `Transmission` at one of them.

    Attributes:
        robot: The robot.
        q: The configurations (B, nq).
        joints: As in `Transmission`, like what follows.
        motors: As in `Transmission`.
        G: (B, nm, nJ); NaN where it does not exist.
        B_J: (B, nJ, nm); NaN where it does not exist.
        rank_motors: (B,); -1 where the loops are open.
        rank_joints: (B,); -1 where the loops are open.
        condition: (B,); NaN where it does not exist.
        reason: For each element why G does not exist; None if it does.
        inverse_reason: For each element why B_J does not exist; None if it does.
    """

    robot: Robot
    q: Matrix
    joints: tuple[str, ...]
    motors: tuple[str, ...]
    G: Matrix
    B_J: Matrix
    rank_motors: Indices
    rank_joints: Indices
    condition: Vector
    reason: tuple[Reason | None, ...]
    inverse_reason: tuple[Reason | None, ...]
    _selections: tuple[Selection, Selection]

    @property
    def exists(self) -> Mask:
        """Whether G exists (B,)."""
        return np.array([reason is None for reason in self.reason], dtype=bool)

    def __len__(self) -> int:
        return len(self.q)

    def __getitem__(self, index: int) -> Transmission:
        joints, motors = self._selections
        return at_one(self.robot, joints, self.q[index], motors)

    def __repr__(self) -> str:
        return f"<Transmissions: G exists at {int(self.exists.sum())} of {len(self.q)} configurations>"


@of_any_robot
@overflow_refused("the transmission")
def transmission(
    robot: Robot,
    joints: str | Iterable[str],
    q: Named | Matrix | None = None,
    *,
    motors: str | Iterable[str] | None = None,
) -> Transmission | Transmissions:
    """The map between motors and the joints of the equivalent serial robot, at closed configurations.

    Let the columns of Z span the motions that keep the loops closed, K Z = 0, and let A = S_mᵀ Z and B = S_Jᵀ Z be
    their rows of motors and joints. G = A B⁺ exists if A = G B: no motor moves while all joints are still. B_J = B A⁺
    exists if B = B_J A: no joint moves while all motors are still. Only if both exist and are square is B_J = G⁻¹. Both
    answer without the other: at a dead point of the joints there is no G, and still v_J = B_J v_m and τ_m = B_Jᵀ τ_J.

    Joints with springs can move while the motors are still. Springs that such a motion would deflect are held where
    they are in q; `forward_kinematics` leaves them at rest. Springs in parallel with motors, such as one on an ankle
    that motors drive, are not held; add their torque (`eurdf.springs.spring_force`) to τ_J.

    Args:
        robot: The robot.
        joints: Names of the joints of the serial robot: revolute, continuous, prismatic, helical, universal or
            cylindrical.
        q: A closed configuration (nq,), or several (B, nq). The default is the `assembled` configuration, or the
            neutral one if there is none.
        motors: Names of the motors, in the order of the rows of G. By default the actuated joints that move the joints,
            in the order of ``robot.actuation``.

    Returns:
        The transmission; for several configurations all of them, in arrays. There, configurations without a map do not
        raise; they state the reason.

    Raises:
        NotClosable: The loops are open at q.
        ValueError: A name is unknown, no actuator moves the joints, ``q`` is not a configuration, or springs block
            motors.
    """
    chosen, by = sides(robot, joints, motors)
    each, single = configurations(robot, q)
    return at_one(robot, chosen, each[0], by) if single else at_many(robot, chosen, each, by)


def configurations(robot: Robot, q: Named | Matrix | None) -> tuple[Matrix, bool]:
    """Configurations (B, nq) that a caller gave, and whether it gave a single one, or None.

    Raises:
        ValueError: They are not configurations.
    """
    if shape_of(q)[1:] == (robot.tree.nq,):
        return checked_configurations(robot, "q", q), False
    return start(robot, q, "q")[None], True


def require(at: Transmission, *names: Literal["G", "B_J"], place: str = "") -> tuple[Matrix, ...]:
    """Maps that have to exist.

    Raises:
        NoTransmission: One does not.
    """
    for name in names:
        if getattr(at, name) is None:
            raise NoTransmission(name + place, (at.reason if name == "G" else at.inverse_reason) or "")
    return tuple(getattr(at, name) for name in names)


def at_one(robot: Robot, joints: Selection, q: Vector, motors: Selection) -> Transmission:
    """The transmission at one closed configuration (nq,); see `transmission`."""
    task = _task(robot, motors, joints)
    at, Q = maps_at(robot, task, q)
    held_index = task.springs[at.held[0]]
    held = tuple(robot.tree.velocity_names[velocity] for velocity in held_index.tolist())
    if at.blocked[0]:
        raise ValueError(f"the springs of {', '.join(held)} cannot all be held while the motors move")
    ranks = int(at.rank[0]), int(at.rank_motors[0]), int(at.rank_joints[0])
    why = reasons(robot, motors, joints, Q, ranks)
    return Transmission(
        robot,
        q,
        joints.names,
        motors.names,
        at.G[0] if why.forward is None else None,
        at.B_J[0] if why.inverse is None else None,
        *ranks[1:],
        None if np.isnan(at.condition[0]) else float(at.condition[0]),
        why.forward,
        why.inverse,
        why.undetermined,
        why.missing,
        held,
        np.array(motors.velocities),
        np.array(joints.velocities),
        held_index,
        task.problem.spaces.scale[:, None] * Q,
    )


def at_many(robot: Robot, joints: Selection, q: Matrix, motors: Selection) -> Transmissions:
    """The transmissions at several closed configurations (B, nq); see `transmission`."""
    task = _task(robot, motors, joints)
    work = blocks(2 * task.problem.numbers + 20 * robot.tree.nv, None, 1, None, None)
    at = Maps(*work.map(maps, task, (q,)))
    why = _codes(at, at.rank_joints, len(joints)), _codes(at, at.rank_motors, len(motors))
    ranks = at.rank_motors, at.rank_joints
    return Transmissions(
        robot, q, joints.names, motors.names, at.G, at.B_J, *ranks, at.condition, *why, (joints, motors)
    )


def _task(robot: Robot, motors: Selection, joints: Selection) -> MapsTask:
    driven = np.union1d(robot.actuation.idx_v, motors.velocities)
    return MapsTask(for_many(robot), motors.velocities, joints.velocities, driven, springs_of(robot))


def _codes(at: Maps, own: Indices, count: int) -> tuple[Reason | None, ...]:
    """Why a map from ``count`` velocities, of which ``own`` (b,) are independent, does not exist."""

    def code(rank: int, own: int, blocked: bool) -> Reason | None:
        if rank < 0:
            return "loops open"
        if blocked:
            return "springs block"
        if rank == own:
            return None
        return "more motions" if rank > count else "singular"

    return tuple(map(code, at.rank.tolist(), own.tolist(), at.blocked.tolist()))
