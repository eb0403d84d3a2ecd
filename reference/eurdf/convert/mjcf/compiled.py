"""An MJCF file as MuJoCo's own compiler reads it, so that defaults, includes and classes are right."""

from __future__ import annotations

import itertools
import json
import os
import re
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from types import SimpleNamespace

from lxml import etree

from eurdf.convert.xml_elements import inside, read_root
from eurdf.errors import CannotImport, MissingExtra
from eurdf.mesh_files.folders import Folders
from eurdf.reading.source import FILE_LIMIT, begin_of_file
from eurdf.sandbox import run

#: Processor time (s) and memory (bytes) that compiling a file may take.
SECONDS, MEMORY = 60, 6 << 30

#: Files that may include each other in turn.
DEPTH_LIMIT = 50

#: Files in the folder of another one that are read to find the one that includes it.
OTHERS_LIMIT = 50

#: Flexible bodies that may be in files of their own, and elements that state options of MuJoCo's compiler.
FLEXIBLE_LIMIT = 50

_INCLUDE = re.compile(rb"""<include\s+file\s*=\s*["']([^"']+)["']""")

_PROGRAM = Path(__file__).with_name("compile_process.py")

#: An element of a compiled model: its ``index`` and ``name`` (empty for none), and its values by their names in
#: ``mjModel``, such as ``pos`` of ``body_pos``. Enumerations are words, as ``hinge``; a value that a release of MuJoCo
#: does not have is an empty list.
Element = SimpleNamespace


@dataclass(frozen=True, slots=True)
class MjcfModel:
    """A compiled model.

    Attributes:
        name: Name of the model.
        elements: The elements of each kind, by its prefix in ``mjModel``, in the order of the model. A body also has
            ``fullinertia`` (xx, yy, zz, xy, xz, yz along its axes, kg·m², if stated); a mesh the ``path`` of its file
            (empty for none), ``scale``, and its content as ``obj``, in the frame of the compiled mesh, where the file
            cannot be used (else empty).
        qpos0: The reference configuration.
        qpos_spring: The configuration at which springs are at rest.
        counts: Numbers of elements that are not here, by their name in ``mjModel``.
        left_out: Assets that were left out before compiling: ``kind``, ``name`` and ``reason``.
    """

    name: str
    elements: Mapping[str, Sequence[Element]]
    qpos0: Sequence[float]
    qpos_spring: Sequence[float]
    counts: Mapping[str, int]
    left_out: Sequence[Element]

    def __getitem__(self, kind: str) -> Sequence[Element]:
        """The elements of a kind."""
        return self.elements[kind]


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
        "seconds": SECONDS,
        "memory": MEMORY,
    }
    with tempfile.TemporaryDirectory() as scratch:
        done = run(_PROGRAM, request, folder=scratch)
    if done.exceeded:
        raise CannotImport(path, f"MuJoCo does not compile it within {SECONDS} s")
    if done.code or not done.output:
        raise CannotImport(path, "MuJoCo crashes on it; check the file with MuJoCo's own tools")
    answer = json.loads(done.output, object_hook=_element)
    if hasattr(answer, "error"):
        scene = _included_by(path)  # a fragment can lack what the file states that includes it
        hint = "" if scene is None else f"; it is included by '{scene.name}': import that file instead"
        raise CannotImport(path, answer.error + hint)
    return MjcfModel(**{**vars(answer), "elements": vars(answer.elements), "counts": vars(answer.counts)})


def _element(values: dict[str, object]) -> Element:
    return Element(**values)


def included_files(path: Path, folders: Folders) -> tuple[Path, ...]:
    """An MJCF file and all that it includes, each read once, the main one first: paths as given, not absolute.

    Our own reader, which refuses entities, reads each of them before MuJoCo does. MuJoCo looks for an included file in
    the folder of the main one, then in that of the one that includes it; for what a model to attach includes, in the
    folder of that model. A file that exists in any of these counts.

    Args:
        path: The file.
        folders: Where all of them must be, with symbolic links followed.

    Raises:
        CannotImport: A file is outside the folders, includes itself, or cannot be read; or another file that MuJoCo
            opens while it reads these is outside the folders.
    """
    found: dict[Path, Path] = {}
    roots: list[etree._Element] = []
    visited: set[tuple[Path, Path]] = set()

    def visit(given: Path, main: Path, chain: tuple[Path, ...]) -> None:
        file = _resolved(path, given)
        inside(path, file, folders)
        if file in chain:
            shown = " -> ".join(f"'{each.name}'" for each in (*chain[chain.index(file) :], file))
            raise CannotImport(path, f"a file includes itself: {shown}; remove one of these includes")
        if len(chain) > DEPTH_LIMIT:
            raise CannotImport(path, f"files include each other more than {DEPTH_LIMIT} deep")
        if (file, main) in visited:
            return
        visited.add((file, main))
        root = read_root(file)
        if file not in found:
            roots.append(root)
        found.setdefault(file, given)
        for element in root.iter("include", "model"):
            if name := element.get("file"):
                places = [folder / name for folder in dict.fromkeys((main, given.parent, path.parent))]
                for each in [each for each in places if os.path.exists(each)] or places[:1]:
                    visit(each, each.parent if element.tag == "model" else main, (*chain, file))

    visit(path, path.parent, ())
    files = tuple(found.values())
    _check_flexible_bodies(path, files, roots, folders)
    return files


def _included_by(path: Path) -> Path | None:
    """The file beside an MJCF file that includes it, such as its scene; None if there is none."""
    others = (other for other in sorted(path.parent.glob("*.xml")) if other.name != path.name)
    for other in itertools.islice(others, OTHERS_LIMIT):
        if other.is_symlink():  # which may lead out of the folder
            continue
        try:
            names = _INCLUDE.findall(begin_of_file(other, FILE_LIMIT))
        except OSError:
            continue
        if any(os.path.normpath(name) == os.fsencode(path.name) for name in names):
            return other
    return None


def _check_flexible_bodies(
    path: Path, files: tuple[Path, ...], roots: Sequence[etree._Element], folders: Folders
) -> None:
    """Refuse files of flexible bodies outside the folders: MuJoCo opens them while it reads the XML.

    The folder that such a name starts from depends on options that any of the files may state, so that all are tried.
    """
    names = [name for root in roots for element in root.iter("flexcomp") if (name := element.get("file"))]
    options = [element for root in roots for element in root.iter("compiler")]
    if len(names) > FLEXIBLE_LIMIT or len(options) > FLEXIBLE_LIMIT:
        raise CannotImport(path, f"it has more than {FLEXIBLE_LIMIT} flexible bodies in files, or compiler elements")
    starts = {"", *(element.get(key, "") for element in options for key in ("meshdir", "assetdir"))}
    for name in dict.fromkeys((*names, *map(os.path.basename, names))):
        for folder in dict.fromkeys(file.parent for file in files):
            for start in sorted(starts):
                file = _resolved(path, folder / start / name)
                inside(path, file, folders)
                if os.path.exists(file) and not os.path.isfile(file):
                    raise CannotImport(path, f"it uses '{file}', which is not a file")


def _resolved(main: Path, file: Path) -> Path:
    """The real path of a file, with symbolic links followed."""
    try:
        return Path(os.path.realpath(file))
    except (OSError, ValueError):  # a name that cannot be one, such as one with a zero
        raise CannotImport(main, f"it includes {file.name!r}, which cannot be the name of a file") from None
