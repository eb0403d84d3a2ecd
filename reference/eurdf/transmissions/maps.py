"""The maps between the velocities of motors and joints, at arrays of closed configurations.

The columns of Z span the motions that keep the loops closed, K Z = 0. With A = S_mᵀ Z and B = S_Jᵀ Z, the velocities of
motors and joints are v_m = A z and v_J = B z. So v_m = G v_J with G = A B⁺ if A = G B, which is if no motor moves while
all joints are still; and v_J = B_J v_m with B_J = B A⁺ if B = B_J A.

Springs. A joint with a spring can move while all actuators are still. Springs that such a motion would deflect hold
their joints where they are: the motions are those with S_sᵀ Z = 0. The power of these springs is then zero, so that
τ_J = Gᵀ τ_m is the statics of the mechanism, whatever their deflection.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from eurdf.array import Indices, Mask, Matrix, Vector
from eurdf.errors import NotClosable
from eurdf.kinematics.problem import Problem
from eurdf.kinematics.rank import numerical_ranks
from eurdf.kinematics.residual import all_openings, drift_of_pairs, residual_and_jacobian
from eurdf.kinematics.tangent_space import TangentSpaces
from eurdf.kinematics.tolerances import CLOSED, MOVES
from eurdf.transmissions.selection import Selection, listed, selectable

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot

# A singular value below this fraction of the largest one belongs to a redundant row.
_REDUNDANT = 1e-9


@dataclass(frozen=True, eq=False)
class MapsTask:
    """What is the same at all configurations.

    Attributes:
        problem: The robot.
        motors: Indices (nm,) in v of the motors.
        joints: Indices (nJ,) in v of the joints.
        driven: Indices in v of all actuators and of the motors.
        springs: Indices in v of the joints with springs.
    """

    problem: Problem
    motors: Indices
    joints: Indices
    driven: Indices
    springs: Indices


class Maps(NamedTuple):
    """The maps at b configurations; NaN where one does not exist.

    Attributes:
        G: (b, nm, nJ).
        B_J: (b, nJ, nm).
        rank: Ranks (b,) of A and B together; -1 where the loops are open.
        rank_motors: Ranks (b,) of A.
        rank_joints: Ranks (b,) of B.
        condition: Condition numbers (b,) of G, dimensionless; NaN where G does not exist or does not have full rank.
        held: Which of the springs (b, ns) hold their joint.
        blocked: Whether (b,) the springs that hold block motors.
    """

    G: Matrix
    B_J: Matrix
    rank: Indices
    rank_motors: Indices
    rank_joints: Indices
    condition: Vector
    held: Mask
    blocked: Mask


def maps(task: MapsTask, q: Matrix) -> Maps:
    """The maps at closed configurations (b, nq)."""
    problem, b, nm, nJ = task.problem, len(q), len(task.motors), len(task.joints)
    closed = (np.abs(problem.residual(q)) <= CLOSED).all(axis=1)
    nowhere, shut = np.full((3, b), -1), np.zeros((b, len(task.springs)), dtype=bool)
    G, B_J = np.full((b, nm, nJ), np.nan), np.full((b, nJ, nm), np.nan)
    ranks = nowhere[0], nowhere[1], nowhere[2]
    found = Maps(G, B_J, *ranks, np.full(b, np.nan), shut, np.zeros(b, dtype=bool))
    which = np.flatnonzero(closed)
    for space in problem.spaces.each(problem.jacobian(q[which])):
        own, Z = which[space.which], space.free / problem.spaces.scale[:, None]
        # Springs can hold another number of motions at each configuration.
        for elements, motions in [(own, Z)] if not len(task.springs) else zip(own[:, None], Z[:, None], strict=True):
            for whole, part in zip(found, _maps(task, motions)[0], strict=True):
                whole[elements] = part
    return found


def maps_at(robot: Robot, task: MapsTask, q: Vector) -> tuple[Maps, Matrix]:
    """The maps at one configuration (nq,), and its motions (nv, m), orthonormal and dimensionless.

    Raises:
        NotClosable: The loops are open there.
    """
    r, K = residual_and_jacobian(robot, q)
    if not (np.abs(r) <= CLOSED).all():
        raise NotClosable("q does not close the loops; call eurdf.assemble first", all_openings(robot, q), q)
    spaces = robot.cached(TangentSpaces)
    found, motions = _maps(task, (spaces.at(K).free / spaces.scale[:, None])[None])
    return found, motions[0]


def _maps(task: MapsTask, Z: Matrix) -> tuple[Maps, Matrix]:
    """The maps of orthonormal motions (c, nv, m), and these without what springs hold; with springs, c is 1."""
    c, scale = len(Z), task.problem.spaces.scale
    held, blocked = np.zeros((c, len(task.springs)), dtype=bool), np.zeros(c, dtype=bool)
    if len(task.springs):
        rigid, held[0], blocked[0] = _with_springs_held(task, Z[0])
        Z = rigid[None]
    A, B = Z[:, task.motors], Z[:, task.joints]
    (A_inverse, rank_m), (B_inverse, rank_J) = pseudoinverse(A), pseudoinverse(B)
    both = np.linalg.svd(np.concatenate((A, B), axis=1), compute_uv=False)
    rank = np.maximum(numerical_ranks(both, np.ones(c)), np.maximum(rank_m, rank_J))
    forward = A @ B_inverse
    has_G, has_B = ~blocked & (rank == rank_J), ~blocked & (rank == rank_m)
    condition, full = np.full(c, np.nan), has_G & (rank_m == min(len(task.motors), len(task.joints)))
    values = np.linalg.svd(forward[full], compute_uv=False)
    condition[full] = values[:, 0] / values[:, -1]
    unit_m, unit_J = scale[task.motors], scale[task.joints]
    G = np.where(has_G[:, None, None], unit_m[:, None] * forward / unit_J, np.nan)
    B_J = np.where(has_B[:, None, None], unit_J[:, None] * (B @ A_inverse) / unit_m, np.nan)
    return Maps(G, B_J, rank, rank_m, rank_J, condition, held, blocked), Z


def pseudoinverse(A: Matrix) -> tuple[Matrix, Indices]:
    """Pseudoinverses (b, m, n) of rows of orthonormal motions (b, n, m), and their numerical ranks (b,)."""
    left, values, right = np.linalg.svd(A, full_matrices=False)
    ranks = numerical_ranks(values, np.ones(len(A)))
    counts = np.arange(values.shape[1]) < ranks[:, None]
    inverse = np.divide(1.0, values, out=np.zeros_like(values), where=counts)
    return np.swapaxes(left * inverse[:, None, :] @ right, 1, 2), ranks


def _with_springs_held(task: MapsTask, Z: Matrix) -> tuple[Matrix, Mask, bool]:
    """The motions (nv, m) that keep the springs, which springs hold, and whether they block actuators."""
    driven = Z[task.driven]
    own = Z @ _null_space(driven)
    hold = np.linalg.norm(own[task.springs], axis=1) > MOVES
    rigid = Z @ _null_space(Z[task.springs[hold]])
    (_, before), (_, after) = pseudoinverse(driven[None]), pseudoinverse(rigid[None, task.driven])
    return rigid, hold, bool(after[0] < before[0])


def _null_space(rows: Matrix) -> Matrix:
    """Basis (m, m - rank) of the null space of rows (n, m) of orthonormal motions."""
    _, values, right = np.linalg.svd(rows)
    return np.asarray(right[int(numerical_ranks(values[None], np.ones(1))[0]) :].T)


class Reasons(NamedTuple):
    """Why maps do not exist at a configuration.

    Attributes:
        forward: Why G does not exist; None if it does.
        inverse: Why B_J does not exist; None if it does.
        undetermined: Names of the joint velocities that the motors do not determine.
        missing: Joints to add so that G exists, where the joints do not determine the motors.
    """

    forward: str | None = None
    inverse: str | None = None
    undetermined: tuple[str, ...] = ()
    missing: tuple[str, ...] = ()


def reasons(robot: Robot, motors: Selection, joints: Selection, Q: Matrix, ranks: tuple[int, int, int]) -> Reasons:
    """Why maps do not exist, if one does not.

    Args:
        robot: The robot.
        motors: The motors.
        joints: The joints.
        Q: Orthonormal motions (nv, m), dimensionless.
        ranks: Of the motions of motors and joints together, of the motors, and of the joints.
    """
    rank, rank_motors, rank_joints = ranks
    if rank == rank_motors == rank_joints:
        return Reasons()
    forward = inverse = None
    undetermined: tuple[str, ...] = ()
    missing: tuple[str, ...] = ()
    if rank > rank_motors:
        undetermined = _moving(Q, joints, motors)
        if rank_motors < min(len(motors), rank_joints):
            inverse = (
                f"the motors are at a dead point: only {rank_motors} of {len(motors)} motor velocities are "
                f"independent, and {listed(undetermined)} can move while the motors are still"
            )
        else:
            inverse = (
                f"{listed(undetermined)} can move while the motors are still; leave out such joints, or add motors"
            )
    if rank > rank_joints:
        moving = listed(_moving(Q, motors, joints))
        if rank > len(joints):
            missing = _missing(robot, motors, joints, Q)
            add = f"; add {listed(missing)} to the joints, or give the motors" if missing else "; give the motors"
            forward = f"these joints do not determine the motors: {moving} can move while the joints are still{add}"
        else:
            forward = (
                f"the pose is singular: only {rank_joints} of {len(joints)} joint velocities are independent, "
                f"and {moving} can move while the joints are still"
            )
    return Reasons(forward, inverse, undetermined, missing)


def _moving(Q: Matrix, chosen: Selection, still: Selection) -> tuple[str, ...]:
    """Names of the velocities that can move while others are still."""
    own, others = Q[chosen.velocities], Q[still.velocities]
    without = own - own @ pseudoinverse(others[None])[0][0] @ others
    moved = np.linalg.norm(without, axis=1) > MOVES
    return tuple(name for name, moves in zip(chosen.names, moved.tolist(), strict=True) if moves)


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
    space = robot.cached(TangentSpaces).at(K)
    still = np.concatenate((joints, held))
    back = space.free @ np.linalg.pinv(space.free[still], rcond=_REDUNDANT)

    a = np.tensordot(-space.inverse, drift_of_pairs(robot, q, N), axes=1)
    return np.asarray(a[motors] - np.tensordot(back[motors], a[still], axes=1))
