"""The output of ``eurdf robots --json``, and its JSON Schema."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field

import eurdf

Count = Annotated[int, Field(ge=0)]


class _Entry(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid", use_attribute_docstrings=True)


class CollectedRobot(_Entry):
    """A robot of the collection; dimensions are for the root that its description states."""

    name: str
    """Name of the robot, for eurdf.load."""
    description: str | None
    """Description from its metadata; null if it has none or cannot be built."""
    root: Literal["fixed", "floating"] | None
    """Whether its root link is fixed to the world or floats in it; null if it cannot be built."""
    nv: Count | None
    """Number of velocities of the spanning tree; null if it cannot be built."""
    closures: Count | None
    """Number of loop closures; null if it cannot be built."""
    nc: Count | None
    """Number of constraint rows of all closures; null if it cannot be built."""
    mobility: Count | None
    """Degrees of freedom of the closed mechanism; null if the loops do not close or it cannot be built."""
    actuated: Count | None
    """Number of actuated velocities; null if it cannot be built."""
    uncontrolled: Count | None
    """Degrees of freedom left with every actuator held; null if the loops do not close or it cannot be built."""
    error: str | None
    """Why it cannot be built, or null."""


class Collection(_Entry):
    """The output of 'eurdf robots --json'."""

    robots: tuple[CollectedRobot, ...]
    """All robots of the collection, by name."""


def collection_info() -> Collection:
    """The robots of the package, including those that cannot be built."""
    return Collection(robots=tuple(map(_collected, eurdf.collection_names())))


def _collected(name: str) -> CollectedRobot:
    try:
        robot = eurdf.load(name, geometry=False)
    except eurdf.InvalidRobot as refusal:
        error = next(str(found) for found in refusal.diagnostics if found.severity == "error")
        unknown: dict[str, Any] = dict.fromkeys(CollectedRobot.model_fields)
        return CollectedRobot(**{**unknown, "name": name, "error": error})
    mechanism, analysis = robot.mechanism, eurdf.analyze(robot)
    description = mechanism.metadata.get("description")
    return CollectedRobot(
        name=name,
        description=description if isinstance(description, str) else None,
        root=mechanism.root,
        nv=analysis.nv,
        closures=len(mechanism.closures),
        nc=analysis.nc,
        mobility=analysis.mobility,
        actuated=analysis.actuated,
        uncontrolled=analysis.uncontrolled,
        error=None,
    )


def collection_schema() -> dict[str, Any]:
    """The JSON Schema (2020-12) of `Collection`."""
    schema = Collection.model_json_schema(mode="serialization")
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **schema}
