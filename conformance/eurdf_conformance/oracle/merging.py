"""Three revolute joints in a row as one spherical joint: chapter Joints, Merging, and EU-ONE-007."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import combinations, pairwise, permutations

import numpy as np

from eurdf_conformance.oracle.description import Change, Description
from eurdf_conformance.oracle.not_read import NotRead
from eurdf_conformance.oracle.spatial import Array, inverse, pose
from eurdf_conformance.oracle.urdf import Urdf, UrdfJoint

#: kg, the mass of each link in between is less, EU-JNT-012.
LIGHT = 1e-5
#: m, from the point to each axis, EU-JNT-014.
NEAR = 1e-4
#: Sine of the angle between two axes, EU-JNT-007.
PARALLEL = 1e-6
#: Between sums of cosines, EU-JNT-028.
EVEN = 1e-9


@dataclass(frozen=True)
class Ball:
    """The pose of a spherical joint in place of three joints, at zero."""

    #: pMj, its frame in that of the link before.
    placement: Array
    #: cMl, the frame of the link that it carries in its own on the child's side.
    link: Array
    #: The axes of the three joints in its frame, one a row.
    axes: Array
    #: m, the largest distance of an axis from its centre.
    miss: float


def ball(joints: list[UrdfJoint]) -> Ball:
    """Of three joints: the point nearest to their axes, with the last one's orientation, EU-JNT-014 and 022.

    The axes pass through o_i along a_i: the point solves Σ (1 − a_i a_iᵀ) (p − o_i) = 0. Where that is as near
    to the last origin as the axes have to be to it, it is that origin.
    """
    pMj = np.eye(4)
    origins, axes = [], []
    for joint in joints:
        pMj = pMj @ joint.origin
        origins.append(pMj[:3, 3])
        axes.append(pMj[:3, :3] @ joint.axis)
    across = [np.eye(3) - np.outer(a, a) for a in axes]
    # About the last origin, so that where all three are one point the answer is exactly that.
    offsets = [P @ (o - origins[-1]) for P, o in zip(across, origins, strict=True)]
    p = origins[-1] + np.linalg.lstsq(np.sum(across, axis=0), np.sum(offsets, axis=0))[0]
    miss = max(float(np.linalg.norm(P @ (p - o))) for P, o in zip(across, origins, strict=True))
    if np.linalg.norm(p - origins[-1]) <= NEAR:
        p = origins[-1]
    R = pMj[:3, :3]
    placement = pose(R, p)
    return Ball(placement, inverse(placement) @ pMj, np.array(axes) @ R, miss)


def nearest(axes: Array) -> list[int]:
    """For each axis of the ball's frame its joint, each joint once, by the largest sum of cosines, EU-JNT-024.

    Of several that are the largest, the first in the order of the joints counts, EU-JNT-028.
    """
    ways = sorted(permutations(range(3)))
    sums = np.array([np.abs(axes)[way, range(3)].sum() for way in ways])
    return list(ways[int(np.argmax(sums >= sums.max() - EVEN))])


def chain(urdf: Urdf, names: tuple[str, ...]) -> list[UrdfJoint]:
    """The joints of a merge, in order from the root, EU-JNT-011."""
    joints = [urdf.joints[name] for name in names]
    if len(joints) != 3 or any(urdf.below(a.child) != [b] for a, b in pairwise(joints)):
        raise NotRead(f"{names} is no chain of three joints")
    return joints


def with_merges_found(description: Description, urdf: Urdf) -> Description:
    """A description of version 1 with a change for each three joints that are merged, EU-ONE-007."""
    held = {reference.name for closure in description.closures for reference in (closure.a, closure.b)}
    taken = set(description.changes)
    changes = dict(description.changes)
    outwards = list(urdf.below(urdf.root))  # each joint after the one that it hangs from
    for joint in outwards:
        outwards += urdf.below(joint.child)
        joints = [joint]
        while len(joints) < 3 and len(below := urdf.below(joints[-1].child)) == 1:
            joints += below
        names = {found.name for found in joints}
        if len(joints) == 3 and not names & taken and mergeable(joints, urdf, held):
            changes[joints[-1].name] = Change("spherical", merges=tuple(found.name for found in joints))
            taken |= names
    return replace(description, changes=changes)


def mergeable(joints: list[UrdfJoint], urdf: Urdf, held: set[str]) -> bool:
    """Whether three joints in a row could be merged, EU-JNT-007 and 012 to 014; `held` names the frames of closures."""
    between = joints[:-1]
    inertias = [urdf.links[joint.child].inertia for joint in between]
    if any(joint.type != "revolute" for joint in joints):
        return False
    if any(inertia is not None and inertia.mass >= LIGHT for inertia in inertias):
        return False
    if held & {name for joint in between for name in (joint.name, joint.child)}:
        return False
    found = ball(joints)
    sines = [np.linalg.norm(np.cross(a, b)) for a, b in combinations(found.axes, 2)]
    return bool(min(sines) >= PARALLEL and found.miss <= NEAR)
