"""Kinematics and dynamics of a mechanism in plain NumPy, written from the definitions of the joint types."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from eurdf.mechanism.body import Body, Inertia
from eurdf.mechanism.joint import Joint
from eurdf.mechanism.joint_types import JointType
from eurdf.mechanism.mechanism import Mechanism
from eurdf.mechanism.pose import Pose

Matrix = Any

#: How many axes a joint type has, where it is not one.
AXES = {JointType.UNIVERSAL: 2, JointType.SPHERICAL: 0, JointType.PLANAR: 0, JointType.FLOATING: 0}
MOVING = [kind for kind in JointType if kind is not JointType.FIXED]


def skew(v: Sequence[float]) -> Matrix:
    x, y, z = v
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])


def rotation(axis: Sequence[float], angle: float) -> Matrix:
    """Rodrigues: I + sin θ [a]ₓ + (1 - cos θ) [a]ₓ²."""
    a = skew(np.asarray(axis) / np.linalg.norm(axis))
    return np.eye(3) + math.sin(angle) * a + (1.0 - math.cos(angle)) * a @ a


def quaternion_rotation(quaternion: Sequence[float]) -> Matrix:
    """(w² - u·u) I + 2 u uᵀ + 2 w [u]ₓ."""
    u, w = np.array(quaternion[:3]), quaternion[3]
    return (w * w - u @ u) * np.eye(3) + 2.0 * np.outer(u, u) + 2.0 * w * skew(u)


def transform(R: Matrix, p: Sequence[float]) -> Matrix:
    M = np.eye(4)
    M[:3, :3], M[:3, 3] = R, p
    return M


def pose_matrix(pose: Pose) -> Matrix:
    return transform(quaternion_rotation(pose.quaternion), pose.xyz)


def motion(joint: Joint, c: Sequence[float]) -> Matrix:
    """Pose of the joint's moving frame in its frame at rest, for the coordinates of files."""
    a = [np.array(axis) / np.linalg.norm(axis) for axis in joint.axes]
    still, here = np.eye(3), np.zeros(3)
    match joint.type:
        case JointType.REVOLUTE | JointType.CONTINUOUS:
            return transform(rotation(a[0], c[0]), here)
        case JointType.PRISMATIC:
            return transform(still, c[0] * a[0])
        case JointType.HELICAL:
            return transform(rotation(a[0], c[0]), joint.pitch * c[0] / (2 * math.pi) * a[0])
        case JointType.CYLINDRICAL:
            return transform(rotation(a[0], c[1]), c[0] * a[0])
        case JointType.UNIVERSAL:
            return transform(rotation(a[0], c[0]) @ rotation(a[1], c[1]), here)
        case JointType.SPHERICAL:
            return transform(quaternion_rotation(c), here)
        case JointType.PLANAR:
            return transform(rotation((0, 0, 1), c[2]), (c[0], c[1], 0.0))
        case JointType.FLOATING:
            return transform(quaternion_rotation(c[3:]), c[:3])
    return np.eye(4)


def subspace(joint: Joint, c: Sequence[float]) -> Matrix:
    """Twists (linear, angular) of the moving frame, seen from itself, for unit velocities; shape (6, nv)."""
    a = [np.array(axis) / np.linalg.norm(axis) for axis in joint.axes]
    o = np.zeros(3)
    match joint.type:
        case JointType.REVOLUTE | JointType.CONTINUOUS:
            columns = [(o, a[0])]
        case JointType.PRISMATIC:
            columns = [(a[0], o)]
        case JointType.HELICAL:
            columns = [(joint.pitch / (2 * math.pi) * a[0], a[0])]
        case JointType.CYLINDRICAL:
            columns = [(a[0], o), (o, a[0])]
        case JointType.UNIVERSAL:
            columns = [(o, rotation(a[1], c[1]).T @ a[0]), (o, a[1])]
        case JointType.SPHERICAL:
            return np.eye(6)[:, 3:]
        case JointType.PLANAR:
            return np.eye(6)[:, [0, 1, 5]]
        case JointType.FLOATING:
            return np.eye(6)
        case JointType.FIXED:
            return np.zeros((6, 0))
    return np.array([np.concatenate(column) for column in columns]).T


def poses(
    mechanism: Mechanism, coordinates: Mapping[str, Sequence[float]], root: Matrix | None = None
) -> dict[str, Matrix]:
    """Pose of every body in the world."""
    found = {mechanism.bodies[0].name: np.eye(4) if root is None else root}
    for joint in mechanism.joints:
        moved = pose_matrix(joint.placement) @ motion(joint, coordinates.get(joint.name, joint.type.neutral))
        found[joint.child] = found[joint.parent] @ moved @ pose_matrix(joint.offset)
    return found


