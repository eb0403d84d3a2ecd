"""The ``transmission.json`` that ``eurdf serial`` writes: `SerialTwin.report`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, ClassVar

from eurdf.json_schema import PAIRS, ROW
from eurdf.kinematics.array import Matrix, Vector
from eurdf.transmissions.polynomial_map import PolynomialMap
from eurdf.transmissions.serial_twin import Choice, Neglected


@dataclass(frozen=True, slots=True)
class SerialInfo:
    """The transmission.json that 'eurdf serial' writes."""

    LIKE: ClassVar = "eurdf.transmissions.serial_twin:SerialTwin"

    joints: tuple[str, ...]
    motors: tuple[str, ...]
    lumped: tuple[str, ...]
    """Bodies left out; their masses are lumped onto those that carry them."""
    lumped_at: dict[str, Annotated[Vector, ROW]]
    """Coordinates of the joints of the parallel robot at which they are lumped, as in files."""
    chosen: Choice
    position: Annotated[Matrix, PAIRS]
    torque: tuple[float | None, ...]
    velocity: tuple[float | None, ...]
    armature: Annotated[Vector, ROW]
    damping: Annotated[Vector, ROW]
    friction: Annotated[Vector, ROW]
    neglected: Neglected
    stops: dict[str, int]
    """Number of points at the edge of the workspace, by what ends the motion there."""
    map: PolynomialMap
    notes: tuple[str, ...]
