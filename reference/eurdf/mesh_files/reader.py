"""Reading mesh files that somebody else's file names: the one place where their bytes are taken from the disk."""

from __future__ import annotations

import base64
import binascii
import json
import os
import posixpath
import re
from collections.abc import Callable, Iterator, MutableMapping
from pathlib import Path
from typing import Any, BinaryIO, NamedTuple
from urllib.parse import unquote, unquote_to_bytes

from eurdf.mesh_files.folders import Folders
from eurdf.mesh_files.kinds import (
    HEAD,
    KINDS,
    MATERIALS,
    MeshKind,
    gltf_document,
    is_embedded,
    joined_lines,
    listed,
    suffix_of,
)
from eurdf.regular_file import open_regular, reason_of

#: Bytes that the mesh files of a robot may have together, with the files that they name.
BYTES_LIMIT = 1 << 30

#: What the mesh loader needs of a glTF file. Pictures and materials are left out.
_GEOMETRY = (
    "asset",
    "scene",
    "scenes",
    "nodes",
    "meshes",
    "accessors",
    "bufferViews",
    "buffers",
    "extensionsUsed",
    "extensionsRequired",
)

#: Files that a mesh may name.
REFERENCES_LIMIT = 1_000

#: How a pointer of Git LFS begins, which is there where the file was not fetched.
GIT_LFS = b"version https://git-lfs"


class RefusedFile(Exception):  # noqa: N818 - named like InvalidRobot
    """A mesh file, or a file that it names, is not read; the text says why."""


class MeshFile(NamedTuple):
    """The content of a mesh file, and of the files that it names.

    Attributes:
        content: Its bytes.
        others: Content of each file that it names, such as a texture, by its path from the folder of the mesh.
        left_out: For each other file that it names: its name, and why it was not read.
    """

    content: bytes
    others: dict[str, bytes]
    left_out: dict[str, str]

    def place(self, path: str, files: MutableMapping[str, bytes]) -> dict[str, str]:
        """Add it to files to write, by path from the folder to write to, and what it names where the copy looks for it.

        The result is for each file that it names and that is not among them: its name, and why.
        """
        files[path] = self.content
        missing = dict(self.left_out)
        for name, content in self.others.items():
            place = posixpath.normpath(posixpath.join(posixpath.dirname(path), name))
            if place.startswith(("/", "../")) or not place.isprintable():
                missing[name] = "its place is not in the folder that is written"
            elif files.setdefault(place, content) != content:
                missing[name] = "another file has this place"
        return missing


