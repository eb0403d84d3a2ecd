"""Whether the inertias are those of real bodies, and whether all that moves has some."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from functools import partial

import numpy as np

from eurdf.diagnostics import Diagnostics
from eurdf.format.urdf.data import Urdf, UrdfLink
from eurdf.mechanism.body import Inertia
from eurdf.mechanism.joint import Joint
from eurdf.mechanism.mechanism import Mechanism, root_joint
from eurdf.mechanism.pose import IDENTITY, Pose, Vector3
from eurdf.mechanism.spanning_tree import rigid_roots

#: A moment may be negative, and a sum of two below the third, by this part of the largest (rounding in files).
MOMENT_TOLERANCE = 1e-6

#: A leaf whose smallest inertia about its joint is below this part of its largest has none about that axis.
SINGULAR = 1e-12

Moments = tuple[float, float, float, float, float, float]

#: The pose of a link in the frame that its joint moves, and its inertia.
Member = tuple[Pose, Inertia]


def check_inertias(urdf: Urdf, diagnostics: Diagnostics) -> set[str]:
    """EU-INR-001 to -003, link by link: mass not negative, inertia positive semidefinite, triangle inequality.

    Returns:
        Names of the links with an error, of which nothing more can be said.
    """
    faulty: set[str] = set()
    suspects: list[tuple[UrdfLink, Inertia]] = []
    for link in urdf.links.values():
        inertia = link.inertia
        if inertia is None:
            continue
        if inertia.mass < 0.0:
            message = f"link '{link.name}' has the negative mass {inertia.mass:g} kg"
            _report(urdf, diagnostics, link, "negative-mass", message, "mass")
            faulty.add(link.name)
            continue
        if not _plainly_sound(inertia.moments):
            suspects.append((link, inertia))
    for link, inertia in suspects:
        moments: list[float] = np.linalg.eigvalsh(_matrix(inertia.moments)).tolist()  # which overflow in silence
        largest = max(map(abs, moments))
        if moments[0] < -MOMENT_TOLERANCE * largest:
            faulty.add(link.name)
            _report(
                urdf,
                diagnostics,
                link,
                "inertia-not-psd",
                f"the inertia of link '{link.name}' has a negative principal moment, {moments[0]:.3g} kg·m²",
                "inertia",
            )
        elif moments[0] + moments[1] < moments[2] - MOMENT_TOLERANCE * largest:
            _report(
                urdf,
                diagnostics,
                link,
                "inertia-triangle",
                f"the inertia of link '{link.name}' is not physical: its principal moments are {moments[0]:.3g}, "
                f"{moments[1]:.3g}, {moments[2]:.3g} kg·m², and the last exceeds the sum of the others",
                "inertia",
            )
    return faulty


def check_leaves(
    mechanism: Mechanism, urdf: Urdf, diagnostics: Diagnostics, faulty: Collection[str] = frozenset()
) -> None:
    """EU-INR-004: what a joint moves at the end of the tree has inertia along every motion of that joint.

    Elsewhere massless bodies describe joints of several axes; at a leaf they make the mass matrix singular.

    Args:
        mechanism: The mechanism.
        urdf: The URDF, for places in diagnostics.
        diagnostics: Gets what is found.
        faulty: Links whose own inertia is invalid: leaves that they are part of are skipped.
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
    (cx, cy, cz), (ax, ay, az) = at.xyz, axis
    u, v, w = ay * cz - az * cy, az * cx - ax * cz, ax * cy - ay * cx
    return own + inertia.mass * (u * u + v * v + w * w)


def _trace_about_origin(pose: Pose, inertia: Inertia) -> float:
    """Sum of the three moments about any axes through the joint's origin: tr I + 2 m |c|²."""
    x, y, z = pose.act(inertia.pose.xyz)
    return inertia.moments[0] + inertia.moments[3] + inertia.moments[5] + 2.0 * inertia.mass * (x * x + y * y + z * z)


def _positive(members: Iterable[Member], bound: float) -> bool:
    """Whether the rotational inertia about the origin, Σ R I Rᵀ + m (cᵀc 1 - c cᵀ), exceeds the bound about all axes.

    Sylvester's criterion on the matrix less the bound.
    """
    xx = xy = xz = yy = yz = zz = 0.0
    for pose, inertia in members:
        at = pose * inertia.pose
        ixx, ixy, ixz, iyy, iyz, izz = turned(inertia.moments, at)
        (x, y, z), mass = at.xyz, inertia.mass
        xx += ixx + mass * (y * y + z * z)
        yy += iyy + mass * (x * x + z * z)
        zz += izz + mass * (x * x + y * y)
        xy += ixy - mass * x * y
        xz += ixz - mass * x * z
        yz += iyz - mass * y * z
    xx, yy, zz = xx - bound, yy - bound, zz - bound
    second = xx * yy - xy * xy
    third = xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz)
    return xx > 0.0 and second > 0.0 and third > 0.0


def turned(moments: Moments, pose: Pose) -> Moments:
    """R I Rᵀ."""
    if pose.quaternion == IDENTITY.quaternion:
        return moments
    a, d, g = pose.rotate((1.0, 0.0, 0.0))
    b, e, h = pose.rotate((0.0, 1.0, 0.0))
    c, f, i = pose.rotate((0.0, 0.0, 1.0))
    xx, xy, xz, yy, yz, zz = moments

    def product(p: float, q: float, r: float, s: float, t: float, u: float) -> float:
        return p * (xx * s + xy * t + xz * u) + q * (xy * s + yy * t + yz * u) + r * (xz * s + yz * t + zz * u)

    return (
        product(a, b, c, a, b, c),
        product(a, b, c, d, e, f),
        product(a, b, c, g, h, i),
        product(d, e, f, d, e, f),
        product(d, e, f, g, h, i),
        product(g, h, i, g, h, i),
    )


def _matrix(moments: Moments) -> np.ndarray:
    xx, xy, xz, yy, yz, zz = moments
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def _plainly_sound(moments: Moments) -> bool:
    """Whether the triangle inequality surely holds, and with it positive semidefiniteness.

    They hold where J = tr(I)/2 · 1 - I is positive semidefinite. That is seen by Sylvester's criterion on J with the
    tolerance added to its diagonal; what fails it is looked at again, by its principal moments.
    """
    xx, xy, xz, yy, yz, zz = moments
    half = (xx + yy + zz) * (0.5 + 0.25 * MOMENT_TOLERANCE)
    a, b, c = half - xx, half - yy, half - zz
    second = a * b - xy * xy
    return (
        a > 0.0 and second > 0.0 and a * (b * c - yz * yz) - xy * (xy * c + yz * xz) - xz * (xy * yz + b * xz) > 0.0
    ) or not any(moments)


def _report(
    urdf: Urdf, diagnostics: Diagnostics, link: UrdfLink, code: str, message: str, child: str | None = None
) -> None:
    element = link.element
    if child is not None and link.inertial is not None:
        found = link.inertial.find(child)
        element = link.inertial if found is None else found
    attribute = "value" if child == "mass" else None
    diagnostics.report(code, message, partial(urdf.document.place, element, attribute))


__all__ = ["check_inertias", "check_leaves"]
