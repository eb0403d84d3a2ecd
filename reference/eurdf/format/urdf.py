"""The URDF as typed data, checked by itself: numbers, names, and one tree of links.

What urdfdom and Pinocchio swallow in silence (a link with two parents, a second root, a missing mass) is refused here,
before any C++ sees the file.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import dropwhile
from typing import Literal, NamedTuple, cast

from lxml import etree

from eurdf.diagnostics import Diagnostics, Hint, did_you_mean, quoted
from eurdf.format.near import near
from eurdf.mechanism.body import Inertia, Shape
from eurdf.mechanism.joint_type import JointType
from eurdf.mechanism.mimic import MIMIC_TYPES, Mimic
from eurdf.mechanism.pose import IDENTITY, Pose, Vector3
from eurdf.reading.xml_reader import XmlDocument

Element = etree._Element
_Primitive = Literal["box", "cylinder", "sphere", "capsule"]

#: The types a URDF may give a joint.
URDF_JOINT_TYPES = {
    kind.value: kind
    for kind in (
        JointType.REVOLUTE,
        JointType.CONTINUOUS,
        JointType.PRISMATIC,
        JointType.PLANAR,
        JointType.FLOATING,
        JointType.FIXED,
    )
}

#: Elements by which other dialects state a closure or a coupling; a reader of this format would drop them.
_CLOSURE_DIALECTS = frozenset({"loop", "loop_joint", "constraint", "coupling"})

#: The elements that an element may have, but need not; of a joint that moves in a range, `limit` it must.
_OPTIONAL_CHILDREN: dict[str, tuple[str, ...]] = {
    "robot": ("link", "joint", "material"),
    "link": ("inertial", "visual", "collision"),
    "inertial": ("origin",),
    "visual": ("origin", "material"),
    "collision": ("origin",),
    "joint": ("origin", "axis", "limit", "dynamics", "mimic"),
    "material": ("color", "texture"),
}

_REQUIRED_CHILDREN: dict[str, tuple[str, ...]] = {
    "inertial": ("mass", "inertia"),
    "visual": ("geometry",),
    "collision": ("geometry",),
    "joint": ("parent", "child"),
}

_KNOWN_CHILDREN: dict[str, frozenset[str]] = {
    tag: frozenset((*optional, *_REQUIRED_CHILDREN.get(tag, ()))) for tag, optional in _OPTIONAL_CHILDREN.items()
}

_RANGED = frozenset({JointType.REVOLUTE, JointType.PRISMATIC})
_AXLESS = frozenset({JointType.FIXED, JointType.FLOATING})

# Attributes of one number each, and what they are where they are left out.
_MASS = {"value": None}
_INERTIA = dict.fromkeys(("ixx", "ixy", "ixz", "iyy", "iyz", "izz"))
_SPHERE = {"radius": None}
_CYLINDER = {"radius": None, "length": None}
_LIMIT = {"effort": None, "velocity": None, "lower": "0", "upper": "0"}
_DYNAMICS = {"damping": "0", "friction": "0"}
_MIMIC = {"multiplier": "1", "offset": "0"}

#: Codes of what is wrong with which joint mimics which.
_OF_MIMICS = frozenset({"urdf-mimic-unknown", "urdf-mimic-cycle", "urdf-mimic-kind", "urdf-mimic-fixed"})

#: The attributes that an element may have, but need not.
_OPTIONAL_ATTRIBUTES: dict[str, tuple[str, ...]] = {
    "origin": ("xyz", "rpy"),
    "mesh": ("scale",),
    "limit": ("lower", "upper"),
    "dynamics": ("damping", "friction"),
    "mimic": ("multiplier", "offset"),
}

_ZERO: Vector3 = (0.0, 0.0, 0.0)

#: White space of XML: a name of other blanks, such as one that does not break, is one like any other.
_WHITE = " \t\r\n"

#: Of so many different names that URDF lacks it is kept whether they are misspelt; of the rest it is asked again.
_MOST_STRANGE = 200


class Limit(NamedTuple):
    """A joint's ``limit``: positions in rad or m, velocity in rad/s or m/s, effort in N·m or N."""

    lower: float
    upper: float
    velocity: float
    effort: float


