"""The mesh files of an imported robot, under names that mean a file in its folder and nothing else."""

from __future__ import annotations

from pathlib import Path

from eurdf.writing.file_names import FileNames


class MeshCopies:
    """Mesh files to write, each once.

    Attributes:
        files: Content by path relative to the folder, ``meshes/`` and a name.
    """

    #: Endings of mesh files: no other file is copied, whatever a file names as its mesh.
    SUFFIXES = frozenset({".stl", ".obj", ".dae", ".ply", ".gltf", ".glb", ".off", ".3ds", ".vtk"})

    def __init__(self) -> None:
        self.files: dict[str, bytes] = {}
        self._of: dict[str, str] = {}
        self._names = FileNames()

    def file(self, path: Path) -> str:
        """Copy a file; returns its path relative to the folder."""
        key = str(path)
        if key not in self._of:
            self._of[key] = self._new(path.stem, path.suffix, path.read_bytes())
        return self._of[key]

    def content(self, name: str, suffix: str, content: bytes) -> str:
        """Add a file that does not exist yet, under a name near to one; returns its path relative to the folder."""
        key = f"{name}{suffix}"
        if key not in self._of:
            self._of[key] = self._new(name, suffix, content)
        return self._of[key]

    def _new(self, stem: str, suffix: str, content: bytes) -> str:
        path = f"meshes/{self._names.new(stem, suffix)}"
        self.files[path] = content
        return path
