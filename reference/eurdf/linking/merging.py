"""Three revolute joints whose axes meet in one point are one spherical joint."""

from __future__ import annotations

import itertools
import math
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple, Protocol

import numpy as np

from eurdf.mechanism.body import Inertia
from eurdf.mechanism.joint import Joint, JointProperties
from eurdf.mechanism.joint_types import ROTARY, JointType
from eurdf.mechanism.pose import IDENTITY, ORIGIN, Pose, Vector3, cross, direction, squarable

#: A link lighter than this, in kg, counts as being without inertia (EU-JNT-012).
MASSLESS = 1e-5

#: Axes that pass a point within this distance, in m, meet in it (EU-JNT-014).
MEETING = 1e-4

#: Directions whose sine is below this are parallel (EU-JNT-007).
PARALLEL = 1e-6

#: In the order of EU-JNT-028.
_ORDERS = tuple(itertools.permutations(range(3)))

#: Sums of cosines that differ by no more are equal (EU-JNT-028).
_AS_LARGE = 1e-9


class _Weighed(Protocol):
    @property
    def name(self) -> str: ...
    @property
    def inertia(self) -> Inertia | None: ...


class _Edge(Protocol):
    @property
    def name(self) -> str: ...
    @property
    def child(self) -> str: ...


class JointTree(Protocol):
    """The links and joints of a URDF, or of a mechanism."""

    @property
    def links(self) -> Mapping[str, _Weighed]:
        """Every link."""

    @property
    def joints(self) -> Mapping[str, _Edge]:
        """Every joint."""

    @property
    def children(self) -> Mapping[str, Sequence[_Edge]]:
        """By the name of a link, the joints that it carries; a link that carries none may be left out."""

    def walk(self) -> Iterable[_Edge]:
        """The joints depth first from the root."""


class NotMergeable(Exception):  # noqa: N818 - a finding, which one of the two callers takes for an answer
    """Why three joints do not make a spherical one, as the code and message of a diagnostic."""

    def __init__(self, code: str, message: str) -> None:
        super().__init__(message)
        self.code = code
        self.message = message


class BallChain(NamedTuple):
    """Three joints that can be merged, from the root outwards.

    Attributes:
        joints: The joints.
        zero: Pose of the last joint at zero, in the frame of the body before.
        directions: Unit vectors of the axes at zero, in that frame.
        point: Where they meet, in that frame.
    """

    joints: tuple[Joint, Joint, Joint]
    zero: Pose
    directions: tuple[Vector3, ...]
    point: Vector3


def check_chain(
    chain: tuple[Joint, Joint, Joint],
    urdf: JointTree,
    closure_links: Collection[str],
    *,
    rotary: Collection[str] = ROTARY,
) -> BallChain:
    """EU-JNT-011 to -014: the joints follow one another, nothing else hangs or weighs between them, their axes meet.

    `NotMergeable` says which of these does not hold.
    """
    for joint in chain:
        if joint.type not in rotary:
            message = f"joint '{joint.name}' is {joint.type}; it must be revolute or continuous"
            raise NotMergeable("merge-not-chain", message)
    for upper, lower in itertools.pairwise(chain):
        if lower.parent != upper.child:
            message = f"joint '{lower.name}' is not attached to the child link of '{upper.name}'"
            raise NotMergeable("merge-not-chain", message)
        siblings = urdf.children.get(upper.child, ())
        if len(siblings) != 1:
            other = next(joint.name for joint in siblings if joint.name != lower.name)
            message = f"link '{upper.child}' between them is also the parent of joint '{other}'"
            raise NotMergeable("merge-not-chain", message)
    for link in (urdf.links[joint.child] for joint in chain[:2]):
        if link.inertia is not None and link.inertia.mass >= MASSLESS:
            message = f"link '{link.name}' between them has mass {link.inertia.mass:g} kg"
            raise NotMergeable("merge-inertia", f"{message}; it must be below {MASSLESS:g} kg")
        if link.name in closure_links:
            raise NotMergeable("merge-closure-frame", f"link '{link.name}' between them has a frame of a closure")
    zero, lines = _lines(chain)
    return BallChain(chain, zero, tuple(along for _, along in lines), _meeting_point(lines))


