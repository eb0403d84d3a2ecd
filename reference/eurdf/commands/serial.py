"""``eurdf serial``: write the serial robot that stands for one whose joints are moved through rods."""

from __future__ import annotations

import argparse
import math
import os
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any, Literal

from eurdf.commands.command import FORCE, OUTPUT_FOLDER, ROBOT, SERIAL_JOINTS, cannot_run, command, option
from eurdf.commands.output_file import writing
from eurdf.commands.terminal import cell, new_table, write_notes, write_rendered
from eurdf.json_schema import Keywords

if TYPE_CHECKING:
    from eurdf.kinematics.array import Matrix, Vector
    from eurdf.transmissions.serial_twin import Choice, SerialTwin

_DESCRIPTION = """\
Write the serial robot that stands for one whose joints are moved through rods, as URDF and MJCF, for simulators and
training: without rods and cranks, with limits and armatures that follow from the motors. transmission.json has the
same numbers, polynomials that give the positions of the motors, and what the serial robot neglects.
"""

Range = tuple[float, float]
Row = tuple[float, ...]


@dataclass(frozen=True, slots=True)
class NeglectedInfo:
    """What the serial robot neglects, over the points of the workspace; one entry for each joint."""

    mass: float
    """Mass of the bodies that are lumped onto others, kg."""
    armature: tuple[Range, ...]
    """Smallest and largest armature that would be exact for the joint alone, kg·m² or kg."""
    rotors: tuple[Range, ...]
    """Smallest and largest part of it that comes from the rotors, kg·m² or kg."""
    linkage: tuple[Range, ...]
    """Smallest and largest part of it that comes from the bodies of the linkage, kg·m² or kg."""
    coupling: tuple[Row, ...]
    """Largest inertia between two joints that no armature can state, one row for each joint."""
    inertia: float
    """Largest relative error of the inertia matrix."""
    gravity: Row
    """Largest error of the torque that holds the joint against gravity, N·m or N."""
    torque: tuple[Range, ...] | None
    """Smallest and largest torque of the joint alone, N·m or N; null where a motor has no limit."""
    velocity: tuple[Range, ...] | None
    """Smallest and largest velocity of the joint alone, rad/s or m/s; null where a motor has no limit."""
    covered: Annotated[float, Keywords(minimum=0.0, maximum=1.0)]
    """Part of the points that are inside the position limits of the serial robot."""


@dataclass(frozen=True, slots=True)
class MapInfo:
    """Motor positions as Chebyshev polynomials of joint positions, each scaled from its range to -1…1."""

    lower: Row
    """Smallest position of each joint, rad or m."""
    upper: Row
    """Largest position of each joint, rad or m."""
    coefficients: tuple[Any, ...]
    """For each motor an array of numbers with one dimension for each joint, of degree + 1 entries, rad or m."""
    error: Row
    """Largest error of the position of each motor at the points tested, rad or m."""
    error_of_G: tuple[Row, ...]  # noqa: N815 - the field's own symbol
    """Largest error of their derivative there, one row for each motor."""


@dataclass(frozen=True, slots=True)
class SerialInfo:
    """The transmission.json that 'eurdf serial' writes."""

    joints: tuple[str, ...]
    """Name of each joint velocity of the serial robot; what follows has one entry for each."""
    motors: tuple[str, ...]
    """Name of each motor velocity of the parallel robot."""
    lumped: tuple[str, ...]
    """Bodies left out; their masses are lumped onto those that carry them."""
    lumped_at: dict[str, Row]
    """Coordinates of the joints of the parallel robot at which they are lumped, as in files."""
    chosen: Literal["conservative", "fitted"]
    """How limits and armature are chosen."""
    position: tuple[Range, ...]
    """Smallest and largest position, rad or m."""
    torque: tuple[float | None, ...]
    """Largest torque or force, N·m or N; null where a motor has no limit."""
    velocity: tuple[float | None, ...]
    """Largest velocity, rad/s or m/s; null where a motor has no limit."""
    armature: Row
    """Armature, kg·m² or kg."""
    damping: Row
    """Viscous damping, N·m·s/rad or N·s/m."""
    friction: Row
    """Dry friction, N·m or N."""
    neglected: NeglectedInfo
    """What the serial robot neglects."""
    stops: dict[str, int]
    """Number of points at the edge of the workspace, by what ends the motion there."""
    map: MapInfo
    """The positions of the motors as polynomials."""
    notes: tuple[str, ...]
    """What was left out for want of numbers."""


