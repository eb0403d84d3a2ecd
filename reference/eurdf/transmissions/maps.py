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
from typing import NamedTuple

import numpy as np

from eurdf.kinematics.array import Indices, Mask, Matrix, Vector
from eurdf.kinematics.batch.problem import Problem
from eurdf.kinematics.batch.tangent import numerical_ranks, tangents

# Largest row of the residual (m, rad) of a closed configuration (EU-CLO-005).
CLOSED = 1e-6

#: A unit motion moves a joint if it does so by more than this.
MOVES = 1e-6


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
    at = model.whole.at(np.ascontiguousarray(q.T))
    closed = (np.abs(model.whole.residual(at)) <= CLOSED).all(axis=0)
    nm, nJ = len(task.motors), len(task.joints)
    G, B_J, condition = np.full((b, nm, nJ), np.nan), np.full((b, nJ, nm), np.nan), np.full(b, np.nan)
    ranks = np.full((3, b), -1)
    held, blocked = np.zeros((b, len(task.springs)), dtype=bool), np.zeros(b, dtype=bool)
    unit_m, unit_J = model.scale[task.motors], model.scale[task.joints]
    for which, Z in _motions(task, model.whole.jacobian(at), np.flatnonzero(closed), held, blocked):
        A, B = Z[:, task.motors], Z[:, task.joints]
        (A_inverse, rank_m), (B_inverse, rank_J) = pseudoinverse(A), pseudoinverse(B)
        both = np.linalg.svd(np.concatenate((A, B), axis=1), compute_uv=False)
        rank = np.maximum(numerical_ranks(both, np.ones(len(both))), np.maximum(rank_m, rank_J))
        ranks[:, which] = rank, rank_m, rank_J
        own = rank == rank_J
        forward = A @ B_inverse
        G[which[own]] = (unit_m[:, None] * forward / unit_J)[own]
        full = own & (rank_m == min(nm, nJ))
        values = np.linalg.svd(forward[full], compute_uv=False)
        condition[which[full]] = values[:, 0] / values[:, -1]
        own = rank == rank_m
        B_J[which[own]] = (unit_J[:, None] * (B @ A_inverse) / unit_m)[own]
    return Maps(G, B_J, ranks[0], ranks[1], ranks[2], condition, held, blocked)


def motions(task: Task, q: Vector) -> Matrix:
    """Orthonormal motions (nv, m), dimensionless, at one closed configuration (nq,)."""
    model = task.problem
    K = model.whole.jacobian(model.whole.at(np.ascontiguousarray(q[:, None])))
    held, blocked = np.zeros((1, len(task.springs)), dtype=bool), np.zeros(1, dtype=bool)
    ((_, Z),) = _motions(task, K, np.zeros(1, np.intp), held, blocked)
    return np.asarray(Z[0])


def pseudoinverse(A: Matrix) -> tuple[Matrix, Indices]:
    """Pseudoinverses (b, m, n) of rows of orthonormal motions (b, n, m), and their numerical ranks (b,)."""
    left, values, right = np.linalg.svd(A, full_matrices=False)
    ranks = numerical_ranks(values, np.ones(len(A)))
    counts = np.arange(values.shape[1]) < ranks[:, None]
    inverse = np.divide(1.0, values, out=np.zeros_like(values), where=counts)
    return np.swapaxes(left * inverse[:, None, :] @ right, 1, 2), ranks


def _motions(task: Task, K: Matrix, which: Indices, held: Mask, blocked: Mask) -> list[tuple[Indices, Matrix]]:
    """Orthonormal motions (c, nv, m), dimensionless, of the configurations, for K (nc, nv, b); with springs, held."""
    found = []
    for space in tangents(task.problem, K[:, :, which]):
        own = which[space.which]
        Z, _ = np.linalg.qr(space.basis / task.problem.scale[:, None])
        if not len(task.springs):
            found.append((own, Z))
            continue
        for element, basis in zip(own.tolist(), Z, strict=True):
            rigid, held[element], blocked[element] = _with_springs_held(task, basis)
            found.append((np.array([element]), rigid[None]))
    return found


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
