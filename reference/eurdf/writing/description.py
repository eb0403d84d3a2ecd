"""A mechanism as the two files that describe it: a URDF, and a YAML file in the lowest version that suffices.

Numbers are read back to the last bit, and the order is that of the mechanism. What URDF can say is in the URDF; the
YAML file has the rest.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

from lxml import etree

from eurdf.closures import REGISTRY
from eurdf.diagnostics.wording import visible
from eurdf.format.closure_model import (
    CLOSURE,
    ClosureEntry,
    ComplianceEntry,
    CouplingEntry,
    FrameOnLink,
    FrameReference,
    NamedFrame,
    PoseOnLink,
)
from eurdf.format.conventions import VERSION2_1, VERSION_KEY, is_own_key
from eurdf.format.joint_model import JOINT, NAMED, Geared, JointEntry, LimitsEntry
from eurdf.format.model import VERSION2, Version2, lowest_version
from eurdf.format.yaml_text import entries_of, modeline, text_of
from eurdf.mechanism.body import Anchor, Body
from eurdf.mechanism.constraint import Closure
from eurdf.mechanism.joint import Joint, JointProperties
from eurdf.mechanism.joint_types import JointType
from eurdf.mechanism.mechanism import Mechanism
from eurdf.mechanism.pose import IDENTITY, Vector3
from eurdf.mechanism.same_model import with_whole_joints
from eurdf.writing import urdf_elements as elements
from eurdf.writing.urdf_elements import Color
from eurdf.writing.xml_text import file_content, representable, rpy_of

#: Between two hyphens, which an XML comment must not contain.
_TWO_HYPHENS = re.compile("-(?=-)")

_Z: Vector3 = (0.0, 0.0, 1.0)


class NotWritable(ValueError):  # noqa: N818 - named as the other refusals are
    """The two files cannot say what a mechanism says; the text says what."""


@dataclass(frozen=True, slots=True)
class DescriptionFiles:
    """The URDF of a robot, and its YAML file, of the lowest version that can say what the mechanism says."""

    urdf: bytes
    yaml: str
    version: Literal["2.0", "2.1"]


def version_needed(mechanism: Mechanism) -> Literal["2.0", "2.1"]:
    """The lowest version that can describe a mechanism."""
    content = _content(mechanism)
    # EU-JNT-030: an earlier version has no entries of mimic joints.
    later = any(joint.mimic and joint.name in content.get("joints", ()) for joint in mechanism.joints)
    return VERSION2_1 if later else lowest_version(content)


def describe_mechanism(
    mechanism: Mechanism,
    *,
    urdf_path: str = "robot.urdf",
    schema: str | None = None,
    comments: Sequence[str] = (),
    materials: Mapping[str, Color] | None = None,
) -> DescriptionFiles:
    """The two files of a mechanism. Read again, they are the same mechanism, but for what follows.

    A limit that is infinite beside one that is not is written as the largest double, which is none. Limits of
    acceleration, deceleration and jerk that differ between the axes of a joint are left out. Where a child's frame is
    not that of its joint (`Joint.offset`), the joint carries a link without mass, to which the child is fixed. User
    data whose place does not exist in the new file are in ``x-own-data``, by their JSON pointer.

    Args:
        mechanism: The robot.
        urdf_path: Path of the URDF from the folder of the YAML file.
        schema: Path of the schema from there, for the first line; None for no such line.
        comments: Lines of text to put at the head of both files; what is not printable in them is escaped.
        materials: Colors by name, red, green, blue, alpha from 0 to 1: the URDF declares each once, and the shapes of
            that color use it by name. Any other color is stated at each shape.

    Raises:
        NotWritable: A name cannot be in such a file, or a joint has properties that its type does not have.
    """
    mechanism = with_whole_joints(mechanism)
    _refuse_unwritable(mechanism)
    version = version_needed(mechanism)
    content = {VERSION_KEY: version, "urdf": urdf_path, **_content(mechanism)}
    for name in content.get("joints", ()):
        if is_own_key(name):
            raise NotWritable(f"joint '{name}' needs an entry in the YAML file, where x- begins user data; rename it")
    _place_own_data(content, mechanism)
    head = [modeline(schema)] if schema is not None else []
    head += [f"# {visible(line)}".rstrip() for line in comments]
    text = "".join(f"{line}\n" for line in head) + text_of(entries_of(content))
    return DescriptionFiles(_UrdfWriter(mechanism, materials or {}).content(comments), text, version)


def _refuse_unwritable(mechanism: Mechanism) -> None:
    """Raise `NotWritable` for a name that XML cannot contain, and for a joint whose axes have different gears."""
    for kind, names in (
        ("link", [body.name for body in mechanism.bodies]),
        ("joint", [joint.name for joint in mechanism.joints]),
        ("robot", [mechanism.name]),
    ):
        for name in names:
            if representable(name) != name or not name:
                raise NotWritable(f"the {kind} {name!r} has a name that XML cannot contain; give it another one")
    for contact in mechanism.contacts:
        raise NotWritable(f"the contact '{contact.name}' with the world is no part of a description; leave it out")
    for joint in mechanism.joints:
        properties = joint.properties
        is_unequal = len(set(properties.gear_ratio)) > 1 or len(set(properties.rotor_inertia)) > 1
        if is_unequal and joint.name in mechanism.actuators and _is_geared(joint):
            raise NotWritable(f"the axes of joint '{joint.name}' have different gears; a joint has one")


class _UrdfWriter:
    """The URDF of a mechanism: each joint just before the link that it carries."""

    def __init__(self, mechanism: Mechanism, materials: Mapping[str, Color]) -> None:
        self.names_of_colors = {color: name for name, color in reversed(list(materials.items()))}
        self.links = {body.name for body in mechanism.bodies}
        self.joints = {joint.name for joint in mechanism.joints}
        self.robot = etree.Element("robot", name=mechanism.name)
        for name, color in materials.items():
            elements.add_material(self.robot, name, color)
        self._link(mechanism.bodies[0])
        for joint, body in zip(mechanism.joints, mechanism.bodies[1:], strict=True):
            self._joint(joint)
            self._link(body)
        elements.state_version(self.robot)

    def content(self, comments: Sequence[str]) -> bytes:
        """The bytes of the file."""
        for line in reversed(comments):
            self.robot.insert(0, etree.Comment(f" {_TWO_HYPHENS.sub('- ', visible(line))} "))
        return file_content(self.robot)

    def _link(self, body: Body) -> None:
        link = etree.SubElement(self.robot, "link", name=body.name)
        if body.inertia is not None:
            elements.add_inertial(link, body.inertia)
        for use, shapes in (("visual", body.visuals), ("collision", body.collisions)):
            for shape in shapes:
                elements.add_shape(link, use, shape, shape.filename, shape.texture, self.names_of_colors)

    def _joint(self, joint: Joint) -> None:
        kind, axis = _in_urdf(joint)
        placement, child = joint.placement, joint.child
        if joint.offset != IDENTITY:
            if joint.type.is_fixed:
                placement = placement * joint.offset
            else:
                child = _new(f"{joint.child}_joint", self.links)
                fixed = _new(f"{joint.name}_offset", self.joints)
        element = elements.add_joint(self.robot, joint.name, kind, joint.parent, child, placement, axis)
        if joint.mimic is not None:
            elements.add_mimic(element, joint.mimic)
        if kind.is_axial:
            self._properties(joint, kind, element)
        if child != joint.child:
            etree.SubElement(self.robot, "link", name=child)
            elements.add_fixed_joint(self.robot, fixed, child, joint.child, joint.offset)

    def _properties(self, joint: Joint, kind: JointType, element: etree._Element) -> None:
        properties = joint.properties
        index = _limited_in_urdf(joint)
        position = None
        if kind.limited:
            position = (-math.inf, math.inf)
            if index is not None and properties.lower:
                position = properties.lower[index], properties.upper[index]
        effort, velocity = _common(properties.effort, math.inf), _common(properties.velocity, math.inf)
        rates = {name: values[0] for name, values in properties.rates.items() if len(set(values)) == 1}
        if position is not None or math.isfinite(effort) or math.isfinite(velocity) or rates:
            elements.add_limit(element, position, effort, velocity, rates)
        elements.add_dynamics(element, _common(properties.damping, 0.0), _common(properties.friction, 0.0))


def _new(name: str, taken: set[str]) -> str:
    while name in taken:
        name += "_"
    taken.add(name)
    return name


def _common(values: Sequence[float], default: float) -> float:
    """The value that all velocities of a joint have; the default if they have several."""
    return values[0] if values and len(set(values)) == 1 else default


def _in_urdf(joint: Joint) -> tuple[JointType, Vector3 | None]:
    """The type and axis that a joint has in the URDF."""
    axis = joint.axes[0] if joint.axes else _Z
    if not joint.type.replaces:
        return joint.type, None if joint.type.is_fixed or joint.type.quaternion is not None else axis
    index = _limited_in_urdf(joint)
    if index is None and JointType.CONTINUOUS in joint.type.replaces:
        return JointType.CONTINUOUS, axis
    slides = index is None or joint.type.steps[index].kind == "slide"
    return JointType.PRISMATIC if slides else JointType.REVOLUTE, axis


def _limited_in_urdf(joint: Joint) -> int | None:
    """The one coordinate of a joint whose limits are in the URDF; those of several are in the YAML file."""
    if joint.type.is_ranged:
        return 0
    if not joint.type.limited or len(joint.axes) != 1:
        return None
    limited = _limited(joint.properties)
    return limited[0] if len(limited) == 1 else None


def _limited(properties: JointProperties) -> list[int]:
    bounds = zip(properties.lower, properties.upper, strict=True)
    return [index for index, pair in enumerate(bounds) if any(map(math.isfinite, pair))]


# -- the YAML file ----------------------------------------------------------------------------------------------------


def _content(mechanism: Mechanism) -> dict[str, Any]:
    """The keys of the YAML file behind its head, without those that have nothing to say."""
    anchors = _Anchors(mechanism)
    joints = (_joint(joint, mechanism) for joint in mechanism.joints)
    file = Version2(
        extended_urdf=VERSION2_1,
        root=mechanism.root,
        closures=tuple(_closure(closure, anchors) for closure in mechanism.closures),
        joints=tuple(joint for joint in joints if joint is not None),
        actuators=tuple(_actuator(joint, mechanism) for joint in mechanism.actuators),
        frames=tuple(
            FrameOnLink(name=frame.name, link=frame.body, xyz=frame.pose.xyz, rpy=rpy_of(frame.pose))
            for frame in mechanism.frames
        ),
        configurations=mechanism.configurations,
        metadata=mechanism.metadata,
        couplings=tuple(
            CouplingEntry(name=each.name, joints=dict(each.coefficients), offset=each.offset)
            for each in mechanism.couplings
        ),
    )
    written = VERSION2.write(file)
    del written[VERSION_KEY]
    # Closures and couplings, which are alike, are beside each other.
    return {key: written[key] for key in dict.fromkeys(("root", "closures", "couplings", *written)) if key in written}


def _joint(joint: Joint, mechanism: Mechanism) -> JointEntry | None:
    """What the URDF does not say of a joint; None where it says all."""
    kind, properties = joint.type, joint.properties
    stated: dict[str, Any] = {}
    if kind.replaces:
        stated["type"] = str(kind)
    if len(joint.axes) == 2:
        stated["axes"] = joint.axes
    if joint.pitch:
        stated["pitch"] = joint.pitch
    if not kind.is_fixed:
        in_urdf = bool(kind.replaces) or kind.is_axial
        limits: dict[str, Any] = {}
        if not kind.is_axial and _limited(properties) and _limited_in_urdf(joint) is None:
            limits = {"lower": properties.lower, "upper": properties.upper}
        for key in ("velocity", "effort"):
            values = getattr(properties, key)
            if any(map(math.isfinite, values)) and not (in_urdf and len(set(values)) == 1):
                limits[key] = values
        if limits:
            stated["limits"] = LimitsEntry(**limits)
        for key in ("damping", "friction"):
            values = getattr(properties, key)
            if any(values) and not (in_urdf and len(set(values)) == 1):
                stated[key] = values
        if properties.armature != _armature_of_motor(joint, mechanism):
            stated["armature"] = properties.armature
        if any(properties.stiffness):
            stated["stiffness"] = properties.stiffness
            if any(properties.rest):
                stated["rest"] = properties.rest
    kinds = (stated["type"],) if "type" in stated else ()
    model = next(record.model for record in JOINT.records if record.values_of_type() == kinds)
    return model(name=joint.name, **stated) if stated else None


def _armature_of_motor(joint: Joint, mechanism: Mechanism) -> tuple[float, ...]:
    """EU-ACT-006: the armature that a joint has where none is stated."""
    properties = joint.properties
    if not properties.armature or joint.name not in mechanism.actuators or not _is_geared(joint):
        return (0.0,) * len(properties.armature)
    return tuple(
        ratio * ratio * rotor for ratio, rotor in zip(properties.gear_ratio, properties.rotor_inertia, strict=True)
    )


def _is_geared(joint: Joint) -> bool:
    return any(ratio != 1.0 for ratio in joint.properties.gear_ratio) or any(joint.properties.rotor_inertia)


def _actuator(name: str, mechanism: Mechanism) -> Geared:
    joint = next(joint for joint in mechanism.joints if joint.name == name)
    stated: dict[str, Any] = {}
    if motor := mechanism.motors.get(name):
        stated = {"name": None if motor.name == name else motor.name, "control": motor.control}
    if _is_geared(joint):
        stated["gear_ratio"] = joint.properties.gear_ratio[0]
        stated["rotor_inertia"] = joint.properties.rotor_inertia[0] or None
    return Geared(joint=name, **stated)


def _closure(closure: Closure, anchors: _Anchors) -> ClosureEntry:
    if closure.type not in REGISTRY:
        raise NotWritable(f"closure '{closure.name}' has the type '{closure.type}', which no version of the format has")
    linear, angular = closure.compliance.linear or None, closure.compliance.angular or None
    return CLOSURE.entry(
        closure.type,
        closure.stated(),
        name=closure.name,
        frames=(anchors.reference(closure.a), anchors.reference(closure.b)),
        compliance=ComplianceEntry(linear=linear, angular=angular) if linear or angular else None,
    )


class _Anchors:
    """How the frames of closures are written: by name where the name means that frame, else as poses on links."""

    def __init__(self, mechanism: Mechanism) -> None:
        self.named = {frame.name: (frame.body, frame.pose) for frame in mechanism.frames}
        for joint in mechanism.joints:
            if joint.offset == IDENTITY or joint.type.is_fixed:
                self.named[joint.name] = joint.child, IDENTITY
        bodies = {body.name for body in mechanism.bodies}
        for name in bodies:
            both = name in self.named and self.named[name] != (name, IDENTITY)
            # A name that means two frames is an error (EU-FRM-002).
            self.named[name] = ("", IDENTITY) if both else (name, IDENTITY)

    def reference(self, anchor: Anchor) -> FrameReference:
        if anchor.frame and self.named.get(anchor.frame) == (anchor.body, anchor.pose):
            return NamedFrame(target=anchor.frame)
        return PoseOnLink(link=anchor.body, xyz=anchor.pose.xyz, rpy=rpy_of(anchor.pose))


def _place_own_data(content: dict[str, Any], mechanism: Mechanism) -> None:
    """Put the user data where they were, as far as their place exists."""
    left: dict[str, object] = {}
    for pointer, value in mechanism.own_data.items():
        *keys, last = (key.replace("~1", "/").replace("~0", "~") for key in pointer.removeprefix("/").split("/"))
        if mechanism.version == "1" and not is_own_key(last):
            last = f"x-{last}"
        place: Any = content
        for key in keys:
            place = _inside(place, key)
        if isinstance(place, dict) and last not in place:
            place[last] = value
        else:
            left[pointer] = value
    if left:
        content["x-own-data"] = left


def _inside(place: Any, key: str) -> Any:
    """What is at a key or an index; an actuator or a joint that is a name alone becomes a mapping."""
    if isinstance(place, dict):
        value = place.get(key)
        if isinstance(value, str) and value in NAMED:
            place[key] = value = {"type": value}
        return value
    if isinstance(place, list) and key.isdigit() and int(key) < len(place):
        value = place[int(key)]
        if isinstance(value, str):
            place[int(key)] = value = {"joint": value}
        return value
    return None
