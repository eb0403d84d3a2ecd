"""The content of a URDF: links, joints, inertias and shapes, chapter The URDF."""

from __future__ import annotations

import re
from collections.abc import Collection
from dataclasses import dataclass, replace
from pathlib import Path
from xml.parsers import expat

import numpy as np

from eurdf_conformance.oracle.not_read import NotRead
from eurdf_conformance.oracle.plain_value import NO_LIMIT, bounded, limit
from eurdf_conformance.oracle.spatial import Array, from_quaternion, from_rpy, pose, unit

_NUMBER = re.compile(r"[-+]?([0-9]+(\.[0-9]*)?|\.[0-9]+)([eE][-+]?[0-9]+)?")
_VERSIONS = ("1.0", "1.1", "1.2")
_TYPES = ("revolute", "continuous", "prismatic", "planar", "floating", "fixed")


@dataclass(frozen=True)
class Inertia:
    """Inertia of a link, in its frame."""

    #: kg
    mass: float
    #: Centre of mass, m.
    center: Array
    #: About the centre of mass, along the axes of the link, kg·m².
    moments: Array


@dataclass(frozen=True)
class Shape:
    """A shape of a link."""

    use: str
    type: str
    #: Lengths in m; of a mesh its scale.
    size: Array
    file: str | None
    #: Pose in the frame of the link.
    placement: Array


@dataclass(frozen=True)
class Link:
    """A link; without `inertial` it has no mass."""

    name: str
    inertia: Inertia | None
    #: Those of one use in the order of the file.
    shapes: list[Shape]


@dataclass(frozen=True)
class Mimic:
    """q = multiplier · q_joint + offset, rad or m, EU-URD-032."""

    joint: str
    multiplier: float
    offset: float


@dataclass(frozen=True)
class UrdfJoint:
    """A joint; a limit is None if it is missing. Units m, rad, N, s."""

    name: str
    type: str
    parent: str
    child: str
    #: pMj, the pose of its frame in its parent's.
    origin: Array
    #: Unit vector in the joint's frame, EU-URD-035.
    axis: Array
    lower: float | None
    upper: float | None
    velocity: float | None
    effort: float | None
    damping: float
    friction: float
    mimic: Mimic | None


@dataclass(frozen=True)
class Urdf:
    """A tree of links, by name."""

    name: str
    links: dict[str, Link]
    joints: dict[str, UrdfJoint]

    @property
    def root(self) -> str:
        """The one link without a parent, EU-URD-018."""
        carried = {joint.child for joint in self.joints.values()}
        (root,) = (name for name in self.links if name not in carried)
        return root

    def without_mimics(self, of: Collection[str] | None = None) -> Urdf:
        """The URDF in which the joints named mimic no other; None: no joint does, as in version 1, EU-ONE-009."""
        named = self.joints if of is None else of
        joints = {name: replace(joint, mimic=None) if name in named else joint for name, joint in self.joints.items()}
        return replace(self, joints=joints)

    def below(self, link: str) -> list[UrdfJoint]:
        """The child joints of a link, in the order of the file."""
        return [joint for joint in self.joints.values() if joint.parent == link]


