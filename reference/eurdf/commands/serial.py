"""``eurdf serial``: write an equivalent serial robot of one whose joints are moved through rods."""

from __future__ import annotations

import argparse
import math
import os
import sys
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from eurdf.commands.command import (
    FORCE,
    JSON,
    OUTPUT_FOLDER,
    ROBOT,
    SERIAL_JOINTS,
    SERIAL_MOTORS,
    cannot_run,
    command,
    option,
)
from eurdf.commands.output_file import writing
from eurdf.commands.terminal import Table, progress_bar, write_json, write_lines, write_notes, write_shown

if TYPE_CHECKING:
    from eurdf.array import Matrix, Vector
    from eurdf.transmissions.serial_model import Choice, SerialTwin

_DESCRIPTION = """\
Write the serial equivalent of a robot whose joints are moved through rods, as URDF and MJCF, for simulators and
training: without rods and cranks, with limits and armatures that follow from the motors. transmission.json has the
same numbers, polynomials that give the positions of the motors, and what the serial robot neglects.
"""


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
    summary="write an equivalent serial robot (URDF, MJCF) and its approximation errors",
    description=_DESCRIPTION,
    exit_codes="0 written, 1 the robot has errors, 2 the command cannot run.",
    examples=(
        "eurdf serial unitree_g1_ankle --joints free_pitch free_roll -o ankle --armature motor_a=0.0036 motor_b=0.0036",
        "eurdf serial my_robot --joints ankle_pitch ankle_roll -o serial --limits fitted",
    ),
)
def serial(
    options: dict[str, Any],
    path: str = ROBOT,
    joints: list[str] = SERIAL_JOINTS,
    motors: list[str] | None = SERIAL_MOTORS,
    output: str = OUTPUT_FOLDER,
    limits: Choice = option(
        "conservative: limits that the motors can always keep, and the largest armature; fitted: means; default: "
        "conservative",
        choices=("conservative", "fitted"),
        default="conservative",
    ),
    armature: list[tuple[str, float]] = option(
        "inertia of a motor after its gear, kg·m² or kg, in place of that of the description",
        nargs="+",
        default=(),
        metavar="MOTOR=VALUE",
        type=_value,
    ),
    grid: int | None = option("number of positions of each joint in the workspace", type=int, metavar="N"),
    degree: int = option("degree of the polynomials; default: 8", type=int, default=8, metavar="N"),
    force: bool = FORCE,
    json: bool = JSON,
) -> int:
    """Write the serial robot, and show what it neglects."""
    import eurdf
    from eurdf.errors import EurdfError

    robot = eurdf.load(path, **options)
    with cannot_run(EurdfError, ValueError):
        with progress_bar("computing the workspace"):
            twin = eurdf.transmissions.serial_twin(
                robot, joints, None, motors=motors, limits=limits, armature=dict(armature), grid=grid, degree=degree
            )
        with writing():
            written = twin.write(output, force=force)
    if json:
        write_json(twin.report())
    else:
        _show(twin)
    write_notes([*twin.notes, *(f"wrote '{os.fspath(each)}'" for each in written)])
    return 0


def _show(twin: SerialTwin) -> None:
    lost, units = twin.neglected, twin.workspace.units
    angles = [unit == "rad" for unit in units]
    torques = ["N·m" if angle else "N" for angle in angles]
    speeds = [f"{unit}/s" for unit in units]
    inertias = ["kg·m²" if angle else "kg" for angle in angles]
    rows = [
        (("position", "bold"), _ranges(twin.position, units)),
        (("torque", "bold"), _numbers(twin.torque, torques)),
        (("velocity", "bold"), _numbers(twin.velocity, speeds)),
        (("armature", "bold"), _numbers(twin.armature, inertias)),
        ("exact armature", _ranges(lost.armature, inertias)),
        *([] if lost.torque is None else [("torque alone", _ranges(lost.torque, torques))]),
        *([] if lost.velocity is None else [("velocity alone", _ranges(lost.velocity, speeds))]),
        ("error of gravity, at most", _numbers(lost.gravity, torques)),
    ]
    columns = range(1, len(twin.joints) + 1)
    table = Table("", *twin.joints, rows=((label, *numbers) for label, numbers in rows), right=columns)
    names = ", ".join(twin.bodies)
    summary = [
        f"{lost.mass:.4g} kg are lumped onto others: {names}",
        f"the box of positions has {100.0 * lost.covered:.0f} % of the workspace; "
        f"the inertia matrix errs by up to {100.0 * lost.inertia:.0f} %",
        f"polynomials of degree {twin.map.degree} err by up to {twin.map.error.max():.2g} in the motors' positions",
    ]
    write_shown(table)
    write_lines([[], *([(line, "")] for line in summary)], sys.stdout)


def _numbers(values: Vector, units: Sequence[str]) -> list[str]:
    return [f"{value:.5g} {unit}" for value, unit in zip(values.tolist(), units, strict=True)]


def _ranges(ranges: Matrix, units: Sequence[str]) -> list[str]:
    pairs = zip(ranges.tolist(), units, strict=True)
    return [f"{lower:.5g} to {upper:.5g} {unit}" for (lower, upper), unit in pairs]
