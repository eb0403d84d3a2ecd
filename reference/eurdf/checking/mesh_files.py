"""Reading the mesh files of a robot."""

from __future__ import annotations

from functools import partial

from eurdf.diagnostics import Diagnostics, quoted
from eurdf.format.urdf.data import Urdf
from eurdf.linking.description import FoundFiles, place_of_file
from eurdf.mesh_files.kinds import KINDS, LOADED, suffix_of
from eurdf.pinocchio.meshes import Mesh, read_meshes


def read_mesh_files(urdf: Urdf, files: FoundFiles) -> tuple[dict[str, Mesh], Diagnostics]:
    """EU-URD-034: every mesh file that was found can be read as a mesh.

    Args:
        urdf: The URDF.
        files: What `find_meshes` found; other files than meshes are ignored.

    Returns:
        The meshes, by path; one diagnostic for each mesh that cannot be read, and one for all of other formats.
    """
    shapes = (shape for link in urdf.links.values() for shape in (*link.visuals, *link.collisions))
    paths = files.paths
    scaled = [(shape.filename, shape.size) for shape in shapes if shape.kind == "mesh" and shape.filename in paths]
    others = [uri for uri in dict.fromkeys(uri for uri, _ in scaled) if suffix_of(paths[uri]) not in LOADED]
    meshes, reasons = read_meshes((each for each in scaled if each[0] not in others), paths, files.folders)
    diagnostics = Diagnostics()
    if others:
        count = "1 mesh file has" if len(others) == 1 else f"{len(others)} mesh files have"
        diagnostics.report(
            "x-mesh-format",
            f"{count} a format that is not read: {quoted(others)}",
            partial(place_of_file, urdf, "mesh", others[0]),
            f"convert them to one of {', '.join(KINDS[suffix][0] for suffix in LOADED)}",
        )
    for uri, reason in reasons.items():
        place = partial(place_of_file, urdf, "mesh", uri)
        diagnostics.report("urdf-mesh-unreadable", f"mesh '{uri}' cannot be read: {reason}", place)
    return meshes, diagnostics
