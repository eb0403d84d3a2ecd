"""The transmission as dependency-free C99, for controllers that run no Python."""

from __future__ import annotations

import math
import re
import textwrap
from collections.abc import Mapping, Sequence
from importlib.resources import files
from string import Template

from eurdf.array import Matrix, Vector
from eurdf.kinematics.closing import SPREADS
from eurdf.kinematics.loop import find_loops
from eurdf.kinematics.scale import row_scale
from eurdf.kinematics.tangent_space import TangentSpaces
from eurdf.kinematics.tolerances import (
    CLOSED,
    FOLLOWED,
    LEAST_CORRECTION,
    LEAST_GAIN,
    LONGEST_MOTION,
    MOST_CORRECTION,
    MOST_IDLE_STEPS,
    MOST_STEPS,
    RESTARTS,
    SHORTEST_STEP,
)
from eurdf.transmissions.c_tables import (
    array,
    constraint_entry,
    drive_entry,
    joint_entry,
    literal,
    rows_of,
    table,
    vector,
)
from eurdf.transmissions.drive import MOST_SUBSTEPS, SINGULAR, Drive
from eurdf.transmissions.first_guess import Prediction, WorkspacePoses
from eurdf.transmissions.generated_source import GeneratedSource, checked_prefix
from eurdf.transmissions.tables import Tables

# Given velocities are independent if none of them opens the loops by more, dimensionless.
_DETERMINED = 1e-6
# Of the damping of a descent, relative to the squares of the derivative: its root is above SINGULAR.
_LEAST_DAMPING = 1e-10
# The bounds of the kernel. In single precision, rounding opens loops of robots by 1e-7 m or rad and more.
_BOUNDS = {
    "double": {
        "CLOSED": FOLLOWED,
        "STILL_CLOSED": CLOSED,
        "SINGULAR": SINGULAR,
        "DETERMINED": _DETERMINED,
        "LEAST_DAMPING": _LEAST_DAMPING,
        "LEAST_GAIN": LEAST_GAIN,
        "LEAST_CORRECTION": LEAST_CORRECTION,
    },
    "float": {
        "CLOSED": 1e-6,
        "STILL_CLOSED": 1e-5,
        "SINGULAR": 1e-5,
        "DETERMINED": 1e-4,
        "LEAST_DAMPING": 1e-8,
        "LEAST_GAIN": 1e-5,
        "LEAST_CORRECTION": 1e-5,
    },
}
# How C in double precision becomes C in single precision: types, functions of math.h, constants.
_SINGLE = (
    (r"\bdouble\b", "float"),
    (r"\b(atan2|cos|fabs|fmax|fmin|remainder|sin|sqrt)\(", r"\1f("),
    (r"(?<![\w.])(\d+\.\d*(?:e[+-]?\d+)?|\d+e[+-]?\d+)(?![\w.])", r"\1f"),
)


def c_source(
    drives: Sequence[Drive], poses: WorkspacePoses, q: Vector, prefix: str | None, steps: int, substeps: int, real: str
) -> GeneratedSource:
    """The source; see `eurdf.transmissions.prepared.PreparedTransmission.c_source`.

    Args:
        drives: By the joints; and by the motors, if they determine the joints.
        poses: The poses of the workspace.
        q: The pose (nq,) of `start`.
        prefix: As there, like what follows.
        steps: As there.
        substeps: As there.
        real: As there.
    """
    robot = drives[0].robot
    name = checked_prefix(prefix, robot)
    for argument, count in (("steps", steps), ("substeps", substeps)):
        if not isinstance(count, int) or count < 1:
            raise ValueError(f"{argument} is {count!r}; it must be a positive integer")
    if real not in _BOUNDS:
        raise ValueError(f"real is {real!r}; it must be 'double' or 'float'")
    tables = Tables(robot, drives)
    predictions = [poses.prediction(drive) for drive in drives]
    stored = poses.stored if any(found is None for found, _ in predictions) else poses.stored[:0]
    header = _header(tables, name, drives, _guesses(drives, predictions, len(stored)), steps, substeps, real)
    guesses = [found for found, _ in predictions]
    reaches = [poses.reach(drive.given) if len(stored) else 0.0 for drive in drives]
    limits = _limits(steps, substeps, guesses, len(stored))
    source = _source(tables, name, drives, q, guesses, reaches, stored, limits, real)
    return GeneratedSource({f"{name}.h": header.encode(), f"{name}.c": source.encode()})


