"""``eurdf transmission``: the map between motors and joints, at a configuration or over a grid of joint positions."""

from __future__ import annotations

import csv
import io
import json as json_text
import os
from collections.abc import Iterable, Mapping, Sequence
from functools import partial
from itertools import product
from typing import TYPE_CHECKING, Any, Literal

from eurdf.commands.command import JSON, ROBOT, SERIAL_JOINTS, SERIAL_MOTORS, cannot_run, command, flag, option
from eurdf.commands.output import write_result
from eurdf.commands.output_file import refuse_to_replace, write_new, writing
from eurdf.commands.terminal import Table, write_notes, write_shown
from eurdf.errors import CannotRun

if TYPE_CHECKING:
    from eurdf.array import Vector
    from eurdf.commands.transmission_info import LimitsInfo, PoseInfo, TransmissionInfo
    from eurdf.pinocchio.robot import Robot

_DESCRIPTION = """\
Show how motors drive joints through the loops of a robot: velocities, torques, the limits that those of the motors
leave to the joints, and the inertia that the joints feel.

The joints are those of the equivalent serial robot, such as pitch and roll of an ankle. --grid moves them over all
poses that they reach, on one branch, with no joint beyond its position limits.
"""

# Number of points along each joint in a figure, unless --grid states it.
_FIGURE = 25
# Largest number of configurations of a grid.
_MOST_POSES = 1_000_000


@command(
    summary="show how motors drive joints through loops: velocities, torques, limits, inertia",
    description=_DESCRIPTION,
    exit_codes="0 shown, 1 the robot has errors or the map does not exist there, 2 the command cannot run.",
    examples=(
        "eurdf transmission unitree_g1_ankle --joints free_pitch free_roll",
        "eurdf transmission unitree_g1_ankle --joints free_pitch free_roll --grid 41 --csv ankle.csv",
        "eurdf transmission unitree_g1_ankle --joints free_pitch free_roll --plot ankle.pdf --c controller",
        "eurdf transmission unitree_g1_ankle --joints free_pitch free_roll --python training",
    ),
)
def transmission(
    options: dict[str, Any],
    path: str = ROBOT,
    joints: list[str] = SERIAL_JOINTS,
    motors: list[str] | None = SERIAL_MOTORS,
    at: str | None = option(
        "a configuration of the description, or a JSON file with coordinates by joint; the joints that it leaves out "
        "follow; default: assembled",
        group="pose",
        metavar="POSE",
    ),
    grid: int | None = option(
        "N positions of each joint, from its lower to its upper limit", group="pose", type=int, metavar="N"
    ),
    json: bool = JSON,
    table: str | None = option("write a table with one row for each pose", "--csv", metavar="FILE"),
    plot: str | None = option(
        "draw what the joints reach, with limits and inertia there, as .png, .svg or .pdf; needs the extra plot",
        metavar="FILE",
    ),
    c: str | None = option(
        "write the map as C99 without dependencies, for controllers; it starts at --at", metavar="FOLDER"
    ),
    ros2: str | None = option(
        "write a package of ROS 2 with the map as a plugin of ros2_control; it starts at --at", metavar="FOLDER"
    ),
    python: str | None = option(
        "write the map for arrays of NumPy, JAX or torch as one Python file without dependencies, for training",
        metavar="FOLDER",
    ),
    single: bool = flag("let --c and --ros2 compute in single precision, for controllers without double"),
    force: bool = flag("replace files of --csv, --plot, --c, --ros2 and --python"),
) -> int:
    """Show the transmission."""
    import eurdf
    from eurdf.errors import EurdfError, NoTransmission

    if force and not (table or plot or c or ros2 or python):
        raise CannotRun("--force has no effect without --csv, --plot, --c, --ros2 or --python; add one of them")
    if single and not (c or ros2):
        raise CannotRun("--single has no effect without --c or --ros2; add one of them")
    for file in (table, plot):
        if file:
            refuse_to_replace(file, force)
    robot = eurdf.load(path, geometry=False, **options)
    written: list[str] = []
    try:
        with cannot_run(EurdfError, ValueError, unless=(NoTransmission,)):
            q = _configuration(robot, at) if grid is None else None
            info = _info(robot, joints, motors, q, grid)
            if plot:
                from eurdf.transmissions.plot import plot_workspace
                from eurdf.transmissions.reachable_set import workspace

                found = workspace(robot, joints, q, motors=motors, grid=_FIGURE if grid is None else grid)
                with writing():
                    written.append(os.fspath(plot_workspace(found, plot)))
            if c or ros2 or python:
                from eurdf.transmissions.prepared import prepare_transmission

                prepared = prepare_transmission(robot, joints, q, motors=motors)
                real: Literal["double", "float"] = "float" if single else "double"
                makers = (
                    (c, partial(prepared.c_source, real=real)),
                    (ros2, partial(prepared.ros2_package, real=real)),
                    (python, prepared.python_source),
                )
                sources = [(folder, make()) for folder, make in makers if folder]
                for file in (os.path.join(folder, name) for folder, source in sources for name in source.files):
                    refuse_to_replace(file, force)
                with writing():
                    for folder, source in sources:
                        written += map(os.fspath, source.write(folder, force=force))
    except NoTransmission as reason:
        write_notes([str(reason)])
        return 1
    if table:
        write_new(table, csv_text(info), force)
    if json:
        write_result(info)
    else:
        _show(info)
    count = [f"wrote {len(info.poses)} poses to '{table}'"] if table else []
    write_notes([*_notes(info), *count, *(f"wrote '{each}'" for each in written)])
    return 0 if any(pose.G is not None for pose in info.poses) else 1