@dataclass(frozen=True)
class Element:
    """An element of the file. Names are as written, with their prefix."""

    name: str
    attributes: dict[str, str]
    children: list[Element]
    #: The version of URDF that the file states, EU-URD-037; 0.9 if it states none.
    version: float = 0.9

    def all(self, name: str) -> list[Element]:
        """The children with a name."""
        return [child for child in self.children if child.name == name]

    def one(self, name: str) -> Element:
        """The child with a name; an empty element if there is none."""
        found = self.all(name)
        if len(found) > 1:
            raise NotRead(f"{len(found)} elements {name!r} in one {self.name!r}")
        return found[0] if found else Element(name, {}, [], self.version)

    def text(self, name: str) -> str:
        """A required attribute."""
        if not self.attributes.get(name, "").strip(" \t\r\n"):
            raise NotRead(f"an element {self.name!r} without {name!r}")
        return self.attributes[name]

    def number(self, name: str, default: float | None = None) -> float:
        """An attribute with one number."""
        return float(self.numbers(name, None if default is None else [default])[0])

    def numbers(self, name: str, default: list[float] | None = None) -> Array:
        """An attribute with one number, or with as many as its default, EU-URD-007."""
        if default is not None and name not in self.attributes:
            return np.array(default)
        words = re.split(r"[ \t\r\n]+", self.text(name).strip(" \t\r\n"))
        if len(words) != len(default or [0.0]) or not all(_NUMBER.fullmatch(word) for word in words):
            raise NotRead(f"{name}={self.attributes[name]!r}")
        return np.array([bounded(float(word)) for word in words])

    def limit(self, name: str, default: float | None = None) -> float | None:
        """An attribute with the number of a limit, EU-FIL-006."""
        if default is not None and name not in self.attributes:
            return default
        if not _NUMBER.fullmatch(word := self.text(name).strip(" \t\r\n")) or not np.isfinite(float(word)):
            raise NotRead(f"{name}={self.attributes[name]!r}")
        return limit(name, float(word))


def parse(source: bytes) -> Element:
    """The root element of an XML document, EU-URD-001 and 002. Only the five entities of XML itself are resolved."""
    top: list[Element] = []
    stack: list[Element] = []

    def start(name: str, attributes: dict[str, str]) -> None:
        stated = attributes.get("version")
        version = stack[-1].version if stack else float(stated) if stated in _VERSIONS else 0.9
        element = Element(name, attributes, [], version)
        (stack[-1].children if stack else top).append(element)
        stack.append(element)

    def doctype(*_: object) -> None:
        raise NotRead("a document type declaration")

    parser = expat.ParserCreate("utf-8")
    parser.StartElementHandler = start
    parser.EndElementHandler = lambda _: stack.pop()
    parser.StartDoctypeDeclHandler = doctype
    try:
        parser.Parse(source, True)
        # Namespaces need a parser that separates them from names, here by a character that XML does not allow.
        expat.ParserCreate("utf-8", "\f").Parse(source, True)
    except expat.ExpatError as error:
        raise NotRead(str(error)) from error
    return top[0]


def read_urdf(path: Path) -> Urdf:
    """The URDF in a file."""
    robot = parse(path.read_bytes())
    if robot.name != "robot":
        raise NotRead(f"the root element is {robot.name!r}")
    if robot.attributes.get("version", "1.0") not in _VERSIONS:
        raise NotRead(f"the version {robot.attributes['version']!r} of URDF")
    links = [Link(element.text("name"), inertia(element), shapes(element)) for element in robot.all("link")]
    joints = [joint(element) for element in robot.all("joint")]
    urdf = Urdf(robot.text("name"), {link.name: link for link in links}, {found.name: found for found in joints})
    carried = {found.child for found in joints}
    known = carried | {found.parent for found in joints} <= urdf.links.keys()
    once = len(links) == len(urdf.links) and len(joints) == len(urdf.joints) == len(carried)
    if not known or not once or len(links) != len(joints) + 1:
        raise NotRead("the links and joints are no tree with unique names")
    return urdf


def origin(element: Element) -> Array:
    """The pose in the `origin` of an element, or the identity."""
    found = element.one("origin")
    R, p = from_rpy(found.numbers("rpy", [0.0] * 3)), found.numbers("xyz", [0.0] * 3)
    if found.version >= 1.1 and "quat_xyzw" in found.attributes:
        quaternion = found.numbers("quat_xyzw", [0.0] * 4)
        if "rpy" in found.attributes or not np.any(quaternion):
            raise NotRead("an origin with two orientations, or with a quaternion of zero")
        R = from_quaternion(unit(quaternion))
    return pose(R, p)


