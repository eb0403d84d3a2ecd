"""An MJCF file as MuJoCo's own compiler reads it, so that defaults, includes and classes are right."""

from __future__ import annotations

import json
import os
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from eurdf.exceptions import MissingExtra
from eurdf.importing.exceptions import CannotImport
from eurdf.importing.xml_files import included_by
from eurdf.mesh_files.folders import Folders
from eurdf.mesh_files.reader import BYTES_LIMIT
from eurdf.sandbox import run

#: Processor time (s) and memory (bytes) that compiling a file may take.
SECONDS, MEMORY = 60, 6 << 30

_PROGRAM = Path(__file__).with_name("process.py")


@dataclass(frozen=True, slots=True)
class MjcfMesh:
    """A mesh of a model.

    Attributes:
        path: Its file; empty for none.
        scale: Factors of the coordinates in the file.
        obj: Its content as OBJ, in the frame of the compiled mesh, where the file cannot be used; else empty.
    """

    path: str
    scale: tuple[float, ...]
    obj: str


@dataclass(frozen=True, slots=True)
class LeftOut:
    """An asset that was left out before compiling: its kind, its name, and why."""

    kind: str
    name: str
    reason: str


@dataclass(frozen=True, slots=True)
class MjcfModel:
    """A compiled model.

    Attributes:
        name: Name of the model.
        arrays: Arrays of ``mjModel`` by name; enumerations are words, as ``hinge``.
        names: For ``body``, ``joint``, ``geom``, … the names of the elements; empty for those without one.
        counts: Numbers of elements of which no array is here, by their name in ``mjModel``.
        meshes: In the order of the model.
        full_inertia: Of bodies that state one: xx, yy, zz, xy, xz, yz along the axes of the body, kg·m².
        left_out: Assets that were left out.
    """

    name: str
    arrays: Mapping[str, Any]
    names: Mapping[str, Sequence[str]]
    counts: Mapping[str, int]
    meshes: tuple[MjcfMesh, ...]
    full_inertia: Mapping[int, tuple[float, ...]]
    left_out: tuple[LeftOut, ...]

    def __getitem__(self, name: str) -> Any:
        """An array by its name; one that this release of MuJoCo does not have is empty."""
        return self.arrays.get(name, ())


def compile_mjcf(path: Path, folders: Folders) -> MjcfModel:
    """Compile a file in a process of its own.

    Args:
        path: The file.
        folders: Where its meshes may be; others are left out.

    Raises:
        CannotImport: MuJoCo refuses it, crashes on it, or takes too long.
        MissingExtra: The extra ``mujoco`` is not installed.
    """
    found = find_spec("mujoco")
    if found is None or found.origin is None:
        from eurdf.diagnostics.extras import install_command

        message = f"'{path}' is an MJCF file, and MuJoCo, which reads it, is not installed; install it with: "
        raise MissingExtra(message + install_command("mujoco"), "mujoco")
    request = {
        "path": os.path.abspath(path),
        "folders": ["/"] if folders.allow_outside else folders.real,
        "bytes": BYTES_LIMIT,
        "seconds": SECONDS,
        "memory": MEMORY,
    }
    with tempfile.TemporaryDirectory() as scratch:
        done = run(_PROGRAM, request, folder=scratch)
    if done.exceeded:
        raise CannotImport(path, f"MuJoCo does not compile it within {SECONDS} s")
    if done.code or not done.output:
        raise CannotImport(path, "MuJoCo crashes on it; check the file with MuJoCo's own tools")
    answer = json.loads(done.output)
    if "error" in answer:
        scene = included_by(path)  # a fragment can lack what the file states that includes it
        hint = "" if scene is None else f"; it is included by '{scene.name}': import that file instead"
        raise CannotImport(path, answer["error"] + hint)
    return MjcfModel(
        answer["name"],
        answer["arrays"],
        answer["names"],
        answer["counts"],
        tuple(MjcfMesh(mesh["path"], tuple(mesh["scale"]), mesh["obj"]) for mesh in answer["meshes"]),
        {int(index): tuple(values) for index, values in answer["fullinertia"].items()},
        tuple(LeftOut(**each) for each in answer["left_out"]),
    )
