"""URDF with ``<loop_joint>``, the element of Isaac Sim for closed loops.

``link1`` and ``link2`` state the pose of the loop joint in two links; the documentation of Isaac also has two
``link1``. Isaac writes no axis, though USD has one, x, y or z of both poses. Others write ``<axis>``, in both poses.
"""

from __future__ import annotations

from dataclasses import replace

from lxml import etree

from eurdf.closures.frame import FrameClosure
from eurdf.closures.hinge import HingeClosure
from eurdf.closures.point import PointClosure
from eurdf.convert.import_format import ImportFormat, ImportInput, RobotRead, loss_kinds
from eurdf.convert.losses import approximate
from eurdf.convert.names import UniqueNames
from eurdf.convert.urdf.read import URDF_LOSSES, UrdfDialect, loop_left_out, read_tree
from eurdf.convert.xml_elements import named
from eurdf.mechanism.body import Anchor, Frame
from eurdf.mechanism.constraint import Closure

_LOSSES = {
    "loop": loop_left_out("loop joint"),
    "loop-axis": approximate(
        "loop joint",
        "is revolute and has no axis: the only axis is taken about which the rest of the mechanism lets it turn",
        'compare it with physics:axis of the joint in USD, and add <axis xyz="…"/>',
        error="none, if it is that of the original",
    ),
    **URDF_LOSSES,
}


def read(given: ImportInput) -> RobotRead:
    """Read a URDF with loop joints.

    Raises:
        CannotImport: It has an error.
    """
    tree = read_tree(given, ("loop_joint", "fixed_frame"))
    names = UniqueNames(tree.losses)
    closures, without_axis = [], []
    for element in tree.root.iterchildren("loop_joint"):
        closure = _closure(element, tree, names)
        if closure is not None:
            closures.append(closure)
            if isinstance(closure, HingeClosure) and element.find("axis") is None:
                without_axis.append(closure.name)
    mechanism = replace(tree.mechanism, closures=tuple(closures), frames=_frames(tree))
    return RobotRead(mechanism, (given.path,), without_axis=tuple(without_axis))


def _closure(element: etree._Element, tree: UrdfDialect, names: UniqueNames) -> Closure | None:
    elements = tree.elements
    ends = [child for child in element if child.tag in ("link1", "link2")]
    if len(ends) != 2:
        raise elements.refuse(
            element, f"{named(element)} has {len(ends)} elements <link1> and <link2>; it must have two"
        )
    a, b = (Anchor(tree.link(end, end.get("link")), elements.pose(end)) for end in ends)
    name = names.new(element.get("name") or f"{a.body}_{b.body}")
    match element.get("type"):
        case None:
            raise elements.refuse(element, f"{named(element)} has no type; state spherical, fixed or revolute")
        case "spherical" | "ball":
            return PointClosure(name, a, b)
        case "fixed":
            return FrameClosure(name, a, b)
        case "revolute" | "continuous":
            axis = element.find("axis")
            if axis is None:
                return HingeClosure(name, a, b, ((0.0, 0.0, 1.0),) * 2)
            xyz = elements.axis(axis)
            return HingeClosure(name, a, b, (xyz, xyz))
    tree.losses.add("import-loop", name, f"is left out: it has the type '{element.get('type')}'")
    return None


def _frames(tree: UrdfDialect) -> tuple[Frame, ...]:
    """The frames that Isaac calls fixed."""
    names, found = tree.frame_names(), []
    for element in tree.root.iterchildren("fixed_frame"):
        parent = tree.elements.child(element, "parent")
        body = tree.link(element, parent.get("link"))
        name = names.new(element.get("name") or f"{body}_frame")
        found.append(Frame(name, body, tree.elements.pose(element.find("origin"))))
    return tuple(found)


FORMAT = ImportFormat(read, loss_kinds(_LOSSES))
