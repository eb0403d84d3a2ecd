"""``eurdf assemble``: find a configuration that closes the loops, show it, and write it to the description."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

from eurdf.commands.cannot_run import CannotRun
from eurdf.commands.migrate import print_notes, show_report
from eurdf.commands.output import cell, new_table, write_json, write_rendered
from eurdf.commands.robot_options import add_robot_options, add_robot_path, ending, robot_options
from eurdf.commands.selection import select_one

if TYPE_CHECKING:
    from rich.table import Table

    from eurdf.commands.assembly_info import AssemblyInfo, JointPosition
    from eurdf.kinematics.array import Vector
    from eurdf.kinematics.assembly import Assembly
    from eurdf.linking.configurations import BeyondLimit
    from eurdf.linking.description import Described
    from eurdf.pinocchio.robot import Robot

_DESCRIPTION = """\
Find a configuration in which every loop is closed, and show the coordinates of each joint as in files.

The search starts at the configuration 'assembled', or at the neutral one if there is none. It respects the joint limits
if possible. --write writes the configuration to the description as 'assembled'; comments and everything else are kept.
"""
_EPILOG = ending(
    "0 the loops close, 1 they do not or the robot has errors, 2 the command cannot run.",
    "eurdf assemble my_robot --hold motor_knee --write",
)

#: Start here if the file has no configuration of this name.
_NEUTRAL = "neutral"

# Tolerance of each row of the residual, m or rad.
_TOLERANCE = 1e-13

# Maximum number of open closures in a message.
_MOST_OPEN = 4


def register(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the command to the parser."""
    parser = subparsers.add_parser(
        "assemble",
        help="find a configuration that closes the loops, and write it to the description",
        description=_DESCRIPTION,
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    add_robot_path(parser)
    add_robot_options(parser)
    parser.add_argument("--write", action="store_true", help="write it to the description as 'assembled'")
    parser.add_argument("--force", action="store_true", help="replace an existing, different 'assembled'")
    parser.add_argument(
        "--hold", metavar="JOINT", action="append", default=[], help="do not move this joint (repeatable)"
    )
    parser.add_argument("--limits", action="store_true", help="never exceed the joint limits")
    parser.add_argument(
        "--from",
        dest="start",
        metavar="CONFIGURATION",
        help=f"configuration to start from: one of the description, or {_NEUTRAL}",
    )
    parser.add_argument("--json", action="store_true", help="write one JSON object")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Assemble, show, write, and return the exit code."""
    from eurdf.linking.description import Described, Unlinked, describe

    path = select_one(args.path)
    if args.force and not args.write:
        raise CannotRun("--force has no effect without --write; add --write")
    description = describe(path, geometry=False, **robot_options(args))
    if isinstance(description, Unlinked) or description.diagnostics.refused:
        show_report(description.path, tuple(description.diagnostics), args.json)
        return 1
    if not isinstance(description, Described):
        raise CannotRun(
            f"'{description.path}' is a plain URDF, without loops; `eurdf generate` writes a description with closures"
        )
    file = _file_to_write(args.path, description) if args.write else None

    from eurdf.commands.assembly_info import assembly_info
    from eurdf.linking.configurations import beyond_limits
    from eurdf.pinocchio.robot import build_robot

    robot = build_robot(description.mechanism, geometry=False)
    start, q0 = _start(robot, args.start)
    assembly = _assemble(robot, q0, args.hold, args.limits)
    beyond = beyond_limits(robot.mechanism.joints, robot.coordinates(assembly.q))
    info = assembly_info(robot, assembly, start, args.hold, {found.joint for found in beyond})
    if not args.json:
        _show(info)
    code = 0 if assembly.closes else 1
    if file is not None:
        info = info.model_copy(update={"file": file})
        if code == 0 and not beyond:
            info = info.model_copy(update={"written": _write(description, robot, assembly.q, args.force)})
        else:
            code = 1
    if args.json:
        write_json(info.model_dump(mode="json"))
    print_notes(_messages(info, assembly, beyond))
    return code


def _file_to_write(path: str, description: Described) -> str:
    """The file to write the configuration to."""
    from eurdf.writing.saved_configuration import CannotSave, file_to_save_to

    try:
        return file_to_save_to(path, description)
    except CannotSave as reason:
        raise CannotRun(str(reason)) from None


def _start(robot: Robot, name: str | None) -> tuple[str, Vector]:
    """The configuration to start from, and its name."""
    import pinocchio as pin

    from eurdf.diagnostics import did_you_mean
    from eurdf.writing.saved_configuration import NAME

    if name is None:
        name = NAME if NAME in robot.configurations else _NEUTRAL
    if name in robot.configurations:
        return name, robot.configurations[name]
    if name == _NEUTRAL:
        return name, pin.neutral(robot.model)
    known = [*robot.configurations, _NEUTRAL]
    hint = did_you_mean(name, known) or f"the configurations are: {', '.join(known)}"
    raise CannotRun(f"there is no configuration '{name}'; {hint}")


def _assemble(robot: Robot, q0: Vector, hold: list[str], limits: bool) -> Assembly:
    """A closed configuration, within the joint limits if possible."""
    from eurdf.kinematics.assembly import assemble
    from eurdf.linking.configurations import beyond_limits

    try:
        within = _clipped(robot, q0, hold)
        assembly = assemble(robot, within if limits else q0, hold, tolerance=_TOLERANCE, limits=limits)
    except ValueError as reason:
        raise CannotRun(str(reason)) from None
    if not limits and assembly.closes and beyond_limits(robot.mechanism.joints, robot.coordinates(assembly.q)):
        limited = assemble(robot, within, hold, tolerance=_TOLERANCE, limits=True)
        if limited.closes:
            return limited
    return assembly


def _clipped(robot: Robot, q: Vector, hold: list[str]) -> Vector:
    """The configuration with all joints but the held ones within their limits, also those outside of loops."""
    import numpy as np

    from eurdf.kinematics.position_limit import position_limits

    held = [velocity for name in hold for velocity in robot.tree.velocities_of(name)]
    return position_limits(robot).clip(q, np.setdiff1d(np.arange(robot.tree.nv), held))


def _write(description: Described, robot: Robot, q: Vector, force: bool) -> bool:
    """Write the configuration to the description; return whether the file changed."""
    from eurdf.writing.saved_configuration import NAME, CannotSave, save_configuration

    try:
        return save_configuration(description, robot, q, force=force)
    except CannotSave as reason:
        replaces = NAME in robot.configurations and not force
        raise CannotRun(f"{reason}; --force replaces it" if replaces else str(reason)) from None


def _messages(info: AssemblyInfo, assembly: Assembly, beyond: list[BeyondLimit]) -> list[str]:
    """The messages after the table."""
    nothing_written = [f"nothing was written to '{info.file}'"] if info.file is not None else []
    if not info.closes:
        held = ", ".join(f"'{joint.name}'" for joint in info.joints if joint.held)
        found = f"no configuration was found that closes the loops{held and f' with {held} held'}"
        messages = [f"{found}; least open: {_widest(assembly)}"]
        if assembly.at_limits:
            messages.append(f"joints at their limits: {', '.join(map(str, assembly.at_limits))}")
        return [*messages, *nothing_written]
    if beyond:
        return [
            f"the loops close only with joints beyond their limits: {'; '.join(map(str, beyond))}",
            *nothing_written,
        ]
    if info.written:
        return [f"wrote the configuration 'assembled' to '{info.file}'"]
    if info.file is not None:
        return [f"'{info.file}' already has this configuration as 'assembled': nothing to do"]
    return []


def _widest(assembly: Assembly) -> str:
    """The closures that are open the most; the table shows all."""
    wide = [opening for opening in assembly.open if opening.is_open]
    wide.sort(key=lambda opening: max(opening.position, opening.angle), reverse=True)
    more = f"; and {len(wide) - _MOST_OPEN} more" if len(wide) > _MOST_OPEN else ""
    return "; ".join(map(str, wide[:_MOST_OPEN])) + more


def _show(info: AssemblyInfo) -> None:
    from rich.text import Text

    from eurdf.diagnostics.visible import visible

    word, style = ("closed", "green") if info.closes else ("open", "red")
    residual = "" if info.residual is None else f", residual {info.residual:.1e}"
    heading = Text.assemble((visible(info.name), "bold"), "  ", (word, style), f"{residual}, from {info.start}")
    write_rendered(heading, *([_joints(info)] if info.joints else []), *([] if info.closes else [_closures(info)]))


def _joints(info: AssemblyInfo) -> Table:
    table = new_table("joint", "type", "coordinates", "unit", "")
    for joint in info.joints:
        numbers = "  ".join(_number(coordinate.value) for coordinate in joint.coordinates)
        notes = [
            word
            for word, applies in (
                ("held", joint.held),
                ("beyond its limits", joint.beyond_limits),
                ("actuated", joint.actuated),
            )
            if applies
        ]
        style = "red" if joint.beyond_limits else "cyan"
        table.add_row(cell(joint.name, "bold"), joint.type.value, numbers, _units(joint), cell(", ".join(notes), style))
    return table


def _number(value: float) -> str:
    """A coordinate to 9 decimals, more accurate than the tolerance of a closure in a file."""
    rounded = round(value, 9) + 0.0  # no negative zero
    return f"{rounded:.9f}".rstrip("0").rstrip(".") if abs(rounded) < 1e9 else repr(rounded)


def _units(joint: JointPosition) -> str:
    """The unit of the coordinates, once if all are equal; for a quaternion the order of its numbers."""
    units = [coordinate.unit for coordinate in joint.coordinates if coordinate.unit]
    words = list(dict.fromkeys(units)) if len(set(units)) == 1 else units
    quaternion = [coordinate.name for coordinate in joint.coordinates if not coordinate.unit]
    return "  ".join([*words, *(["quaternion " + " ".join(quaternion)] if quaternion else [])])


def _closures(info: AssemblyInfo) -> Table:
    table = new_table("closure", "m", "rad", "")
    for column in table.columns[1:3]:
        column.justify = "right"
    for closure in info.closures:
        numbers = ("-" if number is None else f"{number:.1e}" for number in (closure.position, closure.angle))
        table.add_row(
            cell(closure.name, "bold"), *numbers, cell("closed", "green") if closure.closed else cell("open", "red")
        )
    return table
