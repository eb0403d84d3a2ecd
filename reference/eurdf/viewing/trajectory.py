"""Trajectories to replay: CSV files of times and joint coordinates."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

from eurdf.diagnostics import did_you_mean

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot

TIME = "time"


@dataclass(frozen=True, slots=True)
class Trajectory:
    """Coordinates of joints at times; the other joints follow.

    Attributes:
        times: In ascending order, s.
        coordinates: At each time, the coordinates of the joints as in files.
    """

    times: tuple[float, ...]
    coordinates: tuple[Mapping[str, tuple[float, ...]], ...]


def read_trajectory(text: str, robot: Robot) -> Trajectory:
    """Read a CSV file.

    The first line names the columns: ``time`` (s) and, in any order, joints (rad or m). A joint with several
    coordinates has a column for each, ``NAME:1``, ``NAME:2`` and so on, in the order of files.

    Args:
        text: The file.
        robot: Whose joints they are.

    Raises:
        ValueError: The file has an error; the text says in which line.
    """
    rows = csv.reader(io.StringIO(text.removeprefix("\ufeff")))
    header = [name.strip() for name in next(rows, [])]
    columns = _columns(header, robot)
    times: list[float] = []
    coordinates: list[Mapping[str, tuple[float, ...]]] = []
    for row in rows:
        line = rows.line_num
        if not any(cell.strip() for cell in row):
            continue
        if len(row) != len(header):
            raise ValueError(f"line {line}: {len(row)} values, but the first line names {len(header)} columns")
        numbers = [_number(cell, line, name) for cell, name in zip(row, header, strict=True)]
        time = numbers[header.index(TIME)]
        if times and time <= times[-1]:
            raise ValueError(f"line {line}: time {time:g} does not follow {times[-1]:g}; times must ascend")
        times.append(time)
        coordinates.append({joint: tuple(numbers[at] for at in places) for joint, places in columns.items()})
    if not times:
        raise ValueError("the trajectory has no line of values")
    return Trajectory(tuple(times), tuple(coordinates))


def _columns(header: list[str], robot: Robot) -> dict[str, list[int]]:
    """For each joint the indices of its columns."""
    if TIME not in header:
        raise ValueError(f"line 1: there is no column '{TIME}'; the first line names the columns, such as: time,motor")
    for name in header:
        if header.count(name) > 1:
            raise ValueError(f"line 1: column '{name}' occurs {header.count(name)} times")
    sizes = {joint.name: len(joint.type.coordinates) for joint in robot.mechanism.joints if joint.name in robot.slots}
    expected = {
        joint: [joint] if size == 1 else [f"{joint}:{number + 1}" for number in range(size)]
        for joint, size in sizes.items()
    }
    joint_of = {column: joint for joint, names in expected.items() for column in names}
    columns: dict[str, list[int]] = {}
    for name in header:
        if name == TIME:
            continue
        joint = joint_of.get(name)
        if joint is None:
            hint = did_you_mean(name, joint_of) or "columns are 'time' and names of moving joints"
            raise ValueError(f"line 1: there is no joint '{name}'; {hint}")
        missing = [other for other in expected[joint] if other not in header]
        if missing:
            raise ValueError(f"line 1: joint '{joint}' has {sizes[joint]} coordinates; add column '{missing[0]}'")
        columns[joint] = [header.index(other) for other in expected[joint]]
    return columns


def _number(cell: str, line: int, column: str) -> float:
    try:
        number = float(cell)
    except ValueError:
        number = math.nan
    if not math.isfinite(number):
        raise ValueError(f"line {line}: '{cell.strip()}' in column '{column}' is not a finite number")
    return number


def frames_between(trajectory: Trajectory) -> Iterator[tuple[float, Mapping[str, tuple[float, ...]]]]:
    """The coordinates one after the other, each with the time until the next, s; 0 for the last."""
    following = (*trajectory.times[1:], trajectory.times[-1])
    for time, after, coordinates in zip(trajectory.times, following, trajectory.coordinates, strict=True):
        yield after - time, coordinates
