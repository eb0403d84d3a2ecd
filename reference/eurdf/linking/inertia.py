"""Whether the inertias are those of real bodies, and whether all that moves has some."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from functools import partial

import numpy as np

from eurdf.diagnostics import Diagnostics
from eurdf.format.urdf.data import Urdf, UrdfLink
from eurdf.mechanism.body import Inertia
from eurdf.mechanism.joint import Joint
from eurdf.mechanism.mechanism import Mechanism, root_joint
from eurdf.mechanism.pose import AXES, IDENTITY, Pose, Vector3, cross
from eurdf.mechanism.spanning_tree import rigid_roots

#: A moment may be negative, and a sum of two below the third, by this part of the largest (rounding in files).
MOMENT_TOLERANCE = 1e-6

#: A leaf whose smallest inertia about its joint is below this part of its largest has none about that axis.
SINGULAR = 1e-12

#: The pose of a link in the frame that its joint moves, and its inertia.
Member = tuple[Pose, Inertia]


def check_inertias(urdf: Urdf, diagnostics: Diagnostics) -> set[str]:
    """EU-INR-001 to -003, link by link: mass not negative, inertia positive semidefinite, triangle inequality.

    The result is the names of the links with an error, of which nothing more can be said.
    """
    faulty: set[str] = set()
    valid: list[tuple[UrdfLink, Inertia]] = []
    for link in urdf.links.values():
        if link.inertia is None:
            continue
        if link.inertia.mass < 0.0:
            message = f"link '{link.name}' has the negative mass {link.inertia.mass:g} kg"
            _report(urdf, diagnostics, link, "negative-mass", message, "mass")
            faulty.add(link.name)
        else:
            valid.append((link, link.inertia))
    principal = np.linalg.eigvalsh(_matrices([inertia for _, inertia in valid]))  # which overflow in silence
    for (link, _), (least, middle, most) in zip(valid, principal.tolist(), strict=True):
        tolerance = MOMENT_TOLERANCE * max(abs(least), abs(most))
        if least < -tolerance:
            faulty.add(link.name)
            message = f"the inertia of link '{link.name}' has a negative principal moment, {least:.3g} kg·m²"
            _report(urdf, diagnostics, link, "inertia-not-psd", message, "inertia")
        elif least + middle < most - tolerance:
            message = (
                f"the inertia of link '{link.name}' is not physical: its principal moments are {least:.3g}, "
                f"{middle:.3g}, {most:.3g} kg·m², and the last exceeds the sum of the others"
            )
            _report(urdf, diagnostics, link, "inertia-triangle", message, "inertia")
    return faulty


def check_leaves(
    mechanism: Mechanism, urdf: Urdf, diagnostics: Diagnostics, faulty: Collection[str] = frozenset()
) -> None:
    """EU-INR-004: what a joint moves at the end of the tree has inertia along every motion of that joint.

    Elsewhere massless bodies describe joints of several axes; at a leaf they make the mass matrix singular. Leaves with
    a link whose own inertia is invalid, one of ``faulty``, are skipped.
    """
    root = mechanism.bodies[0].name
    rigid = rigid_roots(root, mechanism.joints)
    inner = {rigid[joint.parent] for joint in mechanism.joints if not joint.type.is_fixed}
    inertia_of = {body.name: body.inertia for body in mechanism.bodies}
    poses: dict[str, Pose] = {root: IDENTITY}
    members: dict[str, list[Member]] = {}
    moving: list[Joint] = []
    passed_over: set[str] = set()
    for joint in mechanism.joints:
        if joint.type.is_fixed:
            parent = poses.get(joint.parent)
            if parent is None or rigid[joint.child] in inner:
                continue
            pose = parent * joint.placement
        elif rigid[joint.child] in inner:
            continue
        else:
            moving.append(joint)
            pose = joint.offset
        poses[joint.child] = pose
        inertia = inertia_of[joint.child]
        if inertia is not None:
            members.setdefault(rigid[joint.child], []).append((pose, inertia))
            if joint.child in faulty:
                passed_over.add(rigid[joint.child])
    if mechanism.root == "floating" and root not in inner:
        moving.append(root_joint(root))
        if (inertia := inertia_of[root]) is not None:
            members.setdefault(root, []).append((IDENTITY, inertia))
            if root in faulty:
                passed_over.add(root)
    for joint in moving:
        if joint.child in passed_over or joint.mimic is not None or min(joint.properties.armature, default=0.0) > 0.0:
            continue
        why = _immaterial(joint, members.get(joint.child, ()))
        if why and joint.child in urdf.links:
            message = f"link '{joint.child}', which joint '{joint.name}' moves, {why}"
            _report(urdf, diagnostics, urdf.links[joint.child], "leaf-without-inertia", message)


def _immaterial(joint: Joint, members: Sequence[Member]) -> str | None:
    """Why a leaf does not resist a motion of its joint, in any configuration; None where it resists them all."""
    kind = joint.type
    mass = sum(inertia.mass for _, inertia in members)
    if mass == 0.0 and not any(any(inertia.moments) for _, inertia in members):
        return "has no mass, and no link attached to it has mass"
    if mass == 0.0 and kind.slides:
        return "has no mass"
    scale = sum(_trace_about_origin(pose, inertia) for pose, inertia in members)
    if kind.moving_frame and kind.slides:
        # What resists turning is the inertia about the centre of mass.
        members = _centred(members, mass)
    # Of a universal joint the first axis moves in the child: only mass on the second resists nothing for ever.
    axis, turns, advance = joint.motions[-1]
    if axis is None:
        if not _positive(members, SINGULAR * scale):
            point = "its centre of mass" if kind.slides else "the joint"
            return f"has no inertia about one of the axes through {point}"
    elif turns:
        with_it = advance * advance * mass
        resists = sum(_about_axis(axis, pose, inertia) for pose, inertia in members) + with_it
        if resists <= SINGULAR * (scale + with_it):
            return f"has no inertia about the joint's {'second ' if len(joint.axes) > 1 else ''}axis"
    return None


def _centred(members: Sequence[Member], mass: float) -> list[Member]:
    """The members, seen from a frame at their centre of mass."""
    weighed = [(inertia.mass / mass, pose.act(inertia.pose.xyz)) for pose, inertia in members]
    x, y, z = (-sum(weight * point[axis] for weight, point in weighed) for axis in range(3))
    return [(Pose((x, y, z)) * pose, inertia) for pose, inertia in members]


def _about_axis(axis: Vector3, pose: Pose, inertia: Inertia) -> float:
    """Inertia about an axis a of unit length through the joint's origin: aᵀ I a + m |a × c|²."""
    at = pose * inertia.pose
    x, y, z = at.inverse().rotate(axis)
    xx, xy, xz, yy, yz, zz = inertia.moments
    own = xx * x * x + yy * y * y + zz * z * z + 2.0 * (xy * x * y + xz * x * z + yz * y * z)
    u, v, w = cross(axis, at.xyz)
    return own + inertia.mass * (u * u + v * v + w * w)


