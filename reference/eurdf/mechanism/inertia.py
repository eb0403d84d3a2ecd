"""Whether the inertias are those of real bodies, and whether all that moves has some."""

from __future__ import annotations

from collections.abc import Iterable
from functools import partial

import numpy as np

from eurdf.diagnostics import Diagnostics
from eurdf.format.urdf import Urdf, UrdfLink
from eurdf.mechanism.joint_type import JointType
from eurdf.mechanism.mechanism import Inertia, Joint, Mechanism
from eurdf.mechanism.pose import IDENTITY, Pose, Vector3
from eurdf.mechanism.spanning_tree import rigid_roots

#: A moment may be negative, and a sum of two below the third, by this part of the largest (rounding in files).
MOMENT_TOLERANCE = 1e-6

#: A leaf whose smallest inertia about its joint is below this part of its largest has none about that axis.
SINGULAR = 1e-12

Moments = tuple[float, float, float, float, float, float]


def check_inertias(urdf: Urdf, diagnostics: Diagnostics) -> None:
    """EU-INR-001 to -003, link by link: mass not negative, inertia positive semidefinite, triangle inequality."""
    links = [link for link in urdf.links.values() if link.inertia is not None]
    suspects: list[UrdfLink] = []
    for link in links:
        inertia = link.inertia
        assert inertia is not None
        if inertia.mass < 0.0:
            message = f"link '{link.name}' has a mass of {inertia.mass:g} kg"
            _report(urdf, diagnostics, link, "negative-mass", message, "mass")
            continue
        if not _plainly_sound(inertia.moments):
            suspects.append(link)
    for link in suspects:
        assert link.inertia is not None
        moments = np.linalg.eigvalsh(_matrix(link.inertia.moments))
        largest = float(np.abs(moments).max())
        if moments[0] < -MOMENT_TOLERANCE * largest:
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
                f"no body has the inertia of link '{link.name}': of its principal moments {moments[0]:.3g}, "
                f"{moments[1]:.3g}, {moments[2]:.3g} kg·m² the last is more than the sum of the others",
                "inertia",
            )


def check_leaves(mechanism: Mechanism, urdf: Urdf, diagnostics: Diagnostics) -> None:
    """EU-INR-004: what a joint moves at the end of the tree has inertia along every motion of that joint.

    Elsewhere a massless body is a way to write joints of several axes; at a leaf it makes the mass matrix singular.
    """
    root = mechanism.bodies[0].name
    rigid = rigid_roots(root, mechanism.joints)
    inner = {rigid[joint.parent] for joint in mechanism.joints if joint.type is not JointType.FIXED}
    inertia_of = {body.name: body.inertia for body in mechanism.bodies}
    poses: dict[str, Pose] = {root: IDENTITY}
    members: dict[str, list[tuple[Pose, Inertia]]] = {}
    moving: list[Joint] = []
    for joint in mechanism.joints:
        if joint.type is JointType.FIXED:
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
    for joint in moving:
        if joint.mimic is not None or (joint.armature and min(joint.armature) > 0.0):
            continue
        why = _immaterial(joint, members.get(joint.child, ()))
        if why and joint.child in urdf.links:
            message = f"link '{joint.child}', which joint '{joint.name}' moves, {why}"
            _report(urdf, diagnostics, urdf.links[joint.child], "leaf-without-inertia", message)


def _immaterial(joint: Joint, members: Iterable[tuple[Pose, Inertia]]) -> str | None:
    """Why a leaf does not resist a motion of its joint; None where it resists them all."""
    members = list(members)
    mass = sum(inertia.mass for _, inertia in members)
    if mass < 0.0:
        return None  # reported as a negative mass
    if mass == 0.0 and not any(any(inertia.moments) for _, inertia in members):
        return "has no mass and carries nothing that has"
    if joint.type is JointType.PRISMATIC:
        return None if mass > 0.0 else "has no mass"
    if joint.type in (JointType.REVOLUTE, JointType.CONTINUOUS):
        axis, squared = joint.axes[0], sum(value * value for value in joint.axes[0])
        smallest = sum(_about_axis(axis, pose, inertia) for pose, inertia in members) / squared
        largest = sum(_trace_about_origin(pose, inertia) for pose, inertia in members)
        return None if smallest > SINGULAR * largest else "has no inertia about the joint's axis"
    if joint.type is JointType.SPHERICAL and not _positive(members):
        return "has no inertia about one of the axes through the joint"
    return None  # those joints also slide, or their axes move: any mass resists them somewhere


def _about_axis(axis: Vector3, pose: Pose, inertia: Inertia) -> float:
    """Inertia about an axis through the joint's origin, times the axis's length squared: aᵀ I a + m |a × c|²."""
    at = pose * inertia.pose
    x, y, z = at.inverse().rotate(axis)
    xx, xy, xz, yy, yz, zz = inertia.moments
    own = xx * x * x + yy * y * y + zz * z * z + 2.0 * (xy * x * y + xz * x * z + yz * y * z)
    (cx, cy, cz), (ax, ay, az) = at.xyz, axis
    apart = (ay * cz - az * cy) ** 2 + (az * cx - ax * cz) ** 2 + (ax * cy - ay * cx) ** 2
    return own + inertia.mass * apart


def _trace_about_origin(pose: Pose, inertia: Inertia) -> float:
    """Sum of the three moments about any axes through the joint's origin: tr I + 2 m |c|²."""
    x, y, z = pose.act(inertia.pose.xyz)
    return inertia.moments[0] + inertia.moments[3] + inertia.moments[5] + 2.0 * inertia.mass * (x * x + y * y + z * z)


def _positive(members: Iterable[tuple[Pose, Inertia]]) -> bool:
    """Whether the rotational inertia about the joint's origin, Σ R I Rᵀ + m (cᵀc 1 - c cᵀ), is positive definite.

    Sylvester's criterion on the matrix less `SINGULAR` of its trace.
    """
    xx = xy = xz = yy = yz = zz = 0.0
    for pose, inertia in members:
        at = pose * inertia.pose
        ixx, ixy, ixz, iyy, iyz, izz = _turned(inertia.moments, at)
        (x, y, z), mass = at.xyz, inertia.mass
        xx += ixx + mass * (y * y + z * z)
        yy += iyy + mass * (x * x + z * z)
        zz += izz + mass * (x * x + y * y)
        xy += ixy - mass * x * y
        xz += ixz - mass * x * z
        yz += iyz - mass * y * z
    bound = SINGULAR * (xx + yy + zz)
    xx, yy, zz = xx - bound, yy - bound, zz - bound
    second = xx * yy - xy * xy
    third = xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz)
    return xx > 0.0 and second > 0.0 and third > 0.0


def _turned(moments: Moments, pose: Pose) -> Moments:
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
