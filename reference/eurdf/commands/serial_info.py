"""The JSON Schema of the ``transmission.json`` that ``eurdf serial`` writes: `SerialTwin.report`."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field

Range = tuple[float, float]
Row = tuple[float, ...]


class _Entry(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid", use_attribute_docstrings=True)


class NeglectedInfo(_Entry):
    """What the serial robot neglects, over the points of the workspace; one entry for each joint."""

    mass: float
    """Mass of the bodies that are lumped onto others, kg."""
    armature: tuple[Range, ...]
    """Smallest and largest armature that would be exact for the joint alone, kg·m² or kg."""
    rotors: tuple[Range, ...]
    """Smallest and largest part of it that comes from the rotors, kg·m² or kg."""
    linkage: tuple[Range, ...]
    """Smallest and largest part of it that comes from the bodies of the linkage, kg·m² or kg."""
    coupling: tuple[Row, ...]
    """Largest inertia between two joints that no armature can state, one row for each joint."""
    inertia: float
    """Largest relative error of the inertia matrix."""
    gravity: Row
    """Largest error of the torque that holds the joint against gravity, N·m or N."""
    torque: tuple[Range, ...] | None
    """Smallest and largest torque of the joint alone, N·m or N; null where a motor has no limit."""
    velocity: tuple[Range, ...] | None
    """Smallest and largest velocity of the joint alone, rad/s or m/s; null where a motor has no limit."""
    covered: Annotated[float, Field(ge=0.0, le=1.0)]
    """Part of the points that are inside the position limits of the serial robot."""


class MapInfo(_Entry):
    """Motor positions as Chebyshev polynomials of joint positions, each scaled from its range to -1…1."""

    lower: Row
    """Smallest position of each joint, rad or m."""
    upper: Row
    """Largest position of each joint, rad or m."""
    coefficients: tuple[Any, ...]
    """For each motor an array of numbers with one dimension for each joint, of degree + 1 entries, rad or m."""
    error: Row
    """Largest error of the position of each motor at the points tested, rad or m."""
    error_of_G: tuple[Row, ...]  # noqa: N815 - the field's own symbol
    """Largest error of their derivative there, one row for each motor."""


class SerialInfo(_Entry):
    """The transmission.json that 'eurdf serial' writes."""

    joints: tuple[str, ...]
    """Name of each joint velocity of the serial robot; what follows has one entry for each."""
    motors: tuple[str, ...]
    """Name of each motor velocity of the parallel robot."""
    lumped: tuple[str, ...]
    """Bodies left out; their masses are lumped onto those that carry them."""
    lumped_at: dict[str, Row]
    """Coordinates of the joints of the parallel robot at which they are lumped, as in files."""
    chosen: Literal["conservative", "fitted"]
    """How limits and armature are chosen."""
    position: tuple[Range, ...]
    """Smallest and largest position, rad or m."""
    torque: tuple[float | None, ...]
    """Largest torque or force, N·m or N; null where a motor has no limit."""
    velocity: tuple[float | None, ...]
    """Largest velocity, rad/s or m/s; null where a motor has no limit."""
    armature: Row
    """Armature, kg·m² or kg."""
    damping: Row
    """Viscous damping, N·m·s/rad or N·s/m."""
    friction: Row
    """Dry friction, N·m or N."""
    neglected: NeglectedInfo
    """What the serial robot neglects."""
    stops: dict[str, int]
    """Number of points at the edge of the workspace, by what ends the motion there."""
    map: MapInfo
    """The positions of the motors as polynomials."""
    notes: tuple[str, ...]
    """What was left out for want of numbers."""


def serial_schema() -> dict[str, Any]:
    """The JSON Schema (2020-12) of `SerialInfo`."""
    schema = SerialInfo.model_json_schema(mode="serialization")
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **schema}