def _header(
    tables: Tables, name: str, drives: Sequence[Drive], guesses: str, steps: int, substeps: int, real: str
) -> str:
    joints, motors = drives[0].given, drives[0].asked
    nj, nm, both = len(joints), len(motors), len(drives) > 1
    listed = "".join(
        f" *   {role}[{index}]: {_comment(label)}, {unit}\n"
        for role, side in (("joints", joints), ("motors", motors))
        for index, (label, unit) in enumerate(zip(side.names, side.units, strict=True))
    )
    start_at_motors = f"int {name}_start_at_motors({name}_pose *pose, const double motors[{nm}]);\n"
    size = nm * nj
    at_motors = f"""
/* The joints at positions of the motors, and B (row by row): the velocities are v_J = B v_m. G is the inverse of B. */
int {name}_at_motors({name}_pose *pose, const double motors[{nm}],
                      double joints[{nj}], double B[{size}], double G[{size}]);
"""
    inverse = "\n * B is the inverse of G, SINGULAR if it has none." if both else ""
    template = Template(_in(real, _file("interface.h")))
    return template.substitute(
        robot=_comment(tables.robot.mechanism.name),
        listed=listed,
        guesses=guesses,
        name=name,
        NAME=name.upper(),
        nj=nj,
        nm=nm,
        size=size,
        inverse=inverse,
        B=_in(real, f", double B[{size}]") if both else "",
        coordinates=tables.size,
        solutions=1 + steps,
        substeps=substeps,
        most_substeps=MOST_SUBSTEPS,
        descents=1 + RESTARTS,
        descent_steps=MOST_STEPS,
        start_at_motors=_in(real, start_at_motors) if both else "",
        at_motors=_in(real, at_motors) if both else "",
    )


def _guesses(drives: Sequence[Drive], predictions: Sequence[tuple[Prediction | None, str]], stored: int) -> str:
    """The ranges in which no call depends on the last pose, in lines of the header's comment."""
    lines = []
    for role, drive, (found, missing) in zip(("joints", "motors"), drives, predictions, strict=False):
        if found is None:
            reason = f"a path leads from the nearest of {stored} poses of the workspace" if stored else missing
            lines.append(f"{role}: no range; {reason}")
            continue
        ends = zip(drive.given.names, found.lower.tolist(), found.upper.tolist(), drive.given.units, strict=True)
        lines.append(
            f"{role}: " + ", ".join(f"{name} {low:.4g} to {high:.4g} {unit}" for name, low, high, unit in ends)
        )
    return "".join(f" *   {_comment(part)}\n" for line in lines for part in textwrap.wrap(line, 114))


def _in(real: str, text: str) -> str:
    """C in double precision in the given one."""
    for pattern, replaced in _SINGLE if real == "float" else ():
        text = re.sub(pattern, replaced, text)
    return text


def _file(name: str) -> str:
    return (files("eurdf.transmissions") / name).read_text(encoding="utf-8")


def _limits(steps: int, substeps: int, guesses: Sequence[Prediction | None], stored: int) -> dict[str, int]:
    """The limits of the kernel that do not depend on the robot."""
    return {
        "DEGREES": max(2, *(found.degree + 1 for found in guesses if found is not None), 0),
        "POSES": stored,
        "STEPS": steps,
        "SUBSTEPS": substeps,
        "MOST_SUBSTEPS": MOST_SUBSTEPS,
        "RESTARTS": RESTARTS,
        "SPREADS": len(SPREADS),
        "DESCENT_STEPS": MOST_STEPS,
        "IDLE_STEPS": MOST_IDLE_STEPS,
    }