class UrdfLink(NamedTuple):
    """A ``link`` element as read; ``inertial`` is its element, to point at."""

    name: str
    element: Element
    inertia: Inertia | None
    inertial: Element | None
    visuals: tuple[Shape, ...]
    collisions: tuple[Shape, ...]


class UrdfJoint(NamedTuple):
    """A ``joint`` element as read.

    Attributes:
        name: Its name.
        type: One of URDF's six types.
        element: To point at.
        parent: Name of the parent link.
        child: Name of the child link.
        placement: Pose of the joint, which is that of the child link at zero, in the parent link.
        axis: As written, in the joint's frame; (1, 0, 0) where the URDF gives none.
        limit: None where the URDF gives none.
        damping: N·m·s/rad or N·s/m.
        friction: N·m or N.
        mimic: The joint that it mimics as the file has it, or None. A fixed joint mimics none.
    """

    name: str
    type: JointType
    element: Element
    parent: str
    child: str
    placement: Pose
    axis: Vector3
    limit: Limit | None
    damping: float
    friction: float
    mimic: Mimic | None


@dataclass(frozen=True, slots=True)
class Urdf:
    """A sound URDF: unique names, known links, one tree.

    Attributes:
        document: Where it was read from.
        name: Name of the robot.
        links: By name, in file order.
        joints: By name, in file order.
        root: Name of the root link.
        children: For each link, the joints that hang from it, in the byte order of their names.
    """

    document: XmlDocument
    name: str
    links: Mapping[str, UrdfLink]
    joints: Mapping[str, UrdfJoint]
    root: str
    children: Mapping[str, tuple[UrdfJoint, ...]]

    def without_mimics(self) -> Urdf:
        """The same URDF in which no joint mimics another."""
        if all(joint.mimic is None for joint in self.joints.values()):
            return self
        joints = {name: joint._replace(mimic=None) for name, joint in self.joints.items()}
        children = {link: tuple(joints[joint.name] for joint in of) for link, of in self.children.items()}
        return replace(self, joints=joints, children=children)

    def walk(self) -> Iterator[UrdfJoint]:
        """The joints depth first from the root; the joints of one link in the byte order of their names."""
        stack = list(reversed(self.children.get(self.root, ())))
        while stack:
            joint = stack.pop()
            yield joint
            stack.extend(reversed(self.children.get(joint.child, ())))


def read_urdf(
    document: XmlDocument,
    diagnostics: Diagnostics,
    *,
    geometry: bool = True,
    mimic_diagnostics: Diagnostics | None = None,
) -> Urdf | None:
    """Read a URDF and check it by itself.

    Args:
        document: The XML file.
        diagnostics: Gets what is found.
        geometry: Whether to read what is seen and what collides; else links have neither, and it is not checked.
        mimic_diagnostics: Gets what is wrong with which joint mimics which, in place of `diagnostics`: for a caller
            that ignores mimics, to whom this is no error.

    Returns:
        The URDF, or None where an error was added to `diagnostics`.
    """
    before = diagnostics.error_count
    reader = _Reader(document, diagnostics, geometry, diagnostics if mimic_diagnostics is None else mimic_diagnostics)
    urdf = reader.robot()
    return None if diagnostics.error_count > before else urdf


def _named(element: Element) -> str:
    """How a sentence names an element: a link or joint by its name, what is in it by tag and owner."""
    tag, name = str(element.tag), element.get("name")
    if tag in ("link", "joint") and name:
        return f"{tag} '{name}'"
    owner = next((above for above in element.iterancestors("link", "joint") if above.get("name")), None)
    return f"<{tag}>" + ("" if owner is None else f" of {owner.tag!s} '{owner.get('name')}'")


def _round(cycle: Sequence[str]) -> str:
    """How a sentence names the members of a cycle, a few at most."""
    shown = cycle if len(cycle) <= 6 else [*cycle[:5], "..."]
    return " -> ".join(f"'{name}'" for name in [*shown, cycle[0]])


def _floats(text: str, separator: str | None = None) -> tuple[float, ...] | None:
    """Finite decimal numbers in ASCII; of what `float` takes beyond them (nan, inf, 1_0, other digits) none is URDF."""
    if "_" in text or not text.isascii():
        return None
    try:
        values = tuple(map(float, text.split(separator)))
    except ValueError:
        return None
    # The sum is finite where all are, but for sums that overflow.
    return values if math.isfinite(sum(values)) or all(map(math.isfinite, values)) else None


