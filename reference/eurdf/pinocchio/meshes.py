"""The triangles of mesh files, read in a process of its own, bounded in time and memory."""

from __future__ import annotations

import json
import os
import stat
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from eurdf.dataclass import dataclass
from eurdf.program import command_of
from eurdf.system import exceeded

#: Bytes that the mesh files of a robot may have together.
BYTES_LIMIT = 1 << 30

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


@dataclass(frozen=True, slots=True, eq=False)
class Mesh:
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
    """A file to read: its path, and its size in bytes."""

    path: str
    size: int

    @property
    def seconds(self) -> float:
        return SECONDS + SECONDS_A_BYTE * self.size

    @property
    def memory(self) -> int:
        return min(MEMORY + MEMORY_A_BYTE * self.size, MOST_MEMORY)


def read_meshes(
    shapes: Iterable[tuple[str, tuple[float, ...]]], paths: Mapping[str, str]
) -> tuple[dict[str, Mesh], dict[str, str]]:
    """Read mesh files as Pinocchio does, each file once: STL, OBJ, COLLADA and whatever else assimp reads.

    Whatever is in the files, it takes bounded time and memory.

    Args:
        shapes: URI and scale of each mesh of the robot.
        paths: Path of each URI.

    Returns:
        The meshes, by path; and by URI the reason why there is no mesh, or why it cannot be scaled.
    """
    shapes = dict.fromkeys(shapes)
    read = _read_files(dict.fromkeys(paths[uri] for uri, _ in shapes))
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


def _read_files(paths: Iterable[str]) -> dict[str, Mesh | str]:
    read: dict[str, Mesh | str] = {}
    same: dict[tuple[int, int], list[str]] = {}
    files: list[_File] = []
    total = 0
    for path in paths:
        try:
            status = os.stat(path)
        except OSError as error:
            read[path] = (error.strerror or str(error)).lower()
            continue
        if not stat.S_ISREG(status.st_mode):
            read[path] = "it is not a file"
            continue
        one = same.setdefault((status.st_dev, status.st_ino), [])
        one.append(path)
        if len(one) > 1:
            continue
        total += status.st_size
        if total > BYTES_LIMIT:
            read[path] = f"with it, the mesh files of the robot have more than {BYTES_LIMIT:,} bytes"
        else:
            files.append(_File(path, status.st_size))
    read |= _read(files)
    return read | {path: read[first] for first, *others in same.values() for path in others}


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
    import subprocess  # only now: often no mesh is read

    request = {
        "patience": PATIENCE,
        "files": [{"path": file.path, "seconds": file.seconds, "memory": file.memory} for file in files],
    }
    done = subprocess.run(
        command_of(_PROGRAM),
        input=json.dumps(request).encode(),
        capture_output=True,
        check=False,
        env={**os.environ, "OPENBLAS_NUM_THREADS": "1"},  # each thread takes time to start, and address space
    )
    return _answers(done.stdout, files), exceeded(done.returncode, done.stderr)


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
