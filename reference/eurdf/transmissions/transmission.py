"""The transmission between motors and joints at closed configurations: velocities and torques both ways."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Literal

import numpy as np

from eurdf.errors import DependentVelocities, NoTransmission
from eurdf.kinematics.array import Indices, Mask, Matrix, Vector
from eurdf.kinematics.assembly import start
from eurdf.kinematics.blocks import blocks, checked_configurations, shape_of
from eurdf.kinematics.finite import overflow_refused
from eurdf.kinematics.named import Named, vector_of
from eurdf.kinematics.problem import for_many
from eurdf.loading import of_any_robot
from eurdf.transmissions.curvature import second_derivative
from eurdf.transmissions.maps import Maps, Task, maps, maps_at, pseudoinverse
from eurdf.transmissions.motors import motors_of, springs_of
from eurdf.transmissions.reasons import BOTH_EXIST, reasons
from eurdf.transmissions.selection import Selection, selection

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
    static, without friction, gravity and springs. Motor values are after the gear.

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
        """v_m = G v_J (nm,).

        Args:
            v_J: Joint velocities (nJ,), rad/s or m/s.

        Raises:
            NoTransmission: There is no G.
            DependentVelocities: The loops do not allow these joint velocities together.
            ValueError: ``v_J`` has another shape or is not finite.
        """
        G, v = self._forward, vector_of(v_J, self.joints, "v_J")
        if self.rank_joints < len(self.joints):
            self._refuse_dependent(self.joints, self.joint_index, v)
        return np.asarray(G @ v)

    def joint_velocity(self, v_m: Named) -> Vector:
        """v_J = B_J v_m (nJ,).

        Args:
            v_m: Motor velocities (nm,), rad/s or m/s.

        Raises:
            NoTransmission: There is no B_J.
            DependentVelocities: The loops do not allow these motor velocities together.
            ValueError: ``v_m`` has another shape or is not finite.
        """
        B, v = self._inverse, vector_of(v_m, self.motors, "v_m")
        if self.rank_motors < len(self.motors):
            self._refuse_dependent(self.motors, self.motor_index, v)
        return np.asarray(B @ v)

    def joint_torque(self, tau_m: Named) -> Vector:
        """τ_J = Gᵀ τ_m (nJ,).

        Args:
            tau_m: Motor torques or forces (nm,), N·m or N.

        Raises:
            NoTransmission: There is no G.
            ValueError: ``tau_m`` has another shape or is not finite.
        """
        return np.asarray(self._forward.T @ vector_of(tau_m, self.motors, "tau_m"))

    def motor_torque(self, tau_J: Named) -> Vector:
        """τ_m = B_Jᵀ τ_J (nm,).

        If the motors depend on each other, it is the solution with the least norm in units of the characteristic
        length; any torques of `internal` may be added.

        Args:
            tau_J: Joint torques or forces (nJ,), N·m or N.

        Raises:
            NoTransmission: There is no B_J.
            ValueError: ``tau_J`` has another shape or is not finite.
        """
        return np.asarray(self._inverse.T @ vector_of(tau_J, self.joints, "tau_J"))

    @cached_property
    def internal(self) -> Matrix:
        """Basis (nm, k) of the motor torques that have no effect, since the motors depend on each other: ker Gᵀ."""
        left, _, _ = np.linalg.svd(self._dimensionless(self.motor_index))
        return np.asarray(left[:, self.rank_motors :] / for_many(self.robot).spaces.scale[self.motor_index, None])

    @cached_property
    def hessian(self) -> Matrix:
        """∂²q_m/∂q_J² (nm, nJ, nJ), symmetric in the last two.

        Raises:
            NoTransmission: There is no G, or the joints depend on each other, so that its derivative is not unique.
        """
        if self.G is not None and self.rank_joints < len(self.joints):
            reason = "the joints depend on each other; leave out some of them"
            raise NoTransmission("the derivative of G", reason)
        if self.G is None:
            raise NoTransmission("G", self.reason or "")
        indices = self.joint_index, self.motor_index, self.held_index
        return second_derivative(self.robot, self.q, self.motions, *indices)

    def rate(self, v_J: Named) -> Matrix:
        """Ġ (nm, nJ) while the joints move at v_J.

        Args:
            v_J: Joint velocities (nJ,), rad/s or m/s.

        Raises:
            NoTransmission: As for `hessian`.
            ValueError: ``v_J`` has another shape or is not finite.
        """
        return np.asarray(self.hessian @ vector_of(v_J, self.joints, "v_J"))

    def bias(self, v_J: Named) -> Vector:
        """Ġ v_J (nm,): the motor accelerations are a_m = G a_J + Ġ v_J.

        Args:
            v_J: Joint velocities (nJ,), rad/s or m/s.

        Raises:
            NoTransmission: As for `hessian`.
            ValueError: ``v_J`` has another shape or is not finite.
        """
        return np.asarray(self.rate(v_J) @ vector_of(v_J, self.joints, "v_J"))

    @property
    def _forward(self) -> Matrix:
        if self.G is None:
            raise NoTransmission("G", self.reason or "")
        return self.G

    @property
    def _inverse(self) -> Matrix:
        if self.B_J is None:
            raise NoTransmission("B_J", self.inverse_reason or "")
        return self.B_J

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
    _motors: Selection
    _joints: Selection

    @property
    def exists(self) -> Mask:
        """Whether G exists (B,)."""
        return np.array([reason is None for reason in self.reason], dtype=bool)

    def __len__(self) -> int:
        return len(self.q)

    def __getitem__(self, index: int) -> Transmission:
        return at_one(self.robot, self._joints, self.q[index], self._motors)

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
    they are in q; `forward_kinematics` leaves them at rest. Springs beside the motors, such as one on an ankle that
    motors drive, hold nothing; add their torque (`eurdf.springs.spring_force`) to τ_J.

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
    chosen = selection(robot, joints)
    by = motors_of(robot, chosen) if motors is None else selection(robot, motors, "motors")
    if shape_of(q)[1:] == (robot.tree.nq,):
        return at_many(robot, chosen, checked_configurations(robot, "q", q), by)
    return at_one(robot, chosen, start(robot, q, "q"), by)


def at_one(robot: Robot, joints: Selection, q: Vector, motors: Selection) -> Transmission:
    """The transmission at one closed configuration (nq,); see `transmission`."""
    task = _task(robot, motors, joints)
    at, Q = maps_at(robot, task, q)
    held = _names(robot, task.springs[at.held[0]])
    if at.blocked[0]:
        raise ValueError(f"the springs of {', '.join(held)} cannot all be held while the motors move")
    ranks = int(at.rank[0]), int(at.rank_motors[0]), int(at.rank_joints[0])
    why = BOTH_EXIST if ranks[0] == ranks[1] == ranks[2] else reasons(robot, motors, joints, Q, ranks)
    return Transmission(
        robot,
        q,
        joints.names,
        motors.names,
        at.G[0] if why.forward is None else None,
        at.B_J[0] if why.inverse is None else None,
        ranks[1],
        ranks[2],
        None if np.isnan(at.condition[0]) else float(at.condition[0]),
        why.forward,
        why.inverse,
        why.undetermined,
        why.missing,
        held,
        np.array(motors.velocities),
        np.array(joints.velocities),
        task.springs[at.held[0]],
        task.problem.spaces.scale[:, None] * Q,
    )


def at_many(robot: Robot, joints: Selection, q: Matrix, motors: Selection) -> Transmissions:
    """The transmissions at several closed configurations (B, nq); see `transmission`."""
    task = _task(robot, motors, joints)
    work = blocks(2 * task.problem.numbers + 20 * robot.tree.nv, None, 1, None, None)
    at = Maps(*work.map(maps, task, (q,)))
    forward, inverse = _codes(at, len(joints), len(motors))
    ranks = at.rank_motors, at.rank_joints
    return Transmissions(
        robot, q, joints.names, motors.names, at.G, at.B_J, *ranks, at.condition, forward, inverse, motors, joints
    )


def _task(robot: Robot, motors: Selection, joints: Selection) -> Task:
    driven = np.union1d(robot.actuation.idx_v, motors.velocities)
    return Task(for_many(robot), motors.velocities, joints.velocities, driven, springs_of(robot))


def _codes(at: Maps, nJ: int, nm: int) -> tuple[tuple[Reason | None, ...], tuple[Reason | None, ...]]:
    """Why G and why B_J do not exist, for each configuration."""

    def code(rank: int, own: int, count: int, blocked: bool) -> Reason | None:
        if rank < 0:
            return "loops open"
        if blocked:
            return "springs block"
        if rank == own:
            return None
        return "more motions" if rank > count else "singular"

    rows = list(
        zip(at.rank.tolist(), at.rank_motors.tolist(), at.rank_joints.tolist(), at.blocked.tolist(), strict=True)
    )
    forward = tuple(code(rank, own, nJ, blocked) for rank, _, own, blocked in rows)
    inverse = tuple(code(rank, own, nm, blocked) for rank, own, _, blocked in rows)
    return forward, inverse


def _names(robot: Robot, velocities: Indices) -> tuple[str, ...]:
    owner = {slot.idx_v + k: name for name, slot in robot.slots.items() for k in range(slot.nv)}
    return tuple(owner[velocity] for velocity in velocities.tolist())
