"""The dimensions of a mechanism: rank and mobility of its loops, and the motions that its actuators control."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

from eurdf.array import Mask, Matrix, Vector
from eurdf.kinematics.assembly import Assembly, assembled
from eurdf.kinematics.closing import close, start
from eurdf.kinematics.finite_mobility import MobilityTest
from eurdf.kinematics.loop import LoopGroup
from eurdf.kinematics.loop_analysis import LoopAnalysis, Motion, analyze_group
from eurdf.kinematics.named import Named
from eurdf.kinematics.problem import Problem
from eurdf.kinematics.rank import norms, null_space
from eurdf.kinematics.tolerances import SOLVED
from eurdf.pinocchio.memory import working_memory

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot

# Bound of the sum of n² max(m, n) over the blocks K (m, n) of all groups: each of about twenty decompositions takes a
# few times as many multiplications, and all of them about ten seconds.
_MOST_WORK = 1e9

# Steps to further closed configurations that are analysed (rad, or characteristic lengths).
_MOVES = (0.05, 0.1, 0.2, 0.2)


@dataclass(frozen=True, slots=True, eq=False)
class Analysis:
    """Dimensions of a mechanism, of the whole and of each independent group of loops.

    Values that depend on ranks are None, or empty, if the loops do not close or if ``left_out`` is not empty.

    Attributes:
        nq: Coordinates of the spanning tree: the length of Pinocchio's configuration vector.
        nv: Number of velocities of the spanning tree.
        nc: Number of constraint rows of all closures and couplings.
        rank: Rank of the constraint Jacobian at a generic closed configuration; None if the loops do not close.
        mobility: Degrees of freedom of the closed mechanism, nv - rank; None if the loops do not close.
        redundant: Redundant constraint rows, nc - rank; None if the loops do not close.
        uncontrolled: Degrees of freedom left with every actuator held, nv - rank [K; Sᵀ]; None if the loops do not
            close. The actuators suffice if it is 0.
        actuated: Number of actuated velocities.
        controlled: Degrees of freedom that the actuators control, mobility - uncontrolled: the rank of Sᵀ on the null
            space of K; None if the loops do not close.
        dependent: Actuated velocities that depend on the others through the closures, actuated - controlled; None if
            the loops do not close. A space of torques of this dimension moves nothing and only loads the closures: if
            it is not 0, the actuation is redundant.
        dependent_actuators: Sets of names of dependent actuators: no actuator of a set can move unless another one of
            the set moves; an actuator that is alone in its set cannot move at all.
        motions: The uncontrolled motions: a basis of the null space of [K; Sᵀ], each of few joints, at ``q`` or, if q
            is singular, at a configuration near it.
        singularity: Distance to singularity at the analysed configuration: singular value number ``rank`` of K, in
            units of the characteristic length. It is the least change of K that lowers its rank (Eckart, Young, 1936),
            and 0 at a singular configuration. The smallest of all groups of loops; inf if no closure constrains,
            None without loops.
        actuation_singularity: The same for the constraint Jacobian stacked with the rows that select the actuated
            velocities, [K; Sᵀ]: 0 if the held actuators leave one more motion there.
        loops: The independent groups of loops.
        residual: Norm of the residual of all closures and couplings at the analysed configuration, the smallest found,
            m and rad.
        closes: Whether a configuration was found at which every loop is closed: each is open by at most 1e-6 (m, rad).
        q: The analysed configuration (nq,): closed, or the least open one found.
        left_out: Why the ranks were not computed though the loops close; else empty.
        infinitesimal_mobility: Degrees of freedom to first order at the analysed configuration, nv - rank of K there;
            None if the loops do not close. Above the mobility at a singular configuration.
        finite_mobility: Degrees of freedom of motions that continue from the analysed configuration, on the largest
            branch; 'unknown' if it was not decided, None if the loops do not close. Below the mobility to first order
            at a singular configuration and for a shaky structure.
        rounded_mobility: Degrees of freedom of loops that fail to close only by the rounding of numbers in the files:
            those that they have if they may be open by 'rounded_tolerance'. Else None, and if it was not decided.
        rounded_tolerance: How far open the loops may be for 'rounded_mobility', rad or characteristic lengths: ten
            times the least residual; else None.
    """

    nq: int
    nv: int
    nc: int
    rank: int | None
    mobility: int | None
    redundant: int | None
    uncontrolled: int | None
    actuated: int
    controlled: int | None
    dependent: int | None
    dependent_actuators: tuple[tuple[str, ...], ...]
    motions: tuple[Motion, ...]
    singularity: float | None
    actuation_singularity: float | None
    loops: tuple[LoopAnalysis, ...]
    residual: float
    closes: bool
    q: Vector
    left_out: str = ""
    infinitesimal_mobility: int | None = None
    finite_mobility: int | Literal["unknown"] | None = None
    rounded_mobility: int | None = None
    rounded_tolerance: float | None = None

    def __repr__(self) -> str:
        found = f"rank {self.rank}, {self.mobility} degrees of freedom, {self.uncontrolled} uncontrolled"
        if self.rank is None:
            found = self.left_out or "the loops do not close"
        return f"<Analysis: {self.nv} velocities, {self.nc} rows; {found}; residual {self.residual:.3g} m, rad>"


#: The figures that `eurdf info` and the viewer show, in this order, and what each of them counts, in few words.
FIGURES = {
    "nq": "coordinates",
    "nv": "velocities of the spanning tree",
    "nc": "constraint rows",
    "rank": "of the constraint Jacobian",
    "redundant": "redundant constraint rows, nc - rank",
    "mobility": "degrees of freedom of the closed mechanism, nv - rank",
    "actuated": "velocities",
    "uncontrolled": "degrees of freedom left with every actuator held",
    "dependent": "actuators that cannot move independently",
}


def analyze(robot: Robot, q: Named | None = None) -> Analysis:
    """Close the loops, compute ranks and mobility, and find uncontrolled motions and dependent actuators.

    rank = rank K, mobility = nv - rank, redundant = nc - rank, uncontrolled = nv - rank [K; Sᵀ], where S (nv, nu)
    selects the actuated velocities (the dimensions defined at the start of the specification).

    Ranks are those of a generic configuration: the largest ones found at the closed configuration and at some others
    around it, so a straight or folded start does not change the result. The others are small steps along the null space
    of K, closed again. K is dimensionless (lengths divided by the characteristic length of the robot); the rank of each
    group of loops is its `numerical_rank`.

    The finite mobility is that at q itself, see `LoopAnalysis.evidence`. Limits of joints are ignored.

    Args:
        robot: The robot.
        q: Where to start closing the loops (nq,). The default is the `assembled` configuration, or the neutral one.

    Raises:
        ValueError: ``q`` is not a configuration.
    """
    at = start(robot, q, "q")
    with working_memory(robot, Problem) as problem:
        return _analysis(robot, problem, assembled(problem, at, SOLVED))


def _analysis(robot: Robot, problem: Problem, assembly: Assembly) -> Analysis:
    """The dimensions where the loops are closed, or where they are the least open."""
    tree = robot.tree
    actuated: Mask = np.zeros(tree.nv, dtype=bool)
    actuated[robot.actuation.idx_v] = True
    nv, nc = tree.nv, sum(len(group.loops.rows) for group in problem.groups)
    names = tree.velocity_names
    loops: tuple[LoopAnalysis, ...] = ()
    motions: list[Motion] = []
    left_out = _left_out(problem, assembly)
    ranked = assembly.closes and not left_out
    outside: Mask = np.ones(nv, dtype=bool)
    for group in problem.groups:
        outside[group.loops.velocities] = False
    others = int(outside.sum())
    rounded = None if assembly.closes or left_out else MobilityTest(problem).rounded(assembly.q)
    if ranked:
        closures = [constraint.name for constraint in robot.constraints]
        loops = tuple(
            analyze_group(group, at, finite, actuated[group.loops.velocities], names, closures)
            for group, at, finite in zip(
                problem.groups,
                _generic_jacobians(problem, assembly.q),
                MobilityTest(problem).finite(assembly.q),
                strict=True,
            )
        )
        motions = [motion for loop in loops for motion in loop.motions]
        motions += [
            Motion((names[velocity],), np.array([velocity]), np.ones(1), assembly.q)
            for velocity in np.flatnonzero(outside & ~actuated).tolist()
        ]
    count = int(actuated.sum())
    rank = sum(loop.rank for loop in loops)
    return Analysis(
        nq=tree.nq,
        nv=nv,
        nc=nc,
        rank=rank if ranked else None,
        mobility=nv - rank if ranked else None,
        redundant=nc - rank if ranked else None,
        uncontrolled=len(motions) if ranked else None,
        actuated=count,
        controlled=nv - rank - len(motions) if ranked else None,
        dependent=count - (nv - rank - len(motions)) if ranked else None,
        dependent_actuators=tuple(together for loop in loops for together in loop.dependent_actuators),
        motions=tuple(motions),
        singularity=min((loop.singularity for loop in loops), default=None),
        actuation_singularity=min((loop.actuation_singularity for loop in loops), default=None),
        loops=loops,
        residual=assembly.residual,
        closes=assembly.closes,
        q=assembly.q,
        left_out=left_out,
        infinitesimal_mobility=others + sum(loop.infinitesimal_mobility for loop in loops) if ranked else None,
        finite_mobility=_sum_of_finite(others, loops) if ranked else None,
        rounded_mobility=None if rounded is None else others + rounded[0],
        rounded_tolerance=None if rounded is None else 10.0 * rounded[1],
    )


def _sum_of_finite(others: int, loops: Sequence[LoopAnalysis]) -> int | Literal["unknown"]:
    """Finite mobility of the robot: that of all loops, and the velocities outside of them."""
    total = others
    for loop in loops:
        if loop.finite_mobility == "unknown":
            return "unknown"
        total += loop.finite_mobility
    return total


def _left_out(problem: Problem, assembly: Assembly) -> str:
    """Why no ranks are computed, if that would take too long; else empty."""
    given_up, groups = assembly.reason == "not decided", [each.loops for each in problem.groups]
    if not given_up and not (assembly.closes and sum(map(_work, groups)) > _MOST_WORK):
        return ""
    group = max(groups, key=_work)
    what = "ranks were not computed" if assembly.closes else "it was not computed whether the loops can be closed"
    return (
        f"{what}: the loops that share joints with that of '{assembly.open[group.closures[0]].name}' have "
        f"{len(group.rows):,} constraint rows on {len(group.velocities):,} velocities"
    )


def _work(group: LoopGroup) -> float:
    m, n = len(group.rows), len(group.velocities)
    return float(n) * n * max(m, n)


def _generic_jacobians(problem: Problem, q: Vector) -> list[list[tuple[Vector, Matrix]]]:
    """For each group a closed configuration (nq,) and some around it, each with the dimensionless block of K (m, n)."""
    groups = problem.groups
    open_by = [norms(group.residual(q[None]))[0] for group in groups]
    found = [[(q, group.jacobian_at(q[None])[0])] for group in groups]
    bases = [null_space(blocks[0][1]) for blocks in found]
    for number, length in enumerate(_MOVES):
        steps = [_free_step(basis, number, length)[None] for basis in bases]
        near = close(problem, problem.moved(q[None], groups, steps)).q
        for group, blocks, error in zip(groups, found, open_by, strict=True):
            if norms(group.residual(near))[0] <= max(10.0 * error, 1e-8):
                blocks.append((near[0], group.jacobian_at(near)[0]))
    return found


def _free_step(basis: Matrix, number: int, length: float) -> Vector:
    """A generic step (n,) in the span of ``basis`` whose largest entry is ``length``; zero if the span is empty.

    Each number gives another direction. It is as good as random: sin(k²) has no pattern. To import `numpy.random` takes
    a twelfth of the time that importing Pinocchio takes.
    """
    n = basis.shape[1]
    free = np.asarray(np.sin(np.arange(1 + number * n, 1 + (number + 1) * n) ** 2) @ basis.T @ basis)
    largest = np.abs(free).max(initial=0.0)
    return free * (length / largest) if largest > 1e-6 else np.zeros_like(free)