def inertia(link: Element) -> Inertia | None:
    """The inertia of a link in the axes of its frame: R I Rᵀ, chapter Inertia."""
    if not link.all("inertial"):
        return None
    inertial = link.one("inertial")
    M, moments = origin(inertial), inertial.one("inertia")
    xx, xy, xz, yy, yz, zz = (moments.number(name) for name in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz"))
    R = M[:3, :3]
    return Inertia(
        inertial.one("mass").number("value"),
        M[:3, 3],
        R @ np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]) @ R.T,
    )


#: For each type of shape the attributes of its size, and how many numbers each has.
_SIZES = {
    "box": {"size": 3},
    "cylinder": {"radius": 1, "length": 1},
    "capsule": {"radius": 1, "length": 1},
    "sphere": {"radius": 1},
    "mesh": {"scale": 3},
}


def shapes(link: Element) -> list[Shape]:
    """The shapes of a link."""
    return [shape(element, use) for use in ("visual", "collision") for element in link.all(use)]


def shape(element: Element, use: str) -> Shape:
    """The one shape in a `visual` or `collision`."""
    known = _SIZES.keys() - ({"capsule"} if element.version == 1.0 else set())
    found = [each for each in element.one("geometry").children if each.name in known]
    if len(found) != 1:
        raise NotRead(f"{len(found)} shapes in one geometry")
    (only,) = found
    if only.name != "mesh":  # only a scale may be left out
        for name in _SIZES[only.name]:
            only.text(name)
    sizes = [only.numbers(name, [1.0] * count) for name, count in _SIZES[only.name].items()]
    return Shape(
        use,
        only.name,
        np.concatenate(sizes),
        only.text("filename") if only.name == "mesh" else None,
        origin(element),
    )


def joint(element: Element) -> UrdfJoint:
    """A joint, with the defaults in the table of chapter The URDF. A fixed joint mimics no other."""
    kind = element.text("type")
    if kind not in _TYPES:
        raise NotRead(f"a joint of type {kind!r}")
    axis = element.one("axis").numbers("xyz", [1.0, 0.0, 0.0])
    if not np.any(axis):
        if kind in ("revolute", "continuous", "prismatic"):
            raise NotRead("an axis of zero")
        axis = np.array([1.0, 0.0, 0.0])  # of a joint that has none
    # One number cannot be for lengths and for angles.
    spoken_of = kind not in ("planar", "floating")
    limited = bool(element.all("limit")) and spoken_of
    ranged = kind in ("revolute", "prismatic")
    if ranged and not limited:
        raise NotRead("a joint without the limit that it must have")
    stated = limits(element.one("limit"), ranged) if element.all("limit") else {}
    dynamics = element.one("dynamics")
    follows = mimic(element.one("mimic")) if element.all("mimic") else None
    return UrdfJoint(
        name=element.text("name"),
        type=kind,
        parent=element.one("parent").text("link"),
        child=element.one("child").text("link"),
        origin=origin(element),
        axis=unit(axis),
        lower=stated.get("lower") if ranged else None,
        upper=stated.get("upper") if ranged else None,
        velocity=stated.get("velocity") if limited else None,
        effort=stated.get("effort") if limited else None,
        damping=dynamics.number("damping", 0.0) if spoken_of else 0.0,
        friction=dynamics.number("friction", 0.0) if spoken_of else 0.0,
        mimic=None if kind == "fixed" else follows,
    )


def limits(element: Element, ranged: bool) -> dict[str, float | None]:
    """The limits that a `limit` states, with the defaults of its version."""
    if element.version < 1.2:
        found = {name: element.limit(name, 0.0) for name in ("lower", "upper")}
        return found | {name: element.limit(name) for name in ("effort", "velocity")}
    needed = ("lower", "upper") if ranged else ()
    return {name: element.limit(name) for name in NO_LIMIT if name in element.attributes or name in needed}


def mimic(element: Element) -> Mimic:
    """The mimic of a joint."""
    return Mimic(element.text("joint"), element.number("multiplier", 1.0), element.number("offset", 0.0))
