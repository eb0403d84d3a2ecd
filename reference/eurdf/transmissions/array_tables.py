"""The tables of an array map, and the Python file that contains it with them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from importlib.resources import files
from itertools import product
from typing import Any

import numpy as np

from eurdf.array import Matrix, Vector
from eurdf.closures.se3 import quaternion_exp, rotation_of
from eurdf.kinematics.loop import find_loops
from eurdf.kinematics.scale import row_scale
from eurdf.kinematics.tangent_space import TangentSpaces
from eurdf.kinematics.tolerances import SAME
from eurdf.mechanism.pose import IDENTITY, Pose, X, Y, Z, cross
from eurdf.transmissions.array_kernel import ArrayMap
from eurdf.transmissions.drive import SINGULAR, Drive
from eurdf.transmissions.first_guess import LARGER, WorkspacePoses, fitted, sign_of
from eurdf.transmissions.generated_source import GeneratedSource, checked_prefix
from eurdf.transmissions.reachable_set import Workspace
from eurdf.transmissions.tables import ConstraintNumbers, Screw, Tables

# Newton steps, at least and at most; motors that are farther from those of a pose, rad or m, are at another one.
_FEWEST, _MOST, _APART = 2, 6, 1e-6
# Number of half-spaces at most, and of directions that each is chosen of, about; how deep, relative to the range of
# each joint, a point may be inside before they are moved inwards.
_HALF_SPACES, _DIRECTIONS, _DEEP = 64, 81, 0.01

# What follows the copy of the kernel in a file.
_END = '''

_TABLES: dict[str, Any] = {
$ROWS}


def array_map(xp: Any) -> ArrayMap:
    """The map in a namespace of the array API, such as `numpy`, `jax.numpy` or `torch`."""
    return ArrayMap(xp, _TABLES)
'''


def array_tables(drive: Drive, poses: WorkspacePoses) -> dict[str, Any]:
    """The tables of `eurdf.transmissions.array_kernel.ArrayMap`: plain numbers, lists and texts.

    Args:
        drive: By the joints.
        poses: The poses of the workspace.

    Raises:
        ValueError: The polynomials, a constraint, or a joint is not possible there.
    """
    n, m = len(drive.given), len(drive.asked)
    if n != m:
        raise ValueError(f"arrays are of as many motors as joints; here {n} joints have {m} motors")
    samples, missing = poses.samples(drive)
    if samples is None:
        raise ValueError(f"arrays need polynomials over the workspace: {missing}")
    made, space = Tables(drive.robot, [drive]), poses.within
    own = [made.velocity[v] for v in drive.own.tolist()]
    motions = _coordinates(made, own, samples.motions * drive.unit)
    coefficients, error = fitted(samples, motions / drive.unit)
    numbers = [made.numbers(drive.robot.constraints[index]) for index in made.constraints]
    at, given = made.pose(samples.reference), [made.velocity[v] for v in drive.given.velocities.tolist()]
    arrays = [np.eye(3).tolist(), (coefficients * drive.unit).T.tolist()]
    screws, place = _screws(made, at, arrays)
    start = [at[k] if k >= 0 else 0.0 for k in made.coordinates]
    tables: dict[str, Any] = {
        "joints": list(drive.given.names),
        "motors": list(drive.asked.names),
        "lower": samples.lower.tolist(),
        "upper": samples.upper.tolist(),
        "degree": round(len(coefficients) ** (1.0 / n)) - 1,
        "arrays": arrays,
        "coefficients": 1,
        "sign": sign_of(drive.derivative(samples.reference)),
        "start": start,
        "given": given,
        "asked": [made.velocity[v] for v in drive.asked.velocities.tolist()],
        "own": own,
        "screws": screws,
        "constraints": [_constraint(each, place, arrays) for each in numbers],
        **_half_spaces(space),
    }
    x = [value + np.zeros(len(samples.q)) for value in start]
    for velocities, values in ((given, samples.positions), (own, np.array(start)[own] + motions)):
        for velocity, column in zip(velocities, values.T, strict=True):
            x[velocity] = column
    tables["blocks"] = list(_blocks(drive, made, tables, x))
    wider = {velocity: block["wider"] for block in tables["blocks"] for velocity in block["own"]}
    tables["errors"] = [LARGER * error * made.units[v] * wider.get(v, 1.0) + SAME for v in own]
    return _exact(tables, drive, np.concatenate((samples.q, space.q)))


def python_source(drive: Drive, poses: WorkspacePoses, prefix: str | None) -> GeneratedSource:
    """The file; see `eurdf.transmissions.prepared.PreparedTransmission.python_source`."""
    name, tables = checked_prefix(prefix, drive.robot), array_tables(drive, poses)
    kernel = (files("eurdf.transmissions") / "array_kernel.py").read_text(encoding="utf-8")
    rows = "".join(f"    {key!r}: {value!r},\n" for key, value in tables.items())
    return GeneratedSource({f"{name}.py": f"{kernel}{_END}".replace("$ROWS", rows).encode()})


def _screws(made: Tables, at: Sequence[float], arrays: list[Any]) -> tuple[list[dict[str, Any]], list[list[int]]]:
    """The joints, and of each of the tables its numbers here: a ball is three joints about the axes of a pose."""
    found: list[dict[str, Any]] = []
    place: list[list[int]] = [[0]]
    for screw in made.joints:
        parent, place_here = place[screw.parent][-1], []
        steps = [screw]
        if screw.ball:
            x, y, z, w = at[screw.coordinate : screw.coordinate + 4]
            turned = screw.pose * Pose(quaternion=(x, y, z, w))
            frames = zip((turned, IDENTITY, IDENTITY), (X, Y, Z), strict=True)
            steps = [
                screw._replace(pose=pose, axis=axis, turns=True, velocity=screw.velocity + k)
                for k, (pose, axis) in enumerate(frames)
            ]
        for step in steps:
            found.append(_screw(step, parent, arrays))
            parent = len(found)
            place_here.append(parent)
        place.append(place_here)
    return found, place


def _screw(screw: Screw, parent: int, arrays: list[Any]) -> dict[str, Any]:
    R, K = _rotation(screw.pose), np.array([cross(screw.axis, each) for each in (X, Y, Z)]).T * screw.turns
    # Rodrigues: the rotation is I + K², -K² times the cosine, and K times the sine.
    rows = [(R @ each).T for each in (np.eye(3) + K @ K, -K @ K, K)]
    rows += [R @ screw.axis * screw.turns, R @ screw.advance, np.array(screw.pose.xyz)]
    arrays.append(np.vstack(rows).tolist())
    return {
        "parent": parent,
        "coordinate": screw.velocity,
        "multiplier": screw.multiplier,
        "offset": screw.offset,
        "vectors": len(arrays) - 1,
    }


def _rotation(pose: Pose) -> Matrix:
    return np.array([pose.rotate(axis) for axis in (X, Y, Z)]).T


def _constraint(own: ConstraintNumbers, place: Sequence[Sequence[int]], arrays: list[Any]) -> dict[str, Any]:
    """A constraint; the last vector of each end is its point, those before its axes."""
    ends, vectors = [place[joint][-1] for joint, _ in own.ends], []
    for (_, pose), axes in zip(own.ends, (own.across, own.axes[1:]), strict=True):
        R = _rotation(pose)
        directions = {"frame": R.T, "hinge": np.array(axes) @ R.T}.get(own.kind, np.zeros((0, 3)))
        vectors.append(len(arrays))
        arrays.append(np.vstack((directions, pose.xyz)).tolist())
    path = [(joint, factor) for number, factor in own.path for joint in place[number]]
    return {"kind": own.kind, "joints": ends, "vectors": vectors, "length": own.length, "path": path}


def _coordinates(made: Tables, own: Sequence[int], motions: Matrix) -> Matrix:
    """Motions (N, k), rad or m, with angles about the three moving axes in place of the rotation vectors of balls."""
    found = np.array(motions)
    for k, velocity in enumerate(own):
        if made.coordinates[velocity] == -1:
            R = rotation_of(quaternion_exp(motions[:, k : k + 3]))
            found[:, k] = np.arctan2(-R[:, 1, 2], R[:, 2, 2])
            found[:, k + 1] = np.arcsin(np.clip(R[:, 0, 2], -1.0, 1.0))
            found[:, k + 2] = np.arctan2(-R[:, 0, 1], R[:, 0, 0])
    return found


def _blocks(drive: Drive, made: Tables, tables: dict[str, Any], x: Sequence[Vector]) -> Iterator[dict[str, Any]]:
    """For each group of loops that closes without the others, as many rows and coordinates as are independent.

    Coordinates that are left out, such as the spin of a rod, are where the polynomials lead. The others then may be
    farther from there, by a factor ``wider``. The coordinates x, (N,) each, are those of the workspace.
    """
    kernel = ArrayMap(np, tables)
    found = kernel.constraint_rows(kernel.constants(x[0]), x)
    scale = row_scale(drive.robot, drive.robot.cached(TangentSpaces).length)
    loops = find_loops(drive.robot)
    first = np.cumsum([0, *(len(r) for r, _ in found)]).tolist()
    for group in drive.groups:
        own = [made.velocity[v] for v in group.velocities.tolist()]
        units = np.array([made.units[v] for v in own])
        A = np.zeros((len(x[0]), 0, len(own)))
        rows: list[int] = []
        owner: list[int] = []
        for closure in group.closures:
            index = made.constraints.index(closure)
            r, columns = found[index]
            each = [np.stack(columns.get(v, [0.0 * row for row in r]), axis=-1) for v in own]
            A = np.concatenate((A, scale[loops[closure].rows, None] * np.stack(each, axis=-1) * units), axis=1)
            rows += range(first[index], first[index + 1])
            owner += len(r) * [index]
        left, values, right = np.linalg.svd(A)
        rank = int((values[0] > SINGULAR * values[0].max(initial=0.0)).sum())
        (chosen, _), (kept, wider) = _independent(left[:, :, rank:]), _independent(right[:, rank:].swapaxes(1, 2))
        left_rows, unknown = {row: owner[row] for row in chosen}, {own[k] for k in kept}
        while left_rows:  # constraints that determine as many coordinates as they have rows come first, alone
            parts = {index: {row for row, of in left_rows.items() if of == index} for index in left_rows.values()}
            alone = (
                (part, columns)
                for index, part in parts.items()
                for columns in [unknown & set(found[index][1])]
                if len(columns) == len(part)
            )
            part, its_own = next(alone, (set(left_rows), set(unknown)))
            yield {"rows": [rows[row] for row in sorted(part)], "own": sorted(its_own), "wider": wider}
            left_rows, unknown = {row: of for row, of in left_rows.items() if row not in part}, unknown - its_own


def _independent(null: Matrix) -> tuple[list[int], float]:
    """What to keep so that nothing of null spaces (N, n, k) is left, and how much larger errors are by that, at most.

    One after the other, what moves most in the null space is left out: most where it does least.
    """
    left_out, least = set(), 1.0
    for _ in range(null.shape[2]):
        motions = np.linalg.norm(null, axis=2)
        best = int(motions.min(axis=0).argmax())
        left_out.add(best)
        least = min(least, float(motions[:, best].min()))
        along = null[:, best] / motions[:, best, None]
        null = null - (null @ along[:, :, None]) * along[:, None]
    return [k for k in range(null.shape[1]) if k not in left_out], 1.0 + len(left_out) / least


def _exact(tables: dict[str, Any], drive: Drive, q: Matrix) -> dict[str, Any]:
    """The tables with as few Newton steps as lead to poses (N, nq) of the workspace.

    Raises:
        ValueError: More are needed than are taken at most.
    """
    motors, joints = drive.asked.read(q), drive.given.read(q)
    joints = drive.given.nearest(joints, 0.5 * (np.array(tables["lower"]) + tables["upper"]))
    for steps in range(_FEWEST, _MOST + 1):
        found = ArrayMap(np, tables | {"steps": steps}).at_joints(joints).positions
        wrong = ~(np.abs(drive.asked.nearest(found, motors) - motors) <= _APART).all(axis=1)
        if not wrong.any():
            return tables | {"steps": steps}
    raise ValueError(
        f"{_MOST} Newton steps do not reach {int(wrong.sum())} of {len(q)} poses of the workspace: the polynomials err "
        f"by {max(tables['errors']) / LARGER:.2g} rad or m; prepare the transmission with smaller `ranges`"
    )


def _half_spaces(space: Workspace) -> dict[str, Any]:
    """Half-spaces that leave a convex part of the workspace, and how much of it.

    From the box of what is reached, each half-space cuts off the point that is deepest inside of those of the boundary
    and of the grid that are not reached, in the direction that keeps most points of the grid, and the first pose. In
    the end they are moved inwards by what is left.
    """
    lower, upper = space.positions.min(axis=0), space.positions.max(axis=0)
    every = np.stack([each.ravel() for each in np.meshgrid(*space.axes, indexing="ij")], axis=-1)
    missed = every[np.isnan(space.on_grid(np.ones(len(space.q)))).ravel()]
    limits = [point.position for point in space.boundary]
    first = space.selections[0].nearest(space.selections[0].read(space.first), space.positions[0])
    inside, outside, start = (
        (np.reshape(points, (-1, len(lower))) - lower) / (upper - lower)
        for points in (space.positions, [*limits, *missed], first)
    )
    along = np.linspace(-1.0, 1.0, 1 + 2 * round(0.5 * _DIRECTIONS ** (1.0 / len(lower)) - 0.5))
    directions = np.array([d for d in product(along, repeat=len(lower)) if any(d)])
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    A = np.vstack((np.eye(len(lower)), -np.eye(len(lower))))
    b = np.concatenate((np.ones(len(lower)), np.zeros(len(lower))))
    while True:
        depths = (b - outside @ A.T).min(axis=1) if len(outside) else np.zeros(1)
        deepest = int(depths.argmax())
        if depths[deepest] <= _DEEP or len(b) >= _HALF_SPACES:
            break
        bounds = directions @ outside[deepest]
        kept = (inside @ directions.T <= bounds).sum(axis=0)
        kept[(start @ directions.T >= bounds)[0]] = -1
        inside = inside[inside @ directions[kept.argmax()] <= bounds[kept.argmax()]]
        A, b = np.vstack((A, directions[kept.argmax()])), np.append(b, bounds[kept.argmax()])
    b = b - max(0.0, float(depths[deepest]))
    covered = float((inside @ A.T <= b).all(axis=1).sum() / len(space.positions))
    b, A = b + (A / (upper - lower)) @ lower, A / (upper - lower)
    length = np.linalg.norm(A, axis=1)
    return {"halfplanes": [(A / length[:, None]).tolist(), (b / length).tolist()], "covered": covered}
