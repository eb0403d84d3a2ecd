"""``eurdf assemble``: find a configuration that closes the loops, show it, and write it to the description."""

from __future__ import annotations

import math
from collections.abc import Collection
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Literal

from eurdf.commands.command import JSON, ROBOT, cannot_run, command, flag, option
from eurdf.commands.output import write_result
from eurdf.commands.selection import NEUTRAL, named_configuration
from eurdf.commands.terminal import Table, write_notes, write_shown
from eurdf.errors import CannotRun
from eurdf.json_schema import Count, NullIfInfinite
from eurdf.mechanism.joint_types import JointType
from eurdf.mechanism.mechanism import root_joint

if TYPE_CHECKING:
    from eurdf.array import Vector
    from eurdf.kinematics.assembly import Assembly
    from eurdf.linking.configurations import BeyondLimit
    from eurdf.pinocchio.robot import Robot

_DESCRIPTION = """\
Find a configuration in which every loop is closed, and show the coordinates of each joint as in files.

The search starts at the configuration 'assembled', or at the neutral one if there is none. If possible, it keeps what
'assembled' states, else what it states of motors, and respects the joint limits. --write writes the configuration to
the description as 'assembled'; comments and everything else are kept.
"""

# Tolerance of each row of the residual, m or rad.
_TOLERANCE = 1e-13

Unit = Literal["rad", "m", ""]

# The unit of each coordinate; quaternions have none.
_UNITS: dict[str, Unit] = {"angle": "rad", "length": "m", "x": "m", "y": "m", "z": "m"}


@dataclass(frozen=True, slots=True)
class CoordinateInfo:
    """One number of a joint's configuration."""

    name: str
    """Kind of the number: angle, length, x, y, z, or qx, qy, qz, qw of a quaternion."""
    unit: Unit
    """Unit; empty for the numbers of a quaternion."""
    value: float
    """Value."""


@dataclass(frozen=True, slots=True)
class JointPosition:
    """A joint with its own coordinates (not a mimic joint)."""

    name: str
    """Name of the joint; root_joint for a floating root."""
    type: JointType
    """Type of the joint."""
    coordinates: tuple[CoordinateInfo, ...]
    """Its coordinates, in the order used in files."""
    actuated: bool
    """Whether it is actuated."""
    held: bool
    """Whether it was held by --hold."""
    beyond_limits: bool
    """Whether it is beyond its limits, which a file must not state."""


@dataclass(frozen=True, slots=True)
class OpeningInfo:
    """How far a closure is open."""

    name: str
    """Name of the closure."""
    position: NullIfInfinite
    """Distance between the origins of its frames, m; null if it is not finite."""
    angle: NullIfInfinite
    """Angle between its frames, rad; 0 for a 3d closure."""
    closed: bool
    """Whether it is open by at most 1e-6 (m, rad)."""


@dataclass(frozen=True, slots=True)
class AssemblyInfo:
    """The output of 'eurdf assemble --json'."""

    name: str
    """Name of the robot in the URDF."""
    start: str
    """Name of the configuration at which the search started; neutral if it is not from the file."""
    closes: bool
    """Whether each closure is open by at most 1e-6 (m, rad)."""
    residual: NullIfInfinite
    """Norm of the residual of all closures and couplings, m and rad."""
    iterations: Count
    """Number of evaluations of the residual."""
    within_limits: bool
    """Whether no joint is beyond its limits."""
    joints: tuple[JointPosition, ...]
    """The configuration found; the least open one if the loops do not close."""
    closures: tuple[OpeningInfo, ...]
    """The closures, then the couplings, each in file order."""
    file: str | None
    """The description, if --write is given; else null."""
    written: bool
    """Whether the configuration was written; false if the file already has it."""


@command(
    summary="find a configuration that closes the loops, and write it to the description",
    description=_DESCRIPTION,
    exit_codes="0 the loops close, 1 they do not or the robot has errors, 2 the command cannot run.",
    examples=("eurdf assemble my_robot --hold motor_knee --write",),
)
def assemble(
    options: dict[str, Any],
    path: str = ROBOT,
    write: bool = flag("write it to the description as 'assembled'"),
    force: bool = flag("replace an existing, different 'assembled'"),
    hold: list[str] = option("do not move this joint (repeatable)", metavar="JOINT", action="append", default=[]),
    limits: bool = flag("never exceed the joint limits"),
    start: str | None = option(
        f"configuration to start from: one of the description, or {NEUTRAL}", "--from", metavar="CONFIGURATION"
    ),
    json: bool = JSON,
) -> int:
    """Assemble, show, and write."""
    from eurdf.kinematics.holding import held_in_turn
    from eurdf.linking.configurations import beyond_limits
    from eurdf.linking.robot_files import read_valid
    from eurdf.pinocchio.robot import build_robot
    from eurdf.writing.saved_configuration import NAME, CannotSave, file_to_save_to, save_configuration

    if force and not write:
        raise CannotRun("--force has no effect without --write; add --write")
    read = read_valid(path, geometry=False, **options)
    if read.yaml is None:
        raise CannotRun(
            f"'{read.path}' is a plain URDF, without loops; `eurdf generate` writes a description with closures"
        )
    with cannot_run(CannotSave):
        file = file_to_save_to(path, read) if write else None
    robot = build_robot(read.mechanism, geometry=False)
    start = start or (NAME if NAME in robot.configurations else NEUTRAL)
    with cannot_run(ValueError):
        q0 = named_configuration(robot, start)
        stated = read.mechanism.configurations.get(start, {}) if start == NAME and not hold else {}
        for held in held_in_turn(robot, stated):
            assembly = _assemble(robot, q0, [*hold, *held], limits)
            if assembly.converged:
                break
    beyond = beyond_limits(robot.mechanism.joints, robot.joint_positions(assembly.q))
    info = replace(_assembly_info(robot, assembly, start, hold, {found.joint for found in beyond}), file=file)
    if not json:
        _show(info)
    is_written = assembly.closes and not beyond
    if file is not None and is_written:
        try:
            info = replace(info, written=save_configuration(read, robot, assembly.q, force=force))
        except CannotSave as reason:
            replaces = NAME in robot.configurations and not force
            raise CannotRun(f"{reason}; --force replaces it" if replaces else str(reason)) from None
    if json:
        write_result(info)
    write_notes(_messages(info, assembly, beyond))
    return 0 if (assembly.closes if file is None else is_written) else 1


