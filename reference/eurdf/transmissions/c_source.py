"""The transmission as dependency-free C99, for controllers that run no Python."""

from __future__ import annotations

import math
import os
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path
from string import Template
from typing import TYPE_CHECKING

from eurdf.array import Vector
from eurdf.closures import MODULES
from eurdf.kinematics.closing import SPREADS
from eurdf.kinematics.loop import find_loops
from eurdf.kinematics.scale import row_scale
from eurdf.kinematics.tangent_space import TangentSpaces
from eurdf.kinematics.tolerances import (
    CLOSED,
    FOLLOWED,
    LEAST_CORRECTION,
    LONGEST_MOTION,
    MOST_CORRECTION,
    MOST_IDLE_STEPS,
    MOST_STEPS,
    RESTARTS,
    SHORTEST_STEP,
)
from eurdf.mechanism.body import WORLD
from eurdf.mechanism.constraint import Closure, Constraint, Coupling
from eurdf.mechanism.joint import Joint, Mimic
from eurdf.mechanism.pose import IDENTITY, ORIGIN, Pose, Vector3, X, Y, Z, cross, direction
from eurdf.pinocchio.mimic import following
from eurdf.transmissions.drive import MOST_SUBSTEPS, SINGULAR, Drive
from eurdf.writing.output_folder import write_files

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot

#: What the kernel calls each kind of constraint.
_KINDS = {type_: module.upper() for type_, module in MODULES.items()} | {Coupling.type: "COUPLING"}

# Given velocities are independent if none of them opens the loops by more, dimensionless.
_DETERMINED = 1e-6
# Of the damping of a descent, relative to the squares of the derivative: its root is above SINGULAR.
_LEAST_DAMPING = 1e-10


@dataclass(frozen=True, slots=True)
class CSource:
    """The transmission in C.

    Attributes:
        files: The content of the header and of the source, by file name.
    """

    files: Mapping[str, bytes]

    def write(self, folder: str | os.PathLike[str], *, force: bool = False) -> tuple[Path, ...]:
        """Write the files to a folder: all of them or none.

        Raises:
            FileExistsError: A file exists, and ``force`` is False.
            OSError: A file cannot be written.
        """
        return write_files(folder, self.files, force=force)


def c_source(
    robot: Robot, by_joints: Drive, by_motors: Drive | None, q: Vector, prefix: str | None, steps: int, substeps: int
) -> CSource:
    """The source; see `eurdf.transmissions.prepared.PreparedTransmission.c_source`."""
    name = prefix
    if name is None:
        made = re.sub(r"[^A-Za-z0-9_]", "_", f"{robot.mechanism.name}_transmission")
        name = made.lstrip("_0123456789").lower() or "transmission"
    if not re.fullmatch(r"[A-Za-z][A-Za-z0-9_]*", name):
        raise ValueError(f"prefix is {name!r}; it must be an identifier of C: letters, digits and _")
    for argument, count in (("steps", steps), ("substeps", substeps)):
        if not isinstance(count, int) or count < 1:
            raise ValueError(f"{argument} is {count!r}; it must be a positive integer")
    drives = [by_joints] if by_motors is None else [by_joints, by_motors]
    tables = _Tables(robot, drives, q)
    header = _header(tables, name, by_joints, by_motors is not None, steps, substeps)
    source = _source(tables, name, drives, steps, substeps)
    return CSource({f"{name}.h": header.encode(), f"{name}.c": source.encode()})


