"""URDF with ``<loop_joint>``, as Isaac Sim's exporter of URDF writes loops.

Isaac's types of a loop joint are ``fixed``, ``spherical``, ``revolute`` and ``prismatic``; ``link1`` and ``link2``
state the pose of the joint in two links. Isaac writes no axis: that of USD is x unless it is stated. So the x axes of
both poses are the axis here, and ``<axis>`` states it.
"""

from __future__ import annotations

from lxml import etree

from eurdf.closures.hinge import HingeClosure
from eurdf.convert.export_format import ExportInput, ExportOutput, Format
from eurdf.convert.losses import Losses, dropped
from eurdf.convert.names import UniqueNames
from eurdf.convert.urdf.facts import EXACT, PLAIN_ROWS
from eurdf.convert.urdf.write import PlainTree
from eurdf.mechanism.constraint import Closure
from eurdf.mechanism.pose import Pose, X, turn_from_x
from eurdf.writing.xml_text import numbers, rpy_of

#: The type of the loop joint that a closure is.
CLOSURES = {"3d": "spherical", "6d": "fixed", "hinge": "revolute"}

ROWS = (
    dropped(
        "distance closure",
        "is left out: there is no such loop joint",
        "describe the rod as a link, with a joint at each end",
        code="export-distance-dropped",
    ),
    *PLAIN_ROWS,
)


def write(given: ExportInput, losses: Losses) -> ExportOutput:
    """Write the URDF of a robot with loop joints: ``robot.urdf``, and its meshes in ``meshes/``."""
    tree = PlainTree(given, losses)
    tree.write()
    names = UniqueNames(losses, *(name for names in tree.joints.values() for name in names))
    for closure in given.mechanism.closures:
        if closure.type in CLOSURES:
            _loop_joint(tree.root, closure, names.new(closure.name))
    return tree.output()


def _loop_joint(robot: etree._Element, closure: Closure, name: str) -> None:
    element = etree.SubElement(robot, "loop_joint", name=name, type=CLOSURES[closure.type])
    axes = closure.axes if isinstance(closure, HingeClosure) else (X, X)
    for tag, end, axis in zip(("link1", "link2"), closure.anchors, axes, strict=True):
        pose = end.pose * Pose(quaternion=turn_from_x(axis))
        etree.SubElement(element, tag, link=end.body, xyz=numbers(pose.xyz), rpy=numbers(rpy_of(pose)))
    if isinstance(closure, HingeClosure):
        etree.SubElement(element, "axis", xyz=numbers(X))


FORMAT = Format(write, ROWS, (*EXACT, *(f"{kind} closure" for kind in CLOSURES)))
