"""The output of ``eurdf assemble --json``, and its JSON Schema."""

from __future__ import annotations

import math
from collections.abc import Collection
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field

from eurdf.mechanism.joint_types import JointType
from eurdf.mechanism.mechanism import ROOT_JOINT

if TYPE_CHECKING:
    from eurdf.kinematics.assembly import Assembly
    from eurdf.pinocchio.robot import Robot

Unit = Literal["rad", "m", ""]

# The unit of each coordinate; quaternions have none.
_UNITS: dict[str, Unit] = {"angle": "rad", "length": "m", "x": "m", "y": "m", "z": "m"}


class _Entry(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid", use_attribute_docstrings=True)


class CoordinateInfo(_Entry):
    """One number of a joint's configuration."""

    name: str
    """Kind of the number: angle, length, x, y, z, or qx, qy, qz, qw of a quaternion."""
    unit: Unit
    """Unit; empty for the numbers of a quaternion."""
    value: float
    """Value."""


class JointPosition(_Entry):
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


class OpeningInfo(_Entry):
    """How far a closure is open."""

    name: str
    """Name of the closure."""
    position: float | None
    """Distance between the origins of its frames, m; null if it is not finite."""
    angle: float | None
    """Angle between its frames, rad; 0 for a 3d closure."""
    closed: bool
    """Whether it is open by at most 1e-6 (m, rad)."""


class AssemblyInfo(_Entry):
    """The output of 'eurdf assemble --json'."""

    name: str
    """Name of the robot in the URDF."""
    start: str
    """Name of the configuration at which the search started; neutral if it is not from the file."""
    closes: bool
    """Whether each closure is open by at most 1e-6 (m, rad)."""
    residual: float | None
    """Norm of the residual of all closures and couplings, m and rad."""
    iterations: Annotated[int, Field(ge=0)]
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


def assembly_info(
    robot: Robot, assembly: Assembly, start: str, held: Collection[str], beyond: Collection[str]
) -> AssemblyInfo:
    """An assembly as ``eurdf assemble`` shows it.

    Args:
        robot: The robot.
        assembly: The result of `eurdf.assemble`.
        start: Name of the configuration at which it started.
        held: Names of the held joints.
        beyond: Names of joints beyond their limits.
    """
    types = {ROOT_JOINT: JointType.FLOATING} | {joint.name: joint.type for joint in robot.mechanism.joints}
    return AssemblyInfo(
        name=robot.mechanism.name,
        start=start,
        closes=assembly.closes,
        residual=_finite(assembly.residual),
        iterations=assembly.iterations,
        within_limits=not beyond,
        joints=tuple(
            JointPosition(
                name=name,
                type=types[name],
                coordinates=tuple(
                    CoordinateInfo(name=coordinate, unit=unit, value=value)
                    for (coordinate, unit), value in zip(_units(types[name]), values, strict=True)
                ),
                actuated=name in robot.actuation.joints,
                held=name in held,
                beyond_limits=name in beyond,
            )
            for name, values in robot.coordinates(assembly.q).items()
        ),
        closures=tuple(
            OpeningInfo(
                name=opening.name,
                position=_finite(opening.position),
                angle=_finite(opening.angle),
                closed=not opening.is_open,
            )
            for opening in assembly.open
        ),
        file=None,
        written=False,
    )


def _units(kind: JointType) -> list[tuple[str, Unit]]:
    """Name and unit of each coordinate of a joint."""
    plain = kind.coordinates[: kind.quaternion]
    return [(name, _UNITS[name] if name in plain else "") for name in kind.coordinates]


def _finite(number: float) -> float | None:
    return float(number) if math.isfinite(number) else None


def assembly_schema() -> dict[str, Any]:
    """The JSON Schema (2020-12) of `AssemblyInfo`."""
    schema = AssemblyInfo.model_json_schema(mode="serialization")
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **schema}
