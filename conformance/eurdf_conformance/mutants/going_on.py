"""Readers that go on where a description is wrong, as today's parsers do, and have another robot in the end.

What they accept, they build: it lacks what was wrong, or has it twice. Those of version 1 are in `version1`.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from itertools import chain
from typing import Any

from eurdf.format.extension import FrameReference
from eurdf.format.urdf import UrdfJoint, UrdfLink, _Reader
from eurdf.linking import configurations, link
from eurdf.linking.frame_names import FrameNames
from eurdf_conformance.mutants.deviation import Deviation, around
from eurdf_conformance.mutants.mutant import mutant


@mutant("EU-URD-016")
def link_with_two_parents_doubled() -> Deviation:
    """A link with two parents hangs twice from one of them, and from the other not at all, as in Pinocchio."""

    def tree(original: Any, self: Any, name: str, links: list[UrdfLink], joints: list[UrdfJoint]) -> Any:
        return original(self, name, *_doubled(links, joints))

    return around(_Reader, "tree", tree)


def _doubled(links: Sequence[UrdfLink], joints: Sequence[UrdfJoint]) -> tuple[list[UrdfLink], list[UrdfJoint]]:
    """For each parent that a link has, the last of its joints, by name, and what hangs from it; the others are lost.

    Where Pinocchio has one name twice, the second has a prime here; what hangs from a name hangs from the first.
    """
    all_links, all_joints = list(links), list(joints)
    for child in links:
        carrying = sorted((joint for joint in joints if joint.child == child.name), key=lambda joint: joint.name)
        below = _below(child.name, joints)
        for count, lost in enumerate(carrying[:-1], 1):
            prime = "'" * count
            all_joints.remove(lost)
            all_joints += [
                joint._replace(name=joint.name + prime, child=joint.child + prime)
                for joint in joints
                if joint is carrying[-1] or joint.parent in below
            ]
            all_links += [each._replace(name=each.name + prime) for each in links if each.name in below]
    return all_links, all_joints


def _below(name: str, joints: Sequence[UrdfJoint]) -> Collection[str]:
    """A link and all links that it carries."""
    below = {name}
    while further := {joint.child for joint in joints if joint.parent in below} - below:
        below |= further
    return below


@mutant("EU-JNT-001")
def changes_of_unknown_joints_dropped() -> Deviation:
    """What the description changes of a joint that does not exist is dropped, as by the published loader."""

    def replaced(original: Any, joints: Any, entries: Any, urdf: Any, *arguments: Any, **named: Any) -> Any:
        known = [each for each in entries if all(name in urdf.joints for name in each.merges or (each.name,))]
        return original(joints, tuple(known), urdf, *arguments, **named)

    return around(link, "replace_joints", replaced)


@mutant("EU-ACT-001")
def actuators_of_unknown_joints_dropped() -> Deviation:
    """An actuator that names a joint that does not exist is dropped, as by the published loader."""

    def linked(original: Any, entries: Any, urdf: Any, joints: Any, merged: Any, *arguments: Any) -> Any:
        known = [each for each in entries if each.joint in joints or each.joint in merged]
        return original(known, urdf, joints, merged, *arguments)

    return around(link, "link_actuators", linked)


@mutant("EU-FRM-001")
def closures_of_unknown_frames_dropped() -> Deviation:
    """A closure that names a joint, link or frame that does not exist is dropped."""

    def find(original: Any, self: Any, reference: FrameReference) -> Any:
        known = chain(self._frames, self._urdf.links, self._urdf.joints, self._joints)
        named = reference.name or reference.link or reference.joint
        return original(self, reference) if named in known else None

    return around(FrameNames, "find", find)


@mutant("EU-CFG-001")
def coordinates_of_unknown_joints_dropped() -> Deviation:
    """Of a configuration the coordinates of a joint that does not exist are dropped."""

    def joint(original: Any, name: str, joints: Any, merged: Any, *arguments: Any) -> Any:
        known = name in joints or name in merged
        return original(name, joints, merged, *arguments) if known else None

    return around(configurations, "_joint", joint)
