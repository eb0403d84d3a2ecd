"""The mesh files of an imported robot, under names that mean a file in its folder and nothing else."""

from __future__ import annotations

import re
from pathlib import Path

_ODD = re.compile(r"[^A-Za-z0-9._-]")


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
        self._used: set[str] = set()

    def file(self, path: Path) -> str:
        """Copy a file; returns its path relative to the folder."""
        key = str(path)
        if key not in self._of:
            self._of[key] = self._new(path.stem, path.suffix.lower(), path.read_bytes())
        return self._of[key]

    def content(self, name: str, suffix: str, content: bytes) -> str:
        """Add a file that does not exist yet, under a name near to one; returns its path relative to the folder."""
        key = f"{name}{suffix}"
        if key not in self._of:
            self._of[key] = self._new(name, suffix, content)
        return self._of[key]

    def _new(self, stem: str, suffix: str, content: bytes) -> str:
        stem, suffix = _ODD.sub("_", stem).lstrip(".") or "mesh", _ODD.sub("_", suffix)
        name, count = stem + suffix, 1
        while name.lower() in self._used:
            count += 1
            name = f"{stem}_{count}{suffix}"
        self._used.add(name.lower())
        path = f"meshes/{name}"
        self.files[path] = content
        return path
