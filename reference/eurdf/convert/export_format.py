"""What a format is given, and what it makes of it: the seam between a format and the rest."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path

import numpy as np
import numpy.typing as npt

from eurdf.array import Matrix
from eurdf.convert.coordinates import Coordinates
from eurdf.convert.formats import Actuators, JointChoice, MeshFileChoice
from eurdf.convert.losses import Losses, LossKind
from eurdf.convert.parts import OwnVectors
from eurdf.mechanism.joint import Joint, Mimic
from eurdf.mechanism.mechanism import Mechanism
from eurdf.mesh_files.reader import MeshReader

#: The triangles of a mesh file: vertices (n, 3), in the unit of the file, and their indices (m, 3).
Triangles = tuple[Matrix, npt.NDArray[np.int64]]


@dataclass(frozen=True, slots=True)
class ExportInput:
    """A robot, as a format is given it.

    Attributes:
        mechanism: The robot.
        own: Where the coordinates of its joints are in q and v.
        configurations: Closed configurations by name, the one to start from first; coordinates as in files.
        meshes: Path of the file of each mesh, by URI; a mesh that was not found or is not read is left out.
        refused: For each mesh that is not read, by URI: the folders that it is outside of.
        reader: Reads the files of `meshes`.
        actuators: What actuators become.
        joints: What ball joints become.
        mesh_files: What is done with the mesh files.
        read_mesh: Reads a mesh file of any format; None where it cannot.
    """

    mechanism: Mechanism
    own: OwnVectors
    configurations: Mapping[str, Mapping[str, tuple[float, ...]]]
    meshes: Mapping[str, Path]
    refused: Mapping[str, str]
    reader: MeshReader
    actuators: Actuators
    joints: JointChoice
    mesh_files: MeshFileChoice
    read_mesh: Callable[[Path], Triangles | None]

    @property
    def start(self) -> Mapping[str, tuple[float, ...]]:
        """The configuration to start from; empty, where all coordinates are neutral, if none is known."""
        return next(iter(self.configurations.values()), {})


def coordinates_at(
    configuration: Mapping[str, tuple[float, ...]], joint: Joint, mimic: Mimic | None
) -> tuple[float, ...]:
    """The coordinates of a joint, which may mimic, at a configuration as files have it."""
    if mimic is None:
        return tuple(configuration.get(joint.name, joint.type.neutral))
    (leader,) = configuration.get(mimic.joint, (0.0,))
    return (mimic.multiplier * leader + mimic.offset,)


@dataclass(frozen=True, slots=True)
class ExportOutput:
    """A robot in another format.

    Attributes:
        files: Content of each file, by its path relative to a folder, with ``/``; the main file is the first.
        coordinates: From the vectors of the robot to those of the model.
    """

    files: Mapping[str, bytes]
    coordinates: Coordinates


@dataclass(frozen=True, slots=True)
class Format:
    """A format to export to.

    Attributes:
        write: Writes a robot, and adds the losses that `rows` leaves to it.
        rows: Every kind of loss.
        exact: The joints and closures without a row, as in `ELEMENTS`: they are as in the robot.
    """

    write: Callable[[ExportInput, Losses], ExportOutput]
    rows: tuple[LossKind, ...]
    exact: tuple[str, ...]


def export_format(name: str) -> Format:
    """The format of a name; its module is loaded now."""
    found: Format = import_module(f"eurdf.convert.{name.replace('-', '_')}.write").FORMAT
    return found
