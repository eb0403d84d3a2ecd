"""URDF with ``<loop_joint>``, as Isaac Sim's exporter of URDF writes loops.

Isaac's types of a loop joint are ``fixed``, ``spherical``, ``revolute`` and ``prismatic``; ``link1`` and ``link2``
state the pose of the joint in two links. Isaac writes no axis: that of USD is x unless it is stated. So the x axes of
both poses are the axis here, and ``<axis>`` states it.
"""

from __future__ import annotations

import math

from lxml import etree

from eurdf.closures.hinge import HingeClosure
from eurdf.exporting.urdf_tree import PLAIN_LOSSES, PlainTree
from eurdf.exporting.written import Exportable, Format, Written
from eurdf.loss import Effect, Losses, LossKind
from eurdf.mechanism.constraint import Closure
from eurdf.mechanism.pose import Pose, Quaternion, Vector3, direction
from eurdf.writing.angles import rpy_of
from eurdf.writing.names import UniqueNames
from eurdf.writing.xml_text import file_content, numbers

#: The type of a loop joint, by that of the closure.
_TYPES = {"3d": "spherical", "6d": "fixed", "hinge": "revolute"}

_X: Vector3 = (1.0, 0.0, 0.0)

LOSSES = (
    LossKind(
        "export-distance-dropped",
        "distance closure",
        Effect.DROPPED,
        "is left out: there is no such loop joint",
        "describe the rod as a link, with a joint at each end",
    ),
    *PLAIN_LOSSES,
)


def write(given: Exportable) -> Written:
    """Write the URDF of a robot with loop joints: ``robot.urdf``, and its meshes in ``meshes/``."""
    mechanism, losses = given.mechanism, Losses(LOSSES)
    tree = PlainTree(given, losses)
    tree.write()
    names = UniqueNames(losses, *(name for names in tree.joints.values() for name in names))
    for closure in mechanism.closures:
        if closure.type in _TYPES:
            _loop_joint(tree.root, closure, names.new(closure.name))
        else:
            losses.add("export-distance-dropped", closure.name)
    for coupling in mechanism.couplings:
        losses.add("export-coupling-dropped", coupling.name)
    return Written({"robot.urdf": file_content(tree.root), **tree.meshes.files}, losses.found, tree.coordinates)


def _loop_joint(robot: etree._Element, closure: Closure, name: str) -> None:
    element = etree.SubElement(robot, "loop_joint", name=name, type=_TYPES[closure.type])
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


FORMAT = Format("loop-joint", "URDF with the loop joints of Isaac Sim", write, LOSSES)
