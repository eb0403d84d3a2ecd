"""A binary STL file."""

from __future__ import annotations

import numpy as np

_TRIANGLES = (
    ((0, 0, 0), (0, 1, 0), (1, 0, 0)),
    ((0, 0, 0), (1, 0, 0), (0, 0, 1)),
    ((0, 0, 0), (0, 0, 1), (0, 1, 0)),
    ((1, 0, 0), (0, 1, 0), (0, 0, 1)),
)

#: The tetrahedron of the origin and the three unit vectors.
TETRAHEDRON = (
    b"\0" * 80
    + len(_TRIANGLES).to_bytes(4, "little")
    + b"".join(np.array([(0, 0, 0), *each], "<f4").tobytes() + b"\0\0" for each in _TRIANGLES)
)
