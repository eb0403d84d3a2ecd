"""The whole robot at another pose: what is given in the world moves with it, and nothing else changes."""

from __future__ import annotations

import numpy as np

from eurdf_conformance.level import Level, Version
from eurdf_conformance.properties.chance import Chance
from eurdf_conformance.properties.example import Example
from eurdf_conformance.properties.mechanism import Configuration, Coordinates, Joint, Link, Mechanism, Pose
from eurdf_conformance.properties.pair import Pair, related
from eurdf_conformance.properties.placement import Matrix, matrix_of, quaternion_of, rotation_of
from eurdf_conformance.properties.property import Property
from eurdf_conformance.properties.query import all_frames, query_of
from eurdf_conformance.properties.relations.changing import in_velocities, moved
from eurdf_conformance.protocol.message import MassMatrix, Values

_NEUTRAL = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0)


def moving(example: Example, version: Version) -> Pair:
    """A robot, and the same robot at another pose: on another root link, or with another pose of its floating root."""
    mechanism = example.mechanism
    pose = any_pose(example.chance)
    T = matrix_of(pose)
    if mechanism.root == "fixed":
        other = mounted(mechanism, pose)
        return Pair(
            query_of(mechanism, version),
            query_of(other, version, frames=all_frames(mechanism)),
            carry=lambda values, index: moved(values, T),
        )
    at = {
        name: {**q, "root_joint": _afloat(T @ _matrix(q.get("root_joint", _NEUTRAL)))}
        for name, q in mechanism.configurations.items()
    }
    return Pair(
        query_of(mechanism, version), query_of(mechanism, version, at=at), carry=lambda values, index: moved(values, T)
    )


def floating(example: Example, version: Version) -> Pair:
    """A robot with a fixed root, and the same with a floating root, which changes neither K nor M of its joints."""
    mechanism = example.mechanism
    pose = any_pose(example.chance)
    T = matrix_of(pose)
    at: dict[str, Configuration] = {
        name: {**q, "root_joint": _afloat(T)} for name, q in mechanism.configurations.items()
    }
    other = query_of(mechanism.replace(root="floating"), version, at=at)

    def carry(values: Values, index: int) -> Values:
        if values.jacobian is None:
            return moved(values, T)
        columns = [("root_joint", i) for i in range(6)]
        J = np.hstack([np.zeros((len(values.jacobian.columns), 6)), np.eye(len(values.jacobian.columns))])
        return moved(in_velocities(values, J, [*columns, *values.jacobian.columns]), T)

    return Pair(query_of(mechanism, version), other, carry, seen=_without_root)


def any_pose(chance: Chance) -> Pose:
    """A pose within 2 m."""
    x, y, z = (chance.between(-2, 2) for _ in range(3))
    roll, pitch, yaw = (chance.between(-3, 3) for _ in range(3))
    return Pose(xyz=(x, y, z), rpy=(roll, pitch, yaw))


def mounted(mechanism: Mechanism, pose: Pose) -> Mechanism:
    """The root link fixed to a new root at a pose."""
    carried = {joint.child for joint in mechanism.joints}
    root = next(link.name for link in mechanism.links if link.name not in carried)
    mount = Joint(name="mount of all", type="fixed", parent="floor", child=root, origin=pose)
    return mechanism.replace(links=(*mechanism.links, Link(name="floor")), joints=(*mechanism.joints, mount))


def _without_root(values: Values, index: int) -> Values:
    if values.mass_matrix is None:
        return values
    kept = [i for i, (joint, _) in enumerate(values.mass_matrix.columns) if joint != "root_joint"]
    matrix = [[values.mass_matrix.matrix[i][j] for j in kept] for i in kept]
    M = MassMatrix(columns=[values.mass_matrix.columns[i] for i in kept], matrix=matrix)
    return values.model_copy(update={"mass_matrix": M})


def _matrix(q: Coordinates) -> Matrix:
    M = np.eye(4)
    M[:3, 3], M[:3, :3] = q[:3], rotation_of(q[3:])
    return M


def _afloat(M: Matrix) -> Coordinates:
    return (*M[:3, 3].tolist(), *quaternion_of(M[:3, :3]))


PROPERTIES = (
    Property(
        "moving-base",
        "The pose of the whole robot does not change residuals, K and M.",
        ("EU-VER-004", "EU-JNT-025", "EU-CLO-008", "EU-CLO-009", "EU-CLO-010", "EU-INR-006"),
        (Level.KINEMATICS, Level.DYNAMICS),
        related(moving),
    ),
    Property(
        "floating-base",
        "A floating root adds zero columns to K and does not change the M of the joints.",
        ("EU-VER-004", "EU-JNT-025", "EU-JNT-026", "EU-CLO-010", "EU-INR-006"),
        (Level.KINEMATICS, Level.DYNAMICS),
        related(floating),
        versions=("2",),
        applies=lambda mechanism: mechanism.root == "fixed",
    ),
)
