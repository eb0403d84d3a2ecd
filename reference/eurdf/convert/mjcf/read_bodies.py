"""The bodies of an MJCF file, with their inertias and shapes."""

from __future__ import annotations

import math
from dataclasses import replace

from eurdf.convert.conventions import LEAST
from eurdf.convert.mjcf.compiled import Element
from eurdf.convert.mjcf.read_state import WORLD, MjcfReading, flat, pose_from, vector
from eurdf.mechanism.body import Body, Inertia, Shape
from eurdf.mechanism.pose import Pose
from eurdf.mesh_files.reader import RefusedFile
from eurdf.writing.urdf_elements import Color

_DEFAULT_RGBA = (0.5, 0.5, 0.5, 1.0)


def read_body(reading: MjcfReading, index: int) -> Body:
    """A body, with its shapes."""
    body = reading.model["body"][index]
    name = reading.new_name(reading.links, body, "body", f"body_{index}" if index else WORLD)
    if body.gravcomp:
        reading.losses.add("import-gravity-compensation", name)
    if body.mocapid >= 0:
        reading.losses.add("import-mocap", name)
    visuals, collisions = [], []
    for geom in reading.model["geom"]:
        if geom.bodyid != index or (shape := _shape(reading, geom)) is None:
            continue
        touches = bool(geom.contype or geom.conaffinity)
        visible = geom.group < 3  # MuJoCo shows the groups 0 to 2 by default
        if visible:
            visuals.append(shape)
        if touches:
            collisions.append(replace(shape, color=None))
        if not visible and not touches:
            reading.losses.add("import-hidden-shape", _name_of(reading, geom))
    return Body(name, _inertia(body), tuple(visuals), tuple(collisions))


def _inertia(body: Element) -> Inertia | None:
    principal = body.inertia
    if body.mass <= LEAST and max(principal) <= LEAST:
        return None
    # The compiler may have scaled or balanced it.
    if body.fullinertia and math.isclose(sum(body.fullinertia[:3]), sum(principal), rel_tol=1e-12):
        xx, yy, zz, xy, xz, yz = body.fullinertia
        return Inertia(body.mass, Pose(vector(body.ipos)), (xx, xy, xz, yy, yz, zz))
    xx, yy, zz = principal
    return Inertia(body.mass, pose_from(body.ipos, body.iquat), (xx, 0.0, 0.0, yy, 0.0, zz))


def _name_of(reading: MjcfReading, geom: Element) -> str:
    return geom.name or f"geom {geom.index} of {reading.model['body'][geom.bodyid].name or 'a body'}"


def _shape(reading: MjcfReading, geom: Element) -> Shape | None:
    pose, color = pose_from(geom.pos, geom.quat), _color(reading, geom)
    match geom.type:
        case "box":
            return Shape("box", tuple(2.0 * side for side in geom.size), pose, color=color)
        case "sphere":
            return Shape("sphere", (geom.size[0],), pose, color=color)
        case "cylinder" | "capsule":
            return Shape(geom.type, (geom.size[0], 2.0 * geom.size[1]), pose, color=color)
        case "mesh":
            return _mesh(reading, reading.model["mesh"][geom.dataid], pose, color)
    reading.losses.add("import-shape", _name_of(reading, geom), f"is left out: URDF has no shape of type {geom.type}")
    return None


def _mesh(reading: MjcfReading, mesh: Element, pose: Pose, color: Color | None) -> Shape | None:
    given, scale = reading.given, tuple(mesh.scale)
    if mesh.obj:
        if mesh.path:
            given.folders.admit(mesh.path)
        reading.losses.add("import-mesh-converted", mesh.name)
        return Shape("mesh", scale, pose, given.add_mesh(mesh.name, ".obj", mesh.obj.encode()), color)
    try:
        copy = given.copy(mesh.path)
    except RefusedFile as reason:
        reading.losses.add("import-mesh", mesh.name, f"is left out: {reason}")
        return None
    return Shape("mesh", scale, pose * pose_from(mesh.pos, mesh.quat).inverse(), copy, color)


def _color(reading: MjcfReading, geom: Element) -> Color | None:
    """The color of a shape; None where the file states none."""
    rgba = tuple(geom.rgba)
    if rgba == _DEFAULT_RGBA:
        if geom.matid < 0:
            return None
        material = reading.model["mat"][geom.matid]
        rgba = tuple(material.rgba)
        if any(each >= 0 for each in flat(material.texid)):
            reading.losses.add("import-texture", _name_of(reading, geom))
    red, green, blue, alpha = (round(float(value), 7) for value in rgba)  # single precision
    return red, green, blue, alpha
