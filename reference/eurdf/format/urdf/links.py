"""The links of a URDF."""

from __future__ import annotations

from eurdf.format.urdf.data import UrdfLink
from eurdf.format.urdf.elements import RESERVED, UrdfReader
from eurdf.format.urdf.materials import Materials
from eurdf.format.urdf.shapes import read_shape
from eurdf.mechanism.body import Inertia, Shape
from eurdf.reading.reporter import Element

# Attributes of one number each.
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
            shape = None if materials is None else read_shape(reader, child, materials)
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
    mass, moments = reader.number(mass_element, "value"), reader.single_numbers(inertia_element, _INERTIA)
    if mass is None or moments is None:
        return None
    return Inertia(mass, pose, moments)  # type: ignore[arg-type]
