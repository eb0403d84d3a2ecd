"""The triangles of mesh files, read in a process of its own, bounded in time and memory."""

from __future__ import annotations

import json
import os
import tempfile
from collections.abc import Iterable, Iterator, Mapping
from contextlib import ExitStack
from functools import cache
from pathlib import Path
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from eurdf.mesh_files.folders import Folders, folders_of_files
from eurdf.mesh_files.reader import MeshReader, RefusedFile
from eurdf.regular_file import reason_of
from eurdf.sandbox import run

#: Triangles that the meshes of a robot may have together, where those of each scale of a mesh count.
TRIANGLES_LIMIT = 10_000_000

#: Largest coordinate of a scaled mesh, in m; of larger ones, bounding volumes would not be finite.
LONGEST = 1e100

#: Processes that may die of the meshes of one robot.
DEATHS_LIMIT = 4

#: Processor time that a file may take, in s, and what each of its bytes adds. An OBJ file takes some 7e-8 a byte.
SECONDS, SECONDS_A_BYTE = 2, 1e-6

#: Memory that a file may take, in bytes, what each of its bytes adds, and the most. An OBJ file takes some 50 a byte.
MEMORY, MEMORY_A_BYTE, MOST_MEMORY = 256 << 20, 100, 8 << 30

#: Time after which a file that takes no processor time, such as a pipe, is given up, in s.
PATIENCE = 60

_PROGRAM = Path(__file__).with_name("mesh_process.py")


class Mesh(NamedTuple):
    """The triangles of a file.

    Attributes:
        vertices: Shape (n, 3), in the unit and the axes of the file.
        triangles: Shape (m, 3), indices of vertices.
    """

    vertices: npt.NDArray[np.float64]
    triangles: npt.NDArray[np.int64]

    @property
    def extent(self) -> npt.NDArray[np.float64]:
        """The largest magnitude of each coordinate, shape (3,)."""
        return np.asarray(np.abs(self.vertices).max(axis=0))

    @property
    def size(self) -> float:
        """Length of the longest side of the bounding box."""
        return float(np.ptp(self.vertices, axis=0).max())


class _File(NamedTuple):
    """A file to read: its path, the path of what the mesh loader is given in its place, and the size of that."""

    path: str
    alone: str
    size: int

    @property
    def seconds(self) -> float:
        return SECONDS + SECONDS_A_BYTE * self.size

    @property
    def memory(self) -> int:
        return min(MEMORY + MEMORY_A_BYTE * self.size, MOST_MEMORY)


def read_meshes(
    shapes: Iterable[tuple[str, tuple[float, ...]]], paths: Mapping[str, str], folders: Folders | None = None
) -> tuple[dict[str, Mesh], dict[str, str]]:
    """Read mesh files as Pinocchio does, each file once: STL, OBJ, COLLADA, glTF, PLY, OFF and 3DS.

    Whatever is in the files, it takes bounded time and memory, and opens no file that is outside the folders.

    Args:
        shapes: URI and scale of each mesh of the robot.
        paths: Path of each URI.
        folders: Where the files may be, and those that they name; by default, in the robots' folders that the files
            are in.

    Returns:
        The meshes, by path; and by URI the reason why there is no mesh, or why it cannot be scaled.
    """
    shapes = dict.fromkeys(shapes)
    files = dict.fromkeys(paths[uri] for uri, _ in shapes)
    read = _read_files(files, MeshReader(folders_of_files(files) if folders is None else folders))
    meshes: dict[str, Mesh] = {}
    reasons: dict[str, str] = {}
    triangles = 0
    for uri, scale in shapes:
        mesh = read[paths[uri]]
        if isinstance(mesh, str):
            reasons[uri] = mesh
            continue
        meshes[paths[uri]] = mesh
        triangles += len(mesh.triangles)
        if triangles > TRIANGLES_LIMIT:
            reasons[uri] = f"with it, the meshes of the robot have more than {TRIANGLES_LIMIT:,} triangles"
            break
        if not (mesh.extent * np.abs(scale) <= LONGEST).all():
            reasons[uri] = f"a coordinate of a vertex, times the scale, is beyond {LONGEST:.0e} m"
    return meshes, reasons


