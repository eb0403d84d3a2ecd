"""The mesh files of a robot, and the names they get beside or in an exported file."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from pathlib import Path

from eurdf.exporting.written import Exportable, Triangles
from eurdf.loss import Losses
from eurdf.writing.file_names import FileNames
from eurdf.writing.xml_text import numbers


def mesh_names(paths: Mapping[str, Path]) -> tuple[dict[str, bytes], dict[str, str]]:
    """The content of each mesh file, and a name for it, both by URI.

    The names are those of `FileNames`. Files with equal names get a number.
    """
    contents: dict[str, bytes] = {}
    names: dict[str, str] = {}
    files = FileNames()
    for uri, path in paths.items():
        contents[uri], names[uri] = path.read_bytes(), files.new(path.stem, path.suffix)
    return contents, names


class MeshFiles:
    """The mesh files of a robot while it is written: copied to ``meshes/``, or referenced where they are.

    Attributes:
        files: Content of each file that was copied or converted, by its path relative to the folder.
    """

    def __init__(
        self, given: Exportable, losses: Losses, is_readable: Callable[[str, bytes], bool] | None = None
    ) -> None:
        """Prepare the files.

        Args:
            given: The robot.
            losses: Where to record losses: the common ones and, with ``is_readable``, those of `CONVERSION`.
            is_readable: Whether the program reads a file, of some name and content; None if it reads every file.
        """
        self.files: dict[str, bytes] = {}
        self._given, self._losses, self._is_readable = given, losses, is_readable
        self._contents, self._names = mesh_names(given.meshes)
        self._paths: dict[str, str | None] = {}

    def path(self, uri: str) -> str | None:
        """The path of a mesh as the file states it, with ``/``; None if the mesh is left out, which is a loss."""
        if uri not in self._paths:
            self._paths[uri] = self._written(uri)
        return self._paths[uri]

    def _written(self, uri: str) -> str | None:
        if uri not in self._contents:
            self._losses.add("export-mesh-missing", uri)
            return None
        name, content = self._names[uri], self._contents[uri]
        if self._is_readable is not None and not self._is_readable(name, content):
            triangles = self._given.read_mesh(self._given.meshes[uri])
            if triangles is None:
                self._losses.add("export-mesh-format", uri)
                return None
            name, content = f"{name}.obj", _wavefront(triangles)
            self._losses.add("export-mesh-converted", uri)
            if self._given.mesh_files == "reference":
                self._losses.add("export-mesh-not-referenced", uri)
        elif self._given.mesh_files == "reference":
            path = Path(os.path.abspath(self._given.meshes[uri])).as_posix()
            self._report_package(uri, path)
            return path
        path = f"meshes/{name}"
        self.files[path] = content
        self._report_package(uri, path)
        return path

    def _report_package(self, uri: str, path: str) -> None:
        if uri.startswith("package://"):
            self._losses.add("export-mesh-path", uri, f"becomes '{path}'")


def _wavefront(triangles: Triangles) -> bytes:
    """An OBJ file."""
    lines = [f"v {numbers(vertex)}" for vertex in triangles.vertices.tolist()]
    lines += [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in triangles.triangles.tolist()]
    return "\n".join([*lines, ""]).encode()
