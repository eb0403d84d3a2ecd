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

from eurdf.errors import NotClosable
from eurdf.kinematics.array import Indices, Mask, Matrix, Vector
from eurdf.kinematics.derived import derived
from eurdf.kinematics.problem import Problem
from eurdf.kinematics.rank import numerical_ranks
from eurdf.kinematics.residual import all_openings, residual_and_jacobian
from eurdf.kinematics.tangent_space import TangentSpaces
from eurdf.kinematics.tolerances import CLOSED, MOVES

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot


@dataclass(frozen=True, eq=False)
class Task:
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


def maps(task: Task, q: Matrix) -> Maps:
    """The maps at closed configurations (b, nq)."""
    model, b = task.problem, len(q)
    closed = (np.abs(model.residual(q)) <= CLOSED).all(axis=1)
    nm, nJ = len(task.motors), len(task.joints)
    nowhere = np.full(b, -1)
    found = Maps(
        G=np.full((b, nm, nJ), np.nan),
        B_J=np.full((b, nJ, nm), np.nan),
        rank=nowhere.copy(),
        rank_motors=nowhere.copy(),
        rank_joints=nowhere.copy(),
        condition=np.full(b, np.nan),
        held=np.zeros((b, len(task.springs)), dtype=bool),
        blocked=np.zeros(b, dtype=bool),
    )
    which = np.flatnonzero(closed)
    for space in model.spaces.each(model.jacobian(q[which])):
        own, Z = which[space.which], space.free / model.spaces.scale[:, None]
        # Springs can hold another number of motions at each configuration.
        for elements, motions in [(own, Z)] if not len(task.springs) else zip(own[:, None], Z[:, None], strict=True):
            for whole, part in zip(found, _maps(task, motions)[0], strict=True):
                whole[elements] = part
    return found


def maps_at(robot: Robot, task: Task, q: Vector) -> tuple[Maps, Matrix]:
    """The maps at one configuration (nq,), and its motions (nv, m), orthonormal and dimensionless.

    Raises:
        NotClosable: The loops are open there.
    """
    r, K = residual_and_jacobian(robot, q)
    if not (np.abs(r) <= CLOSED).all():
        raise NotClosable("q does not close the loops; call eurdf.assemble first", all_openings(robot, q), q)
    spaces = derived(robot, TangentSpaces)
    found, motions = _maps(task, (spaces.at(K).free / spaces.scale[:, None])[None])
    return found, motions[0]


def _maps(task: Task, Z: Matrix) -> tuple[Maps, Matrix]:
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


def _with_springs_held(task: Task, Z: Matrix) -> tuple[Matrix, Mask, bool]:
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
