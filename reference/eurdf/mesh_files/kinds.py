"""The formats of mesh files: how each begins, and the other files that one names.

A program chooses its reader by the ending of the name, so the content must be what the name says.
"""

from __future__ import annotations

import html
import json
import re
from collections.abc import Callable, Collection, Iterable, Iterator
from functools import partial
from pathlib import PurePosixPath
from typing import Any, NamedTuple

#: Bytes of the beginning that tell the format.
HEAD = 1 << 16

_PICTURES = frozenset(
    (".png", ".jpg", ".jpeg", ".bmp", ".tga", ".gif", ".tif", ".tiff", ".dds", ".ktx", ".ktx2", ".webp", ".hdr", ".exr")
)

#: Bytes that the JSON of a glTF file may have: in memory, it takes many times that.
JSON_LIMIT = 64 << 20

_BOM = b"\xef\xbb\xbf"


def _is_stl(head: bytes, size: int) -> bool:
    if head.lstrip()[:5].lower() == b"solid":
        return True
    return size >= 84 and size >= 84 + 50 * int.from_bytes(head[80:84], "little")


def _is_obj(head: bytes, size: int) -> bool:
    statement = rb"^[ \t]*(?:#|(?:v|vn|vt|f|o|g|s|mtllib|usemtl)[ \t])"
    return b"\0" not in head and re.search(statement, head, re.MULTILINE | re.IGNORECASE) is not None


def _is_collada(head: bytes, size: int) -> bool:
    return head.removeprefix(_BOM).lstrip().startswith(b"<") and b"COLLADA" in head


def _is_gltf(head: bytes, size: int) -> bool:
    return head.removeprefix(_BOM).lstrip().startswith(b"{")


def _is_msh(head: bytes, size: int) -> bool:
    vertices, normals, texels, faces = (int.from_bytes(head[at : at + 4], "little") for at in (0, 4, 8, 12))
    return size >= 16 and size == 16 + 12 * (vertices + normals) + 8 * texels + 12 * faces


def _begins(pattern: bytes) -> Callable[[bytes, int], bool]:
    return lambda head, size: re.match(pattern, head) is not None


def suffix_of(path: str) -> str:
    """The ending of the name of a file, in lower case."""
    return PurePosixPath(path).suffix.lower()


def is_embedded(uri: str) -> bool:
    """Whether a URI has the data in it."""
    return uri[:5].lower() == "data:"


def gltf_document(suffix: str, content: bytes) -> tuple[dict[str, Any], bytes]:
    """The JSON of a glTF file of version 2, and the data that are in a binary one; `ValueError` if it has none."""
    text, data = (content, b"") if suffix == ".gltf" else _chunks(content)
    if len(text) > JSON_LIMIT:
        raise ValueError(f"its JSON has more than {JSON_LIMIT:,} bytes; keep buffers out of it")
    try:
        document = json.loads(text)
    except RecursionError:
        raise ValueError("its JSON is nested too deeply") from None
    if not isinstance(document, dict):
        raise ValueError("its JSON is not an object")
    asset = document.get("asset")
    if not isinstance(asset, dict) or not str(asset.get("version", "")).startswith("2."):
        raise ValueError("it is not glTF of version 2")
    return document, data


def listed(value: object) -> Iterator[dict[str, Any]]:
    """The objects in a list of a JSON file, whatever else may be there."""
    yield from (each for each in (value if isinstance(value, list) else ()) if isinstance(each, dict))


def _chunks(content: bytes) -> tuple[bytes, bytes]:
    """The first two chunks of a binary glTF file: JSON, and data."""
    chunks: list[bytes] = []
    at = 12
    while at + 8 <= len(content) and len(chunks) < 2:
        end = at + 8 + int.from_bytes(content[at : at + 4], "little")
        chunks.append(content[at + 8 : end])
        at = end
    if not chunks:
        raise ValueError("it has no JSON")
    return chunks[0], chunks[1] if len(chunks) > 1 else b""


def joined_lines(content: bytes) -> bytes:
    """An OBJ or MTL text in which no line goes on in the next one, as one does that ends in a backslash."""
    return re.sub(rb"\\[ \t\r]*\n", b"", content)


# The names of other files in a content: found in time that is proportional to its size, whatever it is.


