"""The visual and collision shapes of a mechanism as Pinocchio geometry, as its URDF parser makes it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import NamedTuple

import coal
import numpy as np
import pinocchio as pin

from eurdf.array import Vector
from eurdf.errors import EurdfError
from eurdf.mechanism.body import Shape
from eurdf.mechanism.mechanism import Mechanism
from eurdf.pinocchio.frames import body_frame_ids, placement_of
from eurdf.pinocchio.meshes import Mesh, read_meshes

Resolve = Callable[[str], str | None]
# The geometry of meshes, by path and scale, which objects share.
_MeshCache = dict[tuple[str, tuple[float, ...]], coal.BVHModelBase]

_GRAY = np.array((0.9, 0.9, 0.9, 1.0))
_BLACK = np.array((0.0, 0.0, 0.0, 1.0))
_FULL_SIZE = np.ones(3)


class UnreadableMesh(EurdfError, ValueError):  # noqa: N818 - named like InvalidRobot
    """A mesh file cannot be read as a mesh.

    Attributes:
        uri: The URI in the URDF.
        path: Path of the file.
        reason: Why not.
    """

    def __init__(self, uri: str, path: str, reason: str) -> None:
        self.uri = uri
        self.path = path
        self.reason = reason
        super().__init__(f"mesh '{uri}' cannot be read from {path}: {reason}")


class Geometry(NamedTuple):
    """The visual and collision shapes of a robot."""

    visual: pin.GeometryModel
    collision: pin.GeometryModel


def build_geometry(
    mechanism: Mechanism, model: pin.Model, resolve: Resolve, meshes: Mapping[str, Mesh] | None = None
) -> Geometry:
    """Build the geometry of a mechanism.

    Object ``link_k`` is the k-th visual, or collision, of link ``link``, fixed to the joint that moves it. No collision
    pair is active, as from Pinocchio's URDF parser.

    Args:
        mechanism: The mechanism.
        model: The result of `build_model`.
        resolve: Path of the file that a URI of the URDF means. It must find every mesh; a texture that it does not find
            is left out.
        meshes: The meshes by path, as `meshes_of` reads them; it does so by default.

    Raises:
        UnreadableMesh: A mesh file cannot be read as a mesh.
        FileNotFoundError: `resolve` does not find a mesh.
    """
    found = Geometry(pin.GeometryModel(), pin.GeometryModel())
    meshes = meshes_of(mechanism, resolve) if meshes is None else meshes
    cache: _MeshCache = {}
    body_frames = body_frame_ids(mechanism)
    for body in mechanism.bodies:
        for geometry_model, shapes in zip(found, (body.visuals, body.collisions), strict=True):
            for index, shape in enumerate(shapes):
                frame_id = body_frames[body.name]
                frame = model.frames[frame_id]
                geometry, path, scale = _geometry(shape, resolve, meshes, cache)
                colored = shape.color is not None or shape.texture != ""
                geometry_model.addGeometryObject(
                    pin.GeometryObject(
                        f"{body.name}_{index}",
                        frame.parentJoint,
                        frame_id,
                        frame.placement * placement_of(shape.pose),
                        geometry,
                        path,
                        scale,
                        colored,
                        _color(shape) if colored else _GRAY,
                        (resolve(shape.texture) or "") if shape.texture else "",
                    )
                )
    return found


def _geometry(
    shape: Shape, resolve: Resolve, meshes: Mapping[str, Mesh], cache: _MeshCache
) -> tuple[coal.CollisionGeometry, str, Vector]:
    """The geometry; the path of its mesh, or in its place the name Pinocchio gives to the kind; the scale."""
    size = shape.size
    match shape.kind:
        case "box":
            return coal.Box(*size), "BOX", _FULL_SIZE
        case "cylinder":
            return coal.Cylinder(*size), "CYLINDER", _FULL_SIZE
        case "sphere":
            return coal.Sphere(*size), "SPHERE", _FULL_SIZE
        case "capsule":
            return coal.Capsule(*size), "CAPSULE", _FULL_SIZE
        case "mesh":
            path = _path(shape.filename, resolve)
            if (path, size) not in cache:
                cache[path, size] = _mesh_geometry(meshes[path], size)
            return cache[path, size], path, np.array(size)


def meshes_of(mechanism: Mechanism, resolve: Resolve) -> dict[str, Mesh]:
    """Read all mesh files of a mechanism: the meshes by path; arguments and errors are those of `build_geometry`."""
    every = (shape for body in mechanism.bodies for shape in (*body.visuals, *body.collisions))
    shapes = [(shape.filename, shape.size) for shape in every if shape.kind == "mesh"]
    read, reasons = read_meshes(shapes, {uri: _path(uri, resolve) for uri, _ in shapes})
    for uri, reason in reasons.items():
        raise UnreadableMesh(uri, _path(uri, resolve), reason)
    return read


def _path(uri: str, resolve: Resolve) -> str:
    path = resolve(uri)
    if path is None:
        raise FileNotFoundError(f"mesh '{uri}' does not exist")
    return path


def _mesh_geometry(mesh: Mesh, scale: tuple[float, ...]) -> coal.BVHModelOBBRSS:
    """What ``coal.MeshLoader`` makes of the same triangles."""
    geometry = coal.BVHModelOBBRSS()
    geometry.beginModel(len(mesh.triangles), len(mesh.vertices))
    geometry.addVertices(mesh.vertices * np.array(scale))
    geometry.addTriangles(mesh.triangles)
    geometry.endModel()
    return geometry


def _color(shape: Shape) -> Vector:
    """In single precision, as urdfdom keeps colors; black where a material has a texture only."""
    if shape.color is None:
        return _BLACK
    with np.errstate(over="ignore", under="ignore"):  # of a component far out of 0 to 1, infinity is as good as any
        return np.array(shape.color, np.float32).astype(np.float64)
