"""The mesh files of an imported robot, under names that mean a file in its folder and nothing else."""

from __future__ import annotations

from pathlib import Path

from eurdf.convert.losses import Effect, Losses, LossKind
from eurdf.mesh_files.folders import Folders
from eurdf.mesh_files.reader import MeshReader
from eurdf.writing.file_names import FileNames

#: The loss of a file that a mesh names.
NAMED_FILE = LossKind(
    "import-mesh-names",
    "mesh",
    Effect.DROPPED,
    "a material, a buffer or a picture that it names is left out",
    "copy it into the robot's folder, and name it by its path from the mesh",
)


class MeshCopies:
    """Mesh files to write, each once, and the files that they name.

    Attributes:
        files: Content by path relative to the folder, ``meshes/`` and a name.
        folders: Where the meshes may be.
    """

    def __init__(self, folders: Folders, losses: Losses) -> None:
        """Prepare the copies.

        Args:
            folders: Where the meshes may be.
            losses: Where to record losses of the kind `NAMED_FILE`.
        """
        self.files: dict[str, bytes] = {}
        self.folders = folders
        self._losses, self._reader = losses, MeshReader(folders)
        self._of: dict[str, str] = {}
        self._names = FileNames()

    def file(self, path: Path) -> str:
        """Copy a file; returns its path relative to the folder.

        Raises:
            RefusedFile: It is outside the folders, or is no mesh.
        """
        key = str(path)
        if key not in self._of:
            mesh = self._reader.read(path)
            self._of[key] = copy = f"meshes/{self._names.new(path.stem, path.suffix)}"
            for other, reason in mesh.place(copy, self.files).items():
                self._losses.add(NAMED_FILE.code, f"{path.name}: {other}", f"is left out: {reason}")
        return self._of[key]

    def content(self, name: str, suffix: str, content: bytes) -> str:
        """Add a file that does not exist yet, under a name near to one; returns its path relative to the folder."""
        key = f"{name}{suffix}"
        if key not in self._of:
            self._of[key] = path = f"meshes/{self._names.new(name, suffix)}"
            self.files[path] = content
        return self._of[key]