class _Tables:
    """The joints and constraints of some drives as numbers.

    Attributes:
        joints: Entry of each joint but number 0, which is at rest, parents first.
        start: Coordinates at the pose.
        units: Unit of each velocity.
        coordinates: For each velocity its coordinate; -1 for the first of a ball, -2 for the others.
        balls: For each velocity the first coordinate of its ball; -1 if it has none.
        velocity: Index here of a velocity of the robot's model.
        constraints: Indices of the constraints.
    """

    def __init__(self, robot: Robot, drives: Sequence[Drive], q: Vector) -> None:
        mechanism = robot.mechanism
        self.robot = robot
        self.constraints = sorted({index for drive in drives for index in drive.closures})
        chosen = [robot.constraints[index] for index in self.constraints]
        for constraint in chosen:
            if any(anchor.body == WORLD for anchor in constraint.anchors):
                raise ValueError(
                    f"the C of a transmission cannot have the contact '{constraint.name}' of a floating robot; prepare "
                    "it for the robot without contacts"
                )
        self._above = {joint.child: joint for joint in mechanism.joints}
        relevant = {body for constraint in chosen for body in self._between(constraint)}
        alone = {name for constraint in chosen for name in constraint.joints}
        alone |= {name for drive in drives for name in (*drive.given.joints, *drive.asked.joints)}
        mimics = following(mechanism).mimics
        self.velocity: dict[int, int] = {}
        self.start: list[float] = []
        self.units: list[float] = []
        self.coordinates: list[int] = []
        self.balls: list[int] = []
        own = {joint.name: mimics.get(joint.name) for joint in mechanism.joints if joint.child in relevant}
        needed = {name if mimic is None else mimic.joint for name, mimic in own.items()} | alone
        first: dict[str, tuple[int, int]] = {}
        values = robot.joint_positions(q)
        scale = robot.cached(TangentSpaces).scale
        for name, slot in robot.slots.items():
            if name not in needed:
                continue
            first[name] = len(self.start), len(self.units)
            quaternion = slot.joint.type.quaternion
            for k in range(slot.nv):
                self.velocity[slot.idx_v + k] = len(self.units)
                self.units.append(float(scale[slot.idx_v + k]))
                of_ball = quaternion is not None and k >= quaternion
                self.coordinates.append((-1 if k == quaternion else -2) if of_ball else len(self.start) + k)
                self.balls.append(len(self.start) + (quaternion or 0) if of_ball else -1)
            self.start += values[name]
        self.joints: list[str] = []
        self.places: dict[str, tuple[int, Pose]] = {}
        self.of_body: dict[str, range] = {}
        self.of_joint: dict[str, int] = {}
        for joint in mechanism.joints:
            if joint.child in relevant:
                self._add(joint, mimics.get(joint.name), first)
            elif joint.name in alone:
                self.of_joint[joint.name] = len(self.joints) + 1
                self.joints += _screws(joint, 0, IDENTITY, *first[joint.name], None, len(self.joints) + 1)

    def _add(self, joint: Joint, mimic: Mimic | None, first: Mapping[str, tuple[int, int]]) -> None:
        parent, pose = self.places.get(joint.parent, (0, IDENTITY))
        pose = pose * joint.placement
        if joint.type.is_fixed:
            self.places[joint.child] = parent, pose * joint.offset
            self.of_body[joint.child] = range(0)
            return
        start = len(self.joints) + 1
        leader = joint.name if mimic is None else mimic.joint
        self.joints += _screws(joint, parent, pose, *first[leader], mimic, start)
        self.of_joint[joint.name] = start
        self.of_body[joint.child] = range(start, len(self.joints) + 1)
        self.places[joint.child] = len(self.joints), joint.offset

    def _way_up(self, body: str) -> list[str]:
        """The body and what is above it."""
        way = [body]
        while way[-1] in self._above:
            way.append(self._above[way[-1]].parent)
        return way

    def _between(self, constraint: Constraint) -> set[str]:
        """The bodies on the way from one anchor to the other, without the one where they meet."""
        ends = [set(self._way_up(anchor.body)) for anchor in constraint.anchors]
        return ends[0] ^ ends[1] if ends else set()

    def anchors(self, constraint: Constraint) -> list[tuple[int, Pose]]:
        """The joints that carry the anchors of a constraint, and their poses there."""
        places = [self.places.get(anchor.body, (0, IDENTITY)) for anchor in constraint.anchors]
        return [(joint, pose * at.pose) for (joint, pose), at in zip(places, constraint.anchors, strict=True)]

    def path(self, constraint: Constraint) -> list[tuple[int, float]]:
        """The joints that move a constraint, with +1 for those that move B and -1 for A, or with coefficients."""
        if isinstance(constraint, Coupling):
            return [(self.of_joint[name], coefficient) for name, coefficient in constraint.coefficients]
        between, found = self._between(constraint), []
        for anchor, sign in zip(constraint.anchors, (-1.0, 1.0), strict=True):
            for body in self._way_up(anchor.body):
                if body in between:
                    found += [(joint, sign) for joint in self.of_body[body]]
        return found


def _screws(
    joint: Joint, parent: int, pose: Pose, coordinate: int, velocity: int, mimic: Mimic | None, number: int
) -> list[str]:
    """The entries of a joint as joints of one coordinate and balls in a row; ``number`` is that of the first."""
    factor, offset = (1.0, 0.0) if mimic is None else (mimic.multiplier, mimic.offset)
    found = []
    for k, (axis, turns, advance) in enumerate(joint.motions):
        numbers = parent, int(axis is None), int(turns), coordinate + k, velocity + k
        along = [advance * each for each in axis] if axis and advance else ORIGIN
        frame = f"{_rotation(pose)}, {_vector(pose.xyz)}, {_vector(axis or Z)}, {_vector(along)}"
        found.append(f"{{{', '.join(map(str, numbers))}, {_number(factor)}, {_number(offset)}, {frame}}}")
        parent, pose = number + k, IDENTITY
    return found


