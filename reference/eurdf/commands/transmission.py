"""``eurdf transmission``: the map between motors and joints, at a configuration or over a grid of joint positions."""

from __future__ import annotations

import argparse
import csv
import io
import json
import os
from collections.abc import Mapping, Sequence
from itertools import product
from typing import TYPE_CHECKING, Any

from eurdf.commands.cannot_run import CannotRun
from eurdf.commands.migrate import print_notes, show_report
from eurdf.commands.output import cell, new_table, write_json, write_rendered
from eurdf.commands.output_file import refuse_to_replace, write_new, writing
from eurdf.commands.robot_options import add_robot_options, add_robot_path, add_serial_joints, ending, robot_options
from eurdf.commands.selection import select_one

if TYPE_CHECKING:
    from rich.table import Table

    from eurdf.commands.transmission_info import LimitsInfo, PoseInfo, TransmissionInfo
    from eurdf.kinematics.array import Vector
    from eurdf.pinocchio.robot import Robot

_DESCRIPTION = """\
Show how motors drive joints through the loops of a robot: velocities, torques, the limits that those of the motors
leave to the joints, and the inertia that the joints feel.

The joints are those of the equivalent serial robot, such as pitch and roll of an ankle. --grid moves them over all
poses that they reach, on one branch, with no joint beyond its position limits.
"""
_EPILOG = ending(
    "0 shown, 1 the robot has errors or the map does not exist there, 2 the command cannot run.",
    "eurdf transmission unitree_g1_ankle --joints free_pitch free_roll",
    "eurdf transmission unitree_g1_ankle --joints free_pitch free_roll --grid 41 --csv ankle.csv",
    "eurdf transmission unitree_g1_ankle --joints free_pitch free_roll --plot ankle.pdf --c controller",
)

# Number of points along each joint in a figure, unless --grid states it.
_FIGURE = 25
# Largest number of configurations of a grid.
_MOST_POSES = 1_000_000