def _info(
    robot: Robot, joint_names: Sequence[str], motor_names: Sequence[str] | None, q: Vector | None, grid: int | None
) -> TransmissionInfo:
    """The transmission at q, or over a grid."""
    from eurdf.commands.transmission_info import transmission_info
    from eurdf.transmissions.motors import motors_of
    from eurdf.transmissions.reachable_set import workspace
    from eurdf.transmissions.selection import selection

    joints = selection(robot, joint_names, "--joints")
    motors = motors_of(robot, joints) if motor_names is None else selection(robot, motor_names, "--motors")
    if grid is None:
        assert q is not None
        at = robot.joint_positions(q)
        return transmission_info(robot, joints, motors, [q], [[value for name in joints.joints for value in at[name]]])
    if grid < 2 or grid ** len(joints) > _MOST_POSES:
        raise CannotRun(f"--grid {grid} makes {grid ** len(joints)} poses; give 2 to {_MOST_POSES}")
    reached = workspace(robot, joints.joints, motors=motors.joints, grid=grid)
    found: dict[tuple[int, ...], Vector] = dict(zip(map(tuple, reached.index.tolist()), reached.q, strict=True))
    nodes = list(product(*(range(len(axis)) for axis in reached.axes)))
    positions = [[float(axis[i]) for axis, i in zip(reached.axes, node, strict=True)] for node in nodes]
    return transmission_info(robot, joints, motors, [found.get(node) for node in nodes], positions)


def _configuration(robot: Robot, given: str | None) -> Vector:
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
            found = json_text.load(stream)
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


def _notes(info: TransmissionInfo) -> list[str]:
    """What follows the tables."""
    notes: list[str] = []
    if len(info.poses) == 1:
        (one,) = info.poses
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
    return notes


def _has_rotors(pose: PoseInfo) -> bool:
    return pose.inertia is not None and any(_flat(pose.inertia.rotors))


def _show(info: TransmissionInfo) -> None:
    names = (", ".join(axis.name for axis in axes) for axes in (info.motors, info.joints))
    motors, joints = names
    heading = (info.name, "bold"), f"  motors {motors}, joints {joints}"
    if len(info.poses) == 1:
        (pose,) = info.poses
        tables = [_map_table(info, pose), *([_joint_table(info, pose)] if pose.limits or pose.inertia else [])]
        write_shown(heading, *tables)
    else:
        write_shown(heading, *_grid_tables(info))


def _map_table(info: TransmissionInfo, pose: PoseInfo) -> Table:
    """G, with the positions of the motors; B_J, with those of the joints, where there is no G."""
    backward = pose.G is None and pose.B_J is not None
    of, by = (info.joints, info.motors) if backward else (info.motors, info.joints)
    positions, matrix = (pose.joints, pose.B_J) if backward else (pose.motors or (), pose.G)
    rows = (
        ((axis.name, "bold"), _number(position), axis.unit, *(map(_number, row) if row else ["-"] * len(by)))
        for axis, position, row in zip(of, positions, matrix or [()] * len(of), strict=True)
    )
    headings = ("joint" if backward else "motor", "position", "unit", *(f"per {axis.name}" for axis in by))
    return Table(*headings, rows=rows)