def _value(text: str) -> tuple[str, float]:
    """The motor and the number of ``MOTOR=VALUE``."""
    name, equals, value = text.partition("=")
    try:
        number = float(value)
    except ValueError:
        number = math.nan
    if not (name and equals and math.isfinite(number)):
        raise argparse.ArgumentTypeError(f"'{text}' is not MOTOR=VALUE, such as motor_a=0.0036")
    return name, number


@command(
    ROBOT,
    SERIAL_JOINTS,
    OUTPUT_FOLDER,
    option(
        "--limits",
        choices=("conservative", "fitted"),
        default="conservative",
        help="conservative: limits that the motors can always keep, and the largest armature; fitted: means; default: "
        "conservative",
    ),
    option(
        "--armature",
        nargs="+",
        default=(),
        metavar="MOTOR=VALUE",
        type=_value,
        help="inertia of a motor after its gear, kg·m² or kg, in place of that of the description",
    ),
    option("--grid", type=int, metavar="N", help="number of positions of each joint in the workspace"),
    option("--degree", type=int, default=8, metavar="N", help="degree of the polynomials; default: 8"),
    FORCE,
    summary="write the serial robot that stands for one with rods, and show what it neglects",
    description=_DESCRIPTION,
    exit_codes="0 written, 1 the robot has errors, 2 the command cannot run.",
    examples=(
        "eurdf serial unitree_g1_ankle --joints free_pitch free_roll -o ankle --armature motor_a=0.0036 motor_b=0.0036",
        "eurdf serial my_robot --joints ankle_pitch ankle_roll -o serial --limits fitted",
    ),
)
def serial(
    path: str,
    options: dict[str, Any],
    joints: list[str],
    motors: list[str] | None,
    output: str,
    limits: Choice,
    armature: list[tuple[str, float]],
    grid: int | None,
    degree: int,
    force: bool,
) -> int:
    """Write the serial robot, and show what it neglects."""
    import eurdf
    from eurdf.exceptions import EurdfError

    robot = eurdf.load(path, **options)
    with cannot_run(EurdfError, ValueError):
        twin = eurdf.serial_twin(
            robot, joints, None, motors, limits=limits, armature=dict(armature), grid=grid, degree=degree
        )
        with writing():
            written = twin.write(output, force=force)
    _show(twin)
    write_notes([*twin.notes, *(f"wrote '{os.fspath(each)}'" for each in written)])
    return 0


def _show(twin: SerialTwin) -> None:
    from rich.text import Text

    lost, units = twin.neglected, twin.workspace.units
    angles = [unit == "rad" for unit in units]
    torques = ["N·m" if angle else "N" for angle in angles]
    speeds = [f"{unit}/s" for unit in units]
    inertias = ["kg·m²" if angle else "kg" for angle in angles]
    rows = [
        (cell("position", "bold"), _ranges(twin.position, units)),
        (cell("torque", "bold"), _numbers(twin.torque, torques)),
        (cell("velocity", "bold"), _numbers(twin.velocity, speeds)),
        (cell("armature", "bold"), _numbers(twin.armature, inertias)),
        (cell("exact armature"), _ranges(lost.armature, inertias)),
        *([] if lost.torque is None else [(cell("torque alone"), _ranges(lost.torque, torques))]),
        *([] if lost.velocity is None else [(cell("velocity alone"), _ranges(lost.velocity, speeds))]),
        (cell("error of gravity, at most"), _numbers(lost.gravity, torques)),
    ]
    columns = range(1, len(twin.joints) + 1)
    table = new_table("", *twin.joints, rows=((label, *numbers) for label, numbers in rows), right=columns)
    names = ", ".join(twin.bodies)
    summary = (
        f"{lost.mass:.4g} kg are lumped onto others: {names}\n"
        f"the box of positions has {100.0 * lost.covered:.0f} % of the workspace; "
        f"the inertia matrix errs by up to {100.0 * lost.inertia:.0f} %\n"
        f"polynomials of degree {twin.map.degree} err by up to {twin.map.error.max():.2g} in the motors' positions"
    )
    write_rendered(table, Text(summary))


def _numbers(values: Vector, units: Sequence[str]) -> list[str]:
    return [f"{value:.5g} {unit}" for value, unit in zip(values.tolist(), units, strict=True)]


def _ranges(ranges: Matrix, units: Sequence[str]) -> list[str]:
    pairs = zip(ranges.tolist(), units, strict=True)
    return [f"{lower:.5g} to {upper:.5g} {unit}" for (lower, upper), unit in pairs]