def merge(chain: BallChain, name: str) -> tuple[Joint, Joint, Joint]:
    """EU-JNT-022 to -024, and -028: the first two joints, fixed at their zero, and the ball that the three become.

    The links in between stay where they are at zero, fixed to the body before. The spherical joint turns about the
    point where the axes meet; its frame has the orientation of the last joint's at zero. Where the last joint's origin
    is that point (within `MEETING`), it is the joint's origin. Of velocity, effort, damping and friction, each axis of
    the frame takes those of the merged joint whose axis, at zero, is nearest to it.
    """
    first, second, third = chain.joints
    zero = chain.zero
    offset = IDENTITY
    if math.dist(chain.point, zero.xyz) > MEETING:
        centre = Pose(chain.point, zero.quaternion)
        offset = Pose(centre.inverse().act(zero.xyz))
        zero = centre
    nearest = _nearest_axes(chain)
    by_axis = {
        name: tuple(getattr(joint.properties, name)[0] for joint in nearest)
        for name in ("velocity", "effort", "damping", "friction", "armature")
    }
    for rate in ("acceleration", "deceleration", "jerk"):
        if any(getattr(joint.properties, rate) for joint in nearest):
            by_axis[rate] = tuple((getattr(joint.properties, rate) or (math.inf,))[0] for joint in nearest)
    properties = replace(JointProperties.unlimited(JointType.SPHERICAL), **by_axis)
    ball = Joint(name, JointType.SPHERICAL, first.parent, third.child, zero, offset, properties=properties)
    return first.fixed(), second.fixed(), ball


def find_chains(
    urdf: JointTree,
    joints: Mapping[str, Joint],
    excluded: Collection[str],
    closure_links: Collection[str],
    *,
    rotary: Collection[str] = (JointType.REVOLUTE,),
) -> list[BallChain]:
    """EU-ONE-007: the chains that version 1 merges by itself, greedily from the root outwards."""
    taken: set[str] = set()
    chains = []
    for start in urdf.walk():
        names = [start.name]
        for _ in range(2):
            below = urdf.children.get(urdf.joints[names[-1]].child, ())
            if len(below) != 1:
                break
            names.append(below[0].name)
        if len(names) < 3 or any(name in taken or name in excluded for name in names):
            continue
        try:
            three = joints[names[0]], joints[names[1]], joints[names[2]]
            chain = check_chain(three, urdf, closure_links, rotary=rotary)
        except NotMergeable:
            continue
        taken.update(names)
        chains.append(chain)
    return chains


def _lines(chain: tuple[Joint, Joint, Joint]) -> tuple[Pose, list[tuple[Vector3, Vector3]]]:
    """The axes at zero as (point, unit direction) in the frame of the body before; and the pose of the last joint."""
    pose = IDENTITY
    lines = []
    for joint in chain:
        pose = pose * joint.placement
        lines.append((pose.xyz, direction(pose.rotate(squarable(joint.axes[0])))))
    return pose, lines


def _meeting_point(lines: list[tuple[Vector3, Vector3]]) -> Vector3:
    """The point nearest to the three axes, in the frame of the body before.

    It solves Σ (I - u uᵀ) p = Σ (I - u uᵀ) o for the lines o + s u. `NotMergeable` where two axes are parallel, or one
    passes the point by more than `MEETING`.
    """
    for (_, u), (_, v) in itertools.combinations(lines, 2):
        if math.hypot(*cross(u, v)) < PARALLEL:
            raise NotMergeable("joint-axes-parallel", "two of their axes are parallel")
    if lines[0][0] == lines[1][0] == lines[2][0]:
        return lines[0][0]  # the usual form of a ball: three joints at one origin
    origins, directions = np.array(lines).transpose(1, 0, 2)
    across = np.eye(3) - directions[:, :, None] * directions[:, None, :]
    point = np.linalg.solve(across.sum(axis=0), np.einsum("kij,kj->i", across, origins))
    for distance in np.linalg.norm(np.cross(point - origins, directions), axis=1):
        if distance > MEETING:
            raise NotMergeable(
                "merge-axes",
                f"their axes do not pass through one point: one is {distance * 1e3:.3g} mm away from it; "
                f"the tolerance is {MEETING * 1e3:g} mm",
            )
    x, y, z = point.tolist()
    return x, y, z


def _nearest_axes(chain: BallChain) -> tuple[Joint, ...]:
    """For x, y, z of the last joint's frame at zero, the joint whose axis is nearest; each joint once."""
    back = replace(chain.zero, xyz=ORIGIN).inverse()
    near = [tuple(map(abs, back.rotate(axis))) for axis in chain.directions]
    sums = [near[x][0] + near[y][1] + near[z][2] for x, y, z in _ORDERS]
    least = max(sums) - _AS_LARGE
    x, y, z = next(order for order, found in zip(_ORDERS, sums, strict=True) if found >= least)
    return chain.joints[x], chain.joints[y], chain.joints[z]
