"""Why a map between motors and joints does not exist, and what to do about it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from eurdf.kinematics.array import Matrix
from eurdf.kinematics.tolerances import MOVES
from eurdf.transmissions.maps import pseudoinverse
from eurdf.transmissions.selection import Selection, selectable

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot


@dataclass(frozen=True, slots=True)
class Reasons:
    """Why maps do not exist at a configuration.

    Attributes:
        forward: Why G does not exist; None if it does.
        inverse: Why B_J does not exist; None if it does.
        undetermined: Names of the joint velocities that the motors do not determine.
        missing: Joints to add so that G exists, where the joints do not determine the motors.
    """

    forward: str | None
    inverse: str | None
    undetermined: tuple[str, ...]
    missing: tuple[str, ...]


#: Where both maps exist.
BOTH_EXIST = Reasons(None, None, (), ())


def reasons(robot: Robot, motors: Selection, joints: Selection, Q: Matrix, ranks: tuple[int, int, int]) -> Reasons:
    """Why maps do not exist.

    Args:
        robot: The robot.
        motors: The motors.
        joints: The joints.
        Q: Orthonormal motions (nv, m), dimensionless.
        ranks: Of the motions of motors and joints together, of the motors, and of the joints.
    """
    rank, rank_motors, rank_joints = ranks
    A, B = Q[motors.velocities], Q[joints.velocities]
    (A_inverse, _), (B_inverse, _) = pseudoinverse(A[None]), pseudoinverse(B[None])
    forward: str | None = None
    inverse: str | None = None
    undetermined: tuple[str, ...] = ()
    missing: tuple[str, ...] = ()
    if rank > rank_motors:
        without = B - B @ A_inverse[0] @ A
        moved = np.linalg.norm(without, axis=1) > MOVES
        undetermined = tuple(name for name, moves in zip(joints.names, moved.tolist(), strict=True) if moves)
        if rank_motors < min(len(motors), rank_joints):
            inverse = (
                f"the motors are at a dead point: only {rank_motors} of {len(motors)} motor velocities are "
                f"independent, and {_listed(undetermined)} can move while the motors are still"
            )
        else:
            inverse = (
                f"{_listed(undetermined)} can move while the motors are still; leave out such joints, or add motors"
            )
    if rank > rank_joints:
        without = A - A @ B_inverse[0] @ B
        moved = np.linalg.norm(without, axis=1) > MOVES
        moving = _listed([name for name, moves in zip(motors.names, moved.tolist(), strict=True) if moves])
        if rank > len(joints):
            missing = _missing(robot, motors, joints, Q)
            add = f"; add {_listed(missing)} to the joints, or give the motors" if missing else "; give the motors"
            forward = f"these joints do not determine the motors: {moving} can move while the joints are still{add}"
        else:
            forward = (
                f"the pose is singular: only {rank_joints} of {len(joints)} joint velocities are independent, "
                f"and {moving} can move while the joints are still"
            )
    return Reasons(forward, inverse, undetermined, missing)


def _missing(robot: Robot, motors: Selection, joints: Selection, Q: Matrix) -> tuple[str, ...]:
    """Joints that the motors determine and that, with the given ones, determine the motors; () if there are none."""
    A = Q[motors.velocities]
    (inverse,), (rank,) = pseudoinverse(A[None])
    controlled = inverse @ A  # projects on the motions that the motors decide
    rows, added = Q[joints.velocities], []
    for name, velocities in _candidates(robot, motors, joints):
        if np.abs(Q[velocities] - Q[velocities] @ controlled).max() > MOVES:
            continue
        _, before = pseudoinverse((rows @ controlled)[None])
        _, after = pseudoinverse((np.vstack((rows, Q[velocities])) @ controlled)[None])
        if after[0] == before[0] + len(velocities):
            rows = np.vstack((rows, Q[velocities]))
            added.append(name)
        if after[0] == rank:
            return tuple(added)
    return ()


def _candidates(robot: Robot, motors: Selection, joints: Selection) -> list[tuple[str, list[int]]]:
    """Other joints that are not motors, with their velocities: first those between the given ones and the root."""
    tree = robot.tree
    owner = {velocity: joint for joint, own in enumerate(tree.own_velocities) for velocity in own}
    above: dict[int, int] = {}
    for velocity in joints.velocities.tolist():
        joint, distance = owner[velocity], 0
        while joint:
            above[joint] = min(distance, above.get(joint, distance))
            joint, distance = tree.parents[joint], distance + 1
    found = []
    for name, slot in selectable(robot):
        own = list(range(slot.idx_v, slot.idx_v + slot.nv))
        if not set(own) & {*joints.velocities.tolist(), *motors.velocities.tolist()}:
            unlimited = not np.isfinite([lower for lower, _ in slot.joint.ranges]).all()
            found.append((above.get(owner[own[0]], tree.nv), unlimited, name, own))
    return [(name, own) for _, _, name, own in sorted(found, key=lambda each: each[:2])]


def _listed(names: Sequence[str]) -> str:
    return ", ".join(f"'{name}'" for name in names)
