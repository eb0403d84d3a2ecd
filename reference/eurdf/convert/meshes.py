"""The mesh files of a robot, and the names they get beside or in an exported file."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

from eurdf.convert.export_format import ExportInput, Triangles
from eurdf.convert.losses import Losses
from eurdf.convert.names import FileNames
from eurdf.mesh_files.reader import RefusedFile
from eurdf.writing.xml_text import numbers

#: Makes the content of a file of triangles: vertices (n, 3), m, and their indices (m, 3).
Writer = Callable[[Triangles], bytes]


class MeshFiles:
    """The mesh files of a robot while it is written: copied to ``meshes/``, or referenced where they are.

    Attributes:
        files: Content of each file that was copied or converted, and of the files that copies name, by its path
            relative to the folder.
    """

    def __init__(
        self,
        given: ExportInput,
        losses: Losses,
        is_readable: Callable[[str, bytes], bool] | None = None,
        conversion: tuple[str, Writer] | None = None,
    ) -> None:
        """Prepare the files.

        Args:
            given: The robot.
            losses: Where to record losses: the common ones, that of `NAMED_FILE` and, with ``is_readable``, those of
                `CONVERSION`.
            is_readable: Whether the program reads a file, of some name and content; None if it reads every file.
            conversion: What the names of converted files end with, and what writes them; an OBJ file by default.
        """
        self.files: dict[str, bytes] = {}
        self._given, self._losses, self._is_readable = given, losses, is_readable
        self._ending, self._converted = conversion or (".obj", _wavefront)
        names = FileNames()
        self._names = {uri: names.new(path.stem, path.suffix) for uri, path in given.meshes.items()}
        self._paths: dict[str, str | None] = {}

    def path(self, uri: str) -> str | None:
        """The path of a mesh as the file states it, with ``/``; None if the mesh is left out, which is a loss."""
        if uri not in self._paths:
            self._paths[uri] = self._written(uri)
        return self._paths[uri]

    def _written(self, uri: str) -> str | None:
        given, losses = self._given, self._losses
        if uri in given.refused:
            where = given.refused[uri]
            losses.add("export-mesh-refused", uri, f"is left out: it is outside the folder of the robot, {where}")
            return None
        if uri not in given.meshes:
            losses.add("export-mesh-missing", uri)
            return None
        try:
            mesh = given.reader.read(given.meshes[uri])
        except RefusedFile as error:
            losses.add("export-mesh-refused", uri, f"is left out: {error}")
            return None
        name = self._names[uri]
        path = f"meshes/{name}"
        if self._is_readable is not None and not self._is_readable(name, mesh.content):
            triangles = given.read_mesh(given.meshes[uri])
            if triangles is None:
                losses.add("export-mesh-format", uri)
                return None
            path += self._ending
            self.files[path] = self._converted(triangles)
            losses.add("export-mesh-converted", uri)
            if given.mesh_files == "reference":
                losses.add("export-mesh-not-referenced", uri)
        elif given.mesh_files == "reference":
            path = Path(os.path.abspath(given.meshes[uri])).as_posix()
        else:
            for other, reason in mesh.place(path, self.files).items():
                losses.add("export-mesh-names", f"{uri}: {other}", f"is left out: {reason}")
        if uri.startswith("package://"):
            losses.add("export-mesh-path", uri, f"becomes '{path}'")
        return path


def _wavefront(triangles: Triangles) -> bytes:
    """An OBJ file."""
    vertices, faces = triangles
    lines = [f"v {numbers(vertex)}" for vertex in vertices.tolist()]
    lines += [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in faces.tolist()]
    return "\n".join([*lines, ""]).encode()