class MeshReader:
    """Reads the mesh files of one robot.

    Attributes:
        folders: Where they may be.
    """

    def __init__(self, folders: Folders) -> None:
        self.folders = folders
        self._left = BYTES_LIMIT

    def size(self, path: str) -> int:
        """The size of a mesh file in bytes.

        Raises:
            RefusedFile: It is outside the folders, is no regular file, or does not begin as its name says.
        """
        stream, size = self._mesh(path)
        stream.close()
        return size

    def read(self, path: str | os.PathLike[str]) -> MeshFile:
        """Read a mesh file, and the files that it names.

        Raises:
            RefusedFile: As for `size`; or the files of the robot are too large together.
        """
        file = os.fspath(path)
        content = self._content(file)
        found: dict[str, bytes] = {}
        left_out: dict[str, str] = {}
        self._read_references(file, KINDS[suffix_of(file)], content, found, left_out)
        return MeshFile(content, found, left_out)

    def alone(self, path: str, scratch: Callable[[], Path]) -> tuple[str, int]:
        """A file with the same triangles that names no other file, and its size in bytes.

        If the mesh is none itself, it is written at the path that ``scratch`` gives, without an ending.

        Raises:
            RefusedFile: As for `read`, or the mesh loader does not know its format.
        """
        suffix = suffix_of(path)
        if suffix in KINDS and KINDS[suffix].is_alone:
            size = self.size(path)
            self._spend(size)
            return path, size
        if suffix == ".obj":
            content = self._content(path)
            clean = _without_materials(content)
            if clean == content:
                return path, len(content)
        elif suffix in (".gltf", ".glb"):
            suffix, clean = ".gltf", self._self_contained(path, suffix)
        else:
            self.size(path)
            raise RefusedFile(f"the mesh loader does not read {KINDS[suffix].name}; convert it to STL or OBJ")
        copy = f"{scratch()}{suffix}"
        try:
            Path(copy).write_bytes(clean)
        except OSError as error:
            raise RefusedFile(f"a copy that names no other file cannot be written: {error.strerror}") from None
        return copy, len(clean)

    def _mesh(self, path: str) -> tuple[BinaryIO, int]:
        """A mesh file, at its beginning, and its size."""
        suffix = suffix_of(path)
        if suffix not in KINDS:
            ending = f"its ending '{suffix}'" if suffix else "its name"
            raise RefusedFile(f"{ending} is not that of a mesh format; convert it to STL, OBJ, COLLADA or glTF")
        stream, size = self._open(path)
        try:
            head = stream.read(HEAD)
            stream.seek(0)
        except OSError as error:
            raise RefusedFile(reason_of(error)) from None
        if head.startswith(GIT_LFS):
            reason = "it is a pointer of Git LFS; fetch the file with `git lfs pull`"
        elif not size:
            reason = "it is empty"
        elif not KINDS[suffix].matches(head, size):
            reason = f"its content is not {KINDS[suffix].name}, as its name says"
        else:
            return stream, size
        stream.close()
        raise RefusedFile(reason)

    def _open(self, path: str) -> tuple[BinaryIO, int]:
        if not self.folders.admit(path):
            raise RefusedFile(f"it is outside the folder of the robot, {self.folders}")
        try:
            stream = open_regular(path)
        except OSError as error:
            raise RefusedFile((error.strerror or "it is not a file").lower()) from None
        except ValueError:  # a NUL in the path
            raise RefusedFile("its name is not that of a file") from None
        return stream, os.fstat(stream.fileno()).st_size

    def _content(self, path: str) -> bytes:
        return self._all(*self._mesh(path))

    def _all(self, stream: BinaryIO, size: int) -> bytes:
        with stream:
            self._spend(size)
            try:
                return stream.read(size)
            except OSError as error:
                raise RefusedFile(reason_of(error)) from None

    def _spend(self, size: int) -> None:
        if size > self._left:
            raise RefusedFile(
                f"it has {size:,} bytes; with it, the mesh files of the robot have more than {BYTES_LIMIT:,} bytes"
            )
        self._left -= size

    def _read_references(
        self, file: str, kind: MeshKind, content: bytes, found: dict[str, bytes], left_out: dict[str, str]
    ) -> None:
        names = dict.fromkeys(kind.names(content))
        if len(names) > REFERENCES_LIMIT:
            left_out[f"{len(names):,} files"] = f"it names more than {REFERENCES_LIMIT:,}"
            return
        for name in names:
            try:
                relative, path = self._named(file, kind, name)
                if relative in found:
                    continue
                found[relative] = other = self._all(*self._open(path))
            except RefusedFile as reason:
                left_out[name] = str(reason)
                continue
            if suffix_of(path) == ".mtl":
                # The pictures of materials are named from the folder of the materials.
                within: dict[str, bytes] = {}
                self._read_references(path, MATERIALS, other, within, left_out)
                folder = posixpath.dirname(relative)
                found |= {posixpath.normpath(posixpath.join(folder, each)): data for each, data in within.items()}

    def _named(self, file: str, kind: MeshKind, name: str) -> tuple[str, str]:
        """What a mesh or its materials name: the path from their folder, and the path of the file."""
        if suffix_of(name) not in kind.may_name:
            raise RefusedFile("its name is not that of a material, a buffer or a picture")
        if "\0" in name or name.startswith("/") or re.match(r"[A-Za-z][A-Za-z0-9+.-]*:", name):
            raise RefusedFile("its address is not a path from the folder of the mesh")
        folder = os.path.dirname(file)
        for each in (name, unquote(name)):
            path = os.path.join(folder, each)
            if "\0" not in each and os.path.isfile(path):
                return posixpath.normpath(each), path
        raise RefusedFile("it was not found")

    def _self_contained(self, path: str, suffix: str) -> bytes:
        """The triangles of a glTF file as one JSON text, with its buffers in it."""
        try:
            document, data = gltf_document(suffix, self._content(path))
        except ValueError as error:
            raise RefusedFile(f"its content is not {KINDS[suffix].name}: {' '.join(str(error).split())}") from None
        kept: dict[str, Any] = {key: document[key] for key in _GEOMETRY if key in document}
        kept["buffers"] = [
            {"byteLength": len(content), "uri": _embedded(content)} for content in self._buffers(path, document, data)
        ]
        for mesh in listed(kept.get("meshes")):
            for primitive in listed(mesh.get("primitives")):
                primitive.pop("material", None)
        return json.dumps(kept).encode()

    def _buffers(self, path: str, document: dict[str, Any], data: bytes) -> Iterator[bytes]:
        for number, buffer in enumerate(listed(document.get("buffers"))):
            uri = buffer.get("uri")
            if uri is None and number == 0:
                yield data
            elif not isinstance(uri, str):
                raise RefusedFile(f"its buffer {number} has no data")
            elif is_embedded(uri):
                yield _data(uri)
            else:
                try:
                    yield self._all(*self._open(self._named(path, KINDS[suffix_of(path)], uri)[1]))
                except RefusedFile as reason:
                    raise RefusedFile(f"its buffer '{uri}' cannot be read: {reason}") from None


def _without_materials(content: bytes) -> bytes:
    """An OBJ text without the names of its materials: the mesh loader would open them."""
    if b"\\" in content:
        # What is left of them must not join lines, which would make a name of two halves.
        content = joined_lines(content).replace(b"\\", b"/")
    return re.sub(rb"mtllib", b"# none", content, flags=re.IGNORECASE)


def _embedded(content: bytes) -> str:
    return "data:application/octet-stream;base64," + base64.b64encode(content).decode()


def _data(uri: str) -> bytes:
    """The data in a URI."""
    head, _, text = uri.partition(",")
    if not head.lower().endswith(";base64"):
        return unquote_to_bytes(text)
    try:
        return base64.b64decode(unquote_to_bytes(text))
    except binascii.Error:
        raise RefusedFile("the data of a buffer are not base64") from None