def _no_names(content: bytes) -> tuple[()]:
    return ()


def _of_obj(content: bytes) -> Iterator[str]:
    for name in _statements(rb"mtllib", content):
        # One name with spaces, or several names.
        yield from (name,) if name.lower().count(".mtl") < 2 else name.split()


def _of_mtl(content: bytes) -> Iterator[str]:
    for name in _statements(rb"(?:map_\w+|bump|disp|decal|refl|norm)", content):
        yield name.split()[-1] if name.startswith("-") else name


def _statements(keyword: bytes, content: bytes) -> Iterator[str]:
    pattern = rb"^[ \t]*" + keyword + rb"[ \t]+(\S.*)"
    for found in re.finditer(pattern, joined_lines(content), re.MULTILINE | re.IGNORECASE):
        yield _text(found[1].rstrip())


def _of_collada(content: bytes) -> Iterator[str]:
    # Elsewhere, an init_from is the id of an image.
    in_image = False
    for found in re.finditer(rb"<(/?image|init_from|ref)\b[^<>]*>([^<]*)", content):
        tag, text = found[1], found[2].strip()
        if tag.endswith(b"image"):
            in_image = tag == b"image"
        elif in_image and text:
            yield html.unescape(_text(text))


def _of_gltf(suffix: str, content: bytes) -> Iterator[str]:
    try:
        document, _ = gltf_document(suffix, content)
    except ValueError:
        return
    for each in (*listed(document.get("buffers")), *listed(document.get("images"))):
        uri = each.get("uri")
        if isinstance(uri, str) and not is_embedded(uri):
            yield uri


def _of_ply(content: bytes) -> Iterator[str]:
    head = content[: content.find(b"end_header")]
    yield from map(_text, re.findall(rb"^comment[ \t]+TextureFile[ \t]+(.*\S)", head, re.MULTILINE))


def _of_3ds(content: bytes) -> Iterator[str]:
    # A chunk: its kind 0xA300, its length, the name of a picture, a zero.
    yield from map(_text, re.findall(rb"\x00\xa3.{4}([ -~]{3,255})\0", content, re.DOTALL))


def _text(data: bytes) -> str:
    return data.decode("utf-8", "surrogateescape")


class MeshKind(NamedTuple):
    """A format of mesh files.

    Attributes:
        name: Its name.
        matches: Whether a file of some first bytes and size is of it.
        names: The names of other files in a content, as it writes them.
        may_name: The endings of these.
        is_loaded: Whether the mesh loader reads it.
        is_alone: Whether a file is given to the mesh loader as it is: its reader in assimp opens no other file.
    """

    name: str
    matches: Callable[[bytes, int], bool]
    names: Callable[[bytes], Iterable[str]] = _no_names
    may_name: Collection[str] = ()
    is_loaded: bool = True
    is_alone: bool = False


#: The formats of meshes, by the ending of their files.
KINDS = {
    ".stl": MeshKind("STL", _is_stl, is_alone=True),
    ".obj": MeshKind("OBJ", _is_obj, _of_obj, (".mtl",)),
    ".dae": MeshKind("COLLADA", _is_collada, _of_collada, _PICTURES, is_alone=True),
    ".gltf": MeshKind("glTF", _is_gltf, partial(_of_gltf, ".gltf"), _PICTURES | {".bin"}),
    ".glb": MeshKind("binary glTF", _begins(rb"glTF"), partial(_of_gltf, ".glb"), _PICTURES | {".bin"}),
    ".ply": MeshKind("PLY", _begins(rb"ply\s"), _of_ply, _PICTURES, is_alone=True),
    ".off": MeshKind("OFF", _begins(rb"\s*(ST)?C?N?4?n?OFF\b"), is_alone=True),
    ".3ds": MeshKind("3DS", _begins(rb"MM"), _of_3ds, _PICTURES, is_alone=True),
    ".vtk": MeshKind("VTK", _begins(rb"# vtk DataFile"), is_loaded=False),
    ".msh": MeshKind("MSH", _is_msh, is_loaded=False),
}

#: Materials, which only a mesh names.
MATERIALS = MeshKind("MTL", lambda head, size: True, _of_mtl, _PICTURES)
