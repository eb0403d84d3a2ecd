"""The spanning tree: the URDF with the changes of the description, as joints and bodies.

Body i is what joint i carries, and its frame is the joint's on the child's side. Joint 0 is the root's, fixed or
floating; every other hangs from a body before it. Links are placed on bodies: those that fixed or locked joints hold
together are on one, EU-INR-005.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from eurdf_conformance.oracle.description import Change, Description, FrameReference
from eurdf_conformance.oracle.joint_kind import KINDS, JointKind
from eurdf_conformance.oracle.merging import ball, chain
from eurdf_conformance.oracle.not_read import NotRead
from eurdf_conformance.oracle.spatial import Array
from eurdf_conformance.oracle.urdf import Mimic, Urdf, UrdfJoint

#: Names of joint 0 of a floating and of a fixed root. No other joint has them, EU-URD-011.
ROOT_JOINT = {"floating": "root_joint", "fixed": "universe"}


@dataclass(frozen=True)
class Joint:
    """A joint of the tree."""

    name: str
    type: str
    #: Index of the parent body; for joint 0 it is 0.
    parent: int
    #: Pose of the joint's frame in that body's.
    placement: Array
    #: Unit vectors in the joint's frame, one a row.
    axes: Array
    pitch: float = 0.0
    mimic: Mimic | None = None
    #: Joints of the URDF that it comes from: none for the root joint, three if merged, else one.
    source: tuple[UrdfJoint, ...] = ()
    change: Change = field(default_factory=Change)

    @property
    def kind(self) -> JointKind:
        """Its type in the table of types."""
        return KINDS[self.type]


@dataclass(frozen=True)
class Placed:
    """A frame on a body."""

    body: int
    #: In the body's frame.
    pose: Array

    def __matmul__(self, M: Array) -> Placed:
        """The frame at a pose in this one."""
        return Placed(self.body, self.pose @ M)


@dataclass(frozen=True)
class Tree:
    """Joints, and the frames on their bodies."""

    joints: list[Joint]
    links: dict[str, Placed]
    #: Frames by the name of a joint, but for the root's: of the link that it carries, EU-FRM-005.
    joint_frames: dict[str, Placed]
    #: Frames that the description adds.
    added: dict[str, Placed]

    def frame(self, name: str) -> Placed:
        """The frame with a name, EU-FRM-001 and 002."""
        found = [frames[name] for frames in (self.links, self.joint_frames, self.added) if name in frames]
        if not found:
            raise NotRead(f"no frame {name!r}")
        if any(other.body != found[0].body or np.any(other.pose != found[0].pose) for other in found):
            raise NotRead(f"{name!r} is two frames")
        return found[0]

    def refer(self, reference: FrameReference) -> Placed:
        """The frame of a reference."""
        if reference.on == "name":
            return self.frame(reference.name)
        frames = self.links if reference.on == "link" else self.joint_frames
        if reference.name not in frames:
            raise NotRead(f"no {reference.on} {reference.name!r}")
        return frames[reference.name] @ reference.pose


def build(urdf: Urdf, description: Description) -> Tree:
    """The tree of a URDF, with the changes of the description."""
    merged = [name for change in description.changes.values() for name in change.merges]
    changed = [*merged, *(name for name, change in description.changes.items() if not change.merges)]
    if len(set(changed)) < len(changed) or not urdf.joints.keys() >= set(changed):
        raise NotRead(f"{changed} are not joints of the URDF, each once")
    root = Joint(ROOT_JOINT[description.root], description.root, 0, np.eye(4), np.zeros((0, 3)))
    tree = Tree([root], {urdf.root: Placed(0, np.eye(4))}, {}, {})
    last = {change.merges[-1]: name for name, change in description.changes.items() if change.merges}
    waiting = urdf.below(urdf.root)[::-1]
    while waiting:
        joint = waiting.pop()
        if joint.name in last:
            add_ball(tree, urdf, last[joint.name], description.changes[last[joint.name]])
        elif joint.name in merged:
            add_fixed(tree, joint)  # EU-JNT-023; the ball is placed when its last joint is met
        else:
            add_joint(tree, joint, description.changes.get(joint.name, Change()))
        waiting += urdf.below(joint.child)[::-1]
    for name, reference in description.frames.items():
        tree.added[name] = tree.refer(reference)
    require_own_names(tree, urdf)
    return tree


def require_own_names(tree: Tree, urdf: Urdf) -> None:
    """No joint that the description makes has the name of another; a ball may have that of its last, EU-JNT-003."""
    for joint in tree.joints:
        same = [other for other in tree.joints if other.name == joint.name]
        if len(same) > 1 or (joint.name in urdf.joints and joint.name != joint.source[-1].name):
            raise NotRead(f"two joints {joint.name!r}")


def place(tree: Tree, joint: Joint) -> Placed:
    """Add a joint. The frame of its child."""
    tree.joints.append(joint)
    return Placed(len(tree.joints) - 1, np.eye(4))


def add_fixed(tree: Tree, joint: UrdfJoint) -> None:
    """A link that stays where it is at the joint's neutral, EU-JNT-019."""
    tree.links[joint.child] = tree.joint_frames[joint.name] = tree.links[joint.parent] @ joint.origin


def add_joint(tree: Tree, joint: UrdfJoint, change: Change) -> None:
    """A joint of the URDF as the description changes it."""
    kind = change.type or joint.type
    if kind == "fixed":
        add_fixed(tree, joint)
        return
    on = tree.links[joint.parent] @ joint.origin
    axes = np.array(change.axes) if change.axes else joint.axis[None, :]
    if kind == "pair":  # EU-ONE-006
        for letter, axis in zip(change.letters, axes, strict=True):
            name = f"{joint.name}_{letter}"
            one = Joint(name, joint.type, on.body, on.pose, axis[None, :], source=(joint,), change=change)
            on = tree.joint_frames[name] = place(tree, one)
        child = on
    else:
        source = (joint,)
        child = place(tree, Joint(joint.name, kind, on.body, on.pose, axes, change.pitch, joint.mimic, source, change))
    tree.links[joint.child] = tree.joint_frames[joint.name] = child


def add_ball(tree: Tree, urdf: Urdf, name: str, change: Change) -> None:
    """Three joints of the URDF as one, EU-JNT-022. Its name means the frame of the link it carries, EU-FRM-005."""
    joints = chain(urdf, change.merges)
    found = ball(joints)
    on = tree.links[joints[0].parent] @ found.placement
    joint = Joint(name, "spherical", on.body, on.pose, found.axes, source=tuple(joints), change=change)
    child = place(tree, joint) @ found.link
    tree.links[joints[-1].child] = tree.joint_frames[joints[-1].name] = tree.joint_frames[name] = child
