"""A valid URDF as data."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import NamedTuple

from eurdf.mechanism.body import Inertia, Shape
from eurdf.mechanism.joint import Mimic
from eurdf.mechanism.joint_types import JointType
from eurdf.mechanism.pose import Pose, Vector3
from eurdf.reading.xml_reader import Element, XmlDocument


class Limit(NamedTuple):
    """A joint's ``limit``: positions in rad or m, velocity in rad/s or m/s, effort in N·m or N; infinite if none.

    Acceleration and deceleration are in rad/s² or m/s², jerk in rad/s³ or m/s³.
    """

    lower: float
    upper: float
    velocity: float
    effort: float
    acceleration: float = math.inf
    deceleration: float = math.inf
    jerk: float = math.inf


class UrdfLink(NamedTuple):
    """A ``link`` element as read; ``inertial`` is its element, for places in diagnostics."""

    name: str
    element: Element
    inertia: Inertia | None
    inertial: Element | None
    visuals: tuple[Shape, ...]
    collisions: tuple[Shape, ...]


class UrdfJoint(NamedTuple):
    """A ``joint`` element as read.

    Attributes:
        name: Its name.
        type: One of URDF's six types.
        element: The element, for places in diagnostics.
        parent: Name of the parent link.
        child: Name of the child link.
        placement: Pose of the joint in the parent link; the child link has this pose at zero.
        axis: As written, in the joint's frame; (1, 0, 0) where the URDF gives none.
        limit: None where the URDF gives none.
        damping: N·m·s/rad or N·s/m.
        friction: N·m or N.
        mimic: Its leader and the relation to it, as written, or None. A fixed joint has no leader.
    """

    name: str
    type: JointType
    element: Element
    parent: str
    child: str
    placement: Pose
    axis: Vector3
    limit: Limit | None
    damping: float
    friction: float
    mimic: Mimic | None


@dataclass(frozen=True, slots=True)
class Urdf:
    """A valid URDF: unique names, known links, one tree.

    Attributes:
        document: The file it was read from.
        name: Name of the robot.
        links: By name, in file order.
        joints: By name, in file order.
        root: Name of the root link.
        children: For each link, the joints that hang from it, in the byte order of their names.
    """

    document: XmlDocument
    name: str
    links: Mapping[str, UrdfLink]
    joints: Mapping[str, UrdfJoint]
    root: str
    children: Mapping[str, tuple[UrdfJoint, ...]]

    def without_mimics(self, of: Collection[str] | None = None) -> Urdf:
        """The same URDF in which some joints, or all if none are named, mimic no other."""
        if not any(joint.mimic and (of is None or joint.name in of) for joint in self.joints.values()):
            return self
        joints = {
            name: joint._replace(mimic=None) if of is None or name in of else joint
            for name, joint in self.joints.items()
        }
        children = {link: tuple(joints[joint.name] for joint in below) for link, below in self.children.items()}
        return replace(self, joints=joints, children=children)

    @property
    def shapes(self) -> Iterator[Shape]:
        """The visual and collision shapes of all links."""
        return (shape for link in self.links.values() for shape in (*link.visuals, *link.collisions))

    def walk(self) -> Iterator[UrdfJoint]:
        """The joints depth first from the root; the joints of one link in the byte order of their names."""
        stack = list(reversed(self.children.get(self.root, ())))
        while stack:
            joint = stack.pop()
            yield joint
            stack.extend(reversed(self.children.get(joint.child, ())))