def seen_from(M: Matrix, twists: Matrix) -> Matrix:
    """Twists of a body, seen from a frame at M of it, as seen from the body's other frame: Ad(M⁻¹)."""
    R, p = M[:3, :3], M[:3, 3]
    linear, angular = twists[:3], twists[3:]
    return np.vstack([R.T @ (linear - skew(p) @ angular), R.T @ angular])


def jacobians(mechanism: Mechanism, coordinates: Mapping[str, Sequence[float]]) -> dict[str, Matrix]:
    """For every body of a mechanism with a fixed root its Jacobian, seen from the body; shape (6, nv)."""
    nv = sum(joint.type.nv for joint in mechanism.joints)
    found = {mechanism.bodies[0].name: np.zeros((6, nv))}
    column = 0
    for joint in mechanism.joints:
        c = coordinates.get(joint.name, joint.type.neutral)
        step = pose_matrix(joint.placement) @ motion(joint, c)
        J = seen_from(step, found[joint.parent])
        own = joint.type.nv
        J[:, column : column + own] = subspace(joint, c)
        column += own
        found[joint.child] = seen_from(pose_matrix(joint.offset), J)
    return found


def spatial_inertia(inertia: Inertia) -> Matrix:
    """Of a body in its frame, for twists (linear, angular): m 1, -m [c]ₓ; m [c]ₓ, I - m [c]ₓ²."""
    ixx, ixy, ixz, iyy, iyz, izz = inertia.moments
    R = quaternion_rotation(inertia.pose.quaternion)
    about_centre = R @ np.array([[ixx, ixy, ixz], [ixy, iyy, iyz], [ixz, iyz, izz]]) @ R.T
    m, c = inertia.mass, skew(inertia.pose.xyz)
    return np.block([[m * np.eye(3), -m * c], [m * c, about_centre - m * c @ c]])


def some_inertia(random: np.random.Generator) -> Inertia:
    A = random.uniform(-1.0, 1.0, (3, 3))
    A = A @ A.T + 0.1 * np.eye(3)
    moments = (A[0, 0], A[0, 1], A[0, 2], A[1, 1], A[1, 2], A[2, 2])
    return Inertia(random.uniform(0.5, 2.0), some_pose(random), tuple(map(float, moments)))


def some_pose(random: np.random.Generator) -> Pose:
    return Pose.from_xyz_rpy(tuple(random.uniform(-1, 1, 3).tolist()), tuple(random.uniform(-2, 2, 3).tolist()))


def some_joint(kind: JointType, random: np.random.Generator, parent: str = "base", child: str = "tip") -> Joint:
    count = AXES.get(kind, 1)
    axes = [random.uniform(-1, 1, 3) for _ in range(count)]
    if count == 2 and random.random() < 0.5:
        axes = [np.array((0.0, 0.0, 1.0)), np.array((0.0, -2.0, 0.0))]
    return Joint(
        f"{kind}_{child}",
        kind,
        parent,
        child,
        some_pose(random),
        axes=tuple(tuple(axis.tolist()) for axis in axes) if kind is not JointType.FIXED else (),
        pitch=0.3 if kind is JointType.HELICAL else 0.0,
    )


def some_coordinates(kind: JointType, random: np.random.Generator) -> tuple[float, ...]:
    values = random.uniform(-1.5, 1.5, len(kind.coordinates))
    if kind.quaternion is not None:
        values[kind.quaternion :] /= np.linalg.norm(values[kind.quaternion :])
    return tuple(values.tolist())


def tree_of_all_types(random: np.random.Generator) -> Mechanism:
    """Every joint type once, fixed too, each hung from a body before it; in depth-first order."""
    kinds = list(JointType)
    random.shuffle(kinds)
    children: dict[str, list[Joint]] = {}
    for index, kind in enumerate(kinds):
        parent = "b0" if index == 0 else f"b{random.integers(max(0, index - 2), index + 1)}"
        children.setdefault(parent, []).append(some_joint(kind, random, parent, f"b{index + 1}"))
    ordered: list[Joint] = []
    stack = sorted(children["b0"], key=lambda joint: joint.name, reverse=True)
    while stack:
        ordered.append(stack.pop())
        stack += sorted(children.get(ordered[-1].child, ()), key=lambda joint: joint.name, reverse=True)
    bodies = [Body("b0"), *(Body(joint.child, some_inertia(random)) for joint in ordered)]
    return Mechanism("tree", "", "fixed", tuple(bodies), tuple(ordered))
