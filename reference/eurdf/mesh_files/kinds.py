"""The formats of mesh files: how each begins, and the other files that one names.

A program chooses its reader by the ending of the name, so the content must be what the name says.
"""

from __future__ import annotations

import html
import json
import re
from collections.abc import Callable, Iterator
from pathlib import PurePosixPath
from typing import Any

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


#: By ending: the name of the format, and whether a file of some first bytes and size is of it.
KINDS: dict[str, tuple[str, Callable[[bytes, int], bool]]] = {
    ".stl": ("STL", _is_stl),
    ".obj": ("OBJ", _is_obj),
    ".dae": ("COLLADA", _is_collada),
    ".gltf": ("glTF", _is_gltf),
    ".glb": ("binary glTF", _begins(rb"glTF")),
    ".ply": ("PLY", _begins(rb"ply\s")),
    ".off": ("OFF", _begins(rb"\s*(ST)?C?N?4?n?OFF\b")),
    ".3ds": ("3DS", _begins(rb"MM")),
    ".vtk": ("VTK", _begins(rb"# vtk DataFile")),
    ".msh": ("MSH", _is_msh),
}


#: Endings of the formats that the mesh loader reads.
LOADED = tuple(suffix for suffix in KINDS if suffix not in (".vtk", ".msh"))

#: By ending, of a mesh or its materials: the endings of the files that it may name.
REFERENCES: dict[str, frozenset[str]] = {
    ".obj": frozenset({".mtl"}),
    ".mtl": _PICTURES,
    ".dae": _PICTURES,
    ".gltf": _PICTURES | {".bin"},
    ".glb": _PICTURES | {".bin"},
    ".ply": _PICTURES,
    ".3ds": _PICTURES,
}


def suffix_of(path: str) -> str:
    """The ending of the name of a file, in lower case."""
    return PurePosixPath(path).suffix.lower()


def references_of(suffix: str, content: bytes) -> tuple[str, ...]:
    """The names of the files that a mesh or its materials name, as it writes them, each once.

    It takes time that is proportional to the size, whatever the content is.

    Args:
        suffix: Ending of its name, in lower case.
        content: Its content.
    """
    return tuple(dict.fromkeys(_REFERENCES[suffix](content))) if suffix in _REFERENCES else ()


def is_embedded(uri: str) -> bool:
    """Whether a URI has the data in it."""
    return uri[:5].lower() == "data:"


def gltf_document(suffix: str, content: bytes) -> tuple[dict[str, Any], bytes]:
    """The JSON of a glTF file of version 2, and the data that are in the file, if it is a binary one.

    Raises:
        ValueError: It has none.
    """
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


def _of_gltf(suffix: str) -> Callable[[bytes], Iterator[str]]:
    def names(content: bytes) -> Iterator[str]:
        try:
            document, _ = gltf_document(suffix, content)
        except ValueError:
            return
        for each in (*listed(document.get("buffers")), *listed(document.get("images"))):
            uri = each.get("uri")
            if isinstance(uri, str) and not is_embedded(uri):
                yield uri

    return names


def _of_ply(content: bytes) -> Iterator[str]:
    head = content[: content.find(b"end_header")]
    yield from map(_text, re.findall(rb"^comment[ \t]+TextureFile[ \t]+(.*\S)", head, re.MULTILINE))


def _of_3ds(content: bytes) -> Iterator[str]:
    # A chunk: its kind 0xA300, its length, the name of a picture, a zero.
    yield from map(_text, re.findall(rb"\x00\xa3.{4}([ -~]{3,255})\0", content, re.DOTALL))


_REFERENCES: dict[str, Callable[[bytes], Iterator[str]]] = {
    ".obj": _of_obj,
    ".mtl": _of_mtl,
    ".dae": _of_collada,
    ".gltf": _of_gltf(".gltf"),
    ".glb": _of_gltf(".glb"),
    ".ply": _of_ply,
    ".3ds": _of_3ds,
}


def _text(data: bytes) -> str:
    return data.decode("utf-8", "surrogateescape")