def _header(tables: _Tables, name: str, by_joints: Drive, both: bool, steps: int, substeps: int) -> str:
    joints, motors = by_joints.given, by_joints.asked
    nj, nm = len(joints), len(motors)
    listed = "".join(
        f" *   {role}[{index}]: {_comment(label)}, {unit}\n"
        for role, side in (("joints", joints), ("motors", motors))
        for index, (label, unit) in enumerate(zip(side.names, side.units, strict=True))
    )
    start_at_motors = f"int {name}_start_at_motors({name}_pose *pose, const double motors[{nm}]);\n"
    at_motors = f"""
/* The joints at positions of the motors, and B (row by row): the velocities are v_J = B v_m. */
int {name}_at_motors({name}_pose *pose, const double motors[{nm}], double joints[{nj}], double B[{nj * nm}]);
"""
    return Template(_file("interface.h")).substitute(
        robot=_comment(tables.robot.mechanism.name),
        listed=listed,
        name=name,
        NAME=name.upper(),
        nj=nj,
        nm=nm,
        size=nm * nj,
        coordinates=len(tables.start),
        solutions=1 + steps,
        substeps=substeps,
        most_substeps=MOST_SUBSTEPS,
        descents=1 + RESTARTS,
        descent_steps=MOST_STEPS,
        start_at_motors=start_at_motors if both else "",
        at_motors=at_motors if both else "",
    )


def _file(name: str) -> str:
    return (files("eurdf.transmissions") / name).read_text(encoding="utf-8")


def _source(tables: _Tables, name: str, drives: Sequence[Drive], steps: int, substeps: int) -> str:
    robot = tables.robot
    scale = row_scale(robot, robot.cached(TangentSpaces).length)
    rows = [loop.rows for loop in find_loops(robot)]
    path: list[str] = []
    constraints: list[str] = []
    for index in tables.constraints:
        constraint, of_rows = robot.constraints[index], rows[index]
        if constraint.type not in _KINDS:
            raise ValueError(
                f"constraint '{constraint.name}' is {constraint.type}, which the generated C does not support"
            )
        first = len(path)
        path += [f"{{{joint}, {_number(factor)}}}" for joint, factor in tables.path(constraint)]
        constraints.append(_constraint(constraint, tables, first, len(path), scale[of_rows]))
    place = {index: number for number, index in enumerate(tables.constraints)}
    calls = [_calls(name, drive, number) for number, drive in enumerate(drives)]
    most_rows = max(_rows_of(rows, drive) for drive in drives)
    limits = {
        "JOINTS": len(tables.joints) + 1,
        "COORDINATES": len(tables.start),
        "VELOCITIES": len(tables.units),
        "ROWS": max(1, most_rows),
        "SIDES": 1 + max(len(drive.given) for drive in drives),
        "STEPS": steps,
        "SUBSTEPS": substeps,
        "MOST_SUBSTEPS": MOST_SUBSTEPS,
        "RESTARTS": RESTARTS,
        "SPREADS": len(SPREADS),
        "DESCENT_STEPS": MOST_STEPS,
        "IDLE_STEPS": MOST_IDLE_STEPS,
        "BALLS": int(-1 in tables.coordinates),
    }
    bounds = {
        "CLOSED": FOLLOWED,
        "SINGULAR": SINGULAR,
        "DETERMINED": _DETERMINED,
        "STILL_CLOSED": CLOSED,
        "LEAST_DAMPING": _LEAST_DAMPING,
        "SHORTEST_STEP": SHORTEST_STEP,
        "TURN": 2.0 * math.pi,
        "LONGEST_MOTION": LONGEST_MOTION,
        "MOST_CORRECTION": MOST_CORRECTION,
        "LEAST_CORRECTION": LEAST_CORRECTION,
    }
    big = name.upper()
    parts = [
        f'/* See {name}.h. */\n#include "{name}.h"\n\n#include <math.h>\n#include <stdint.h>\n',
        "\n".join(f"#define {key} {value}" for key, value in limits.items()),
        "\n".join(f"#define {key} {_number(value)}" for key, value in bounds.items()),
        "#define BALL (-1)",
        f"#define CLOSED_POSE {big}_OK\n#define NOT_CLOSED {big}_NOT_CLOSED\n#define TOO_FAR {big}_TOO_FAR\n"
        f"#define AT_SINGULARITY {big}_SINGULAR\n#define NOT_FINITE {big}_NOT_FINITE",
        _file("tables.h").rstrip(),
        _array("double", "start", map(_number, tables.start)),
        _array("double", "units", map(_number, tables.units)),
        _array("double", "spreads", map(_number, SPREADS)),
        _array("int", "coordinates", map(str, tables.coordinates)),
        _array("int", "ball_coordinates", map(str, tables.balls)),
        _table("joint", "joints", ["{0, 0, 0, 0, 0, 0, 0, {0}, {0}, {0}, {0}}", *tables.joints]),
        _table("step", "path", path or ["{0, 0}"]),
        _table("constraint", "constraints", constraints or ["{0}"]),
        *(_drive(number, drive, tables, place, rows) for number, drive in enumerate(drives)),
        _file("kernel.c").rstrip(),
        f"void {name}_start({name}_pose *pose) {{\n"
        "    for (int k = 0; k < COORDINATES; ++k) pose->x[k] = start[k];\n}",
        *calls,
    ]
    return "\n\n".join(parts) + "\n"


