"""The dimensions of a mechanism: how its loops constrain it and what can still move."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from eurdf.kinematics.array import Mask, Matrix, Vector
from eurdf.kinematics.assembly import Assembler, Assembly, start
from eurdf.kinematics.rank import numerical_rank

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot

# Closed configurations looked at beside the first, and how far each is stepped to (rad, or characteristic lengths).
_MOVES = (0.05, 0.1, 0.2, 0.2)


@dataclass(frozen=True, slots=True, eq=False)
class Analysis:
    """Dimensions of a mechanism.

    Attributes:
        nq: Coordinates of the spanning tree.
        nv: Velocities of the spanning tree.
        nc: Constraint rows.
        rank: Rank of the constraint Jacobian K at a generic closed configuration; None if the loops do not close.
        mobility: nv - rank, or None.
        redundant: Redundant rows, nc - rank, or None.
        uncontrolled: Uncontrolled mobility, nv - rank [K; S], what still moves with every actuator held, or None.
        actuated: Number of actuated velocities.
        residual: Norm of the residual at q, m and rad: the smallest found.
        closes: Whether the loops close, with every row of the residual at q at most 1e-6.
        q: The configuration (nq,) looked at: closed, or the least open one found.
    """

    nq: int
    nv: int
    nc: int
    rank: int | None
    mobility: int | None
    redundant: int | None
    uncontrolled: int | None
    actuated: int
    residual: float
    closes: bool
    q: Vector


def analyze(robot: Robot, q: Vector | None = None) -> Analysis:
    """Close the loops and count what they constrain.

    Ranks are those of a generic configuration: the largest found at the closed configuration and at some others
    around it, reached by small steps along the null space of K that are closed again, so that a straight or folded
    start does not pass for the rule. K is taken free of unit, lengths over the characteristic length of the robot,
    and each group of loops on its own, and its rank is counted as `numerical_rank` says.

    Args:
        robot: The robot.
        q: Where to start closing the loops (nq,). `assembled` by default, or else the neutral configuration.

    Raises:
        ValueError: ``q`` is no configuration.
    """
    actuated: Mask = np.any(robot.actuation.selection, axis=1)
    assembler = Assembler(robot)
    assembly = assembler.assemble(start(robot, q))
    r, K = assembler.evaluate(assembly.q)
    nv, nc = robot.model.nv, len(r)
    rank = held = None
    if assembly.closes:
        rank, held = _generic_ranks(assembler, assembly, K, actuated)
    return Analysis(
        nq=robot.model.nq,
        nv=nv,
        nc=nc,
        rank=rank,
        mobility=None if rank is None else nv - rank,
        redundant=None if rank is None else nc - rank,
        uncontrolled=None if held is None else nv - held,
        actuated=int(actuated.sum()),
        residual=assembly.residual,
        closes=assembly.closes,
        q=assembly.q,
    )


def _generic_ranks(assembler: Assembler, closed: Assembly, K: Matrix, actuated: Mask) -> tuple[int, int]:
    """Largest rank of K, and of [K; S], found at a closed configuration and around it."""
    ranks = [_ranks(assembler, K, actuated)]
    allowed = max(10.0 * closed.residual, 1e-8)
    random = np.random.default_rng(0)
    for length in _MOVES:
        steps = [_free_step(assembler.scaled(K, group), random, length) for group in assembler.groups]
        near = assembler.assemble(assembler.moved(closed.q, assembler.groups, steps), restarts=0)
        if near.residual <= allowed:
            ranks.append(_ranks(assembler, assembler.evaluate(near.q)[1], actuated))
    return max(rank for rank, _ in ranks), max(held for _, held in ranks)


def _ranks(assembler: Assembler, K: Matrix, actuated: Mask) -> tuple[int, int]:
    """Rank of K and of [K; S]: the actuated velocities, and what K makes of the others."""
    rank, held = 0, int(actuated.sum())
    for group in assembler.groups:
        A = assembler.scaled(K, group)
        values = _singular_values(A)
        reference = values.max(initial=0.0)
        rank += numerical_rank(values, reference)
        held += numerical_rank(_singular_values(A[:, ~actuated[group.velocities]]), reference)
    return rank, held


def _singular_values(A: Matrix) -> Vector:
    return np.asarray(np.linalg.svd(A, compute_uv=False), dtype=np.float64)


def _free_step(A: Matrix, random: np.random.Generator, length: float) -> Vector:
    """A random step (n,) in the null space of A, its largest entry ``length``; zero where there is none."""
    _, values, right = np.linalg.svd(A, full_matrices=False)
    bound = right[: numerical_rank(values, values.max(initial=0.0))]
    step = random.normal(size=A.shape[1])
    free = step - bound.T @ (bound @ step)
    largest = np.abs(free).max(initial=0.0)
    return free * (length / largest) if largest > 1e-6 else np.zeros_like(free)