def _assemble(robot: Robot, q0: Vector, hold: list[str], limits: bool) -> Assembly:
    """A closed configuration, within the joint limits if possible."""
    import numpy as np

    from eurdf.kinematics.assembly import assemble
    from eurdf.kinematics.position_limit import position_limits
    from eurdf.linking.configurations import beyond_limits

    held = [velocity for name in hold for velocity in robot.tree.velocities_of(name)]
    # All joints but the held ones within their limits, also those outside of loops.
    within = position_limits(robot).clip(q0, np.setdiff1d(np.arange(robot.tree.nv), held))
    assembly = assemble(robot, within if limits else q0, hold=hold, tolerance=_TOLERANCE, limits=limits)
    if not limits and assembly.closes and beyond_limits(robot.mechanism.joints, robot.joint_positions(assembly.q)):
        limited = assemble(robot, within, hold=hold, tolerance=_TOLERANCE, limits=True)
        if limited.closes:
            return limited
    return assembly


def _assembly_info(
    robot: Robot, assembly: Assembly, start: str, held: Collection[str], beyond: Collection[str]
) -> AssemblyInfo:
    types = {joint.name: joint.type for joint in (root_joint(""), *robot.mechanism.joints)}
    joints = tuple(
        JointPosition(
            name,
            types[name],
            tuple(
                CoordinateInfo(coordinate, unit, value)
                for (coordinate, unit), value in zip(_units(types[name]), values, strict=True)
            ),
            actuated=name in robot.actuation.joints,
            held=name in held,
            beyond_limits=name in beyond,
        )
        for name, values in robot.joint_positions(assembly.q).items()
    )
    return AssemblyInfo(
        name=robot.mechanism.name,
        start=start,
        closes=assembly.closes,
        residual=assembly.residual,
        iterations=assembly.iterations,
        within_limits=not beyond,
        joints=joints,
        closures=tuple(OpeningInfo(each.name, each.position, each.angle, not each.is_open) for each in assembly.open),
        file=None,
        written=False,
    )


def _units(kind: JointType) -> list[tuple[str, Unit]]:
    """Name and unit of each coordinate of a joint."""
    plain = kind.coordinates[: kind.quaternion]
    return [(name, _UNITS[name] if name in plain else "") for name in kind.coordinates]


def _messages(info: AssemblyInfo, assembly: Assembly, beyond: list[BeyondLimit]) -> list[str]:
    """The messages after the table, which shows all openings."""
    from eurdf.kinematics.opening import widest

    nothing_written = [f"nothing was written to '{info.file}'"] if info.file is not None else []
    if not info.closes:
        held = ", ".join(f"'{joint.name}'" for joint in info.joints if joint.held)
        found = f"no configuration was found that closes the loops{held and f' with {held} held'}"
        messages = [f"{found}; least open: {widest(assembly.open)}"]
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


def _show(info: AssemblyInfo) -> None:
    word, style = ("closed", "green") if info.closes else ("open", "red")
    residual = f", residual {info.residual:.1e}" if math.isfinite(info.residual) else ""
    heading = (info.name, "bold"), "  ", (word, style), f"{residual}, from {info.start}"
    write_shown(heading, *([_joints(info)] if info.joints else []), *([] if info.closes else [_closures(info)]))


def _joints(info: AssemblyInfo) -> Table:
    rows = []
    for joint in info.joints:
        numbers = "  ".join(_number(coordinate.value) for coordinate in joint.coordinates)
        words = ("held", joint.held), ("beyond its limits", joint.beyond_limits), ("actuated", joint.actuated)
        notes = [word for word, applies in words if applies]
        style = "red" if joint.beyond_limits else "cyan"
        note = (", ".join(notes), style)
        rows.append(((joint.name, "bold"), joint.type.value, numbers, _units_shown(joint), note))
    return Table("joint", "type", "coordinates", "unit", "", rows=rows)


def _number(value: float) -> str:
    """A coordinate to 9 decimals, more accurate than the tolerance of a closure in a file."""
    rounded = round(value, 9) + 0.0  # no negative zero
    return f"{rounded:.9f}".rstrip("0").rstrip(".") if abs(rounded) < 1e9 else repr(rounded)


def _units_shown(joint: JointPosition) -> str:
    """The unit of the coordinates, once if all are equal; for a quaternion the order of its numbers."""
    units = [coordinate.unit for coordinate in joint.coordinates if coordinate.unit]
    words = list(dict.fromkeys(units)) if len(set(units)) == 1 else units
    quaternion = [coordinate.name for coordinate in joint.coordinates if not coordinate.unit]
    return "  ".join([*words, *(["quaternion " + " ".join(quaternion)] if quaternion else [])])


def _closures(info: AssemblyInfo) -> Table:
    rows = []
    for closure in info.closures:
        numbers = (f"{number:.1e}" if math.isfinite(number) else "-" for number in (closure.position, closure.angle))
        state = ("closed", "green") if closure.closed else ("open", "red")
        rows.append(((closure.name, "bold"), *numbers, state))
    return Table("closure", "m", "rad", "", rows=rows, right=[1, 2])