class _Reader:
    """Walks the elements once; every method reads one kind of element and reports what is wrong with it."""

    def __init__(
        self, document: XmlDocument, diagnostics: Diagnostics, geometry: bool, mimic_diagnostics: Diagnostics
    ) -> None:
        self.document = document
        self.diagnostics = diagnostics
        self.mimic_diagnostics = mimic_diagnostics
        self.geometry_too = geometry
        self.floats: dict[str, tuple[float, ...] | None] = {}
        self.joined: dict[str, tuple[float, ...] | None] = {}
        self.poses: dict[tuple[str | None, str | None], Pose] = {}
        self.strange: dict[tuple[str, tuple[str, ...]], str | None] = {}
        self.materials: dict[str, tuple[tuple[float, float, float, float] | None, str]] = {}
        self.nameless = False  # whether a material of the robot has no name

    # -- reporting ------------------------------------------------------------------------------------------------

    def report(
        self, code: str, message: str, element: Element, attribute: str | None = None, hint: Hint = None
    ) -> None:
        diagnostics = self.mimic_diagnostics if code in _OF_MIMICS else self.diagnostics
        diagnostics.report(code, message, partial(self.document.place, element, attribute), hint)

    # -- attributes -----------------------------------------------------------------------------------------------

    def numbers(self, element: Element, attribute: str, text: str, count: int) -> tuple[float, ...] | None:
        """EU-URD-007: an attribute of numbers holds as many finite decimal numbers as it must."""
        values = self.floats.get(text)
        if values is None:
            # Zeros, units and limits come again and again in a file.
            values = self.floats[text] = _floats(text)
        if values is not None and len(values) == count:
            return values
        if values is None:
            self._bad_number(element, attribute, text, count)
            return None
        wanted = "one number" if count == 1 else f"{count} numbers separated by spaces"
        self.report(
            "urdf-bad-number",
            f"'{attribute}' of {_named(element)} has {len(values)} numbers; it must have {wanted}",
            element,
            attribute,
        )
        return None

    def _bad_number(self, element: Element, attribute: str, text: str, count: int) -> None:
        wanted = "a finite decimal number" if count == 1 else f"{count} finite decimal numbers separated by spaces"
        hint = None
        if "," in text:
            hint = "write a point, not a comma, and separate numbers by spaces"
        elif "${" in text or "$(" in text:
            hint = (
                "this looks like xacro: give the .xacro file itself, by --urdf if there is a description, or expand it"
            )
        shown = text if len(text) <= 40 else text[:37] + "..."
        self.report(
            "urdf-bad-number",
            f"'{attribute}' of {_named(element)} is '{shown}'; it must be {wanted}",
            element,
            attribute,
            hint,
        )

    def several(self, element: Element, attributes: Mapping[str, str | None]) -> tuple[float, ...] | None:
        """Attributes of one number each.

        Args:
            element: The element.
            attributes: What each is where it is left out; None where it must not be.
        """
        get = element.get
        texts = [get(attribute, default) for attribute, default in attributes.items()]
        if None not in texts:
            # A comma in an attribute makes one number too many, and a blank is no number: so none slips through.
            joined = ",".join(texts)  # type: ignore[arg-type]
            values = self.joined.get(joined)
            if values is None:
                values = self.joined[joined] = _floats(joined, ",")
            if values is not None and len(values) == len(texts):
                return values
        for attribute, text in zip(attributes, texts, strict=True):
            if text is None:
                self._missing_attribute(element, attribute)
            else:
                self.numbers(element, attribute, text, 1)
        return None

    def _missing_attribute(self, element: Element, attribute: str) -> None:
        near = did_you_mean(attribute, [str(key) for key in element.keys()])  # noqa: SIM118 - an lxml element
        hint = near.replace("did you mean", "rename").replace("?", "") if near else None
        self.report("urdf-missing-attribute", f"{_named(element)} has no attribute '{attribute}'", element, None, hint)

    def name(self, element: Element, attribute: str = "name") -> str | None:
        """EU-URD-005, EU-URD-008: what must have a name has one, and it is not empty."""
        name = element.get(attribute)
        if name is None:
            self._missing_attribute(element, attribute)
            return None
        if not name.strip(_WHITE):
            self.report("urdf-empty-name", f"'{attribute}' of <{element.tag}> is empty", element, attribute)
            return None
        return name

    # -- elements -------------------------------------------------------------------------------------------------

    def children(self, parent: Element) -> dict[str, Element]:
        """EU-URD-006: the child elements that may stand once, by tag. Unknown ones are looked at for near misses."""
        found: dict[str, Element] = {}
        known = _KNOWN_CHILDREN[str(parent.tag)]
        for child in parent:
            tag = child.tag
            if tag in found:
                self.report("urdf-repeated-element", f"<{parent.tag}> has a second <{tag}>", child)
            elif tag in known:
                found[tag] = child
            else:
                self.unknown(parent, child)
        return found

    def unknown(self, parent: Element, child: Element) -> None:
        """EU-URD-026: an element that URDF lacks is left alone unless it is near one that may be left out."""
        tag = child.tag
        if not isinstance(tag, str):
            return
        optional = _OPTIONAL_CHILDREN[str(parent.tag)]
        if parent.tag == "joint" and URDF_JOINT_TYPES.get(parent.get("type", "")) in _RANGED:
            optional = tuple(other for other in optional if other != "limit")
        if hint := self.near_miss(tag, optional):
            self.report("urdf-unknown-element", f"<{parent.tag}> has an unknown element <{tag}>", child, hint=hint)

    def other_dialect(self, element: Element) -> bool:
        """EU-URD-027: whether an element of the robot states a closure in another dialect, of which is told."""
        local = re.split("[}:]", str(element.tag))[-1]
        if local not in _CLOSURE_DIALECTS and not local.endswith("_constraint"):
            return False
        self.report(
            "urdf-closure-ignored",
            f"<{local}> states a constraint that is not part of this format and has no effect",
            element,
            hint="state it under 'closures' in the YAML file",
        )
        return True

    def attributes(self, element: Element) -> None:
        """EU-URD-026: an attribute that may be left out is not misspelt, which would leave it out."""
        optional = _OPTIONAL_ATTRIBUTES[str(element.tag)]
        for attribute in map(str, element.keys()):
            hint = None if attribute in optional else self.near_miss(attribute, optional)
            if hint:
                message = f"{_named(element)} has an unknown attribute '{attribute}'"
                self.report("urdf-unknown-element", message, element, hint=hint)

    def near_miss(self, name: str, optional: tuple[str, ...]) -> str | None:
        """The hint for a name that URDF lacks, without a prefix; mostly the same few stand in each joint of a file."""
        if (name, optional) in self.strange:
            return self.strange[name, optional]
        meant = None if "}" in name or ":" in name else near(name, optional)
        hint = meant and f"did you mean '{meant}'?"
        if len(self.strange) < _MOST_STRANGE:
            self.strange[name, optional] = hint
        return hint

    def need(self, parent: Element, found: Mapping[str, Element], tag: str) -> Element | None:
        """EU-URD-004: an element has the child elements that it must have."""
        element = found.get(tag)
        if element is None:
            self.report("urdf-missing-element", f"{_named(parent)} has no <{tag}>", parent)
        return element

    def origin(self, element: Element | None) -> Pose:
        if element is None:
            return IDENTITY
        text = (element.get("xyz"), element.get("rpy"))
        if len(element.keys()) > 2 - text.count(None):
            self.attributes(element)
        pose = self.poses.get(text)
        if pose is None:
            xyz = _ZERO if text[0] is None else self.numbers(element, "xyz", text[0], 3)
            rpy = _ZERO if text[1] is None else self.numbers(element, "rpy", text[1], 3)
            if xyz is None or rpy is None:
                return IDENTITY
            # What is seen and what collides mostly stand in the same place.
            pose = self.poses[text] = Pose.from_xyz_rpy(xyz, rpy)  # type: ignore[arg-type]
        return pose

    # -- robot ----------------------------------------------------------------------------------------------------

    def robot(self) -> Urdf | None:
        root = self.document.root
        if root.tag != "robot":
            hint = None
            if root.tag in ("sdf", "mujoco"):
                hint = "this is another format; give the URDF of the robot"
            self.report("urdf-root-element", f"the root element is <{root.tag}>; it must be <robot>", root, hint=hint)
            return None
        name = self.name(root)
        links: list[UrdfLink] = []
        joints: list[UrdfJoint] = []
        elements: list[Element] = []
        for element in root:
            tag = element.tag
            if tag in ("link", "joint"):
                elements.append(element)
            elif tag == "material":
                if self.geometry_too:
                    self.robot_material(element)
            elif isinstance(tag, str) and not self.other_dialect(element):
                self.unknown(root, element)
        complete = True
        for element in elements:
            if element.tag == "link":
                link = self.link(element)
                complete = complete and link is not None
                if link:
                    links.append(link)
            else:
                joint = self.joint(element)
                complete = complete and joint is not None
                if joint:
                    joints.append(joint)
        if not complete or name is None:
            return None
        return self.tree(name, links, joints)

    # -- links ----------------------------------------------------------------------------------------------------

    def link(self, element: Element) -> UrdfLink | None:
        name = self.name(element)
        inertia: Inertia | None = None
        inertial: Element | None = None
        visuals: list[Shape] = []
        collisions: list[Shape] = []
        for child in element:
            tag = child.tag
            if tag == "inertial":
                if inertial is not None:
                    self.report("urdf-repeated-element", f"link '{name}' has a second <inertial>", child)
                    continue
                inertial = child
                inertia = self.inertial(child)
            elif tag in ("visual", "collision"):
                shape = self.shape(child, visual=tag == "visual") if self.geometry_too else None
                if shape is not None:
                    (visuals if tag == "visual" else collisions).append(shape)
            else:
                self.unknown(element, child)
        if name is None:
            return None
        if name == "universe":
            self.report(
                "urdf-reserved-name", "'universe' is the name of the world and cannot be a link's", element, "name"
            )
        return UrdfLink(name, element, inertia, inertial, tuple(visuals), tuple(collisions))

    def inertial(self, element: Element) -> Inertia | None:
        found = self.children(element)
        pose = self.origin(found.get("origin"))
        mass_element = self.need(element, found, "mass")
        inertia_element = self.need(element, found, "inertia")
        if mass_element is None or inertia_element is None:
            return None
        mass, moments = self.several(mass_element, _MASS), self.several(inertia_element, _INERTIA)
        if mass is None or moments is None:
            return None
        return Inertia(mass[0], pose, moments)  # type: ignore[arg-type]

    # -- shapes ---------------------------------------------------------------------------------------------------

    def shape(self, element: Element, *, visual: bool) -> Shape | None:
        color: tuple[float, float, float, float] | None = None
        texture = ""
        found = self.children(element)
        pose = self.origin(found.get("origin"))
        if visual and "material" in found:
            color, texture = self.material(found["material"])
        geometry = self.need(element, found, "geometry")
        if geometry is None:
            return None
        return self.geometry(geometry, pose, color, texture)

    def geometry(
        self, element: Element, pose: Pose, color: tuple[float, float, float, float] | None, texture: str
    ) -> Shape | None:
        """EU-URD-024: a geometry is one box, cylinder, sphere, capsule or mesh of positive size."""
        shapes = list(element)
        if len(shapes) != 1:
            self.report(
                "urdf-geometry", f"<geometry> holds {len(shapes)} elements; it must hold exactly one shape", element
            )
            return None
        shape = shapes[0]
        kind = shape.tag
        size: tuple[float, ...] | None
        if kind == "mesh":
            name = self.name(shape, "filename")
            scale = shape.get("scale")
            self.attributes(shape)
            size = (1.0, 1.0, 1.0) if scale is None else self.numbers(shape, "scale", scale, 3)
            if name is None or size is None:
                return None
            if 0.0 in size:
                self.report("urdf-geometry", "'scale' of <mesh> has a zero", shape, "scale")
                return None
            return Shape("mesh", size, pose, name, color, texture)
        if kind == "box":
            text = shape.get("size")
            if text is None:
                self._missing_attribute(shape, "size")
                return None
            size = self.numbers(shape, "size", text, 3)
        elif kind == "sphere":
            size = self.several(shape, _SPHERE)
        elif kind in ("cylinder", "capsule"):
            size = self.several(shape, _CYLINDER)
        else:
            shown = kind if isinstance(kind, str) else "?"
            self.report(
                "urdf-geometry",
                f"<{shown}> is no shape; it must be box, cylinder, sphere, capsule or mesh",
                shape,
                hint=did_you_mean(shown, ("box", "cylinder", "sphere", "capsule", "mesh")),
            )
            return None
        if size is None:
            return None
        if min(size) <= 0.0:
            self.report("urdf-geometry", f"a size of <{kind}> is not positive", shape)
            return None
        return Shape(cast(_Primitive, kind), size, pose, color=color, texture=texture)

    def color(self, element: Element) -> tuple[tuple[float, float, float, float] | None, str]:
        found = self.children(element)
        rgba: tuple[float, ...] | None = None
        if "color" in found:
            text = found["color"].get("rgba")
            if text is None:
                self._missing_attribute(found["color"], "rgba")
            else:
                rgba = self.numbers(found["color"], "rgba", text, 4)
        texture = self.name(found["texture"], "filename") or "" if "texture" in found else ""
        return rgba, texture  # type: ignore[return-value]

    def robot_material(self, element: Element) -> None:
        name = self.name(element)
        color = self.color(element)
        if name is None:
            self.nameless = True
        else:
            self.materials.setdefault(name, color)

    def material(self, element: Element) -> tuple[tuple[float, float, float, float] | None, str]:
        """EU-URD-029: a material is defined where it is used, in the robot, or at an earlier use."""
        name = element.get("name", "")
        if element.find("color") is None and element.find("texture") is None:
            if name not in self.materials:
                if self.nameless:  # it may be the one that lacks its name
                    return None, ""
                message = f"material '{name}' is not defined" if name else f"{_named(element)} has no name and no color"
                self.report(
                    "urdf-unknown-material",
                    message,
                    element,
                    "name",
                    partial(did_you_mean, name, self.materials),
                )
                return None, ""
            return self.materials[name]
        own = self.color(element)
        return self.materials.setdefault(name, own) if name else own

    # -- joints ---------------------------------------------------------------------------------------------------

    def joint(self, element: Element) -> UrdfJoint | None:
        name = self.name(element)
        found = self.children(element)
        kind = self.joint_type(element)
        parent_element, child_element = self.need(element, found, "parent"), self.need(element, found, "child")
        parent = self.name(parent_element, "link") if parent_element is not None else None
        child = self.name(child_element, "link") if child_element is not None else None
        placement = self.origin(found.get("origin"))
        if kind is None:
            return None
        axis = self.axis(name, kind, found.get("axis"))
        limit = self.limit(name, kind, element, found.get("limit"))
        damping = friction = 0.0
        if "dynamics" in found:
            damping, friction = self.dynamics(found["dynamics"])
        mimic = self.mimic(name, kind, found["mimic"]) if "mimic" in found else None
        if name is None or parent is None or child is None or axis is None:
            return None
        if name == "universe":
            self.report(
                "urdf-reserved-name", "'universe' is the name of the world and cannot be a joint's", element, "name"
            )
        return UrdfJoint(name, kind, element, parent, child, placement, axis, limit, damping, friction, mimic)

    def joint_type(self, element: Element) -> JointType | None:
        """EU-URD-012: the type of a joint is one of URDF's six."""
        text = element.get("type")
        if text is None:
            self._missing_attribute(element, "type")
            return None
        kind = URDF_JOINT_TYPES.get(text)
        if kind is None:
            hint = did_you_mean(text, URDF_JOINT_TYPES)
            if text in ("spherical", "ball", "universal", "cylindrical", "helical", "screw"):
                hint = "write 'revolute' or 'continuous' here, and the type under 'joints' in the YAML file"
            self.report("urdf-joint-type", f"'{text}' is no joint type of URDF", element, "type", hint)
        return kind

    def axis(self, name: str | None, kind: JointType, element: Element | None) -> Vector3 | None:
        """EU-URD-013, EU-URD-035: the axis of a joint that turns about or slides along it is a direction, or else x."""
        if element is None:
            return (1.0, 0.0, 0.0)
        text = element.get("xyz")
        if text is None:
            self._missing_attribute(element, "xyz")
            return None
        axis = self.numbers(element, "xyz", text, 3)
        if axis is None:
            return None
        x, y, z = axis
        if kind in _AXLESS:
            return (1.0, 0.0, 0.0)
        if kind is JointType.PLANAR:
            if x != 0.0 or y != 0.0:
                self.report(
                    "urdf-planar-axis",
                    f"planar joint '{name}' moves in its own xy plane, whatever its axis says",
                    element,
                    "xyz",
                    "turn the joint's origin so that its z is the normal of the plane, and write the axis 0 0 1",
                )
        elif x == y == z == 0.0:
            self.report("urdf-zero-axis", f"the axis of joint '{name}' has no direction", element, "xyz")
            return None
        return (x, y, z)

    def limit(self, name: str | None, kind: JointType, joint: Element, element: Element | None) -> Limit | None:
        """EU-URD-004, EU-URD-019, EU-URD-020: what moves in a range says a range, lower before upper."""
        ranged = kind in _RANGED
        if element is None:
            if ranged:
                self.report(
                    "urdf-missing-element",
                    f"{kind} joint '{name}' has no <limit>",
                    joint,
                    hint="use type 'continuous' for a joint that turns without limits" if kind == "revolute" else None,
                )
            return None
        self.attributes(element)
        values = self.several(element, _LIMIT)
        if values is None:
            return None
        effort, velocity, lower, upper = values
        if effort < 0.0 or velocity < 0.0:
            self.negative(element, effort=effort, velocity=velocity)
        if ranged and lower > upper:
            self.report(
                "urdf-reversed-limits",
                f"joint '{name}' has its lower limit {lower:g} above its upper limit {upper:g}",
                element,
                "lower",
                "swap them",
            )
        return Limit(lower, upper, velocity, effort)

    def dynamics(self, element: Element) -> tuple[float, ...]:
        self.attributes(element)
        damping, friction = self.several(element, _DYNAMICS) or (0.0, 0.0)
        if damping < 0.0 or friction < 0.0:
            self.negative(element, damping=damping, friction=friction)
        return damping, friction

    def negative(self, element: Element, **values: float) -> None:
        """EU-URD-020: what is a magnitude is not negative."""
        for attribute, value in values.items():
            if value < 0.0:
                message = f"'{attribute}' of {_named(element)} is negative"
                self.report("urdf-negative-limit", message, element, attribute)

    def mimic(self, name: str | None, kind: JointType, element: Element) -> Mimic | None:
        """EU-URD-036: a fixed joint, which has no coordinate, has no use for a `<mimic>`."""
        joint = self.name(element, "joint")
        self.attributes(element)
        values = self.several(element, _MIMIC)
        if joint is None or values is None:
            return None
        if kind is JointType.FIXED:
            self.report(
                "urdf-mimic-fixed",
                f"joint '{name}' is fixed: its <mimic> of '{joint}' has no effect",
                element,
                hint="remove <mimic>, or change the type if the joint moves",
            )
            return None
        return Mimic(joint, *values)

    # -- the tree -------------------------------------------------------------------------------------------------

    def tree(self, name: str, links: list[UrdfLink], joints: list[UrdfJoint]) -> Urdf | None:
        """EU-URD-009, -010, -014 to -018: unique names, known links, and exactly one tree."""
        before = self.diagnostics.error_count
        link_by_name: dict[str, UrdfLink] = {}
        for link in links:
            if link.name in link_by_name:
                self.report("urdf-duplicate-link", f"there is a second link '{link.name}'", link.element, "name")
            link_by_name[link.name] = link
        joint_by_name: dict[str, UrdfJoint] = {}
        for joint in joints:
            if joint.name in joint_by_name:
                self.report("urdf-duplicate-joint", f"there is a second joint '{joint.name}'", joint.element, "name")
            joint_by_name[joint.name] = joint
        if not links:
            self.report("urdf-no-link", f"robot '{name}' has no link", self.document.root)
        for joint in joints:
            for tag, link_name in (("parent", joint.parent), ("child", joint.child)):
                if link_name not in link_by_name:
                    self.report(
                        "urdf-unknown-link",
                        f"joint '{joint.name}' names the {tag} link '{link_name}', which does not exist",
                        joint.element.find(tag),  # type: ignore[arg-type]
                        "link",
                        partial(did_you_mean, link_name, link_by_name, joint.name),
                    )
        if self.diagnostics.error_count > before:
            return None
        self.mimics(joint_by_name)
        parent_joint: dict[str, UrdfJoint] = {}
        children: dict[str, list[UrdfJoint]] = {}
        for joint in joints:
            if joint.child in parent_joint:
                other = parent_joint[joint.child].name
                self.report(
                    "urdf-two-parents",
                    f"link '{joint.child}' is the child of two joints, '{other}' and '{joint.name}'",
                    joint.element.find("child"),  # type: ignore[arg-type]
                    "link",
                    "keep one of the joints, and state the other under 'closures' in the YAML file",
                )
            parent_joint[joint.child] = joint
            children.setdefault(joint.parent, []).append(joint)
        if self.diagnostics.error_count > before:
            return None
        roots = [link for link in links if link.name not in parent_joint]
        ordered = {link: tuple(sorted(of, key=lambda joint: joint.name)) for link, of in children.items()}
        urdf = Urdf(self.document, name, link_by_name, joint_by_name, roots[0].name if roots else "", ordered)
        if not self.acyclic(links, roots, urdf, parent_joint):
            return None
        if len(roots) > 1:
            names = quoted([link.name for link in roots], 5)
            self.report(
                "urdf-two-roots",
                f"{len(roots)} links have no parent: {names}; a robot has one root",
                roots[1].element,
                "name",
                "join them by a joint",
            )
            return None
        return urdf

    def acyclic(
        self, links: list[UrdfLink], roots: list[UrdfLink], urdf: Urdf, parent_joint: Mapping[str, UrdfJoint]
    ) -> bool:
        """EU-URD-017: no joints form a cycle; every link hangs from a root."""
        reached = {link.name for link in roots}
        stack = list(reached)
        while stack:
            for joint in urdf.children.get(stack.pop(), ()):
                reached.add(joint.child)
                stack.append(joint.child)
        for link in links:
            if link.name in reached:
                continue
            # Walking up from a link that no root reaches must enter a cycle.
            seen: dict[str, int] = {}
            path: list[str] = []
            name = link.name
            while name not in seen:
                seen[name] = len(path)
                path.append(name)
                name = parent_joint[name].parent
            cycle = list(reversed(path[seen[name] :]))
            # The last one in the file: whoever closed the cycle mostly wrote it last.
            order = {name: index for index, name in enumerate(urdf.joints)}
            last = max((parent_joint[link] for link in cycle), key=lambda joint: order[joint.name])
            self.report(
                "urdf-cycle",
                "links form a cycle: " + _round(cycle),
                last.element,
                hint="take one joint out of the cycle, and state it under 'closures' in the YAML file",
            )
            return False
        return True

    def mimics(self, joints: Mapping[str, UrdfJoint]) -> None:
        """EU-URD-021 to -023: a mimic follows another joint of one coordinate, and not itself round a cycle."""
        following = [joint for joint in joints.values() if joint.mimic]
        done: set[str] = set()
        for joint in following:
            assert joint.mimic is not None
            element: Element = joint.element.find("mimic")  # type: ignore[assignment]
            target = joints.get(joint.mimic.joint)
            if target is None:
                self.report(
                    "urdf-mimic-unknown",
                    f"joint '{joint.name}' mimics '{joint.mimic.joint}', which is no joint",
                    element,
                    "joint",
                    partial(did_you_mean, joint.mimic.joint, joints.keys() - {joint.name}, joint.name),
                )
                continue
            roles = {"mimics another": joint, "is mimicked": target}
            wrong = next((role for role, other in roles.items() if other.type not in MIMIC_TYPES), None)
            if wrong:
                other = roles[wrong]
                self.report(
                    "urdf-mimic-kind",
                    f"joint '{other.name}' {wrong}, but is {other.type}: only joints of one coordinate can",
                    element,
                    "joint",
                )
                continue
            trail = dict.fromkeys([joint.name])
            at = target
            while at is not None and at.name not in trail and at.name not in done:
                trail[at.name] = None
                at = joints.get(at.mimic.joint) if at.mimic else None  # type: ignore[assignment]
            if at is not None and at.name in trail:
                self.report(
                    "urdf-mimic-cycle",
                    "joints mimic one another in a cycle: " + _round([*dropwhile(at.name.__ne__, trail)]),
                    element,
                    "joint",
                )
            done.update(trail)
