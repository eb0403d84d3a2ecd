"""The URDF of a mechanism."""

from __future__ import annotations

from collections.abc import Iterable
from xml.etree import ElementTree

from eurdf_conformance.properties.mechanism import Inertia, Joint, Link, Mechanism, Pose

_MOMENTS = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")


def urdf_text(mechanism: Mechanism, *, backwards: bool = False) -> str:
    """The text of the URDF.

    Args:
        mechanism: The mechanism; of its links and joints the order is kept.
        backwards: Whether joints come before links, and the content of an element in reversed order.
    """
    robot = ElementTree.Element("robot", {"name": mechanism.name})
    parts = [[_link(link) for link in mechanism.links], [_joint(joint) for joint in mechanism.joints]]
    for elements in reversed(parts) if backwards else parts:
        robot.extend(elements)
    if backwards:
        for element in robot:
            _reverse(element)
    ElementTree.indent(robot)
    return '<?xml version="1.0"?>\n' + ElementTree.tostring(robot, encoding="unicode") + "\n"


def _reverse(element: ElementTree.Element) -> None:
    element[:] = list(reversed(element))
    attributes = list(reversed(element.attrib.items()))
    element.attrib.clear()
    element.attrib.update(attributes)
    for child in element:
        _reverse(child)


def _link(link: Link) -> ElementTree.Element:
    element = ElementTree.Element("link", {"name": link.name})
    if link.inertia is not None:
        element.append(_inertial(link.inertia))
    return element


def _inertial(inertia: Inertia) -> ElementTree.Element:
    element = ElementTree.Element("inertial")
    _origin(element, inertia.pose)
    ElementTree.SubElement(element, "mass", {"value": repr(inertia.mass)})
    moments = {name: repr(value) for name, value in zip(_MOMENTS, inertia.moments, strict=True)}
    ElementTree.SubElement(element, "inertia", moments)
    return element


def _joint(joint: Joint) -> ElementTree.Element:
    element = ElementTree.Element("joint", {"name": joint.name, "type": joint.type})
    _origin(element, joint.origin)
    ElementTree.SubElement(element, "parent", {"link": joint.parent})
    ElementTree.SubElement(element, "child", {"link": joint.child})
    if joint.axis is not None:
        ElementTree.SubElement(element, "axis", {"xyz": _numbers(joint.axis)})
    if (limit := joint.limit) is not None:
        _numbered(element, "limit", lower=limit.lower, upper=limit.upper, effort=limit.effort, velocity=limit.velocity)
    if joint.damping is not None or joint.friction is not None:
        _numbered(element, "dynamics", damping=joint.damping, friction=joint.friction)
    if (mimic := joint.mimic) is not None:
        _numbered(element, "mimic", multiplier=mimic.multiplier, offset=mimic.offset).set("joint", mimic.joint)
    return element


def _origin(element: ElementTree.Element, pose: Pose) -> None:
    """The `origin` element, without zeros."""
    attributes = {key: _numbers(value) for key, value in (("xyz", pose.xyz), ("rpy", pose.rpy)) if any(value)}
    if attributes:
        ElementTree.SubElement(element, "origin", attributes)


def _numbered(element: ElementTree.Element, tag: str, **numbers: float | None) -> ElementTree.Element:
    attributes = {key: repr(value) for key, value in numbers.items() if value is not None}
    return ElementTree.SubElement(element, tag, attributes)


def _numbers(values: Iterable[float]) -> str:
    return " ".join(map(repr, values))
