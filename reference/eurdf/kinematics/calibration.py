"""Offsets of encoders and positions of rod ends, from readings of more encoders than the closed mechanism has motions.

At each sample, with p the unknown positions, o the offsets and y the readings, r(q, p) = 0 and y = E q + o + noise.
The loops leave q the free motions Z z, K Z = 0. A Gauss-Newton step linearizes both equations:

    ∂q = -K⁺ (r + P ∂p) + Z ∂z,    P = ∂r/∂p,
    y - E q - o = E ∂q + ∂o,

and Q, which projects out E Z, eliminates ∂z: Q (O ∂o - E K⁺ P ∂p) = Q (y - E q - o + E K⁺ r). Redundant rows of K also
require (1 - K K⁺) (r + P ∂p) = 0: without this, the loops do not close.

Source: Hollerbach, Wampler, *The calibration index and taxonomy for robot kinematic calibration methods*, 1996, for
closed loops; the elimination is that of separable least squares.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from eurdf.array import Indices, Matrix, Vector
from eurdf.closures.se3 import transposed
from eurdf.diagnostics.wording import quoted
from eurdf.errors import NotClosable
from eurdf.kinematics import batch
from eurdf.kinematics.closing import start
from eurdf.kinematics.evaluate import Evaluator, many_tree
from eurdf.kinematics.finite import finite, overflow_refused
from eurdf.kinematics.named import Named, require_names, unknown_joint, vector_of
from eurdf.kinematics.rank import numerical_rank, singular_values, times
from eurdf.kinematics.residual import all_openings
from eurdf.kinematics.tangent_space import TangentSpaces
from eurdf.mechanism.constraint import Closure
from eurdf.pinocchio.arguments import as_names, checked_array
from eurdf.pinocchio.frames import placement_of
from eurdf.pinocchio.robot import Robot, build_robot

if TYPE_CHECKING:
    from eurdf.mechanism.mechanism import Mechanism

_MOST_GAUSS_NEWTON = 50
# The steps end after one below this, dimensionless.
_LAST_STEP = 1e-10
# A parameter is identifiable if its share in the combinations that the readings do not show is below this.
_HIDDEN = 3e-6


#: Readings (n,) of encoders by joint.
Readings = Mapping[str, Any]


class Calibration(NamedTuple):
    """The result of `calibrate`.

    Attributes:
        robot: The robot with the rod ends that were found, without geometry.
        offsets: By joint, what its encoder reads at 0, rad or m.
        ends: By rod end, ``CLOSURE/a`` or ``CLOSURE/b``, its position (3,) in the axes of its link, m.
        parameters: Names of the parameters (p,): joints, and the coordinates ``CLOSURE/a x``, ``… y`` and ``… z``.
        unidentifiable: Those of them that the readings do not show. They have no covariance; they are changed only
            together with others, as little as possible.
        covariance: Of the parameters (p, p), rad² and m²; NaN in rows and columns of those, and 0 of coordinates that
            redundant rows of the loops decide, such as one across a planar loop.
        deviation: Estimated standard deviation of a reading, as a multiple of ``deviations``: without these in rad, or
            in characteristic lengths. NaN if there are no more readings than unknowns.
        q: The configuration of each sample (n, nq), closed.
        remaining: Reading minus position and offset (n, k), rad and m, in the order of the samples' joints.
    """

    robot: Robot
    offsets: dict[str, float]
    ends: dict[str, Vector]
    parameters: tuple[str, ...]
    unidentifiable: tuple[str, ...]
    covariance: Matrix
    deviation: float
    q: Matrix
    remaining: Matrix

    def __repr__(self) -> str:
        hidden = quoted(self.unidentifiable, 4) or "none"
        return f"<Calibration: {len(self.parameters)} parameters, rad and m; not identifiable: {hidden}>"


class _Encoders(NamedTuple):
    """Encoders of k joints with one velocity.

    Attributes:
        readings: (n, k), rad and m.
        slots: Of each joint its indices in q and v.
        idx_v: (k,).
        weights: 1 over the deviations (k,), dimensionless.
        offset_of: Which offsets (k, o) are those of which encoders, 0 or 1.
    """

    readings: Matrix
    slots: Sequence[Any]
    idx_v: Indices
    weights: Vector
    offset_of: Matrix

    def remaining(self, q: Matrix, offsets: Vector) -> Matrix:
        """Readings minus positions and offsets (n, k); angles that q has as (cos, sin) in [-π, π]."""
        found = np.empty_like(self.readings)
        for column, slot in enumerate(self.slots):
            own = q[:, slot.idx_q : slot.idx_q + slot.nq].T
            e = self.readings[:, column] - (own[0] if slot.nq == 1 else np.arctan2(own[1], own[0]))
            e -= self.offset_of[column] @ offsets
            found[:, column] = e if slot.nq == 1 else (e + np.pi) % (2.0 * np.pi) - np.pi
        return found


@overflow_refused("the calibration")
def calibrate(
    robot: Robot,
    samples: Readings,
    unknown: str | Sequence[str],
    *,
    deviations: Mapping[str, float] | None = None,
    q0: Named | None = None,
) -> Calibration:
    """Offsets of encoders and positions of rod ends that explain the readings best, by least squares.

    The readings must be redundant: of more joints than the closed mechanism has motions, such as of motors and of the
    joints that they move, or of more motors than motions. (Also a robot `with_contacts` has fewer motions.)

    Args:
        robot: The robot, with its nominal dimensions.
        samples: By joint, the readings (n,) of its encoder at n poses: position + offset + noise, rad or m. Joints have
            one velocity; those that are not named have no encoder.
        unknown: A joint of the samples for the offset of its encoder; ``CLOSURE/a`` or ``CLOSURE/b`` for the position
            of the origin of frame A or B of a closure in its link.
        deviations: By joint, the standard deviation of its readings, rad or m. By default all are equally precise: 1
            rad as 1 characteristic length, and the precision is estimated from what remains of the readings.
        q0: Where to start (nq,): it determines the branch of the samples. The default is as in `forward_kinematics`.

    Raises:
        ValueError: An argument does not fit the robot, or no parameters were found that fit the readings.
        NotClosable: A sample cannot be reached from q0, or its loops do not close with the parameters that were found.
    """
    encoders, joints, ends = _arguments(robot, samples, unknown, deviations)
    spaces, tree = robot.cached(TangentSpaces), many_tree(robot)
    q = _first(robot, encoders, list(samples), q0)
    anchors = {f"{each.name}/{side}": getattr(each, side) for each in robot.mechanism.closures for side in "ab"}
    offsets, positions = np.zeros(len(joints)), np.array([anchors[end].pose.xyz for end in ends]).reshape(-1, 3)
    unit = _units(spaces, encoders, ends)
    for _ in range(_MOST_GAUSS_NEWTON):
        mechanism = _with_ends(robot.mechanism, ends, positions)
        step = _GaussNewton(robot, mechanism, ends, q, encoders, offsets)
        q = tree.normalized(tree.integrate(q, step.q))
        offsets = offsets + (step.parameters * unit)[: len(joints)]
        positions = positions + (step.parameters * unit)[len(joints) :].reshape(-1, 3)
        size = max(np.abs(each).max(initial=0.0) for each in (step.parameters, step.q / spaces.scale))
        if not size > _LAST_STEP:
            break
    else:
        raise ValueError(
            f"no parameters were found that fit the readings: after {_MOST_GAUSS_NEWTON} steps they still change by "
            f"{size:.2g} (rad, or characteristic lengths); check the readings, or start nearer to the dimensions"
        )
    found = build_robot(_with_ends(robot.mechanism, ends, positions), geometry=False)
    for index, each in enumerate(q):
        openings = all_openings(found, each)
        if any(opening.is_open for opening in openings):
            raise NotClosable(f"sample {index} does not close the loops with the parameters found", openings, each)
    names = (*joints, *(f"{end} {axis}" for end in ends for axis in "xyz"))
    remaining = encoders.remaining(q, offsets)
    freedom = remaining.size - step.unknowns
    square = float(((encoders.weights * remaining) ** 2).sum())
    deviation = float(np.sqrt(square / freedom)) if freedom > 0 else np.nan
    covariance = step.covariance * np.outer(unit, unit) * (deviation**2 if deviations is None else 1.0)
    covariance[step.hidden], covariance[:, step.hidden] = np.nan, np.nan
    hidden = tuple(names[each] for each in np.flatnonzero(step.hidden))
    by_joint, by_end = dict(zip(joints, offsets.tolist(), strict=True)), dict(zip(ends, positions, strict=True))
    return Calibration(found, by_joint, by_end, names, hidden, covariance, deviation, q, remaining)


class _GaussNewton:
    """A Gauss-Newton step.

    Attributes:
        parameters: Change of the parameters (p,), dimensionless.
        q: Change of the configurations (n, nv), rad and m.
        unknowns: Number of unknowns that the readings determine.
        hidden: Which parameters (p,) they do not determine.
        covariance: That (p, p) of the parameters, for readings with deviations of 1, dimensionless.
    """

    def __init__(
        self, robot: Robot, mechanism: Mechanism, ends: Sequence[str], q: Matrix, encoders: _Encoders, offsets: Vector
    ) -> None:
        spaces, at_v, w = robot.cached(TangentSpaces), encoders.idx_v, encoders.weights[:, None]
        unit = _units(spaces, encoders, ends)
        constraints = Evaluator(robot.tree, mechanism.constraints, np.arange(robot.tree.nv), few=False)
        at = constraints.at(q)
        r, K = np.array(constraints.residual(at)), constraints.jacobian(at)
        P = np.concatenate((np.zeros((*r.shape, len(offsets))), _by_ends(mechanism, constraints, at, ends)), axis=2)
        P *= unit
        finite("the residual and its derivatives", r, K, P)
        e, (n, k) = encoders.remaining(q, offsets), encoders.readings.shape
        own = np.concatenate((encoders.offset_of, np.zeros((k, len(unit) - len(offsets)))), axis=1) * unit
        W, b, bases = np.empty((n, k, len(unit))), np.empty((n, k)), []
        fixed, missed, back = np.empty_like(P), np.empty_like(r), np.empty((n, *K.shape[:0:-1]))
        self.unknowns = 0
        for space in spaces.each(K):
            for index, Z, inverse in zip(space.which, space.free, space.inverse, strict=True):
                back[index] = inverse
                fixed[index] = spaces.row_scale[:, None] * (P[index] - K[index] @ (inverse @ P[index]))
                missed[index] = spaces.row_scale * (r[index] - K[index] @ (inverse @ r[index]))
                W[index] = w * (own - (inverse @ P[index])[at_v])
                b[index] = w[:, 0] * (e[index] + (inverse @ r[index])[at_v])
                left, values, right = np.linalg.svd(w * Z[at_v], full_matrices=False)
                rank = numerical_rank(values, float(np.linalg.norm(w[:, 0] * spaces.scale[at_v])))
                self.unknowns += rank
                bases.append((index, Z @ right[:rank].T / values[:rank], left[:, :rank]))
        shown, seen = W.copy(), b.copy()
        for index, _, left in bases:
            shown[index] -= left @ (left.T @ W[index])
            seen[index] -= left @ (left.T @ b[index])
        # Of the parameters, the least change that redundant rows require, and a basis of those that they leave free.
        left, values, right = np.linalg.svd(fixed.reshape(-1, len(unit)), full_matrices=False)
        rank = numerical_rank(values, float(np.linalg.norm(spaces.row_scale[:, None] * P)))
        required = -right[:rank].T @ ((left[:, :rank].T @ missed.ravel()) / values[:rank])
        free = _complement(right[:rank])
        A = shown.reshape(-1, len(unit))
        left, values, right = np.linalg.svd(A @ free, full_matrices=False)
        rank = numerical_rank(values, float(np.linalg.norm(W)))
        self.unknowns += rank
        along = free @ right[:rank].T / values[:rank]
        self.parameters = required + along @ (left[:, :rank].T @ (seen.ravel() - A @ required))
        self.covariance = along @ along.T
        self.hidden = np.linalg.norm(free @ _complement(right[:rank]), axis=1) > _HIDDEN
        self.q = -times(back, r + P @ self.parameters)
        for index, Z, left in bases:
            self.q[index] += Z @ (left.T @ (b[index] - W[index] @ self.parameters))


def _units(spaces: TangentSpaces, encoders: _Encoders, ends: Sequence[str]) -> Vector:
    """Units (p,) of the parameters: 1 rad, or a characteristic length."""
    return np.concatenate((spaces.scale[encoders.idx_v] @ encoders.offset_of, np.full(3 * len(ends), spaces.length)))


def _complement(rows: Matrix) -> Matrix:
    """Orthonormal basis (n, n - m) of what is orthogonal to orthonormal rows (m, n)."""
    _, _, right = np.linalg.svd(rows, full_matrices=True)
    return np.asarray(right[len(rows) :].T)


def _arguments(
    robot: Robot, samples: Readings, unknown: str | Sequence[str], deviations: Mapping[str, float] | None
) -> tuple[_Encoders, list[str], list[str]]:
    """The encoders, the joints with unknown offsets, and the rod ends."""
    if not isinstance(samples, Mapping) or not samples:
        raise ValueError("samples must map names of joints to readings (n,); expected at least one joint")
    for name in samples:
        if name not in robot.slots:
            raise ValueError(f"samples: {unknown_joint(robot, name)}")
        if robot.slots[name].nv != 1:
            raise ValueError(f"samples: joint '{name}' has {robot.slots[name].nv} velocities; give joints with one")
    count = max(1, np.size(next(iter(samples.values()))))
    readings = np.array([checked_array(f"samples['{name}']", each, (count,)) for name, each in samples.items()]).T
    slots = [robot.slots[name] for name in samples]
    idx_v = np.array([slot.idx_v for slot in slots])
    names = list(dict.fromkeys(as_names(unknown)))
    possible = [f"{each.name}/{side}" for each in robot.mechanism.closures for side in "ab"]
    require_names(names, [*samples, *possible], "unknown")
    if not names:
        raise ValueError("unknown is empty; name joints of the samples, or ends such as 'CLOSURE/a'")
    joints = [name for name in names if name in samples]
    scale = robot.cached(TangentSpaces).scale[idx_v]
    if deviations is not None:
        scale = vector_of(deviations, list(samples), "deviations")
        if not (scale > 0.0).all():
            raise ValueError(
                f"deviations[{int(scale.argmin())}] is {scale.min()}; expected positive numbers, of all joints"
            )
    offset_of = np.array([[float(name == joint) for joint in joints] for name in samples]).reshape(len(samples), -1)
    ends = [name for name in names if name not in joints]
    return _Encoders(readings, slots, idx_v, 1.0 / scale, offset_of), joints, ends


def _first(robot: Robot, encoders: _Encoders, names: Sequence[str], q0: Named | None) -> Matrix:
    """Configurations (n, nq) at which as many joints are at their readings as can move independently."""
    near = start(robot, q0)
    spaces = robot.cached(TangentSpaces)
    constraints = Evaluator(robot.tree, robot.constraints, np.arange(robot.tree.nv), few=False)
    Z = spaces.at(constraints.jacobian(constraints.at(near[None]))[0]).free / spaces.scale[:, None]
    rest, chosen = Z[encoders.idx_v], []
    for _ in range(numerical_rank(singular_values(rest), 1.0) if rest.size else 0):
        chosen.append(int(np.linalg.norm(rest, axis=1).argmax()))
        along = rest[chosen[-1]] / np.linalg.norm(rest[chosen[-1]])
        rest = rest - np.outer(rest @ along, along)
    if not chosen:
        raise ValueError(f"samples: the loops let none of {quoted(names, 4)} move")
    given = {names[each]: encoders.readings[:, each] for each in chosen}
    found = batch.forward_kinematics(robot, given, near)
    for index, reason in enumerate(found.reason):
        if reason is not None:
            text = f"sample {index} cannot be reached from q0 with the readings of {quoted(tuple(given), 4)} ({reason})"
            raise NotClosable(text, all_openings(robot, found.q[index]), found.q[index])
    return np.array(found.q)


def _with_ends(mechanism: Mechanism, ends: Sequence[str], positions: Matrix) -> Mechanism:
    """The mechanism with rod ends at positions (e, 3) in their links."""
    closures: dict[str, Closure] = {each.name: each for each in mechanism.closures}
    for end, position in zip(ends, positions.tolist(), strict=True):
        name, _, side = end.rpartition("/")
        anchor = getattr(closures[name], side)
        moved = replace(anchor, pose=replace(anchor.pose, xyz=tuple(position)), frame="")
        closures[name] = replace(closures[name], **{side: moved})
    return replace(mechanism, closures=tuple(closures.values()))


def _by_ends(mechanism: Mechanism, constraints: Evaluator, at: Any, ends: Sequence[str]) -> Matrix:
    """The derivative (n, nc, 3 e) of the residual by the positions of rod ends in their links."""
    found = np.zeros((len(at.q), constraints.m, 3 * len(ends)))
    index_of = {each.name: index for index, each in enumerate(mechanism.constraints)}
    for group, poses in zip(constraints.groups, at.by_kind, strict=True):
        members = np.arange(len(index_of))[group.members].tolist()
        by_position = group.kind.jacobian(poses, group.fixed)[..., :3]
        rows = np.arange(constraints.m)[group.rows].reshape(len(members), -1)
        for column, end in enumerate(ends):
            name, _, side = end.rpartition("/")
            if index_of[name] in members:
                which, anchor = members.index(index_of[name]), getattr(mechanism.constraints[index_of[name]], side)
                turn = transposed(placement_of(anchor.pose).rotation)  # from the link to the frame
                turn = -turn if side == "a" else poses.rotation[:, which] @ turn
                found[:, rows[which], 3 * column : 3 * column + 3] = by_position[:, which] @ turn
    return found
