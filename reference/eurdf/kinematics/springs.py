"""Force and energy of the springs of a robot's joints, and the closed configuration at which they store the least.

The public names are those of `eurdf.springs`.
"""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from eurdf.array import Indices, Matrix, Vector
from eurdf.kinematics.closing import close
from eurdf.kinematics.named import Named, configuration_of
from eurdf.kinematics.problem import Problem
from eurdf.kinematics.rank import numerical_rank
from eurdf.kinematics.residual import drift_of_pairs, residual_and_jacobian
from eurdf.kinematics.tolerances import LONGEST_MOTION, MOST_CORRECTION

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot

# A Newton step below this (rad, or characteristic lengths) is the last one: its error is about its square.
_LAST_STEP = 1e-6
# Energy that a step must save, relative to what its slope promises.
_SAVED = 1e-4
# Stiffness along a motion, relative to the largest one, below which no spring acts on it. If each motion deflects the
# springs by less than this fraction of it, none acts: what is left is rounding.
_SLACK = 1e-9
_SHORTEST_STEP = 2.0**-20


def spring_force(robot: Robot, q: Named) -> Vector:
    """Generalized force of the springs (EU-JNT-035).

    A spring with the stiffness k on a coordinate c has the force -k (c - rest). That of a mimic joint acts on its
    leader, multiplied by the multiplier.

    Args:
        robot: The robot.
        q: Configuration (nq,).

    Returns:
        The force (nv,), N·m and N; zero where there is no spring.

    Raises:
        ValueError: ``q`` has a wrong shape or is not finite.
    """
    return robot.tree.springs.force(configuration_of(robot, q), robot.tree.nv)


def spring_energy(robot: Robot, q: Named) -> float:
    """Energy that the springs store, Σ ½ k (c - rest)², J.

    Args:
        robot: The robot.
        q: Configuration (nq,).

    Raises:
        ValueError: ``q`` has a wrong shape or is not finite.
    """
    return robot.tree.springs.energy(configuration_of(robot, q))


class Resting(NamedTuple):
    """Joints whose springs are at rest.

    Attributes:
        joints: Their names.
        coordinates: Indices in q of all their coordinates.
        velocities: Indices in v of all their velocities.
        values: Their coordinates at rest, rad or m.
    """

    joints: tuple[str, ...]
    coordinates: Indices
    velocities: Indices
    values: Vector


def joints_at_rest(robot: Robot, given: Indices) -> Resting | None:
    """The joints with springs, but for given ones (indices in v), at the coordinates where no spring stores energy.

    None if there are none, if a joint has springs on some of its coordinates only, or if two springs act on one.
    """
    held = set(given.tolist())
    free = [each for each in robot.cached(_sprung) or () if each[2][0] not in held]
    if not free:
        return None
    names, coordinates, velocities, values = zip(*free, strict=True)
    chain = itertools.chain.from_iterable
    return Resting(
        names,
        np.fromiter(chain(coordinates), np.intp),
        np.fromiter(chain(velocities), np.intp),
        np.fromiter(chain(values), float),
    )


def _sprung(robot: Robot) -> list[tuple[str, list[int], list[int], list[float]]] | None:
    """Each joint with springs as in `Resting`; None as for `joints_at_rest`."""
    springs = robot.tree.springs
    velocities = springs.idx_v.tolist()
    found = []
    for name, slot in robot.slots.items():
        own = [index for index, velocity in enumerate(velocities) if slot.idx_v <= velocity < slot.idx_v + slot.nv]
        if own and (slot.nq != slot.nv or sorted(velocities[index] - slot.idx_v for index in own) != [*range(slot.nv)]):
            return None
        if own:
            with np.errstate(all="ignore"):
                rest = -springs.shift[own] / springs.ratio[own]
            if not np.isfinite(rest).all():  # of a mimic joint that does not move with its leader
                return None
            found.append((name, springs.idx_q[own].tolist(), springs.idx_v[own].tolist(), rest.tolist()))
    return found


