"""``eurdf robots``: list the robots of the package."""

from __future__ import annotations

import sys
from dataclasses import dataclass
from typing import ClassVar, Literal

from eurdf.commands.command import JSON, command
from eurdf.commands.output import write_result
from eurdf.commands.terminal import cell, columns, is_terminal, new_table, write_lines, write_rendered
from eurdf.json_schema import Count

# A narrower terminal has no space for descriptions.
_WIDE = 120

_COUNTS = ("nv", "closures", "nc", "mobility", "actuated", "uncontrolled")


@dataclass(frozen=True, slots=True)
class CollectedRobot:
    """A robot of the collection; dimensions are for the root that it states, and null if it cannot be built."""

    LIKE: ClassVar = "eurdf.kinematics.analysis:Analysis"

    name: str
    """Name of the robot, for eurdf.load."""
    description: str | None = None
    """Description from its metadata; null if it has none or cannot be built."""
    root: Literal["fixed", "floating"] | None = None
    """Whether its root link is fixed to the world or floats in it."""
    nv: Count | None = None
    closures: Count | None = None
    """Number of loop closures."""
    nc: Count | None = None
    mobility: Count | None = None
    actuated: Count | None = None
    uncontrolled: Count | None = None
    error: str | None = None
    """Why it cannot be built, or null."""


@dataclass(frozen=True, slots=True)
class Collection:
    """The output of 'eurdf robots --json'."""

    robots: tuple[CollectedRobot, ...]
    """All robots of the collection, by name."""


@command(
    summary="list the robots of the collection",
    description="List the robots of this package. All commands and eurdf.load accept their names.",
    exit_codes="0 listed, 1 a robot cannot be built, 2 the command cannot run.",
    examples=("eurdf robots --json",),
)
def robots(json: bool = JSON) -> int:
    """List them."""
    import eurdf

    collection = Collection(tuple(map(_collected, eurdf.collection_names())))
    if json:
        write_result(collection)
    else:
        _show(collection)
    return 1 if any(robot.error for robot in collection.robots) else 0


def _collected(name: str) -> CollectedRobot:
    import eurdf

    try:
        robot = eurdf.load(name, geometry=False)
    except eurdf.InvalidRobot as refusal:
        return CollectedRobot(name, error=next(str(each) for each in refusal.diagnostics if each.severity == "error"))
    mechanism, analysis = robot.mechanism, eurdf.analyze(robot)
    description = mechanism.metadata.get("description")
    text = description if isinstance(description, str) else None
    counts = {count: getattr(analysis, count) for count in _COUNTS if count != "closures"}
    return CollectedRobot(name, text, mechanism.root, closures=len(mechanism.closures), **counts)


def _show(collection: Collection) -> None:
    from eurdf.diagnostics.wording import visible

    described = not is_terminal(sys.stdout) or columns() >= _WIDE
    rows = []
    for robot in collection.robots:
        numbers = (getattr(robot, count) for count in _COUNTS)
        said = cell("cannot be built", "red") if robot.error else cell(robot.description or "")
        rows.append(
            (
                cell(robot.name, "bold"),
                *("-" if number is None else str(number) for number in numbers),
                robot.root or "-",
                *([said] if described else []),
            )
        )
    headings = ("robot", *_COUNTS, "root", *(["description"] if described else []))
    table = new_table(*headings, rows=rows, right=range(1, len(_COUNTS) + 1))
    for column in table.columns[: len(_COUNTS) + 2]:
        column.no_wrap = described
    write_rendered(table)
    errors = (f"{robot.name}: {robot.error}" for robot in collection.robots if robot.error)
    write_lines([[(visible(error), "")] for error in errors], sys.stderr)
