"""Parsers that merge other joints, or merge them differently."""

from __future__ import annotations

import math
import sys
from collections.abc import Callable
from dataclasses import replace
from typing import Any
from unittest.mock import patch

from eurdf_conformance.oracle import joint_property, merging, tree
from eurdf_conformance.oracle.spatial import inverse, pose
from mutants.mutant import Deviation, Members, instead, means, refuses


def _ball(placement: Callable[[Any, Any], Any]) -> Deviation:
    """The ball is at another pose in the link before: placement(ball, joints). The link after it stays where it is."""

    def changed(right: Any, joints: Any) -> Any:
        found = right(joints)
        pMj = placement(found, joints)
        return replace(found, placement=pMj, link=inverse(pMj) @ found.placement @ found.link)

    return instead(tree, "ball", changed)


wrong = means("EU-JNT-022")
wrong(
    "Merged joints turn about the origin of the last one, wherever their axes meet.",
    lambda: _ball(lambda ball, joints: ball.placement @ ball.link),
)
wrong(
    "The frame of merged joints has the orientation of the first one.",
    lambda: _ball(lambda ball, joints: pose(joints[0].origin[:3, :3], ball.placement[:3, 3])),
)


@means("EU-JNT-023")
def links_between_are_at_the_link_before() -> Deviation:
    """The links between merged joints are where the link before them is."""

    def fixed(right: Any, found: Any, joint: Any) -> None:
        right(found, joint)
        if joint.type != "fixed":
            found.links[joint.child] = found.joint_frames[joint.name] = found.links[joint.parent]

    return instead(tree, "add_fixed", fixed)


@means("EU-ONE-007")
def nothing_is_merged() -> Deviation:
    """Three revolute joints of version 1 stay three."""
    read = sys.modules["eurdf_conformance.oracle.read"]  # the package has a function of that name
    return instead(read, "with_merges_found", lambda right, description, urdf: description)


wrong = means("EU-ONE-007")
wrong(
    "Three joints are merged even if a link between them has a mass.", lambda: patch.object(merging, "LIGHT", math.inf)
)
wrong("Three joints are merged even if their axes do not meet.", lambda: patch.object(merging, "NEAR", math.inf))
wrong(
    "Three joints are merged if their axes pass a point within a millimetre.",
    lambda: patch.object(merging, "NEAR", 1e-3),
)


@means("EU-JNT-022")
def centres_within_a_millimetre_are_the_last_origin() -> Deviation:
    """The centre of merged joints is the origin of the last one if it is within a millimetre of it."""

    def placement(ball: Any, joints: Any) -> Any:
        last = ball.placement @ ball.link
        return last if math.dist(last[:3, 3], ball.placement[:3, 3]) <= 1e-3 else ball.placement

    return _ball(placement)


@means("EU-JNT-024")
def nearest_axis_of_x_first() -> Deviation:
    """The joint nearest to x gives x; of the other two, the one nearest to y gives y."""

    def greedy(right: Any, axes: Any) -> list[int]:
        left, found = [0, 1, 2], list[int]()
        for cosines in abs(axes).T:
            found.append(max(left, key=lambda joint: cosines[joint]))
            left.remove(found[-1])
        return found

    return instead(joint_property, "nearest", greedy)


@refuses("EU-JNT-033")
def all_merged_joints_must_mimic(data: Members, robot: Any) -> bool:
    """An entry that frees joints to merge must free all three."""
    mimics = set(robot.xpath("joint[mimic]/@name"))
    entries = (entry for entry in data.get("joints", {}).values() if isinstance(entry, dict))
    return any(entry.get("mimic") is False and not mimics.issuperset(entry.get("merges", ())) for entry in entries)
