"""Reading the mesh files of a robot."""

from __future__ import annotations

from functools import partial

from eurdf.diagnostics import Diagnostics
from eurdf.format.urdf.data import Urdf
from eurdf.linking.description import FoundFiles, place_of_file
from eurdf.pinocchio.meshes import Mesh, read_meshes


def read_mesh_files(urdf: Urdf, files: FoundFiles) -> tuple[dict[str, Mesh], Diagnostics]:
    """EU-URD-034: every mesh file that was found can be read as a mesh.

    Args:
        urdf: The URDF.
        files: What `find_meshes` found; other files than meshes are ignored.

    Returns:
        The meshes, by path; and one diagnostic for each mesh that cannot be read.
    """
    shapes = (shape for link in urdf.links.values() for shape in (*link.visuals, *link.collisions))
    paths = files.paths
    scaled = ((shape.filename, shape.size) for shape in shapes if shape.kind == "mesh" and shape.filename in paths)
    meshes, reasons = read_meshes(scaled, paths, files.folders)
    diagnostics = Diagnostics()
    for uri, reason in reasons.items():
        place = partial(place_of_file, urdf, "mesh", uri)
        diagnostics.report("urdf-mesh-unreadable", f"mesh '{uri}' cannot be read: {reason}", place)
    return meshes, diagnostics
