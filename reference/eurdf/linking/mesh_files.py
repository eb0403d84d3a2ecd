"""The mesh and texture files that a URDF names: where they are, and whether they may be read."""

from __future__ import annotations

import os
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import NamedTuple

from eurdf.diagnostics import Diagnostics, Place, quoted
from eurdf.format.urdf.data import Urdf
from eurdf.mesh_files.folders import Folders
from eurdf.reading.resource import HINT, FileFinder


class FoundFiles(NamedTuple):
    """The mesh and texture files of a URDF.

    Attributes:
        paths: Path of each file that may be read, by URI.
        diagnostics: About files that are missing, or outside the robot's folder.
        folders: Where the files may be, and those that they name.
        outside: URIs of files that exist and are outside, so that they are not read.
    """

    paths: dict[str, str]
    diagnostics: Diagnostics
    folders: Folders
    outside: tuple[str, ...]


def find_meshes(
    urdf: Urdf,
    package_dirs: Sequence[str | os.PathLike[str]] = (),
    *,
    confined: bool = False,
    allow_outside: bool = False,
) -> FoundFiles:
    """EU-URD-028, EU-URD-033: look every mesh and every texture up, in the robot's folder and in packages.

    A mesh that is outside is an error if files are ``confined``, and is read if ``allow_outside``. There is one
    diagnostic for all meshes, and one for all textures of a kind.
    """
    source = urdf.document.source
    real = Path(os.path.realpath(source.files[0])).parent if source.files and not confined else source.folder
    finder = FileFinder(source.folder, package_dirs, real_folder=real, allow_outside=allow_outside)
    shapes = list(urdf.shapes)
    paths: dict[str, str] = {}
    diagnostics = Diagnostics()
    refused: list[str] = []
    for tag, uris in (
        ("mesh", dict.fromkeys(shape.filename for shape in shapes if shape.filename)),
        ("texture", dict.fromkeys(shape.texture for shape in shapes if shape.texture)),
    ):
        found = {uri: finder.find(uri) for uri in uris}
        outside = [uri for uri, path in found.items() if path is not None and not finder.folders.contains(path)]
        if not allow_outside:
            refused += outside
        paths |= {uri: path for uri, path in found.items() if path is not None and uri not in refused}
        if missing := [uri for uri, path in found.items() if path is None]:
            diagnostics.report(
                f"urdf-{tag}-missing",
                f"{_files(tag, missing)} not found: {quoted(missing)}",
                partial(place_of_file, urdf, tag, missing[0]),
                HINT,
            )
        if outside:
            _report_outside(urdf, tag, outside, finder.folders, confined, diagnostics)
    return FoundFiles(paths, diagnostics, finder.folders, tuple(refused))


def _report_outside(
    urdf: Urdf, tag: str, uris: list[str], folders: Folders, confined: bool, diagnostics: Diagnostics
) -> None:
    """Report the files of a kind that are outside the robot's folder."""
    hint = (
        "copy them there, or give the folder of their package with --package-dir (package_dirs= in Python); "
        "--allow-outside (allow_outside=True) reads files from anywhere"
    )
    if confined and tag == "mesh":
        for uri in uris:
            diagnostics.report(
                "urdf-mesh-unreadable",
                f"mesh '{uri}' cannot be read: it is outside the folder of the robot, {folders}, and files are "
                "confined to it",
                partial(place_of_file, urdf, tag, uri),
                "copy it there, or give the folder of its package with --package-dir (package_dirs= in Python)",
            )
        return
    is_read = "are read all the same" if folders.allow_outside else "are not read"
    diagnostics.report(
        "x-file-outside-folder",
        f"{_files(tag, uris)} outside the folder of the robot, {folders}, and {is_read}: {quoted(uris)}",
        partial(place_of_file, urdf, tag, uris[0]),
        "copy them there" if folders.allow_outside else hint,
    )


def _files(tag: str, uris: Sequence[str]) -> str:
    return f"1 {tag} file is" if len(uris) == 1 else f"{len(uris)} {tag} files are"


def place_of_file(urdf: Urdf, tag: str, uri: str) -> Place:
    """Where the URDF first names a mesh or a texture."""
    document = urdf.document
    element = next(element for element in document.root.iter(tag) if element.get("filename") == uri)
    return document.place(element, "filename")
