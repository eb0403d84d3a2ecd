"""A drawing as the text of a URDF."""

from __future__ import annotations

import numpy as np
from lxml import etree

from robots.builder.drawing import Body, Drawing
from robots.builder.joint import PASSIVE, WORLD, Joint
from robots.builder.number_text import length_text, mass_text, number_text
from robots.builder.shape import Box, Cylinder, Matrix3, Shape, Vector3, rotation_of, rpy_of
from robots.builder.solid import solid_of

_HEAD = '<?xml version="1.0" encoding="UTF-8"?>\n<!-- Written by build.py beside this file: change it there. -->\n'


def urdf_text(drawing: Drawing) -> str:
    """The spanning tree as a URDF: each joint just before the link it carries, the frames of closures last."""
    robot = etree.Element("robot", name=drawing.name)
    for name, color in drawing.materials.items():
        material = etree.SubElement(robot, "material", name=name)
        etree.SubElement(material, "color", rgba=" ".join(map(number_text, color)))
    for body in drawing.bodies.values():
        if body.joint:
            _write_joint(robot, body.joint, body.name, drawing.bodies[body.joint.parent])
        _write_link(robot, body)
    for closure in drawing.closures:
        for frame, body_name, at in zip(closure.frames, closure.bodies, closure.points, strict=True):
            joint = etree.SubElement(robot, "joint", name=f"weld_{frame}", type="fixed")
            body = drawing.bodies[body_name]
            _write_origin(joint, at, rpy_of(body.rotation.T), body)
            etree.SubElement(joint, "parent", link=body_name)
            etree.SubElement(joint, "child", link=frame)
            etree.SubElement(robot, "link", name=frame)
    etree.indent(robot)
    return _HEAD + etree.tostring(robot, encoding="unicode") + "\n"


def _write_joint(robot: etree._Element, joint: Joint, child: str, parent: Body) -> None:
    kind = "prismatic" if joint.type == "prismatic" else "revolute" if joint.stops else "continuous"
    element = etree.SubElement(robot, "joint", name=joint.name, type=kind)
    _write_origin(element, joint.at, rpy_of(parent.rotation.T @ joint.rotation), parent)
    etree.SubElement(element, "parent", link=joint.parent)
    etree.SubElement(element, "child", link=child)
    etree.SubElement(element, "axis", xyz=length_text(joint.rotation.T @ joint.axis))
    if joint.stops or joint.motor:
        motor = joint.motor or PASSIVE
        limit = etree.SubElement(element, "limit")
        if joint.stops:
            limit.set("lower", number_text(joint.stops[0]))
            limit.set("upper", number_text(joint.stops[1]))
        limit.set("effort", number_text(motor.effort))
        limit.set("velocity", number_text(motor.velocity))
    if joint.damping or joint.friction:
        dynamics = etree.SubElement(element, "dynamics")
        dynamics.set("damping", number_text(joint.damping))
        dynamics.set("friction", number_text(joint.friction))


def _write_link(robot: etree._Element, body: Body) -> None:
    link = etree.SubElement(robot, "link", name=body.name)
    solid = body.solid or (solid_of(body.shapes) if body.shapes else None)
    if solid:
        inertial = etree.SubElement(link, "inertial")
        # The moments are about the body's own axes, so that the inertial frame need not be turned.
        _write_origin(inertial, solid.center, (0.0, 0.0, 0.0), body)
        etree.SubElement(inertial, "mass", value=mass_text(solid.mass))
        etree.SubElement(inertial, "inertia", attrib=_moments(body.rotation.T @ solid.inertia @ body.rotation))
    for shape in body.shapes:
        visual = _write_shape(link, "visual", shape, body)
        etree.SubElement(visual, "material", name=body.material)
    for shape in body.contacts:
        _write_shape(link, "collision", shape, body)


def _write_origin(element: etree._Element, at: Vector3, rpy: Vector3, parent: Body) -> None:
    """The pose of a frame in its parent: given are its position in the world (m) and its turn in the parent (rad)."""
    xyz = length_text(parent.rotation.T @ np.subtract(at, parent.origin))
    turn = length_text(rpy)
    attributes = {key: text for key, text in (("xyz", xyz), ("rpy", turn)) if text != "0 0 0"}
    if attributes:
        etree.SubElement(element, "origin", attrib=attributes)


def _write_shape(link: etree._Element, purpose: str, shape: Shape, body: Body) -> etree._Element:
    element = etree.SubElement(link, purpose)
    turned = body.joint is not None and body.joint.axes != WORLD
    rpy = rpy_of(body.rotation.T @ rotation_of(shape.rpy)) if turned else shape.rpy
    _write_origin(element, shape.center, rpy, body)
    geometry = etree.SubElement(element, "geometry")
    if isinstance(shape, Box):
        etree.SubElement(geometry, "box", size=length_text(shape.size))
    elif isinstance(shape, Cylinder):
        etree.SubElement(geometry, "cylinder", radius=length_text([shape.radius]), length=length_text([shape.length]))
    else:
        etree.SubElement(geometry, "sphere", radius=length_text([shape.radius]))
    return element


def _moments(inertia: Matrix3) -> dict[str, str]:
    """The six moments; what is nothing but rounding beside the largest is zero."""
    noise = 1e-12 * float(inertia.max())
    moments = {}
    for row, column in ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)):
        value = float(inertia[row, column])
        moments[f"i{'xyz'[row]}{'xyz'[column]}"] = mass_text(value if abs(value) > noise else 0.0)
    return moments
