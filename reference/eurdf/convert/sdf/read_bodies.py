"""The links of an SDFormat model, with their inertias and shapes."""

from __future__ import annotations

from lxml import etree

from eurdf.convert.sdf.read_model import SdfModel
from eurdf.mechanism.body import Body, Inertia, Shape
from eurdf.mechanism.pose import IDENTITY, Pose
from eurdf.mesh_files.reader import RefusedFile

_Color = tuple[float, float, float, float]


def read_body(model: SdfModel, name: str, link: etree._Element) -> Body:
    """A link, with its inertia and its shapes."""
    visuals, collisions = (
        tuple(shape for element in link.iterchildren(use) if (shape := _shape(model, element, name)) is not None)
        for use in ("visual", "collision")
    )
    return Body(name, _inertia(model, name, link), visuals, collisions)


def _inertia(model: SdfModel, name: str, link: etree._Element) -> Inertia:
    inertial = link.find("inertial")
    if inertial is None:
        model.losses.add("import-default-inertia", name)
        return Inertia(1.0, IDENTITY, (1.0, 0.0, 0.0, 1.0, 0.0, 1.0))
    pose = model.in_link(name, inertial)
    xx, yy, zz = (model.number(inertial, f"inertia/{key}", 1.0) for key in ("ixx", "iyy", "izz"))
    xy, xz, yz = (model.number(inertial, f"inertia/{key}", 0.0) for key in ("ixy", "ixz", "iyz"))
    return Inertia(model.number(inertial, "mass", 1.0), pose, (xx, xy, xz, yy, yz, zz))


def _shape(model: SdfModel, element: etree._Element, link: str) -> Shape | None:
    pose = model.in_link(link, element)
    geometry = element.find("geometry")
    shapes = [] if geometry is None else [child for child in geometry if isinstance(child.tag, str)]
    color = _color(model, element)
    shown = f"{element.get('name', element.tag)} of {link}"
    for shape in shapes:
        match shape.tag:
            case "box":
                size = model.elements.numbers(shape, shape.findtext("size"), 3, "<size>")
                return Shape("box", size, pose, color=color)
            case "sphere":
                return Shape("sphere", (model.number(shape, "radius", 1.0),), pose, color=color)
            case "cylinder" | "capsule":
                size = model.number(shape, "radius", 1.0), model.number(shape, "length", 1.0)
                return Shape("cylinder" if shape.tag == "cylinder" else "capsule", size, pose, color=color)
            case "mesh":
                return _mesh(model, shape, pose, color)
        model.losses.add("import-shape", shown, f"is left out: URDF has no shape of type {shape.tag}")
    return None


def _mesh(model: SdfModel, mesh: etree._Element, pose: Pose, color: _Color | None) -> Shape | None:
    uri = (mesh.findtext("uri") or "").strip()
    found = model.given.finder.find(uri) if uri else None
    if found is None:
        model.losses.add("import-mesh", uri)
        return None
    try:
        copy = model.given.copy(found)
    except RefusedFile as reason:
        model.losses.add("import-mesh", uri, f"is left out: {reason}")
        return None
    scale = (1.0, 1.0, 1.0)
    if mesh.find("scale") is not None:
        x, y, z = model.elements.numbers(mesh, mesh.findtext("scale"), 3, "<scale>")
        scale = x, y, z
    return Shape("mesh", scale, pose, copy, color)


def _color(model: SdfModel, element: etree._Element) -> _Color | None:
    material = element.find("material")
    if material is None:
        return None
    if material.find("script") is not None or material.find(".//albedo_map") is not None:
        model.losses.add("import-texture", element.get("name", ""))
    for tag in ("diffuse", "ambient"):
        found = material.find(tag)
        if found is not None:
            words = (found.text or "").split()
            text = " ".join([*words, "1"] if len(words) == 3 else words)
            red, green, blue, alpha = model.elements.numbers(found, text, 4, f"<{tag}>")
            return red, green, blue, alpha
    return None
