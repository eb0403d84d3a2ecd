"""What a format is given, and what it makes of it: the seam between a format and the rest."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal

from eurdf.exporting.coordinates import Coordinates, OwnVectors
from eurdf.loss import Loss, LossKind
from eurdf.mechanism.mechanism import Mechanism

#: What actuators become.
Actuators = Literal["motor", "position", "none"]


@dataclass(frozen=True, slots=True)
class Exportable:
    """A robot, as a format is given it.

    Attributes:
        mechanism: The robot.
        own: Where the coordinates of its joints are in q and v.
        configurations: Closed configurations by name, the one to start from first; coordinates as in files.
        meshes: Path of the file of each mesh, by URI; a mesh that was not found is left out.
        actuators: What actuators become.
    """

    mechanism: Mechanism
    own: OwnVectors
    configurations: Mapping[str, Mapping[str, tuple[float, ...]]] = field(default_factory=dict)
    meshes: Mapping[str, Path] = field(default_factory=dict)
    actuators: Actuators = "motor"


@dataclass(frozen=True, slots=True)
class Written:
    """A robot in another format.

    Attributes:
        files: Content of each file, by its path relative to a folder, with ``/``; the main file is the first.
        losses: What is not as in the robot.
        coordinates: From the vectors of the robot to those of the model.
    """

    files: Mapping[str, bytes]
    losses: tuple[Loss, ...]
    coordinates: Coordinates


@dataclass(frozen=True, slots=True)
class Format:
    """A format to export to.

    Attributes:
        name: As the user gives it.
        title: What it is.
        write: Writes a robot.
        losses: Every kind of loss that `write` can record.
    """

    name: str
    title: str
    write: Callable[[Exportable], Written]
    losses: tuple[LossKind, ...]
