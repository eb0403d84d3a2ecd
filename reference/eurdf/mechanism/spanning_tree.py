"""The order of the joints in the spanning tree, and which bodies no joint moves against each other."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from operator import attrgetter
from typing import Protocol

from eurdf.mechanism.joint import Joint
from eurdf.mechanism.joint_types import JointType
from eurdf.mechanism.pose import IDENTITY, Pose


class _Placed(Protocol):
    """What a joint of a mechanism and one of a URDF have in common."""

    @property
    def parent(self) -> str: ...
    @property
    def child(self) -> str: ...
    @property
    def type(self) -> JointType: ...
    @property
    def placement(self) -> Pose: ...


def depth_first(root: str, joints: Iterable[Joint]) -> list[Joint]:
    """EU-URD-031: the joints depth first from the root body; those of one body in the byte order of their names."""
    children: dict[str, list[Joint]] = {}
    for joint in joints:
        children.setdefault(joint.parent, []).append(joint)
    for siblings in children.values():
        if len(siblings) > 1:
            siblings.sort(key=attrgetter("name"), reverse=True)
    ordered: list[Joint] = []
    stack = list(children.get(root, ()))
    while stack:
        joint = stack.pop()
        ordered.append(joint)
        stack.extend(children.get(joint.child, ()))
    return ordered


def rigid_roots(root: str, ordered: Iterable[_Placed]) -> Mapping[str, str]:
    """For each body the one it is rigidly fixed to that is nearest to the root; itself where a joint moves it."""
    of = {root: root}
    for joint in ordered:
        of[joint.child] = of[joint.parent] if joint.type.is_fixed else joint.child
    return of


def rigid_poses(root: str, ordered: Iterable[_Placed]) -> Mapping[str, tuple[str, Pose]]:
    """For each body the one of `rigid_roots`, and its pose in that one."""
    of = {root: (root, IDENTITY)}
    for joint in ordered:
        body, pose = of[joint.parent]
        of[joint.child] = (body, pose * joint.placement) if joint.type.is_fixed else (joint.child, IDENTITY)
    return of
