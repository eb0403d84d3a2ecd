"""``eurdf robots``: list the robots of the package."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import ClassVar, Literal

from eurdf.commands.command import JSON, command
from eurdf.commands.terminal import Table, write_shown, write_text
from eurdf.errors import CannotRun
from eurdf.json_schema import Count

#: What the command shows, in the folder of the collection: to build and analyse all robots takes many times as long.
FILE = "collection.json"

#: Its dimensions.
COUNTS = ("nv", "closures", "nc", "mobility", "actuated", "uncontrolled")


@dataclass(frozen=True, slots=True)
class CollectedRobot:
    """A robot of the collection; dimensions are for the root that it states."""

    LIKE: ClassVar = "eurdf.kinematics.analysis:Analysis"

    name: str
    """Name of the robot, for eurdf.load."""
    description: str
    """Description from its metadata."""
    root: Literal["fixed", "floating"]
    """Whether its root link is fixed to the world or floats in it."""
    nv: Count
    closures: Count
    """Number of loop closures."""
    nc: Count
    mobility: Count
    """Degrees of freedom of the closed mechanism, nv - rank."""
    actuated: Count
    uncontrolled: Count
    """Degrees of freedom left with every actuator held, nv - rank [K; Sᵀ]."""


@dataclass(frozen=True, slots=True)
class Collection:
    """The output of 'eurdf robots --json'."""

    robots: tuple[CollectedRobot, ...]
    """All robots of the collection, by name."""


@command(
    summary="list the robots of the collection",
    description="List the robots of this package. All commands and eurdf.load accept their names.",
    exit_codes="0 listed, 2 the command cannot run.",
    examples=("eurdf robots --json",),
)
def robots(json: bool = JSON) -> int:
    """List them."""
    from eurdf.collection import collection_folder

    folder = collection_folder()
    if folder is None:
        raise CannotRun("the collection of robots is not installed")
    text = (folder / FILE).read_text(encoding="utf-8")
    if json:
        write_text(text)
    else:
        _show(text)
    return 0


def _show(text: str) -> None:
    shown = [*COUNTS, "root", "description"]
    collected = json.loads(text)["robots"]
    rows = [((robot["name"], "bold"), *(str(robot[column]) for column in shown)) for robot in collected]
    # Without the description, it fits into 80 columns.
    numbers = range(1, len(COUNTS) + 1)
    write_shown(Table("robot", *shown, rows=rows, right=numbers, spare=(8, 3, 7, 2, 5, 6)))
