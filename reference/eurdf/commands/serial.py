"""``eurdf serial``: write the serial robot that stands for one whose joints are moved through rods."""

from __future__ import annotations

import argparse
import math
import os
from collections.abc import Sequence
from typing import TYPE_CHECKING

from eurdf.commands.cannot_run import CannotRun
from eurdf.commands.migrate import print_notes, show_report
from eurdf.commands.output import cell, new_table, write_rendered
from eurdf.commands.output_file import writing
from eurdf.commands.robot_options import add_robot_options, add_robot_path, add_serial_joints, ending, robot_options
from eurdf.commands.selection import select_one

if TYPE_CHECKING:
    from eurdf.kinematics.array import Matrix, Vector
    from eurdf.transmissions.serial_twin import SerialTwin

_DESCRIPTION = """\
Write the serial robot that stands for one whose joints are moved through rods, as URDF and MJCF, for simulators and
training: without rods and cranks, with limits and armatures that follow from the motors. transmission.json has the
same numbers, polynomials that give the positions of the motors, and what the serial robot neglects.
"""
_EPILOG = ending(
    "0 written, 1 the robot has errors, 2 the command cannot run.",
    "eurdf serial unitree_g1_ankle --joints free_pitch free_roll -o ankle --armature motor_a=0.0036 motor_b=0.0036",
    "eurdf serial my_robot --joints ankle_pitch ankle_roll -o serial --limits fitted",
)


def register(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the command to the parser."""
    parser = subparsers.add_parser(
        "serial",
        help="write the serial robot that stands for one with rods, and show what it neglects",
        description=_DESCRIPTION,
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    add_robot_path(parser)
    add_robot_options(parser)
    add_serial_joints(parser)
    parser.add_argument("-o", "--output", required=True, metavar="FOLDER", help="the folder to write to")
    parser.add_argument(
        "--limits",
        choices=("conservative", "fitted"),
        default="conservative",
        help="conservative: limits that the motors can always keep, and the largest armature; fitted: means; default: "
        "conservative",
    )
    parser.add_argument(
        "--armature",
        nargs="+",
        default=(),
        metavar="MOTOR=VALUE",
        type=_value,
        help="inertia of a motor after its gear, kg·m² or kg, in place of that of the description",
    )
    parser.add_argument("--grid", type=int, metavar="N", help="number of positions of each joint in the workspace")
    parser.add_argument("--degree", type=int, default=8, metavar="N", help="degree of the polynomials; default: 8")
    parser.add_argument("--force", action="store_true", help="replace existing files")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Write the serial robot, show what it neglects, and return the exit code."""
    from eurdf.checking.load import load
    from eurdf.exceptions import EurdfError, InvalidRobot

    path = select_one(args.path)
    try:
        robot = load(path, **robot_options(args))
    except InvalidRobot as refusal:
        show_report(path, tuple(refusal.diagnostics), False)
        return 1
    from eurdf.transmissions.serial_twin import serial_twin

    try:
        twin = serial_twin(
            robot,
            args.joints,
            None,
            args.motors,
            limits=args.limits,
            armature=dict(args.armature),
            grid=args.grid,
            degree=args.degree,
        )
        with writing():
            written = twin.write(args.output, force=args.force)
    except (EurdfError, ValueError) as reason:
        raise CannotRun(str(reason)) from None
    _show(twin)
    print_notes([*twin.notes, *(f"wrote '{os.fspath(each)}'" for each in written)])
    return 0


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


def _show(twin: SerialTwin) -> None:
    from rich.text import Text

    lost, units = twin.neglected, twin.workspace.units
    table = new_table("", *twin.joints)
    for column in table.columns[1:]:
        column.justify = "right"
    angles = [unit == "rad" for unit in units]
    torques = ["N·m" if angle else "N" for angle in angles]
    speeds = [f"{unit}/s" for unit in units]
    inertias = ["kg·m²" if angle else "kg" for angle in angles]
    rows = [
        ("position", _ranges(twin.position, units)),
        ("torque", _numbers(twin.torque, torques)),
        ("velocity", _numbers(twin.velocity, speeds)),
        ("armature", _numbers(twin.armature, inertias)),
        ("exact armature", _ranges(lost.armature, inertias)),
        *([] if lost.torque is None else [("torque alone", _ranges(lost.torque, torques))]),
        *([] if lost.velocity is None else [("velocity alone", _ranges(lost.velocity, speeds))]),
        ("error of gravity, at most", _numbers(lost.gravity, torques)),
    ]
    for label, numbers in rows:
        table.add_row(cell(label, "bold" if label in ("position", "torque", "velocity", "armature") else ""), *numbers)
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
