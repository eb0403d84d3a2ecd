"""What a format makes of a file, and a format: the seam between a format and the rest."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType

from eurdf.convert.losses import Loss, LossKind
from eurdf.mechanism.mechanism import Mechanism
from eurdf.reading.other_formats import IMPORTED
from eurdf.reading.resource import FileFinder


@dataclass(frozen=True, slots=True)
class RobotRead:
    """A robot that was read from a file.

    Attributes:
        mechanism: The robot. The meshes of its shapes are named as in ``meshes``.
        losses: What is not as in the file.
        meshes: Content of each mesh file, and of the files that meshes name, by its path relative to the folder that is
            written, with ``/``.
        start: Name of the configuration to assemble from, and its coordinates as files have them.
        sources: Every file that was read, the main one first.
        without_axis: Names of the hinges whose axis the file does not state; that in the mechanism has no meaning.
    """

    mechanism: Mechanism
    losses: tuple[Loss, ...]
    meshes: Mapping[str, bytes] = field(default_factory=dict)
    start: tuple[str, Mapping[str, tuple[float, ...]]] = ("the neutral configuration", MappingProxyType({}))
    sources: tuple[Path, ...] = ()
    without_axis: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class ImportFormat:
    """A format to import from.

    Attributes:
        name: As the user gives it, in `eurdf.reading.other_formats.IMPORTED`.
        read: Reads a file, whose own files must be where a finder allows them.
        losses: Every kind of loss that `read` can record.
    """

    name: str
    read: Callable[[Path, FileFinder], RobotRead]
    losses: tuple[LossKind, ...]

    @property
    def title(self) -> str:
        """What it is."""
        return IMPORTED[self.name].title
