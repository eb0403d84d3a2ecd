"""URDF+, as generalized_rbda reads it: ``<loop>`` and ``<coupling>`` beside the spanning tree.

The successor of a loop is held at its predecessor. A coupling states that ratio times the sum of the coordinates of the
joints between the nearest common ancestor and the predecessor is that of the joints to the successor. An older spelling
of a loop is ``<loop_constraint>`` with ``parent``, ``parent_origin``, ``child`` and ``child_origin``.
"""

from __future__ import annotations

from dataclasses import replace

from lxml import etree

from eurdf.closures.frame import FrameClosure
from eurdf.closures.hinge import HingeClosure
from eurdf.closures.point import PointClosure
from eurdf.convert.import_format import ImportFormat, ImportInput, RobotRead, loss_kinds
from eurdf.convert.losses import dropped
from eurdf.convert.names import UniqueNames
from eurdf.convert.urdf.read import URDF_LOSSES, UrdfDialect, loop_left_out, read_tree
from eurdf.convert.xml_elements import named
from eurdf.mechanism.body import Anchor
from eurdf.mechanism.constraint import Closure, Coupling

_LOSSES = {
    "loop": loop_left_out("loop"),
    "independent": dropped(
        "joint", "which coordinates are independent is left out", "name the actuated joints in the description"
    ),
    **URDF_LOSSES,
}


def read(given: ImportInput) -> RobotRead:
    """Read a file of URDF+.

    Raises:
        CannotImport: It has an error.
    """
    tree = read_tree(given, ("loop", "loop_constraint", "coupling"))
    names = UniqueNames(tree.losses)
    closures = [
        closure
        for element in tree.root.iterchildren("loop", "loop_constraint")
        if (closure := _closure(element, tree, names))
    ]
    couplings = tuple(_coupling(element, tree, names) for element in tree.root.iterchildren("coupling"))
    for element in tree.root.iterchildren("joint"):
        if element.get("independent") is not None:
            tree.losses.add("import-independent", tree.mechanism.name)
    mechanism = replace(tree.mechanism, closures=tuple(closures), couplings=couplings)
    return RobotRead(mechanism, (given.path,))


def _closure(element: etree._Element, tree: UrdfDialect, names: UniqueNames) -> Closure | None:
    elements = tree.elements
    ends = []
    for new, old in (("predecessor", "parent"), ("successor", "child")):
        end = elements.child(element, new, old)
        origin = end.find("origin") if end.tag == new else element.find(f"{old}_origin")
        ends.append(Anchor(tree.link(element, end.get("link")), elements.pose(origin)))
    a, b = ends
    name = names.new(element.get("name") or f"{a.body}_{b.body}")
    match element.get("type", "spherical"):
        case "spherical" | "position":
            return PointClosure(name, a, b)
        case "fixed":
            return FrameClosure(name, a, b)
        case "revolute" | "continuous":
            axis = elements.axis(elements.child(element, "axis"))
            return HingeClosure(name, a, b, (axis, axis))
    tree.losses.add("import-loop", name, f"is left out: it has the type '{element.get('type')}'")
    return None


def _coupling(element: etree._Element, tree: UrdfDialect, names: UniqueNames) -> Coupling:
    elements = tree.elements
    chains = [
        _joints_above(tree.link(element, elements.child(element, tag).get("link")), tree)
        for tag in ("predecessor", "successor")
    ]
    ratio = elements.attribute(elements.child(element, "ratio"), "value")
    types = {joint.name: joint.type for joint in tree.mechanism.joints}
    coefficients: dict[str, float] = {}
    for chain, other, factor in ((chains[0], chains[1], ratio), (chains[1], chains[0], -1.0)):
        for joint in chain:
            if joint in other or types[joint].is_fixed:
                continue
            if not types[joint].is_axial:
                raise elements.refuse(element, f"{named(element)} couples joint '{joint}', which is {types[joint]}")
            coefficients[joint] = factor
    if len(coefficients) < 2 or not ratio:
        raise elements.refuse(element, f"{named(element)} relates fewer than two joints")
    return Coupling(names.new(element.get("name") or "_".join(coefficients)), tuple(coefficients.items()))


def _joints_above(link: str, tree: UrdfDialect) -> list[str]:
    """The joints between the root and a link."""
    carrying = {joint.child: joint for joint in tree.mechanism.joints}
    found: list[str] = []
    while link in carrying:
        found.insert(0, carrying[link].name)
        link = carrying[link].parent
    return found


FORMAT = ImportFormat(read, loss_kinds(_LOSSES))
