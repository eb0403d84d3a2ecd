"""Motors at many positions of the serial joints, in any namespace of the array API, such as NumPy, JAX or torch.

`eurdf transmission --python` copies this file, so that it imports nothing but the standard library. Inside, arrays have
the poses as their last axis, and rotations are three columns (3, 3, B), so that a fixed rotation is one product.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from math import prod
from typing import Any, NamedTuple

#: An array of the namespace.
Array = Any


class MotorsAt(NamedTuple):
    """The motors at positions (..., nJ) of the serial joints; NaN where these are not in the workspace.

    Attributes:
        positions: Positions (..., nm) of the motors, rad or m.
        G: (..., nm, nJ) with v_m = G v_J and τ_J = Gᵀ τ_m.
        B: (..., nJ, nm), G⁻¹, with v_J = B v_m and τ_m = Bᵀ τ_J.
    """

    positions: Array
    G: Array
    B: Array


class ArrayMap:
    """The transmission from serial joints to motors as functions of arrays: differentiable, and without a state.

    Polynomials predict the pose of the loops at the positions, and Newton steps make it exact, on the branch that the
    map was made for. Each function calls `at_joints`. Results have the data type of the positions, and are on their
    device; in double precision G errs by 1e-9 or less. Positions outside of the workspace give NaN.

    Attributes:
        joints: Names of the serial joints, nJ.
        motors: Names of the motors, nm; as many.
        lower: Smallest positions (nJ,) of the joints, rad or m; the map is NaN below.
        upper: Largest positions (nJ,).
        covered: Part of the workspace, of the points of a grid, that `halfplanes` leaves.
    """

    def __init__(self, xp: Any, tables: Mapping[str, Any]) -> None:
        """Take a namespace, and the tables of a transmission."""
        self._xp, self._tables = xp, tables
        self.joints, self.motors = tuple(tables["joints"]), tuple(tables["motors"])
        self.lower, self.upper = tuple(tables["lower"]), tuple(tables["upper"])
        self.covered: float = tables["covered"]
        self._concrete = type(xp.asarray(self.lower))
        self._kept: dict[Any, list[Array]] = {}

    def __repr__(self) -> str:
        return f"<ArrayMap: joints {', '.join(self.joints)}; motors {', '.join(self.motors)}>"

    @property
    def halfplanes(self) -> tuple[Array, Array]:
        """A (k, nJ) and b (k,): the joints can be where A q_J ≤ b, a convex part of the workspace.

        No point of the grid that is not reached, and none of the boundary, is inside by more than 1e-9 rad or m.
        """
        A, b = self._tables["halfplanes"]
        return self._xp.asarray(A), self._xp.asarray(b)

    def at_joints(self, positions: Array) -> MotorsAt:
        """The motors at positions (..., nJ) of the serial joints, rad or m.

        Raises:
            TypeError: The positions are no array of floating-point numbers.
            ValueError: They have another shape.
        """
        xp, count, tables = self._xp, len(self.joints), self._tables
        if "float" not in str(getattr(positions, "dtype", "")):
            raise TypeError("positions must be an array of floating-point numbers of the namespace of the map")
        shape = tuple(positions.shape)
        if not shape or shape[-1] != count:
            raise ValueError(f"positions has the shape {shape}; the map needs (..., {count}): {', '.join(self.joints)}")
        made = self.constants(positions)
        flat = xp.reshape(positions, (prod(shape[:-1]), count))
        asked = [flat[:, k] for k in range(count)]
        # What is not a number becomes the lower end, which is not what was asked for.
        raised = [xp.where(each > low, each, low) for each, low in zip(asked, self.lower, strict=True)]
        given = [xp.where(each < up, each, up) for each, up in zip(raised, self.upper, strict=True)]
        is_good = asked[0] == asked[0]
        for one, other in zip(asked, given, strict=True):
            is_good = is_good & (one == other)
        x = [value + 0.0 * given[0] for value in tables["start"]]
        for coordinate, value in zip(tables["given"], given, strict=True):
            x[coordinate] = value
        predicted = self._predicted(made, given)
        for row, coordinate in enumerate(tables["own"]):
            x[coordinate] = x[coordinate] + predicted[row, ...]
        first = list(x)
        for _ in range(tables["steps"]):
            x, _, _ = self._stepped(made, x, [])
        x, open_by, rates = self._stepped(made, x, tables["given"])
        is_good = is_good & (open_by <= max(1e-9, 100.0 * float(xp.finfo(positions.dtype).eps)))
        for coordinate, bound in zip(tables["own"], tables["errors"], strict=True):
            is_good = is_good & (xp.abs(x[coordinate] - first[coordinate]) <= bound)
        unit = [[(1.0 if row == k else 0.0) + 0.0 * given[0] for k in range(count)] for row in range(count)]
        rates.update(zip(tables["given"], unit, strict=True))
        G = [rates[coordinate] for coordinate in tables["asked"]]
        is_good = is_good & (_determinant(xp, G) * tables["sign"] > 0.0)
        motors = [[x[coordinate]] for coordinate in tables["asked"]]
        found = (_matrix(xp, each) for each in (motors, G, _solved(xp, G, unit)))
        known = (xp.where(is_good[:, None, None], each, xp.full_like(each, float("nan"))) for each in found)
        shapes = (count,), (count, count), (count, count)
        return MotorsAt(*(xp.reshape(each, (*shape[:-1], *own)) for each, own in zip(known, shapes, strict=True)))

    def torque_limits(self, positions: Array, motor_torque: Any) -> Array:
        """The largest torque (..., nJ) of each joint, N·m or N, while the others have none.

        Args:
            positions: Positions (..., nJ) of the joints, rad or m.
            motor_torque: The largest torque or force of the motors, N·m or N: an array (..., nm), or a number.
        """
        at, xp = self.at_joints(positions), self._xp
        part = xp.abs(at.B) / (motor_torque + 0.0 * at.positions)[..., None, :]
        most = part[..., 0]
        for motor in range(1, len(self.motors)):
            most = _larger(xp, most, part[..., motor])
        return 1.0 / most

    def clip(self, positions: Array, torque: Array, motor_torque: Any) -> Array:
        """Torques (..., nJ) that the motors produce at the joints instead of others: Gᵀ times what they clip Bᵀ τ_J to.

        Args:
            positions: Positions (..., nJ) of the joints, rad or m.
            torque: Torques or forces τ_J (..., nJ) of the joints, N·m or N.
            motor_torque: As in `torque_limits`.
        """
        at, xp = self.at_joints(positions), self._xp
        most = motor_torque + 0.0 * at.positions
        motors = xp.sum(at.B * torque[..., :, None], axis=-2)
        clipped = _larger(xp, motors, -most)
        clipped = xp.where(clipped > most, most, clipped)
        return xp.sum(at.G * clipped[..., :, None], axis=-2)

    def reflected_inertia(self, positions: Array, rotor: Any) -> Array:
        """The inertia Gᵀ I G (..., nJ, nJ) of the rotors at the joints, kg·m² or kg.

        Args:
            positions: Positions (..., nJ) of the joints, rad or m.
            rotor: The inertia I of each rotor after its gear, kg·m² or kg: an array (..., nm), or a number.
        """
        at = self.at_joints(positions)
        weighted = (rotor + 0.0 * at.positions)[..., :, None] * at.G
        return self._xp.sum(at.G[..., :, :, None] * weighted[..., :, None, :], axis=-3)

    def constants(self, like: Array) -> list[Array]:
        """The arrays of the tables with the type and device of another; kept unless they belong to a traced call."""
        device = getattr(like, "device", None)  # a traced array has none
        found = self._kept.get((like.dtype, device))
        if found is None:
            place = {} if device is None else {"device": device}
            found = [self._xp.asarray(each, dtype=like.dtype, **place) for each in self._tables["arrays"]]
            if type(found[0]) is self._concrete:
                self._kept[like.dtype, device] = found
        return found

    def _predicted(self, made: Sequence[Array], given: Sequence[Array]) -> Array:
        """The motions (k, B) from the first pose, by Chebyshev polynomials of the positions (B,) of each joint."""
        xp, basis = self._xp, None
        degree = self._tables["degree"]
        for value, lower, upper in zip(given, self.lower, self.upper, strict=True):
            t = (2.0 * value - (lower + upper)) / (upper - lower)
            T = [1.0 + 0.0 * t, t]
            while len(T) <= degree:
                T.append(2.0 * t * T[-1] - T[-2])
            own = xp.stack(T[: degree + 1], axis=0)
            basis = (
                own
                if basis is None
                else xp.reshape(basis[:, None, :] * own[None, :, :], (basis.shape[0] * own.shape[0], own.shape[1]))
            )
        return xp.matmul(made[self._tables["coefficients"]], basis)

    def _stepped(
        self, made: Sequence[Array], x: Sequence[Array], sides: Sequence[int]
    ) -> tuple[list[Array], Array, dict[int, list[Array]]]:
        """A Newton step from coordinates x, (B,) each; before it, how far loops are open, and rates by some sides."""
        xp, none = self._xp, 0.0 * x[0]
        residual, derivative, open_by = [], [], none
        for r, columns in self.constraint_rows(made, x):
            for row, each in enumerate(r):
                residual.append(each)
                derivative.append({column: own[row] for column, own in columns.items()})
                open_by = _larger(xp, open_by, xp.abs(each))
        solved: dict[int, list[Array]] = {}
        for block in self._tables["blocks"]:
            b = []
            for row in block["rows"]:
                each = [residual[row], *(derivative[row].get(side, none) for side in sides)]
                for column in solved.keys() & derivative[row].keys():
                    each = [own - derivative[row][column] * of for own, of in zip(each, solved[column], strict=True)]
                b.append(each)
            A = [[derivative[row].get(column, none) for column in block["own"]] for row in block["rows"]]
            solved.update(zip(block["own"], _solved(xp, A, b), strict=True))
        moved = [value - solved[k][0] if k in solved else value for k, value in enumerate(x)]
        return moved, open_by, {k: [-rate for rate in own[1:]] for k, own in solved.items()}

    def constraint_rows(
        self, made: Sequence[Array], x: Sequence[Array]
    ) -> list[tuple[list[Array], dict[int, list[Array]]]]:
        """Of each constraint the rows of its residual, m and rad, and by coordinate those of the derivative, (B,) each.

        The derivative is exact where the constraint is closed.
        """
        screws = self._screws(made, x)
        return [self._constraint(made, own, x, screws) for own in self._tables["constraints"]]

    def _screws(self, made: Sequence[Array], x: Sequence[Array]) -> list[_MovedFrame]:
        """The moving frame of each joint, in the world; number 0 is at rest."""
        xp, at_rest = self._xp, made[0][:, :, None] + 0.0 * x[0]
        placed = [_MovedFrame(at_rest, *(3 * [0.0 * at_rest[0, ...]]))]
        for own in self._tables["screws"]:
            parent = placed[own["parent"]]
            vectors = _products(xp, made[own["vectors"]], parent.columns)
            amount = own["multiplier"] * x[own["coordinate"]] + own["offset"]
            c, s, (turns, along, origin) = xp.cos(amount), xp.sin(amount), (vectors[k, ...] for k in (9, 10, 11))
            columns = vectors[:3, ...] + c * vectors[3:6, ...] + s * vectors[6:9, ...]
            placed.append(_MovedFrame(columns, parent.origin + origin + amount * along, turns, along))
        return placed

    def _constraint(
        self, made: Sequence[Array], own: Mapping[str, Any], x: Sequence[Array], placed: Sequence[_MovedFrame]
    ) -> tuple[list[Array], dict[int, list[Array]]]:
        screws = [self._tables["screws"][screw - 1] for screw, _ in own["path"]]
        if own["kind"] == "coupling":
            each = [(factor, screw["coordinate"]) for screw, (_, factor) in zip(screws, own["path"], strict=True)]
            r = _sum(factor * x[coordinate] for factor, coordinate in each) - own["length"]
            return [r], {coordinate: [factor + 0.0 * r] for factor, coordinate in each}
        joints = [placed[joint] for joint in own["joints"]]
        ends = [_products(self._xp, made[k], at.columns) for k, at in zip(own["vectors"], joints, strict=True)]
        a, b = (at.origin + end[-1, ...] for at, end in zip(joints, ends, strict=True))
        r, project = self._kind(own, ends[0], ends[1], b - a)
        velocities: dict[int, list[Array]] = {}
        for screw, (number, factor) in zip(screws, own["path"], strict=True):
            _, origin, turns, along = placed[number]
            v = along + _cross(self._xp, turns, (b if factor > 0.0 else a) - origin)
            rows = [factor * screw["multiplier"] * row for row in project(v, turns)]
            before = velocities.get(screw["coordinate"], [0.0] * len(rows))
            velocities[screw["coordinate"]] = [row + other for row, other in zip(rows, before, strict=True)]
        return r, velocities

    def _kind(
        self, own: Mapping[str, Any], a: Array, b: Array, apart: Array
    ) -> tuple[list[Array], Callable[[Array, Array], list[Array]]]:
        """The residual, and what makes rows of the velocity of point B and the turn of frame B, seen from A.

        The axes of the ends are a and b, and B's origin is ``apart`` from A's.
        """
        xp, r = self._xp, _parts(apart)
        if own["kind"] == "point":
            return r, lambda v, w: _parts(v)
        if own["kind"] == "frame":
            turn = _sum(0.5 * _cross(xp, a[k, ...], b[k, ...]) for k in range(3))
            return [*r, *_parts(turn)], lambda v, w: [*_parts(v), *_parts(w)]
        if own["kind"] == "hinge":  # b's axis, and the plane across a's
            axis, across = b[0, ...], [a[0, ...], a[1, ...]]
            normals = [_cross(xp, axis, each) for each in across]
            tilt = [_dot(each, axis) for each in across]
            return [*r, *tilt], lambda v, w: [*_parts(v), *(_dot(w, each) for each in normals)]
        length = xp.sqrt(_dot(apart, apart))
        return [length - own["length"]], lambda v, w: [_dot(apart, v) / length]


class _MovedFrame(NamedTuple):
    """A frame in the world: its columns (3, 3, B) and origin (3, B), and how its joint turns and advances (3, B)."""

    columns: Array
    origin: Array
    turns: Array
    along: Array


def _products(xp: Any, vectors: Array, columns: Array) -> Array:
    """Vectors (r, 3) that are fixed in a frame with columns (3, 3, B), in the world (r, 3, B)."""
    return xp.reshape(xp.matmul(vectors, xp.reshape(columns, (3, -1))), (vectors.shape[0], 3, -1))


def _parts(vector: Array) -> list[Array]:
    return [vector[k, ...] for k in range(3)]


def _cross(xp: Any, one: Array, other: Array) -> Array:
    (a, b, c), (x, y, z) = _parts(one), _parts(other)
    return xp.stack([b * z - c * y, c * x - a * z, a * y - b * x], axis=0)


def _dot(one: Array, other: Array) -> Array:
    (a, b, c), (x, y, z) = _parts(one), _parts(other)
    return a * x + b * y + c * z


def _matrix(xp: Any, rows: Sequence[Sequence[Array]]) -> Array:
    """A matrix (B, m, n) of rows of arrays (B,)."""
    flat = xp.stack([each for row in rows for each in row], axis=-1)
    return xp.reshape(flat, (-1, len(rows), len(rows[0])))


def _solved(xp: Any, A: Sequence[Sequence[Array]], b: Sequence[Sequence[Array]]) -> list[list[Array]]:
    """A⁻¹ b, in rows of arrays (B,) as both: by cofactors if A is small, which is faster than a call for each pose."""
    sides = range(len(b[0]))
    if len(A) > 3:
        found = xp.linalg.solve(_matrix(xp, A), _matrix(xp, b))
        return [[found[:, row, side] for side in sides] for row in range(len(A))]
    one_by_det = 1.0 / _determinant(xp, A)
    inverse = [[each * one_by_det for each in row] for row in _cofactors(A)]
    return [[_sum(each * own[side] for each, own in zip(row, b, strict=True)) for side in sides] for row in inverse]


def _determinant(xp: Any, A: Sequence[Sequence[Array]]) -> Array:
    if len(A) > 3:
        return xp.linalg.det(_matrix(xp, A))
    return _sum(each * row[0] for each, row in zip(A[0], _cofactors(A), strict=True))


def _sum(values: Iterable[Array]) -> Array:
    first, *others = values
    for each in others:
        first = first + each
    return first


def _cofactors(A: Sequence[Sequence[Array]]) -> list[list[Array]]:
    """Of a matrix with one to three rows, its inverse times its determinant."""
    if len(A) == 1:
        return [[1.0 + 0.0 * A[0][0]]]
    if len(A) == 2:
        return [[A[1][1], -A[0][1]], [-A[1][0], A[0][0]]]
    (a, b, c), (d, e, f), (g, h, i) = A
    return [
        [e * i - f * h, c * h - b * i, b * f - c * e],
        [f * g - d * i, a * i - c * g, c * d - a * f],
        [d * h - e * g, b * g - a * h, a * e - b * d],
    ]


def _larger(xp: Any, one: Array, other: Array) -> Array:
    return xp.where(one < other, other, one)