def _trace_about_origin(pose: Pose, inertia: Inertia) -> float:
    """Sum of the three moments about any axes through the joint's origin: tr I + 2 m |c|²."""
    x, y, z = pose.act(inertia.pose.xyz)
    return inertia.moments[0] + inertia.moments[3] + inertia.moments[5] + 2.0 * inertia.mass * (x * x + y * y + z * z)


def _positive(members: Sequence[Member], bound: float) -> bool:
    """Whether the inertia about all axes through the origin, Σ R I Rᵀ + m (cᵀc 1 - c cᵀ), exceeds the bound."""
    total = np.zeros((3, 3))
    for (pose, inertia), moments in zip(members, _matrices([inertia for _, inertia in members]), strict=True):
        at = pose * inertia.pose
        R = np.array([at.rotate(axis) for axis in AXES]).T
        c = np.array(at.xyz)
        total += R @ moments @ R.T + inertia.mass * (c @ c * np.eye(3) - np.outer(c, c))
    return bool(np.linalg.eigvalsh(total)[0] > bound)


def _matrices(inertias: Sequence[Inertia]) -> np.ndarray:
    """The moments as (k, 3, 3)."""
    moments = np.array([inertia.moments for inertia in inertias]).reshape(-1, 6)
    return moments[:, [0, 1, 2, 1, 3, 4, 2, 4, 5]].reshape(-1, 3, 3)


def _report(
    urdf: Urdf, diagnostics: Diagnostics, link: UrdfLink, code: str, message: str, child: str | None = None
) -> None:
    element = link.element
    if child is not None and link.inertial is not None:
        found = link.inertial.find(child)
        element = link.inertial if found is None else found
    attribute = "value" if child == "mass" else None
    diagnostics.report(code, message, partial(urdf.document.place, element, attribute))