def register(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the command to the parser."""
    parser = subparsers.add_parser(
        "transmission",
        help="show how motors drive joints through loops: velocities, torques, limits, inertia",
        description=_DESCRIPTION,
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    add_robot_path(parser)
    add_robot_options(parser)
    add_serial_joints(parser)
    poses = parser.add_mutually_exclusive_group()
    poses.add_argument(
        "--at",
        metavar="POSE",
        help="a configuration of the description, or a JSON file with coordinates by joint; the joints that it leaves "
        "out follow; default: assembled",
    )
    poses.add_argument(
        "--grid", type=int, metavar="N", help="N positions of each joint, from its lower to its upper limit"
    )
    parser.add_argument("--json", action="store_true", help="write one JSON object")
    parser.add_argument("--csv", metavar="FILE", help="write a table with one row for each pose")
    parser.add_argument(
        "--plot",
        metavar="FILE",
        help="draw what the joints reach, with limits and inertia there, as .png, .svg or .pdf; needs the extra plot",
    )
    parser.add_argument(
        "--c", metavar="FOLDER", help="write the map as C99 without dependencies, for controllers; it starts at --at"
    )
    parser.add_argument("--force", action="store_true", help="replace files of --csv, --plot and --c")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Show the transmission, and return the exit code."""
    from eurdf.exceptions import EurdfError, InvalidRobot, MissingExtra

    path = select_one(args.path)
    if args.force and not (args.csv or args.plot or args.c):
        raise CannotRun("--force has no effect without --csv, --plot or --c; add one of them")
    for file in (args.csv, args.plot):
        if file:
            refuse_to_replace(file, args.force)
    from eurdf.checking.load import load
    from eurdf.transmissions.exceptions import NoTransmission

    try:
        robot = load(path, geometry=False, **robot_options(args))
    except InvalidRobot as refusal:
        show_report(path, tuple(refusal.diagnostics), args.json)
        return 1
    try:
        info = _info(robot, args)
        written = [*_drawn(robot, args), *_generated(robot, args)]
    except NoTransmission as reason:
        print_notes([str(reason)])
        return 1
    except MissingExtra:
        raise
    except (EurdfError, ValueError) as reason:
        raise CannotRun(str(reason)) from None
    if args.csv:
        write_new(args.csv, csv_text(info), args.force)
    if args.json:
        write_json(info.model_dump(mode="json"))
    else:
        _show(info)
    print_notes([*_notes(info, args), *(f"wrote '{each}'" for each in written)])
    return 0 if any(pose.G is not None for pose in info.poses) else 1


def _info(robot: Robot, args: argparse.Namespace) -> TransmissionInfo:
    from eurdf.commands.transmission_info import transmission_info
    from eurdf.transmissions.motors import motors_of
    from eurdf.transmissions.selection import selection
    from eurdf.transmissions.workspace import workspace

    joints = selection(robot, args.joints, "--joints")
    motors = motors_of(robot, joints) if args.motors is None else selection(robot, args.motors, "--motors")
    if args.grid is None:
        q = _pose(robot, args.at)
        at = robot.coordinates(q)
        return transmission_info(robot, joints, motors, [q], [[value for name in joints.joints for value in at[name]]])
    if args.grid < 2 or args.grid ** len(joints) > _MOST_POSES:
        raise CannotRun(f"--grid {args.grid} makes {args.grid ** len(joints)} poses; give 2 to {_MOST_POSES}")
    reached = workspace(robot, joints.joints, motors=motors.joints, grid=args.grid)
    found: dict[tuple[int, ...], Vector] = dict(zip(map(tuple, reached.index.tolist()), reached.q, strict=True))
    nodes = list(product(*(range(len(axis)) for axis in reached.axes)))
    positions = [[float(axis[i]) for axis, i in zip(reached.axes, node, strict=True)] for node in nodes]
    return transmission_info(robot, joints, motors, [found.get(node) for node in nodes], positions)


def _drawn(robot: Robot, args: argparse.Namespace) -> list[str]:
    """Draw the workspace, if asked; the path of the figure."""
    if not args.plot:
        return []
    from eurdf.transmissions.plot import plot_workspace
    from eurdf.transmissions.workspace import workspace

    q = None if args.grid is not None else _pose(robot, args.at)
    found = workspace(robot, args.joints, q, args.motors, grid=_FIGURE if args.grid is None else args.grid)
    with writing():
        return [os.fspath(plot_workspace(found, args.plot))]


def _generated(robot: Robot, args: argparse.Namespace) -> list[str]:
    """Generate the C, if asked; the paths of the files."""
    if not args.c:
        return []
    from eurdf.transmissions.prepared import prepare_transmission

    q = None if args.grid is not None else _pose(robot, args.at)
    source = prepare_transmission(robot, args.joints, q, args.motors).c_source()
    with writing():
        return [os.fspath(each) for each in source.write(args.c, force=args.force)]


def _pose(robot: Robot, given: str | None) -> Vector:
    """A closed configuration (nq,)."""
    from eurdf.kinematics.assembly import assemble
    from eurdf.kinematics.forward import forward_kinematics

    if given is None or (given in robot.configurations and not os.path.exists(given)):
        assembly = assemble(robot, None if given is None else robot.configurations[given])
        if not assembly.closes:
            raise CannotRun(f"the loops do not close at '{given or 'assembled'}'; `eurdf assemble` shows how far")
        return assembly.q
    return forward_kinematics(robot, _coordinates(robot, given))


def _coordinates(robot: Robot, file: str) -> Mapping[str, Any]:
    """The coordinates in a JSON file, by joint."""
    try:
        with open(file, encoding="utf-8") as stream:
            found = json.load(stream)
    except FileNotFoundError:
        known = ", ".join(robot.configurations) or "none"
        raise CannotRun(
            f"--at: there is no file '{file}', nor a configuration of this name; the configurations are: {known}"
        ) from None
    except (OSError, ValueError) as error:
        raise CannotRun(f"--at: cannot read '{file}' as JSON: {error}") from None
    if not isinstance(found, dict):
        raise CannotRun(f"--at: '{file}' is no JSON object; write coordinates by joint, such as {{\"ankle\": 0.1}}")
    return found


def csv_text(info: TransmissionInfo) -> str:
    """One row for each pose; numbers that do not exist are empty."""
    joints, motors = [axis.name for axis in info.joints], [axis.name for axis in info.motors]
    axes = [axis.name for axis in (*info.joints, *info.motors)]
    ranges = [f"{kind}_{end}[{name}]" for kind in ("torque", "velocity") for name in joints for end in ("min", "max")]
    boxes = [f"{kind}_box[{name}]" for kind in ("torque", "velocity") for name in joints]
    maps = [f"G[{motor},{joint}]" for motor in motors for joint in joints]
    terms = ("rotors", "linkage", "serial", "other_armature")
    inertias = [f"{term}[{one},{other}]" for term in terms for one in joints for other in joints]
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow([*axes, "reached", "beyond", "condition", *maps, *ranges, *boxes, *inertias, "reason"])
    for pose in info.poses:
        limits, inertia = pose.limits, pose.inertia
        numbers = [
            *pose.joints,
            *(pose.motors or [""] * len(motors)),
            int(pose.reached),
            " ".join(pose.beyond),
            "" if pose.condition is None else pose.condition,
            *(_flat(pose.G) if pose.G else [""] * len(maps)),
            *([*_flat(limits.torque), *_flat(limits.velocity)] if limits else [""] * len(ranges)),
            *([*limits.torque_box, *limits.velocity_box] if limits else [""] * len(boxes)),
            *([each for term in terms for each in _flat(getattr(inertia, term))] if inertia else [""] * len(inertias)),
            pose.reason or "",
        ]
        writer.writerow(numbers)
    return out.getvalue()


def _flat(rows: Sequence[Sequence[float]]) -> list[float]:
    return [number for row in rows for number in row]


def _notes(info: TransmissionInfo, args: argparse.Namespace) -> list[str]:
    """What follows the tables."""
    one = info.poses[0] if len(info.poses) == 1 else None
    notes: list[str] = []
    if one is not None:
        if one.reason:
            notes.append(f"G does not exist: {one.reason}")
        if one.inverse_reason:
            notes.append(f"B_J does not exist: {one.inverse_reason}")
        if one.beyond:
            notes.append(f"beyond their position limits: {', '.join(one.beyond)}")
    if any(pose.inertia for pose in info.poses) and not any(map(_has_rotors, info.poses)):
        notes.append("the motors have no armature; state gear_ratio and rotor_inertia of the actuators")
    if info.limits_reason:
        notes.append(f"no limits of the joints: {info.limits_reason}")
    if args.csv:
        notes.append(f"wrote {len(info.poses)} poses to '{args.csv}'")
    return notes


def _has_rotors(pose: PoseInfo) -> bool:
    return pose.inertia is not None and any(_flat(pose.inertia.rotors))


def _show(info: TransmissionInfo) -> None:
    from rich.text import Text

    from eurdf.diagnostics.visible import visible

    names = (", ".join(axis.name for axis in axes) for axes in (info.motors, info.joints))
    motors, joints = map(visible, names)
    heading = Text.assemble((visible(info.name), "bold"), f"  motors {motors}, joints {joints}")
    if len(info.poses) == 1:
        (pose,) = info.poses
        tables = [_map_table(info, pose), *([_joint_table(info, pose)] if pose.limits or pose.inertia else [])]
        write_rendered(heading, *tables)
    else:
        write_rendered(heading, *_grid_tables(info))


def _map_table(info: TransmissionInfo, pose: PoseInfo) -> Table:
    """G, with the positions of the motors; B_J, with those of the joints, where there is no G."""
    backward = pose.G is None and pose.B_J is not None
    of, by = (info.joints, info.motors) if backward else (info.motors, info.joints)
    positions, rows = (pose.joints, pose.B_J) if backward else (pose.motors or (), pose.G)
    table = new_table("joint" if backward else "motor", "position", "unit", *(f"per {axis.name}" for axis in by))
    for row, (axis, position) in enumerate(zip(of, positions, strict=True)):
        numbers = ["-"] * len(by) if rows is None else map(_number, rows[row])
        table.add_row(cell(axis.name, "bold"), _number(position), axis.unit, *numbers)
    return table


def _joint_table(info: TransmissionInfo, pose: PoseInfo) -> Table:
    """Positions, limits and inertia of the joints."""
    table = new_table("", *(axis.name for axis in info.joints))
    for column in table.columns[1:]:
        column.justify = "right"
    units = [axis.unit for axis in info.joints]
    table.add_row("position", *(f"{_number(value)} {unit}" for value, unit in zip(pose.joints, units, strict=True)))
    if pose.limits:
        for label, numbers in _limit_rows(pose.limits, units):
            table.add_row(label, *numbers)
    if pose.inertia:
        terms = [("linkage", pose.inertia.linkage)]
        if _has_rotors(pose):
            terms.insert(0, ("rotors", pose.inertia.rotors))
        for label, term in terms:
            own = [term[j][j] for j in range(len(units))]
            shown = [f"{_number(value)} {_INERTIA[unit]}" for value, unit in zip(own, units, strict=True)]
            table.add_row(f"inertia of {label}", *shown)
    return table


_INERTIA = {"rad": "kg·m²", "m": "kg"}
_TORQUE = {"rad": "N·m", "m": "N"}


def _limit_rows(limits: LimitsInfo, units: Sequence[str]) -> list[tuple[str, list[str]]]:
    torques, speeds = [_TORQUE[unit] for unit in units], [f"{unit}/s" for unit in units]
    return [
        ("torque, others zero", _ranges(limits.torque, torques)),
        ("torque, all at once", _sides(limits.torque_box, torques)),
        ("velocity, others zero", _ranges(limits.velocity, speeds)),
        ("velocity, all at once", _sides(limits.velocity_box, speeds)),
    ]


def _ranges(ranges: Sequence[tuple[float, float]], units: Sequence[str]) -> list[str]:
    return [f"{_number(lower)} to {_number(upper)} {unit}" for (lower, upper), unit in zip(ranges, units, strict=True)]


def _sides(sides: Sequence[float], units: Sequence[str]) -> list[str]:
    return [f"±{_number(side)} {unit}" for side, unit in zip(sides, units, strict=True)]


def _grid_tables(info: TransmissionInfo) -> list[Any]:
    from rich.text import Text

    poses = info.poses
    counts = f"{len(poses)} poses, {sum(pose.reached for pose in poses)} of them reached within all position limits"
    units = [axis.unit for axis in info.joints]
    spread = new_table("", *(f"{axis.name}: least to most" for axis in info.joints))
    inside = [pose for pose in poses if pose.reached]
    for label, word, by_unit in (
        ("torque, others zero", "torque", _TORQUE),
        ("velocity, others zero", "velocity", {unit: f"{unit}/s" for unit in units}),
    ):
        rows = [getattr(pose.limits, word) for pose in inside if pose.limits]
        if rows:
            ends = [[min(-row[j][0], row[j][1]) for row in rows] for j in range(len(units))]
            spread.add_row(label, *(_span(own, by_unit[unit]) for own, unit in zip(ends, units, strict=True)))
    for label in ("rotors", "linkage") if any(map(_has_rotors, inside)) else ("linkage",):
        terms = [getattr(pose.inertia, label) for pose in inside if pose.inertia]
        if terms:
            own = [[term[j][j] for term in terms] for j in range(len(units))]
            shown = (_span(each, _INERTIA[unit]) for each, unit in zip(own, units, strict=True))
            spread.add_row(f"inertia of {label}", *shown)
    tables: list[Any] = [Text(counts), *([spread] if spread.row_count else [])]
    if info.common:
        table = new_table("at all poses reached", *(axis.name for axis in info.joints))
        for column in table.columns[1:]:
            column.justify = "right"
        for label, numbers in _limit_rows(info.common, units):
            table.add_row(label, *numbers)
        tables.append(table)
    return tables


def _span(values: Sequence[float], unit: str) -> str:
    return f"{_number(min(values))} to {_number(max(values))} {unit}"


def _number(value: float) -> str:
    """To five digits; nothing smaller than 1e-12."""
    return f"{0.0 if abs(value) < 1e-12 else value:.5g}"
