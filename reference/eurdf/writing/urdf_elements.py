"""The elements of a URDF, from the parts of a mechanism. Numbers are read back to the last bit."""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from types import MappingProxyType

from lxml import etree

from eurdf.mechanism.body import Inertia, Shape
from eurdf.mechanism.joint import Mimic
from eurdf.mechanism.joint_types import JointType
from eurdf.mechanism.pose import IDENTITY, Pose, Vector3
from eurdf.writing.xml_text import numbers, representable, rpy_of

Color = tuple[float, float, float, float]

NO_MATERIALS: Mapping[Color, str] = MappingProxyType({})

#: What is written where there is no limit, but the file wants a number (EU-FIL-006): rad, m, their rates, N·m or N.
UNLIMITED = sys.float_info.max

#: Attributes of `limit` from version 1.2 on.
_RATES = frozenset({"acceleration", "deceleration", "jerk"})

_MOMENTS = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")


def add_inertial(link: etree._Element, inertia: Inertia) -> None:
    """Add the inertia of a link."""
    inertial = etree.SubElement(link, "inertial")
    add_origin(inertial, inertia.pose)
    etree.SubElement(inertial, "mass", value=numbers((inertia.mass,)))
    moments = {name: numbers((value,)) for name, value in zip(_MOMENTS, inertia.moments, strict=True)}
    etree.SubElement(inertial, "inertia", moments)


def add_material(robot: etree._Element, name: str, color: Color) -> None:
    """Declare a material, for shapes to use by its name."""
    material = etree.SubElement(robot, "material", name=representable(name))
    etree.SubElement(material, "color", rgba=numbers(color))


def add_shape(
    link: etree._Element,
    use: str,
    shape: Shape,
    filename: str = "",
    texture: str = "",
    materials: Mapping[Color, str] = NO_MATERIALS,
) -> None:
    """Add a shape as ``visual`` or ``collision``, the former with its color and texture, empty for none.

    Materials that the robot declares are used by their name.
    """
    element = etree.SubElement(link, use)
    add_origin(element, shape.pose)
    geometry = etree.SubElement(element, "geometry")
    size = shape.size
    match shape.kind:
        case "box":
            etree.SubElement(geometry, "box", size=numbers(size))
        case "cylinder" | "capsule":
            etree.SubElement(geometry, shape.kind, radius=numbers(size[:1]), length=numbers(size[1:]))
        case "sphere":
            etree.SubElement(geometry, "sphere", radius=numbers(size))
        case "mesh":
            etree.SubElement(geometry, "mesh", filename=representable(filename), scale=numbers(size))
    if use != "visual":
        return
    if shape.color is not None and shape.color in materials and not texture:
        etree.SubElement(element, "material", name=representable(materials[shape.color]))
    elif shape.color is not None or texture:
        color = "" if shape.color is None else f"color {numbers(shape.color)}"
        material = etree.SubElement(element, "material", name=representable(f"{color} {texture}".strip()))
        if shape.color is not None:
            etree.SubElement(material, "color", rgba=numbers(shape.color))
        if texture:
            etree.SubElement(material, "texture", filename=representable(texture))


def add_joint(
    robot: etree._Element, name: str, kind: JointType, parent: str, child: str, placement: Pose, axis: Vector3 | None
) -> etree._Element:
    """Add a joint of a type that URDF has; returns its element."""
    element = etree.SubElement(robot, "joint", name=name, type=str(kind))
    add_origin(element, placement)
    etree.SubElement(element, "parent", link=parent)
    etree.SubElement(element, "child", link=child)
    if axis is not None:
        etree.SubElement(element, "axis", xyz=numbers(axis))
    return element


def add_fixed_joint(robot: etree._Element, name: str, parent: str, child: str, placement: Pose) -> None:
    """Add a joint that does not move."""
    add_joint(robot, name, JointType("fixed"), parent, child, placement, None)


def add_limit(
    joint: etree._Element,
    position: tuple[float, float] | None,
    effort: float,
    velocity: float,
    rates: Mapping[str, float],
) -> None:
    """Add the limits of a joint, which may be infinite: position (rad or m) unless continuous, effort, velocity.

    ``rates`` are finite limits of acceleration, deceleration and jerk, by the name of their attribute.
    """
    limit = {}
    if position is not None:
        lower, upper = (min(max(each, -UNLIMITED), UNLIMITED) for each in position)
        limit = {"lower": numbers((lower,)), "upper": numbers((upper,))}
    limit["effort"], limit["velocity"] = (numbers((min(each, UNLIMITED),)) for each in (effort, velocity))
    limit |= {name: numbers((value,)) for name, value in rates.items()}
    etree.SubElement(joint, "limit", limit)


def state_version(robot: etree._Element) -> None:
    """State the lowest version of URDF that has what the robot has; none for 1.0, which most programs read.

    From version 1.2 on, limits of effort and velocity that do not limit are left out.
    """
    if any(_RATES.intersection(map(str, limit.keys())) for limit in robot.iter("limit")):
        robot.set("version", "1.2")
        for limit in robot.iter("limit"):
            for name in ("effort", "velocity"):
                if float(limit.get(name, "0")) >= UNLIMITED:
                    del limit.attrib[name]
    elif next(robot.iter("capsule"), None) is not None:
        robot.set("version", "1.1")


def add_dynamics(joint: etree._Element, damping: float, friction: float) -> None:
    """Add the losses of a joint, unless there are none."""
    if damping or friction:
        etree.SubElement(joint, "dynamics", damping=numbers((damping,)), friction=numbers((friction,)))


def add_mimic(joint: etree._Element, mimic: Mimic) -> None:
    """Add the leader of a joint."""
    ratio = {"multiplier": numbers((mimic.multiplier,)), "offset": numbers((mimic.offset,))}
    etree.SubElement(joint, "mimic", {"joint": mimic.joint, **ratio})


def add_origin(element: etree._Element, pose: Pose) -> None:
    """Add the pose of a joint, a shape or an inertia, unless it is the identity."""
    if pose == IDENTITY:
        return
    rpy: Sequence[float] = rpy_of(pose)
    attributes = {"xyz": numbers(pose.xyz)} | ({"rpy": numbers(rpy)} if any(rpy) else {})
    etree.SubElement(element, "origin", attributes)