def _read_files(paths: Iterable[str], reader: MeshReader) -> dict[str, Mesh | str]:
    read: dict[str, Mesh | str] = {}
    same: dict[tuple[object, ...], list[str]] = {}
    files: list[_File] = []
    with ExitStack() as stack:

        @cache
        def scratch() -> Path:
            return Path(stack.enter_context(tempfile.TemporaryDirectory()))

        for path in paths:
            try:
                one = same.setdefault(_identity(path), [])
                if one:
                    reader.size(path)  # by this name, it may be outside the folders
                else:
                    files.append(_File(path, *reader.alone(path, lambda: scratch() / str(len(files)))))
                one.append(path)
            except RefusedFile as reason:
                read[path] = str(reason)
            except OSError as error:  # it was there a moment ago
                read[path] = reason_of(error)
        read |= _read(files)
    return read | {path: read[one[0]] for one in same.values() for path in one[1:]}


def _identity(path: str) -> tuple[object, ...]:
    """What two names of a file have in common if it is the same mesh by both."""
    status, suffix = os.stat(path), Path(path).suffix.lower()
    names_files = suffix in (".gltf", ".glb")  # from the folder that it is in
    return status.st_dev, status.st_ino, suffix, os.path.dirname(path) if names_files else ""


def _read(files: list[_File]) -> dict[str, Mesh | str]:
    read: dict[str, Mesh | str] = {}
    deaths = 0
    while len(read) < len(files) and deaths < DEATHS_LIMIT:
        rest = files[len(read) :]
        answers, bound = _run(rest)
        for file, answer in zip(rest, answers, strict=False):
            read[file.path] = answer
        if len(read) < len(files):
            deaths += 1
            dead = files[len(read)]
            read[dead.path] = _death(bound, dead)
    for file in files[len(read) :]:
        read[file.path] = f"it was not read, as {deaths} other mesh files crashed the mesh loader"
    return read


def _run(files: list[_File]) -> tuple[Iterator[Mesh | str], str | None]:
    """What a process reads of files, as far as it comes, and the bound that ended it."""
    request = {
        "patience": PATIENCE,
        "files": [{"path": file.alone, "seconds": file.seconds, "memory": file.memory} for file in files],
    }
    # Each thread takes time to start, and address space.
    done = run(_PROGRAM, request, environment={**os.environ, "OPENBLAS_NUM_THREADS": "1"})
    return _answers(done.output, files), done.exceeded


def _answers(data: bytes, files: list[_File]) -> Iterator[Mesh | str]:
    at = 0
    for file in files:
        end = data.find(b"\n", at)
        if end < 0:
            return
        head = json.loads(data[at:end])
        at = end + 1
        if "error" in head:
            yield _memory(file) if head["error"] == "memory" else head["error"]
            continue
        size = 24 * (head["vertices"] + head["triangles"])
        if at + size > len(data):
            return
        vertices = np.frombuffer(data, np.float64, 3 * head["vertices"], at).reshape(-1, 3)
        triangles = np.frombuffer(data, np.int64, 3 * head["triangles"], at + vertices.nbytes).reshape(-1, 3)
        at += size
        yield _checked(vertices, triangles)


def _checked(vertices: npt.NDArray[np.float64], triangles: npt.NDArray[np.int64]) -> Mesh | str:
    if not triangles.size:
        return "it has no triangle"
    if triangles.min() < 0 or triangles.max() >= len(vertices):
        return "a triangle has a vertex that does not exist"
    if not np.isfinite(vertices).all():
        return "a coordinate of a vertex is not finite"
    return Mesh(vertices, triangles)


def _memory(file: _File) -> str:
    return f"reading it takes more than {file.memory >> 20:,} MiB of memory, and it has {file.size:,} bytes"


def _death(bound: str | None, file: _File) -> str:
    if bound == "time":
        return f"reading it does not end within {PATIENCE} s"
    if bound == "processor time":
        return f"reading it takes longer than {file.seconds:.0f} s, and it has {file.size:,} bytes"
    return "the mesh loader crashed on it"
