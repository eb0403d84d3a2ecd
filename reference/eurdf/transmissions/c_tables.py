"""The joints, constraints and polynomials of a transmission as tables of C."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from eurdf.array import Vector
from eurdf.mechanism.pose import Pose, X, Y, Z
from eurdf.transmissions.drive import Drive
from eurdf.transmissions.first_guess import Prediction
from eurdf.transmissions.tables import ConstraintNumbers, Screw, Tables

# Digits of a coefficient after the point, which are more than a first guess needs.
_DIGITS = 9


def joint_entry(screw: Screw) -> str:
    """The entry of a joint."""
    numbers = ", ".join(str(int(each)) for each in screw[:5])
    frame = f"{_frame(screw.pose)}, {vector(screw.axis)}, {vector(screw.advance)}"
    return f"{{{numbers}, {literal(screw.multiplier)}, {literal(screw.offset)}, {frame}}}"


def constraint_entry(own: ConstraintNumbers, rows: int, first: int, last: int, scale: Vector) -> str:
    """The entry of a constraint, whose path is that from first to last, with the scales of its rows."""
    (joint_a, a), (joint_b, b) = own.ends
    return (
        f"{{{own.kind.upper()}, {rows}, {first}, {last}, {joint_a}, {joint_b}, {_frame(a)}, {_frame(b)}, "
        f"{literal(own.length)}, {', '.join(map(vector, own.axes))}, {{{', '.join(map(vector, own.across))}}}, "
        f"{vector(scale)}}}"
    )


def drive_entry(
    number: int,
    drive: Drive,
    tables: Tables,
    place: Mapping[int, int],
    rows: Sequence[slice],
    guess: Prediction | None,
    reach: float,
) -> str:
    """The arrays of a drive and its entry; ``place`` is that of each constraint, ``rows`` those of all."""
    own = [tables.velocity[v] for v in drive.own.tolist()]
    asked = [tables.velocity[v] for v in drive.asked.velocities.tolist()]
    position = {velocity: index for index, velocity in enumerate(own)}
    lists = {
        "given_velocity": [tables.velocity[v] for v in drive.given.velocities.tolist()],
        "given_circular": [int(circular) for circular in drive.given.circular],
        "asked_velocity": asked,
        "asked_circular": [int(circular) for circular in drive.asked.circular],
        "asked_own": [position.get(velocity, -1) for velocity in asked],
        "own_velocity": own or [0],
        "constraint": [place[index] for index in drive.closures] or [0],
    }
    degrees, error, sign = (0, 0.0, 0.0) if guess is None else (guess.degree + 1, guess.error, guess.sign)
    coefficients = (
        np.zeros(1) if guess is None or not own else guess.coefficients.reshape(len(own), -1) / drive.unit[:, None]
    )
    boxes = {
        "lower": np.zeros(1) if guess is None else guess.lower,
        "upper": np.zeros(1) if guess is None else guess.upper,
        "coefficients": coefficients.round(_DIGITS).ravel() + 0.0,
    }
    arrays = [array("int", f"{key}_{number}", map(str, values)) for key, values in lists.items()]
    arrays += [array("double", f"{key}_{number}", map(literal, values)) for key, values in boxes.items()]
    counts = len(drive.given), len(drive.asked), len(own), rows_of(rows, drive), drive.rank, len(drive.closures)
    parts = [*map(str, (*counts, degrees)), *(f"{key}_{number}" for key in lists), *map(literal, (error, sign, reach))]
    parts += [f"{key}_{number}" for key in boxes]
    return "\n".join([*arrays, f"static const drive drive_{number} = {{{', '.join(parts)}}};"])


def rows_of(rows: Sequence[slice], drive: Drive) -> int:
    """The number of rows of the constraints of a drive."""
    return sum(rows[index].stop - rows[index].start for index in drive.closures)


def array(type_: str, name: str, values: Iterable[str]) -> str:
    """An array of numbers."""
    return f"static const {type_} {name}[] = {{{', '.join(values)}}};"


def table(type_: str, name: str, entries: Iterable[str], size: str = "[]") -> str:
    """An array of structures or rows, one a line."""
    lines = ",\n".join(f"    {entry}" for entry in entries)
    return f"static const {type_} {name}{size} = {{\n{lines},\n}};"


def literal(value: float) -> str:
    """A number, with all its digits."""
    return repr(float(value))


def vector(values: Iterable[float]) -> str:
    """The initializer of an array of numbers."""
    return "{" + ", ".join(map(literal, values)) + "}"


def _frame(pose: Pose) -> str:
    columns = [pose.rotate(axis) for axis in (X, Y, Z)]
    rotation = vector(columns[column][row] for row in range(3) for column in range(3))
    return f"{rotation}, {vector(pose.xyz)}"
