"""The process that reads mesh files: the request is JSON on standard input, the meshes are on standard output.

The mesh loader of coal, assimp, is C++. Of this package, this program imports only `eurdf.sandbox`.

For each file, in order: a line of JSON, then, for a mesh, its vertices as doubles and its triangles as 64-bit integers.
"""

from __future__ import annotations

import json
from typing import Any

import coal
import numpy as np

from eurdf.sandbox import bound_memory, bound_time, request_and_answers

_FULL_SIZE = np.ones(3)


def main() -> None:
    """Answer the request."""
    request, answers = request_and_answers()
    for file in request["files"]:
        bound_time(request["patience"], file["seconds"])
        bound_memory(file["memory"])
        head, arrays = _read(file["path"])
        answers.write(json.dumps(head).encode() + b"\n")
        for array in arrays:
            answers.write(array.tobytes())
        answers.flush()


def _read(path: str) -> tuple[dict[str, Any], tuple[Any, ...]]:
    """The number of vertices and triangles, and the arrays; or the reason why there are none."""
    try:
        # The smallest bounding volumes: these are thrown away.
        mesh = coal.MeshLoader(coal.BV_AABB).load(path, _FULL_SIZE)
        vertices = np.array(mesh.vertices(), np.float64).reshape(-1, 3)
        triangles = np.empty((mesh.num_tris, 3), np.int64)
        for index in range(mesh.num_tris):
            triangle = mesh.tri_indices(index)
            triangles[index] = triangle[0], triangle[1], triangle[2]
    except MemoryError:
        return {"error": "memory"}, ()
    except Exception as error:
        return {"error": "memory" if "bad_alloc" in str(error) else _reason(error)}, ()
    return {"vertices": len(vertices), "triangles": len(triangles)}, (vertices, triangles)


def _reason(error: Exception) -> str:
    """The message of coal's mesh loader, without places in its source code and its hint."""
    lines = str(error).rpartition("message:")[2].strip().splitlines()
    return lines[1].strip().rstrip(".") if len(lines) > 1 else "it is not a mesh"


if __name__ == "__main__":
    main()