def _joint_table(info: TransmissionInfo, pose: PoseInfo) -> Table:
    """Positions, limits and inertia of the joints."""
    units = [axis.unit for axis in info.joints]
    rows = [("position", _with_units(pose.joints, units))]
    if pose.limits:
        rows += _limit_rows(pose.limits, units)
    if pose.inertia:
        for label in _terms([pose]):
            own = [row[j] for j, row in enumerate(getattr(pose.inertia, label))]
            rows.append((f"inertia of {label}", _with_units(own, [_INERTIA[unit] for unit in units])))
    return _table_of_joints("", info, rows)


def _table_of_joints(heading: str, info: TransmissionInfo, rows: Iterable[tuple[str, list[str]]]) -> Table:
    names = [axis.name for axis in info.joints]
    return Table(heading, *names, rows=((label, *cells) for label, cells in rows), right=range(1, len(names) + 1))


_INERTIA = {"rad": "kg·m²", "m": "kg"}
_TORQUE = {"rad": "N·m", "m": "N"}


def _terms(poses: Iterable[PoseInfo]) -> tuple[str, ...]:
    """The terms of the inertia that are shown."""
    return ("rotors", "linkage") if any(map(_has_rotors, poses)) else ("linkage",)


def _limit_rows(limits: LimitsInfo, units: Sequence[str]) -> list[tuple[str, list[str]]]:
    rows: list[tuple[str, list[str]]] = []
    for word, by in (("torque", [_TORQUE[unit] for unit in units]), ("velocity", [f"{unit}/s" for unit in units])):
        ranges, sides = getattr(limits, word), getattr(limits, f"{word}_box")
        ends = zip(ranges, by, strict=True)
        rows.append(
            (f"{word}, others zero", [f"{_number(lower)} to {_number(upper)} {u}" for (lower, upper), u in ends])
        )
        rows.append((f"{word}, all at once", [f"±{each}" for each in _with_units(sides, by)]))
    return rows


def _with_units(values: Sequence[float], units: Sequence[str]) -> list[str]:
    return [f"{_number(value)} {unit}" for value, unit in zip(values, units, strict=True)]


def _grid_tables(info: TransmissionInfo) -> list[Any]:
    poses = info.poses
    counts = f"{len(poses)} poses, {sum(pose.reached for pose in poses)} of them reached within all position limits"
    units = [axis.unit for axis in info.joints]
    inside = [pose for pose in poses if pose.reached]
    # Of each joint, its value at each pose.
    spreads: list[tuple[str, list[list[float]], list[str]]] = []
    for word, by in (("torque", [_TORQUE[unit] for unit in units]), ("velocity", [f"{unit}/s" for unit in units])):
        ranges = [getattr(pose.limits, word) for pose in inside if pose.limits]
        ends = [[min(-lower, upper) for lower, upper in joint] for joint in zip(*ranges, strict=True)]
        spreads.append((f"{word}, others zero", ends, by))
    for label in _terms(inside):
        terms = [getattr(pose.inertia, label) for pose in inside if pose.inertia]
        own = [[term[j][j] for term in terms] for j in range(len(units))] if terms else []
        spreads.append((f"inertia of {label}", own, [_INERTIA[unit] for unit in units]))
    rows = [
        (label, *(f"{_number(min(own))} to {_number(max(own))} {unit}" for own, unit in zip(values, by, strict=True)))
        for label, values, by in spreads
        if values
    ]
    headings = ("", *(f"{axis.name}: least to most" for axis in info.joints))
    tables: list[Any] = [[counts], *([Table(*headings, rows=rows)] if rows else [])]
    if info.common:
        tables.append(_table_of_joints("at all poses reached", info, _limit_rows(info.common, units)))
    return tables


def _number(value: float) -> str:
    """To five digits; nothing smaller than 1e-12."""
    return f"{0.0 if abs(value) < 1e-12 else value:.5g}"
