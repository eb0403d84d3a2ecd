"""The shapes of bodies."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from eurdf.importing.mjcf.reading import MjcfReading
from eurdf.importing.mjcf.values import flat, pose_from
from eurdf.mechanism.body import Shape
from eurdf.mechanism.pose import Pose
from eurdf.mesh_files.reader import RefusedFile

_DEFAULT_RGBA = (0.5, 0.5, 0.5, 1.0)


def read_shapes(reading: MjcfReading, body: int) -> tuple[list[Shape], list[Shape]]:
    """The visual and the collision shapes of a body."""
    model = reading.model
    visuals, collisions = [], []
    for geom, owner in enumerate(model["geom_bodyid"]):
        if owner != body:
            continue
        shape = _shape(reading, geom)
        if shape is None:
            continue
        touches = bool(model["geom_contype"][geom] or model["geom_conaffinity"][geom])
        visible = model["geom_group"][geom] < 3  # MuJoCo shows the groups 0 to 2 by default
        if visible:
            visuals.append(shape)
        if touches:
            collisions.append(replace(shape, color=None))
        if not visible and not touches:
            reading.losses.add("import-hidden-shape", _geom_name(reading, geom))
    return visuals, collisions


def _geom_name(reading: MjcfReading, geom: int) -> str:
    model = reading.model
    return model.names["geom"][geom] or f"geom {geom} of {model.names['body'][model['geom_bodyid'][geom]] or 'a body'}"


def _shape(reading: MjcfReading, geom: int) -> Shape | None:
    model = reading.model
    kind, size = model["geom_type"][geom], model["geom_size"][geom]
    pose = pose_from(model["geom_pos"][geom], model["geom_quat"][geom])
    color = _color(reading, geom)
    match kind:
        case "box":
            return Shape("box", tuple(2.0 * side for side in size), pose, color=color)
        case "sphere":
            return Shape("sphere", (size[0],), pose, color=color)
        case "cylinder":
            return Shape("cylinder", (size[0], 2.0 * size[1]), pose, color=color)
        case "capsule":
            return Shape("capsule", (size[0], 2.0 * size[1]), pose, color=color)
        case "mesh":
            return _mesh(reading, model["geom_dataid"][geom], pose, color)
    reading.losses.add("import-shape", _geom_name(reading, geom), f"is left out: URDF has no shape of type {kind}")
    return None


def _mesh(reading: MjcfReading, mesh: int, pose: Pose, color: tuple[float, float, float, float] | None) -> Shape | None:
    model = reading.model
    given, name = model.meshes[mesh], model.names["mesh"][mesh]
    if given.obj:
        if given.path:
            reading.copies.folders.admit(given.path)
        reading.losses.add("import-mesh-converted", name)
        return Shape("mesh", given.scale, pose, reading.copies.content(name, ".obj", given.obj.encode()), color)
    try:
        uri = reading.copies.file(Path(given.path))
    except RefusedFile as reason:
        reading.losses.add("import-mesh", name, f"is left out: {reason}")
        return None
    own = pose_from(model["mesh_pos"][mesh], model["mesh_quat"][mesh])
    return Shape("mesh", given.scale, pose * own.inverse(), uri, color)


def _color(reading: MjcfReading, geom: int) -> tuple[float, float, float, float] | None:
    """The color of a shape; None where the file states none."""
    model = reading.model
    rgba, material = tuple(model["geom_rgba"][geom]), model["geom_matid"][geom]
    if material >= 0 and rgba == _DEFAULT_RGBA:
        rgba = tuple(model["mat_rgba"][material])
        if any(each >= 0 for each in flat(model["mat_texid"][material])):
            reading.losses.add("import-texture", _geom_name(reading, geom))
    elif rgba == _DEFAULT_RGBA:
        return None
    red, green, blue, alpha = (round(float(value), 7) for value in rgba)  # single precision
    return red, green, blue, alpha
