"""The seam between the formats to import from and the rest: what a format gets, what it makes of it, what it loses."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from importlib import import_module
from pathlib import Path
from types import MappingProxyType

from eurdf.convert.losses import Losses, LossKind, dropped, exact
from eurdf.convert.names import FileNames
from eurdf.mechanism.mechanism import Mechanism
from eurdf.mesh_files.reader import MeshReader
from eurdf.reading.resource import FileFinder


class ImportInput:
    """A file to import, and the mesh files that are copied, under names that mean a file in the folder of the robot.

    Attributes:
        path: The file.
        finder: Finds the files that it names.
        folders: Where these may be.
        losses: Where to record what is lost.
        meshes: Content of each mesh file, and of the files that meshes name, by its path relative to the folder that is
            written: ``meshes/`` and a name.
    """

    def __init__(self, path: Path, finder: FileFinder, losses: Losses) -> None:
        self.path, self.finder, self.folders, self.losses = path, finder, finder.folders, losses
        self.meshes: dict[str, bytes] = {}
        self._reader, self._names = MeshReader(finder.folders), FileNames()
        self._copies: dict[str, str] = {}

    def copy(self, mesh: str | Path) -> str:
        """Copy a mesh file, and the files that it names; returns its path relative to the folder.

        Raises:
            RefusedFile: It is outside the folders, or is no mesh.
        """
        file = Path(mesh)
        key = str(file)
        if key not in self._copies:
            content = self._reader.read(file)
            self._copies[key] = copy = f"meshes/{self._names.new(file.stem, file.suffix)}"
            for other, reason in content.place(copy, self.meshes).items():
                self.losses.add("import-mesh-names", f"{file.name}: {other}", f"is left out: {reason}")
        return self._copies[key]

    def add_mesh(self, name: str, suffix: str, content: bytes) -> str:
        """Add a mesh that is no file yet, under a name near to one; returns its path relative to the folder."""
        key = f"{name}{suffix}"
        if key not in self._copies:
            self._copies[key] = path = f"meshes/{self._names.new(name, suffix)}"
            self.meshes[path] = content
        return self._copies[key]


@dataclass(frozen=True, slots=True)
class RobotRead:
    """A robot that was read from a file.

    Attributes:
        mechanism: The robot. The meshes of its shapes are named as in `ImportInput.meshes`.
        sources: Every file that was read, the main one first.
        start: Name of the configuration to assemble from, and its coordinates as files have them.
        without_axis: Names of the hinges whose axis the file does not state; that in the mechanism has no meaning.
    """

    mechanism: Mechanism
    sources: tuple[Path, ...]
    start: tuple[str, Mapping[str, tuple[float, ...]]] = ("the neutral configuration", MappingProxyType({}))
    without_axis: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class ImportFormat:
    """A format to import from.

    Attributes:
        read: Reads a file.
        losses: Every kind of loss that `read` can record, beside those of all formats.
    """

    read: Callable[[ImportInput], RobotRead]
    losses: tuple[LossKind, ...]


def loss_kinds(rows: Mapping[str, LossKind]) -> tuple[LossKind, ...]:
    """The kinds of loss of rows, whose keys are their codes without ``import-``."""
    return tuple(replace(kind, code=f"import-{code}") for code, kind in rows.items())


#: Of formats in which limits of 0 and 0 lock a joint: see `eurdf.convert.steps.without_locks`.
LOCKED = exact(
    "joint",
    "is fixed where its limits are 0 and 0, which would be no range in a description",
    "make it a fixed joint",
    only="limits that are both 0",
)

#: Of formats whose textures are not copied, and of all that their files have for a simulation.
TEXTURE = dropped("texture", "is left out; the color is kept", "add it to the URDF")
SIMULATION = dropped("simulation", "is no part of a description", "keep it in a file of the simulator")


def import_format(name: str) -> ImportFormat:
    """The format of a name; its module is loaded now."""
    found: ImportFormat = import_module(f"eurdf.convert.{name.replace('-', '_')}.read").FORMAT
    return found
