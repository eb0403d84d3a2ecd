"""URDF with ``<loop_joint>``, as Isaac Sim's exporter of URDF writes loops.

Isaac's types of a loop joint are ``fixed``, ``spherical``, ``revolute`` and ``prismatic``; ``link1`` and ``link2``
state the pose of the joint in two links. Isaac writes no axis: that of USD is x unless it is stated. So the x axes of
both poses are the axis here, and ``<axis>`` states it.
"""

from __future__ import annotations

import math

from lxml import etree

from eurdf.convert.export_format import ExportInput, ExportOutput, Format
from eurdf.convert.loop_joint.facts import CLOSURES, EXACT, ROWS
from eurdf.convert.losses import Losses
from eurdf.convert.names import UniqueNames
from eurdf.convert.urdf.tree import PlainTree
from eurdf.mechanism.constraint import Closure, HingeClosure
from eurdf.mechanism.pose import Pose, Quaternion, Vector3, direction
from eurdf.writing.xml_text import file_content, numbers, rpy_of

_X: Vector3 = (1.0, 0.0, 0.0)


def write(given: ExportInput, losses: Losses) -> ExportOutput:
    """Write the URDF of a robot with loop joints: ``robot.urdf``, and its meshes in ``meshes/``."""
    mechanism = given.mechanism
    tree = PlainTree(given, losses)
    tree.write()
    names = UniqueNames(losses, *(name for names in tree.joints.values() for name in names))
    for closure in mechanism.closures:
        if closure.type in CLOSURES:
            _loop_joint(tree.root, closure, names.new(closure.name))
    return ExportOutput({"robot.urdf": file_content(tree.root), **tree.meshes.files}, tree.coordinates)


def _loop_joint(robot: etree._Element, closure: Closure, name: str) -> None:
    element = etree.SubElement(robot, "loop_joint", name=name, type=CLOSURES[closure.type])
    axes = closure.axes if isinstance(closure, HingeClosure) else (_X, _X)
    for tag, end, axis in zip(("link1", "link2"), closure.anchors, axes, strict=True):
        pose = end.pose * Pose(quaternion=from_x(axis))
        etree.SubElement(element, tag, link=end.body, xyz=numbers(pose.xyz), rpy=numbers(rpy_of(pose)))
    if isinstance(closure, HingeClosure):
        etree.SubElement(element, "axis", xyz=numbers(_X))


def from_x(axis: Vector3) -> Quaternion:
    """The shortest rotation that takes x to an axis; the half turn about z where the axis is opposite."""
    x, y, z = direction(axis)
    cosine = 1.0 + x if x > 0.0 else (y * y + z * z) / (1.0 - x)  # 1 + x, without cancellation
    norm = math.hypot(cosine, y, z)
    if norm == 0.0:
        return 0.0, 0.0, 1.0, 0.0
    return 0.0, -z / norm, y / norm, cosine / norm


FORMAT = Format("loop-joint", "URDF with the loop joints of Isaac Sim", write, ROWS, EXACT)