def spring_equilibrium(robot: Robot, q: Vector, coordinates: Indices, problem: Problem, tolerance: float) -> Vector:
    """A local minimum of the energy of the springs, on the branch of a closed configuration.

    Newton's method in the motions z that keep the loops closed and the held joints still: with K F = 0, the energy has
    the gradient Fᵀ g and the Hessian Fᵀ k F - λᵀ K̇ F, where g is the gradient by the velocities and Kᵀ λ its part that
    the loops and the held joints bear. No other force acts, so that a spring is at rest wherever the loops allow it.
    Motions that no spring acts on are minimal.

    Args:
        robot: The robot.
        q: Configuration (nq,), closed.
        coordinates: Indices in q of the joints that are held.
        problem: The robot with these joints given.
        tolerance: Bound of each row of the residual for closed loops, m or rad.
    """
    tree, spaces, springs, held = robot.tree, problem.spaces, robot.tree.springs, problem.given
    root = np.sqrt(springs.stiffness)
    least = (_SLACK * (root * np.abs(springs.ratio) * spaces.scale[springs.idx_v]).max(initial=0.0)) ** 2
    while True:
        _, K = residual_and_jacobian(robot, q)
        F = _motions(spaces.at(K).basis, held, spaces.scale)
        A = (root * springs.ratio)[:, None] * F[springs.idx_v]
        gradient = A.T @ (root * springs.deflection(q))
        stiffness = A.T @ A
        largest = float(np.diagonal(stiffness).max(initial=0.0))
        if not largest > least:
            return q
        values, axes = np.linalg.eigh(stiffness + _curvature(robot, q, K, held, F, spaces.scale))
        acting = np.abs(values) > _SLACK * largest
        # With the absolute values, the step leads downhill also where the energy is not convex. Each axis has its own
        # bound: along one that springs hardly act on, such as the spin of a rod, the step is long and saves little.
        axes = axes[:, acting]
        bound = LONGEST_MOTION / np.abs((F @ axes) / spaces.scale[:, None]).max(axis=0)
        z = -axes @ np.clip((axes.T @ gradient) / np.abs(values[acting]), -bound, bound)
        v = F @ z
        size, length = float(np.abs(v / spaces.scale).max(initial=0.0)), float(np.linalg.norm(v / spaces.scale))
        last = size <= _LAST_STEP
        step = min(1.0, LONGEST_MOTION / size) if size else 1.0
        energy, slope = springs.energy(q), float(gradient @ z)
        while True:
            expected = tree.integrate(q, step * v)
            expected[coordinates] = q[coordinates]
            closed = close(problem, expected[None], tolerance)
            there = closed.q[0]
            corrected = float(np.linalg.norm(tree.difference(expected, there) / spaces.scale))
            near = closed.closes[0] and (corrected <= MOST_CORRECTION * step * length or last)
            if near and (last or springs.energy(there) <= energy + _SAVED * step * slope):
                q = there
                break
            step *= 0.5
            if step < _SHORTEST_STEP:
                return q
        if last:
            return q


def _motions(Z: Matrix, held: Indices, scale: Vector) -> Matrix:
    """Those of the motions Z (nv, f) that hold the held joints, orthonormal in the units of the velocities."""
    _, values, right = np.linalg.svd(Z[held] / scale[held, None])
    rank = numerical_rank(values)
    return np.asarray(scale[:, None] * np.linalg.qr((Z @ right[rank:].T) / scale[:, None])[0])


def _curvature(robot: Robot, q: Vector, K: Matrix, held: Indices, F: Matrix, scale: Vector) -> Matrix:
    """-λᵀ K̇ along pairs of motions: what the bending of the closed configurations adds to the Hessian."""
    rows = np.vstack([K, np.eye(robot.tree.nv)[held]])
    lambdas = np.linalg.lstsq((rows * scale).T, -scale * robot.tree.springs.force(q, robot.tree.nv), rcond=None)[0]
    return -np.tensordot(lambdas[: len(K)], drift_of_pairs(robot, q, F), axes=1)
