"""The tree that the joints of a URDF make of its links."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from typing import TypeVar

from eurdf.diagnostics import quoted
from eurdf.format.urdf.data import Urdf, UrdfJoint, UrdfLink
from eurdf.format.urdf.elements import UrdfReader
from eurdf.format.urdf.mimics import check_mimics, cycle_of
from eurdf.reading.other_formats import of_element

_Named = TypeVar("_Named", UrdfLink, UrdfJoint)


def build_tree(reader: UrdfReader, name: str, links: Sequence[UrdfLink], joints: Sequence[UrdfJoint]) -> Urdf | None:
    """The tree of links and joints in file order; None if an error was found.

    What follows from an error is not checked.
    """
    diagnostics, document = reader.reporter.diagnostics, reader.reporter.document
    before = diagnostics.error_count
    link_by_name, joint_by_name = _by_name(reader, "link", links), _by_name(reader, "joint", joints)
    if not links:  # EU-URD-015
        reader.report("urdf-no-link", f"robot '{name}' has no link", document.root)
    _check_links_of_joints(reader, joints, link_by_name)
    if diagnostics.error_count > before:
        return None
    check_mimics(reader, joint_by_name)
    parent_joint = _parent_joints(reader, joints)
    if diagnostics.error_count > before:
        return None
    children: dict[str, list[UrdfJoint]] = {}
    for joint in joints:
        children.setdefault(joint.parent, []).append(joint)
    for siblings in children.values():
        if len(siblings) > 1:
            siblings.sort(key=lambda joint: joint.name)
    ordered = {link: tuple(siblings) for link, siblings in children.items()}
    roots = [link for link in links if link.name not in parent_joint]
    urdf = Urdf(document, name, link_by_name, joint_by_name, roots[0].name if roots else "", ordered)
    return urdf if _is_acyclic(reader, urdf, roots, parent_joint) and _has_one_root(reader, roots) else None


def _by_name(reader: UrdfReader, tag: str, items: Sequence[_Named]) -> dict[str, _Named]:
    """EU-URD-009, EU-URD-010: the names of links are unique, and those of joints."""
    by_name: dict[str, _Named] = {}
    for item in items:
        if item.name in by_name:
            reader.report(f"urdf-duplicate-{tag}", f"two {tag}s are named '{item.name}'", item.element, "name")
        by_name[item.name] = item
    return by_name


def _check_links_of_joints(reader: UrdfReader, joints: Sequence[UrdfJoint], links: Mapping[str, UrdfLink]) -> None:
    """EU-URD-014: the links that a joint names exist."""
    for joint in joints:
        if joint.parent in links and joint.child in links:
            continue
        for tag, name in (("parent", joint.parent), ("child", joint.child)):
            if name not in links:
                reader.reporter.report_name(
                    "urdf-unknown-link",
                    f"the {tag} link '{name}' of joint '{joint.name}' does not exist",
                    next(joint.element.iterchildren(tag)),
                    "link",
                    links,
                    joint.name,
                )


def _parent_joints(reader: UrdfReader, joints: Sequence[UrdfJoint]) -> dict[str, UrdfJoint]:
    """EU-URD-016: for each link except the root, the joint that carries it; there is only one."""
    parent_joint: dict[str, UrdfJoint] = {}
    for joint in joints:
        if joint.child in parent_joint:
            other = parent_joint[joint.child].name
            reader.report(
                "urdf-two-parents",
                f"link '{joint.child}' is the child of two joints, '{other}' and '{joint.name}'",
                next(joint.element.iterchildren("child")),
                "link",
                partial(_one_parent, joints, (parent_joint[joint.child], joint)),
            )
        parent_joint[joint.child] = joint
    return parent_joint


def _one_parent(joints: Sequence[UrdfJoint], carriers: Sequence[UrdfJoint]) -> str:
    """The hint on a link with two parents: whether one joint has it as its child by mistake, else how to write a loop.

    The parent of a joint with parent and child exchanged is a root, and not the one that carries the most.
    """
    below: dict[str, list[str]] = {}
    for joint in joints:
        below.setdefault(joint.parent, []).append(joint.child)
    roots = below.keys() - {joint.child for joint in joints}
    exchanged = [joint for joint in carriers if joint.parent in roots]
    if len(roots) < 2 or not exchanged:
        return "keep one of the joints, and describe the other under 'closures' in the YAML file"

    def carried(joint: UrdfJoint) -> int:
        reached = {joint.parent: None}
        stack = [joint.parent]
        while stack:
            new = [link for link in below.get(stack.pop(), ()) if link not in reached]
            reached.update(dict.fromkeys(new))
            stack += new
        return len(reached)

    return f"are parent and child of joint '{min(exchanged, key=carried).name}' exchanged?"


def _is_acyclic(
    reader: UrdfReader, urdf: Urdf, roots: Sequence[UrdfLink], parent_joint: Mapping[str, UrdfJoint]
) -> bool:
    """EU-URD-017: no joints form a cycle; every link hangs from a root."""
    reached = {link.name for link in roots}
    stack = list(reached)
    while stack:
        for joint in urdf.children.get(stack.pop(), ()):
            reached.add(joint.child)
            stack.append(joint.child)
    lost = next((name for name in urdf.links if name not in reached), None)
    if lost is None:
        return True
    # Walking up from a link that no root reaches must enter a cycle.
    path: dict[str, None] = {}
    while lost not in path:
        path[lost] = None
        lost = parent_joint[lost].parent
    walked = list(path)
    cycle = walked[walked.index(lost) :][::-1]
    # The last one in the file: the joint that closed the cycle was probably written last.
    order = {name: index for index, name in enumerate(urdf.joints)}
    last = max((parent_joint[link] for link in cycle), key=lambda joint: order[joint.name])
    reader.report(
        "urdf-cycle",
        "links form a cycle: " + cycle_of(cycle),
        last.element,
        hint="remove one joint of the cycle, and describe it under 'closures' in the YAML file",
    )
    return False


def _has_one_root(reader: UrdfReader, roots: Sequence[UrdfLink]) -> bool:
    """EU-URD-018: one link has no parent."""
    if len(roots) == 1:
        return True
    names = quoted([link.name for link in roots], 5)
    joints = [child for child in reader.reporter.document.root if str(child.tag).endswith("}joint")]
    other = next(filter(None, map(of_element, joints)), None)  # the joints that are missed are of this dialect
    reader.report(
        "urdf-two-roots",
        f"{len(roots)} links have no parent: {names}; a robot has one root",
        roots[1].element,
        "name",
        other.hint if other else "connect them with a joint",
    )
    return False
