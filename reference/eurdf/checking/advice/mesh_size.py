"""The order of magnitude of a mesh, from the beginning of its file: nothing is loaded for it."""

from __future__ import annotations

import re

import numpy as np

# Bytes that are read of a file: the coordinates of a thousand triangles show its unit.
_READ = 2**16

_STL_HEADER, _TRIANGLE = 84, 50
_VERTEX = re.compile(rb"^[ \t]*(?:vertex|v)[ \t]+(\S+)[ \t]+(\S+)[ \t]+(\S+)", re.MULTILINE)


def mesh_size(path: str) -> float | None:
    """Extent of the first triangles or vertices of an STL or OBJ file along its longest axis, in its own unit.

    Args:
        path: The file.

    Returns:
        None where the file is of another format, or cannot be read.
    """
    try:
        with open(path, "rb") as stream:
            head = stream.read(_READ)
    except OSError:
        return None
    if path.lower().endswith(".stl") and not _VERTEX.search(head):
        count = (len(head) - _STL_HEADER) // _TRIANGLE
        if count < 1:
            return None
        rows = np.frombuffer(head, np.uint8, count * _TRIANGLE, _STL_HEADER).reshape(count, _TRIANGLE)
        # A normal, three vertices, and two bytes of attributes.
        vertices = np.ascontiguousarray(rows[:, 12:48]).view("<f4").reshape(-1, 3).astype(np.float64)
    elif path.lower().endswith((".stl", ".obj")):
        try:
            vertices = np.array([[float(number) for number in found] for found in _VERTEX.findall(head)])
        except ValueError:
            return None
    else:
        return None
    if not len(vertices) or not np.isfinite(vertices).all():
        return None
    return float((vertices.max(axis=0) - vertices.min(axis=0)).max())
