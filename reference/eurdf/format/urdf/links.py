"""The links of a URDF, with their inertia and their visual and collision shapes."""

from __future__ import annotations

from functools import partial
from typing import Literal, cast, get_args

from eurdf.diagnostics import misspelt
from eurdf.format.urdf.data import UrdfLink
from eurdf.format.urdf.elements import RESERVED, UrdfReader
from eurdf.format.urdf.materials import Look, Materials
from eurdf.mechanism.body import Inertia, Shape
from eurdf.mechanism.pose import Pose
from eurdf.reading.xml_reader import Element, written_name

_Primitive = Literal["box", "cylinder", "sphere", "capsule"]

_SHAPES = (*get_args(_Primitive), "mesh")
_SHAPES_1_0 = tuple(shape for shape in _SHAPES if shape != "capsule")

# Attributes of one number each.
_CYLINDER = {"radius": None, "length": None}
_INERTIA = dict.fromkeys(("ixx", "ixy", "ixz", "iyy", "iyz", "izz"))


def read_link(reader: UrdfReader, element: Element, materials: Materials | None) -> UrdfLink | None:
    """A link, with its shapes if `materials` are given; None if it has no name, which was reported."""
    name = reader.name(element)
    inertia: Inertia | None = None
    inertial: Element | None = None
    visuals: list[Shape] = []
    collisions: list[Shape] = []
    for child in element[:]:  # type: ignore[index]  # a list, which lxml makes in half the time
        tag = child.tag
        if tag == "inertial":
            if inertial is not None:
                reader.report("urdf-repeated-element", f"link '{name}' has a second <inertial>", child)
                continue
            inertial = child
            inertia = _inertial(reader, child)
        elif tag in ("visual", "collision"):
            shape = None if materials is None else _shape(reader, child, materials)
            if shape is not None:
                (visuals if tag == "visual" else collisions).append(shape)
        else:
            reader.unknown(element, child)
    if name is None:
        return None
    if name == RESERVED:
        reader.refuse_reserved(element)
    return UrdfLink(name, element, inertia, inertial, tuple(visuals), tuple(collisions))


def _inertial(reader: UrdfReader, element: Element) -> Inertia | None:
    found = reader.children(element)
    pose = reader.origin(found.get("origin"))
    mass_element = reader.need(element, found, "mass")
    inertia_element = reader.need(element, found, "inertia")
    if mass_element is None or inertia_element is None:
        return None
    mass, moments = reader.required(mass_element, "value", 1), reader.single_numbers(inertia_element, _INERTIA)
    if mass is None or moments is None:
        return None
    return Inertia(mass[0], pose, moments)  # type: ignore[arg-type]


def _shape(reader: UrdfReader, element: Element, materials: Materials) -> Shape | None:
    """The shape of a ``visual`` or ``collision``; None if it has an error, which was reported."""
    found = reader.children(element)
    pose = reader.origin(found.get("origin"))
    look: Look = (None, "")
    if element.tag == "visual" and "material" in found:
        look = materials.of(found["material"])
    geometry = reader.need(element, found, "geometry")
    shape = None if geometry is None else _only_shape(reader, geometry)
    if shape is None:
        return None
    return (_mesh if shape.tag == "mesh" else _primitive)(reader, shape, pose, look)


def _only_shape(reader: UrdfReader, geometry: Element) -> Element | None:
    """EU-URD-024: a geometry contains one shape; elements of other programs are ignored."""
    known = _SHAPES_1_0 if reader.version == "1.0" else _SHAPES
    shapes = [child for child in geometry if child.tag in known]
    if len(shapes) == 1:
        if not reader.version and shapes[0].tag == "capsule":
            reader.later(shapes[0], None, "1.1")
        return shapes[0]
    other = None if shapes or len(geometry) != 1 else geometry[0]
    if other is None:
        message = f"<geometry> contains {len(shapes)} shapes; it must contain exactly one"
        reader.report("urdf-geometry", message, geometry)
    elif other.tag in _SHAPES:
        message = f"<{other.tag}> is a shape from URDF 1.1 on, and <robot> has version {reader.version}"
        reader.report("urdf-geometry", message, other, hint='write version="1.1" in <robot>')
    else:
        name = written_name(other, str(other.tag))
        message = f"<{name}> is not a shape; it must be box, cylinder, sphere, capsule or mesh"
        write = partial(reader.reporter.document.retagged, other)
        reader.report("urdf-geometry", message, other, None, *misspelt(str(other.tag), _SHAPES, write))
    return None


def _mesh(reader: UrdfReader, element: Element, pose: Pose, look: Look) -> Shape | None:
    """EU-URD-024: the scale of a mesh is not zero on any axis."""
    name = reader.name(element, "filename")
    text = element.get("scale")
    reader.attributes(element)
    scale = (1.0, 1.0, 1.0) if text is None else reader.numbers(element, "scale", text, 3)
    if name is None or scale is None:
        return None
    if 0.0 in scale:
        reader.report("urdf-geometry", "'scale' of <mesh> contains a 0", element, "scale")
        return None
    return Shape("mesh", scale, pose, name, *look)


def _primitive(reader: UrdfReader, element: Element, pose: Pose, look: Look) -> Shape | None:
    """EU-URD-024: any other shape is a box, cylinder, sphere or capsule of positive size."""
    kind = element.tag
    if kind == "box":
        size = reader.required(element, "size", 3)
    elif kind == "sphere":
        size = reader.required(element, "radius", 1)
    else:
        size = reader.single_numbers(element, _CYLINDER)
    if size is None:
        return None
    if min(size) <= 0.0:
        reader.report("urdf-geometry", f"<{kind}> has a dimension that is not positive", element)
        return None
    color, texture = look
    return Shape(cast(_Primitive, kind), size, pose, color=color, texture=texture)
