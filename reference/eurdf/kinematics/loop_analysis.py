"""The dimensions of an independent group of loops, the motions that its actuators leave, and those that they share."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from eurdf.array import Indices, Mask, Matrix, Vector
from eurdf.diagnostics.wording import enumerated
from eurdf.json_schema import HIDDEN, Count, NullIfInfinite
from eurdf.kinematics.finite_mobility import Evidence, FiniteMobility
from eurdf.kinematics.problem import Group
from eurdf.kinematics.rank import numerical_rank, singular_values

#: Entries below this, relative to the largest of their vector, count as rounding of numbers in files.
NEGLIGIBLE = 1e-4


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Motion:
    """A motion left with every actuator held.

    Attributes:
        joints: Names of the joints that it moves.
        velocities: Indices (k,) in v of the nonzero velocities.
        values: These velocities (k,), rad/s and m/s; the largest is 1 in units of rad and characteristic lengths.
        q: The closed configuration (nq,) of the motion.
    """

    joints: tuple[str, ...]
    velocities: Indices = field(metadata=HIDDEN)
    values: Vector = field(metadata=HIDDEN)
    q: Vector = field(metadata=HIDDEN)

    def __repr__(self) -> str:
        return f"<Motion of {enumerated(self.joints)}>"


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class LoopAnalysis:
    """An independent group of loops: they share joints with one another and with no other loop.

    Attributes:
        closures: Names of its closures and couplings, in file order.
        joints: Names of its joints, in the model's order.
        nv: Number of velocities of its joints.
        nc: Number of its constraint rows.
        rank: Rank of its block of the constraint Jacobian.
        mobility: Degrees of freedom of the closed loops, nv - rank.
        redundant: Redundant constraint rows, nc - rank.
        uncontrolled: Degrees of freedom left with its actuators held, nv - rank [K; Sᵀ].
        actuated: Number of its velocities that are actuated.
        controlled: Degrees of freedom that its actuators control, mobility - uncontrolled: the rank of Sᵀ on the null
            space of K.
        singularity: Its distance to singularity, as for the whole robot.
        actuation_singularity: Its distance to a singularity of the actuation, as for the whole robot.
        dependent_actuators: Its sets of dependent actuators: see `Analysis`.
        motions: Its uncontrolled motions: see `Analysis`.
        infinitesimal_mobility: Degrees of freedom to first order at the analysed configuration, nv - rank of K there.
        finite_mobility: Degrees of freedom of motions that continue from the analysed configuration; 'unknown' if it
            was not decided.
        evidence: What decides the finite mobility: the rank is the same all around (a proof), the second-order test (a
            proof), or continuation (numerical evidence); None if it is unknown.
        branches: Degrees of freedom of each branch of closed configurations that was found to pass through the analysed
            one; if more than two velocities are free there, each dimension once.
        rigid_order: Order p of rigidity, if the finite mobility is 0; else None. A motion of size h opens the loops by
            about hᵖ, so at p = 2 and above they are shaky.
    """

    closures: tuple[str, ...]
    joints: tuple[str, ...]
    nv: Count
    nc: Count
    rank: Count
    mobility: Count
    redundant: Count
    uncontrolled: Count
    actuated: Count
    controlled: Count
    singularity: NullIfInfinite
    actuation_singularity: NullIfInfinite
    dependent_actuators: tuple[tuple[str, ...], ...] = field(metadata=HIDDEN)
    motions: tuple[Motion, ...] = field(metadata=HIDDEN)
    infinitesimal_mobility: Count
    finite_mobility: Count | Literal["unknown"]
    evidence: Evidence | None
    branches: tuple[Count, ...]
    rigid_order: Count | None

    def __repr__(self) -> str:
        return (
            f"<LoopAnalysis of {enumerated(self.closures)}: {self.nv} velocities, {self.nc} rows of rank {self.rank}, "
            f"{self.mobility} degrees of freedom, {self.uncontrolled} uncontrolled>"
        )


def analyze_group(
    group: Group,
    at: Sequence[tuple[Vector, Matrix]],
    finite: FiniteMobility,
    actuated: Mask,
    names: Sequence[str],
    closures: Sequence[str],
) -> LoopAnalysis:
    """Analyse one group of loops.

    Args:
        group: The group.
        at: Closed configurations, each with its dimensionless block of K; the first is the one to analyse.
        finite: What was found of its finite mobility.
        actuated: Which of its velocities (n,) are actuated.
        names: For each velocity of the robot, the name of its joint.
        closures: Names of the robot's closures.
    """
    loops = group.loops
    ranks = [_ranks(A, actuated) for _, A in at]
    rank, held = max(rank for rank, _ in ranks), max(held for _, held in ranks)
    q, A = next(place for place, found in zip(at, ranks, strict=True) if found[1] == held)
    looked_at = at[0][1]
    nv, nc = len(loops.velocities), len(loops.rows)
    members = [names[velocity] for velocity in loops.velocities.tolist()]
    stacked = np.vstack([looked_at, np.eye(nv)[actuated]])
    return LoopAnalysis(
        closures=tuple(closures[index] for index in loops.closures),
        joints=_distinct(members),
        nv=nv,
        nc=nc,
        rank=rank,
        mobility=nv - rank,
        redundant=nc - rank,
        uncontrolled=nv - held,
        actuated=int(actuated.sum()),
        controlled=held - rank,
        singularity=_nth(singular_values(looked_at), rank),
        actuation_singularity=_nth(singular_values(stacked), held),
        dependent_actuators=_dependent_actuators(A, rank, held - rank, actuated, members),
        motions=_motions(A, held, actuated, group, members, q),
        infinitesimal_mobility=finite.infinitesimal,
        finite_mobility="unknown" if finite.finite is None else finite.finite,
        evidence=finite.evidence,
        branches=finite.branches,
        rigid_order=finite.rigid_order,
    )


def _ranks(A: Matrix, actuated: Mask) -> tuple[int, int]:
    """Ranks of K and of [K; Sᵀ]; the latter is the number of actuated velocities plus the rank of the other columns."""
    values = singular_values(A)
    reference = values.max(initial=0.0)
    rest = numerical_rank(singular_values(A[:, ~actuated]), reference)
    return numerical_rank(values, reference), int(actuated.sum()) + rest


def _dependent_actuators(
    A: Matrix, rank: int, controlled: int, actuated: Mask, members: Sequence[str]
) -> tuple[tuple[str, ...], ...]:
    """Names of the actuators whose velocities depend on one another, set by set.

    Torques z with zᵀ Sᵀ v = 0 for all v with K v = 0 do no work in any motion. The actuators in one vector of a sparse
    basis of them depend on one another, and so do those of two vectors that have an actuator in common.
    """
    count = int(actuated.sum())
    if count == controlled:
        return ()
    basis = _right_vectors(A)[rank:].T[actuated]  # actuated velocities of the free motions, (nu, mobility)
    columns = np.linalg.svd(basis, full_matrices=True)[0][:, controlled:]
    names = [name for name, moves in zip(members, actuated.tolist(), strict=True) if moves]
    sets: list[set[str]] = []
    for row in sparse_basis(columns.T):
        together = {name for name, value in zip(names, row.tolist(), strict=True) if value}
        apart = [other for other in sets if not other & together]
        sets = [*apart, together.union(*(other for other in sets if other & together))]
    order = {name: index for index, name in enumerate(_distinct(names))}
    ordered = (tuple(sorted(together, key=order.__getitem__)) for together in sets)
    return tuple(sorted(ordered, key=lambda together: order[together[0]]))


def _motions(
    A: Matrix, held: int, actuated: Mask, group: Group, members: Sequence[str], q: Vector
) -> tuple[Motion, ...]:
    """The motions of a group at q (nq,) with its actuators held; A is its block of K."""
    free = np.flatnonzero(~actuated)
    basis = _right_vectors(A[:, free])[held - int(actuated.sum()) :]
    motions = []
    for row in sparse_basis(basis):
        moving = free[np.flatnonzero(row)]
        values = row[np.flatnonzero(row)] * group.unit[moving]
        joints = _distinct(members[index] for index in moving.tolist())
        motions.append(Motion(joints, group.loops.velocities[moving], values, q))
    return tuple(motions)


def sparse_basis(vectors: Matrix) -> Matrix:
    """A basis of the same space whose vectors have few nonzero entries.

    It is the reduced echelon form with complete pivoting: up to a factor, each vector is the only one of the space with
    its pattern of zeros. If the space is a sum of spaces without common entries, each vector lies in one of them.

    Args:
        vectors: A basis (k, n), one vector a row.

    Returns:
        The basis (k, n), one vector a row, in the order of their first nonzero entries. The first of the largest
        entries of each vector, to within 0.1 %, is 1, so the choice does not depend on rounding.
    """
    basis = np.array(vectors, dtype=np.float64)
    for row in range(len(basis)):
        rest = np.abs(basis[row:])
        pivot, column = np.unravel_index(int(np.argmax(rest)), rest.shape)
        basis[[row, row + int(pivot)]] = basis[[row + int(pivot), row]]
        basis[row] /= basis[row, column]
        others = np.arange(len(basis)) != row
        basis[others] -= np.outer(basis[others, column], basis[row])
    for index, vector in enumerate(basis):
        largest = vector[np.argmax(np.abs(vector) > 0.999 * np.abs(vector).max(initial=0.0))] if len(vector) else 1.0
        basis[index] = vector / largest
    basis[np.abs(basis) < NEGLIGIBLE] = 0.0
    first = [int(np.argmax(vector != 0.0)) for vector in basis]
    return basis[np.argsort(np.array(first, dtype=np.intp), kind="stable")]


def _distinct(names: Iterable[str]) -> tuple[str, ...]:
    return tuple(dict.fromkeys(names))


def _nth(values: Vector, number: int) -> float:
    """Singular value number ``number``; inf for number 0, since there is no rank to lose."""
    return float(values[number - 1]) if number > 0 else math.inf


def _right_vectors(A: Matrix) -> Matrix:
    """All right singular vectors (n, n) of A, one a row, those of the largest singular values first."""
    return np.asarray(np.linalg.svd(A, full_matrices=True)[2], dtype=np.float64)
