"""An SDFormat model as written: its elements by name, the poses of links, joints and frames, and what a link has."""

from __future__ import annotations

import math

from lxml import etree

from eurdf.convert.import_format import ImportInput
from eurdf.convert.xml_elements import Elements, named
from eurdf.errors import CannotImport
from eurdf.mechanism.body import Body, Inertia, Shape
from eurdf.mechanism.pose import IDENTITY, Pose
from eurdf.mesh_files.reader import RefusedFile
from eurdf.writing.urdf_elements import Color

WORLD = "world"

#: Frames that a pose may refer to in turn.
DEPTH_LIMIT = 200


class SdfModel:
    """The one model of a file.

    Attributes:
        given: The file.
        losses: What is lost.
        elements: Reads its elements.
        element: The element of the model.
        links: The elements of its links, by name.
        joints: Likewise.
        frames: Likewise.
        poses: Poses in the model that were computed, by name.
    """

    def __init__(self, given: ImportInput, root: etree._Element) -> None:
        self.given, self.losses, self.elements = given, given.losses, Elements(given.path)
        if root.tag != "sdf":
            raise self.refuse(root, f"the root element is {named(root)}; it must be <sdf>")
        self.element = self._only_model(root)
        self.links = {self._name(link): link for link in self.element.iterchildren("link")}
        if not self.links:
            raise self.refuse(self.element, "the model has no link")
        self.joints = {self._name(joint): joint for joint in self.element.iterchildren("joint")}
        self.frames = {self._name(frame): frame for frame in self.element.iterchildren("frame")}
        for element in self.element.iterchildren("include", "model"):
            raise self.refuse(element, f"{named(element)} is another model; merge the models into one first")
        #: Poses in the model.
        self.poses: dict[str, Pose] = {}

    def refuse(self, element: etree._Element, reason: str) -> CannotImport:
        """The exception for an error in an element."""
        return self.elements.refuse(element, reason)

    def _only_model(self, root: etree._Element) -> etree._Element:
        models = list(root.iterchildren("model"))
        models += [model for world in root.iterchildren("world") for model in world.iterchildren("model")]
        if len(models) != 1:
            shown = ", ".join(f"'{model.get('name')}'" for model in models[:5]) or "none"
            raise self.refuse(root, f"the file has {len(models)} models: {shown}; it must have one")
        return models[0]

    def _name(self, element: etree._Element) -> str:
        name = element.get("name")
        if not name:
            raise self.refuse(element, f"{named(element)} has no name")
        return name

    def pose(self, element: etree._Element, default: str = "") -> tuple[Pose, str]:
        """The pose of an element, and the frame that it is in."""
        found = element.find("pose")
        if found is None or not (found.text or "").strip():
            return IDENTITY, default if found is None else found.get("relative_to") or default
        if found.get("rotation_format", "euler_rpy") != "euler_rpy" or found.get("degrees", "false") == "true":
            raise self.refuse(found, "the pose must have roll, pitch and yaw in radians")
        x, y, z, roll, pitch, yaw = self.elements.numbers(found, found.text, 6, "the pose")
        return Pose.from_xyz_rpy((x, y, z), (roll, pitch, yaw)), found.get("relative_to") or default

    def in_model(self, name: str, element: etree._Element, seen: tuple[str, ...] = ()) -> Pose:
        """The pose of a link, joint or frame in the model."""
        if name in ("", "__model__"):
            return IDENTITY
        if name in self.poses:
            return self.poses[name]
        if len(seen) > DEPTH_LIMIT:
            raise self.refuse(element, f"the pose of '{seen[0]}' refers to more than {DEPTH_LIMIT} others in turn")
        if name in seen:
            raise self.refuse(element, f"poses refer to each other in a circle: {' -> '.join((*seen, name))}")
        base = self._base(name, element)
        found, base = self.pose({**self.frames, **self.joints, **self.links}[name], base)
        pose = self.poses[name] = self.in_model(base, element, (*seen, name)) * found
        return pose

    def in_link(self, link: str, element: etree._Element) -> Pose:
        """The pose of an element of a link in the link."""
        pose, frame = self.pose(element)
        if not frame:
            return pose
        return self.in_model(link, element).inverse() * self.in_model(frame, element) * pose

    def link_of(self, name: str, element: etree._Element, seen: tuple[str, ...] = ()) -> str:
        """The link that a link, joint or frame is fixed to."""
        if name in self.links or name == WORLD:
            return name
        if len(seen) > DEPTH_LIMIT:
            raise self.refuse(element, f"'{seen[0]}' is attached to more than {DEPTH_LIMIT} others in turn")
        if name in seen:
            raise self.refuse(element, f"frames are attached in a circle: {' -> '.join((*seen, name))}")
        if name in ("", "__model__"):
            return self.canonical()
        return self.link_of(self._base(name, element), element, (*seen, name))

    def _base(self, name: str, element: etree._Element) -> str:
        """What a link, joint or frame is attached to, which an element names; empty for the model."""
        if name in self.links:
            return ""
        if name in self.joints:
            return text_of(self.joints[name], "child")
        if name in self.frames:
            return self.frames[name].get("attached_to", "")
        raise self.refuse(element, f"there is no link, joint or frame '{name}'")

    def canonical(self) -> str:
        """The link that the frame of the model is fixed to."""
        return self.element.get("canonical_link") or next(iter(self.links))

    def number(self, element: etree._Element | None, path: str, default: float, *, infinite: bool = False) -> float:
        """The number of an element; infinite ones only where they mean no limit."""
        found = None if element is None else element.find(path)
        if found is None or not (found.text or "").strip():
            return default
        text = (found.text or "").strip()
        if infinite and text.lstrip("+-").lower() in ("inf", "infinity"):
            return -math.inf if text.startswith("-") else math.inf
        return self.elements.numbers(found, text, 1, f"<{found.tag}>")[0]


def text_of(element: etree._Element, path: str) -> str:
    """The text of an element inside another one; empty without it."""
    return (element.findtext(path) or "").strip()


def is_true(element: etree._Element, path: str) -> bool:
    """Whether a text says that something is so."""
    return text_of(element, path) in ("true", "1")


# -- links ------------------------------------------------------------------------------------------------------------


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


def _mesh(model: SdfModel, mesh: etree._Element, pose: Pose, color: Color | None) -> Shape | None:
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


def _color(model: SdfModel, element: etree._Element) -> Color | None:
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