def _constraint(constraint: Constraint, tables: _Tables, first: int, last: int, scale: Vector) -> str:
    ends = tables.anchors(constraint) or [(0, IDENTITY), (0, IDENTITY)]
    own = constraint.own if isinstance(constraint, Closure) else {}
    a, b = (direction(axis) for axis in own.get("axes", (Z, Z)))
    length = constraint.offset if isinstance(constraint, Coupling) else own.get("length", 0.0)
    frames = ", ".join(f"{_rotation(pose)}, {_vector(pose.xyz)}" for _, pose in ends)
    return (
        f"{{{_KINDS[constraint.type]}, {constraint.rows}, {first}, {last}, "
        f"{ends[0][0]}, {ends[1][0]}, {frames}, "
        f"{_number(length)}, {_vector(a)}, {_vector(b)}, {{{', '.join(map(_vector, _across(a)))}}}, {_vector(scale)}}}"
    )


def _across(a: Vector3) -> tuple[Vector3, Vector3]:
    """Two unit vectors across a unit vector and each other."""
    least = min(range(3), key=lambda k: abs(a[k]))
    first = direction(cross(a, (X, Y, Z)[least]))
    return first, cross(a, first)


def _drive(number: int, drive: Drive, tables: _Tables, place: Mapping[int, int], rows: Sequence[slice]) -> str:
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
    arrays = "\n".join(_array("int", f"{key}_{number}", map(str, values)) for key, values in lists.items())
    counts = (len(drive.given), len(drive.asked), len(own), _rows_of(rows, drive), drive.rank, len(drive.closures))
    names = ", ".join(f"{key}_{number}" for key in lists)
    return f"{arrays}\nstatic const drive drive_{number} = {{{', '.join(map(str, counts))}, {names}}};"


def _calls(name: str, drive: Drive, number: int) -> str:
    given, asked = ("joints", "motors") if number == 0 else ("motors", "joints")
    matrix = "G" if number == 0 else "B"
    n, m = len(drive.given), len(drive.asked)
    return (
        f"int {name}_at_{given}({name}_pose *pose, const double {given}[{n}], double {asked}[{m}], "
        f"double {matrix}[{m * n}]) {{\n"
        f"    return at_positions(&drive_{number}, pose->x, {given}, {asked}, {matrix});\n}}"
        f"\n\nint {name}_start_at_{given}({name}_pose *pose, const double {given}[{n}]) {{\n"
        f"    return start_at(&drive_{number}, pose->x, {given});\n}}"
    )


def _rows_of(rows: Sequence[slice], drive: Drive) -> int:
    return sum(rows[index].stop - rows[index].start for index in drive.closures)


def _array(type_: str, name: str, values: Iterable[str]) -> str:
    return f"static const {type_} {name}[] = {{{', '.join(values)}}};"


def _table(type_: str, name: str, entries: Sequence[str]) -> str:
    lines = ",\n".join(f"    {entry}" for entry in entries)
    return f"static const {type_} {name}[] = {{\n{lines},\n}};"


def _comment(text: str) -> str:
    """A name in a comment of C: visible, and unable to end it."""
    return re.sub(r"[^ -~]|[*/\\?]", "_", text)


def _number(value: float) -> str:
    return repr(float(value))


def _vector(values: Iterable[float]) -> str:
    return "{" + ", ".join(map(_number, values)) + "}"


def _rotation(pose: Pose) -> str:
    columns = [pose.rotate(axis) for axis in (X, Y, Z)]
    return _vector(columns[column][row] for row in range(3) for column in range(3))