def _source(
    tables: Tables,
    name: str,
    drives: Sequence[Drive],
    q: Vector,
    guesses: Sequence[Prediction | None],
    reaches: Sequence[float],
    stored: Matrix,
    limits: Mapping[str, int],
    real: str,
) -> str:
    robot = tables.robot
    scale = row_scale(robot, robot.cached(TangentSpaces).length)
    rows = [loop.rows for loop in find_loops(robot)]
    path: list[str] = []
    constraints: list[str] = []
    for index in tables.constraints:
        numbers, first = tables.numbers(robot.constraints[index]), len(path)
        path += [f"{{{joint}, {literal(factor)}}}" for joint, factor in numbers.path]
        entry = numbers, robot.constraints[index].rows, first, len(path), scale[rows[index]]
        constraints.append(constraint_entry(*entry))
    place = {index: number for number, index in enumerate(tables.constraints)}
    calls = [_calls(name, drive, number, len(drives) > 1) for number, drive in enumerate(drives)]
    most_rows = max(rows_of(rows, drive) for drive in drives)
    limits = {
        "JOINTS": len(tables.joints) + 1,
        "COORDINATES": tables.size,
        "VELOCITIES": len(tables.units),
        "ROWS": max(most_rows, len(drives[0].given)),
        "SIDES": 1 + max(len(drive.given) for drive in drives),
        "MATRIX": len(drives[0].given) * len(drives[0].asked),
        "BALLS": int(-1 in tables.coordinates),
        **limits,
    }
    bounds = _BOUNDS[real] | {
        "SHORTEST_STEP": SHORTEST_STEP,
        "TURN": 2.0 * math.pi,
        "LONGEST_MOTION": LONGEST_MOTION,
        "MOST_CORRECTION": MOST_CORRECTION,
    }
    big, reference = name.upper(), next((each.reference for each in guesses if each), q)
    parts = [
        f'/* See {name}.h. */\n#include "{name}.h"\n\n#include <math.h>\n#include <stdint.h>\n',
        "\n".join(f"#define {key} {value}" for key, value in limits.items()),
        "\n".join(f"#define {key} {literal(value)}" for key, value in bounds.items()),
        "#define BALL (-1)",
        f"#define CLOSED_POSE {big}_OK\n#define NOT_CLOSED {big}_NOT_CLOSED\n#define TOO_FAR {big}_TOO_FAR\n"
        f"#define AT_SINGULARITY {big}_SINGULAR\n#define NOT_FINITE {big}_NOT_FINITE",
        _file("tables.h").rstrip(),
        f"static const double start[] = {vector(tables.pose(q))};",
        f"static const double reference[] = {vector(tables.pose(reference))};",
        table("double", "poses", map(vector, map(tables.pose, stored if len(stored) else [q])), "[][COORDINATES]"),
        array("double", "units", map(literal, tables.units)),
        array("double", "spreads", map(literal, SPREADS)),
        array("int", "coordinates", map(str, tables.coordinates)),
        array("int", "ball_coordinates", map(str, tables.balls)),
        table("joint", "joints", ["{0, 0, 0, 0, 0, 0, 0, {0}, {0}, {0}, {0}}", *map(joint_entry, tables.joints)]),
        table("step", "path", path or ["{0, 0}"]),
        table("constraint", "constraints", constraints or ["{0}"]),
        *(
            drive_entry(number, drive, tables, place, rows, guesses[number], reaches[number])
            for number, drive in enumerate(drives)
        ),
        _file("kernel.c").rstrip(),
        f"void {name}_start({name}_pose *pose) {{\n"
        "    for (int k = 0; k < COORDINATES; ++k) pose->x[k] = start[k];\n}",
        *calls,
    ]
    return _in(real, "\n\n".join(parts) + "\n")


def _calls(name: str, drive: Drive, number: int, both: bool) -> str:
    given, asked, matrix, inverse = ("joints", "motors", "G", "B") if number == 0 else ("motors", "joints", "B", "G")
    n, m = len(drive.given), len(drive.asked)
    returned = f", double {inverse}[{m * n}]" if both else ""
    return (
        f"int {name}_at_{given}({name}_pose *pose, const double {given}[{n}], double {asked}[{m}], "
        f"double {matrix}[{m * n}]{returned}) {{\n"
        f"    return at_positions(&drive_{number}, pose->x, {given}, {asked}, {matrix}, {inverse if both else 0});\n}}"
        f"\n\nint {name}_start_at_{given}({name}_pose *pose, const double {given}[{n}]) {{\n"
        f"    return start_at(&drive_{number}, pose->x, {given});\n}}"
    )


def _comment(text: str) -> str:
    """A name in a comment of C: visible, and unable to end it."""
    return re.sub(r"[^ -~]|[*/\\?]", "_", text)
