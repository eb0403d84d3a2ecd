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
from mutants.frames import fixed_at
from mutants.mutant import Deviation, Members, instead


def _ball(placement: Callable[[Any, Any], Any]) -> Deviation:
    """The ball is at another pose in the link before: placement(ball, joints). The link after it stays where it is."""

    def changed(right: Any, joints: Any) -> Any:
        found = right(joints)
        pMj = placement(found, joints)
        return replace(found, placement=pMj, link=inverse(pMj) @ found.placement @ found.link)

    return instead(tree, "ball", changed)


def _last_origin_if_near(ball: Any, joints: Any) -> Any:
    last = ball.placement @ ball.link
    return last if math.dist(last[:3, 3], ball.placement[:3, 3]) <= 1e-3 else ball.placement


def _greedy(right: Any, axes: Any) -> list[int]:
    left, found = [0, 1, 2], list[int]()
    for cosines in abs(axes).T:
        found.append(max(left, key=lambda joint: cosines[joint]))
        left.remove(found[-1])
    return found


def _frees_some_only(data: Members, robot: Any) -> bool:
    mimics = set(robot.xpath("joint[mimic]/@name"))
    entries = (entry for entry in data.get("joints", {}).values() if isinstance(entry, dict))
    return any(entry.get("mimic") is False and not mimics.issuperset(entry.get("merges", ())) for entry in entries)


MEANS = {
    "EU-JNT-022": {
        "Merged joints turn about the origin of the last one, wherever their axes meet.": _ball(
            lambda ball, joints: ball.placement @ ball.link
        ),
        "The frame of merged joints has the orientation of the first one.": _ball(
            lambda ball, joints: pose(joints[0].origin[:3, :3], ball.placement[:3, 3])
        ),
        "The centre of merged joints is the origin of the last one if it is within a millimetre of it.": _ball(
            _last_origin_if_near
        ),
    },
    "EU-JNT-023": {
        "The links between merged joints are where the link before them is.": fixed_at(
            lambda found, joint: found.links[joint.parent] if joint.type != "fixed" else None
        ),
    },
    "EU-ONE-007": {
        "Three revolute joints of version 1 stay three.": instead(
            sys.modules["eurdf_conformance.oracle.read"],  # the package has a function of that name
            "with_merges_found",
            lambda right, description, urdf: description,
        ),
        "Three joints are merged even if a link between them has a mass.": patch.object(merging, "LIGHT", math.inf),
        "Three joints are merged even if their axes do not meet.": patch.object(merging, "NEAR", math.inf),
        "Three joints are merged if their axes pass a point within a millimetre.": patch.object(merging, "NEAR", 1e-3),
    },
    "EU-JNT-024": {
        "The joint nearest to x gives x; of the other two, the one nearest to y gives y.": instead(
            joint_property, "nearest", _greedy
        ),
    },
}

REFUSES = {
    "EU-JNT-033": {"An entry that frees joints to merge must free all three.": _frees_some_only},
}
