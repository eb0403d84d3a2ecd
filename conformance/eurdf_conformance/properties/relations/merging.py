"""Three revolute joints through one point move as the spherical joint that they are merged into."""

from __future__ import annotations

import numpy as np

from eurdf_conformance.level import Level, Version
from eurdf_conformance.oracle.spatial import rotation
from eurdf_conformance.properties.example import Example
from eurdf_conformance.properties.mechanism import Configuration, Mechanism
from eurdf_conformance.properties.pair import Pair, related
from eurdf_conformance.properties.placement import Matrix, inverse, matrix_of, quaternion_of
from eurdf_conformance.properties.property import Property
from eurdf_conformance.properties.query import all_frames, query_of
from eurdf_conformance.properties.relations.changing import in_velocities, with_poses_of
from eurdf_conformance.properties.truth import truth
from eurdf_conformance.protocol.message import Values

Angles = tuple[float, float, float]


def merging(example: Example, version: Version) -> Pair:
    """A mechanism with merged joints, and the same with the three revolutes instead.

    With a the axes at zero, seen from the last frame, R = R(a₁, θ₁) R(a₂, θ₂) R(a₃, θ₃) and ω = A(θ) θ̇ seen from the
    child: K′ = K A and M′ = Aᵀ M A.
    """
    mechanism, chance = weightless(example.mechanism), example.chance
    balls = {name: change.merges for name, change in mechanism.changes.items() if change.merges}
    apart = unmerged(mechanism)
    axes = {name: axes_at_zero(mechanism, merged) for name, merged in balls.items()}
    one: dict[str, Configuration] = {}
    other: dict[str, Configuration] = {}
    turns: list[dict[str, Matrix]] = []
    for name, stated in mechanism.configurations.items():
        one[name], other[name] = dict(stated), {joint: q for joint, q in stated.items() if joint not in balls}
        turns.append({})
        for ball, merged in balls.items():
            angles = [chance.between(-1.5, 1.5) for _ in merged]
            R, A = turned(axes[ball], angles)
            one[name][ball] = quaternion_of(R)
            other[name] |= {joint: (angle,) for joint, angle in zip(merged, angles, strict=True)}
            turns[-1][ball] = A
    columns, before = truth(apart, version).velocities, truth(mechanism, version).velocities
    hidden = {joint for merged in balls.values() for joint in merged[:-1]}
    hidden |= {joint.child for joint in mechanism.joints if joint.name in hidden}
    hidden |= balls.keys() - set(all_frames(apart))
    frames = [frame for frame in all_frames(mechanism) if frame not in hidden]

    def carry(values: Values, index: int) -> Values:
        J = np.zeros((len(before), len(columns)))
        for i, column in enumerate(columns):
            owner = next((ball for ball, merged in balls.items() if column[0] in merged), None)
            if owner is None:
                J[before.index(column), i] = 1.0
            else:
                at = [before.index((owner, k)) for k in range(3)]
                J[at, i] = turns[index][owner][:, balls[owner].index(column[0])]
        return with_poses_of(in_velocities(values, J, columns), frames)

    return Pair(
        query_of(mechanism, version, at=one, frames=frames), query_of(apart, version, at=other, frames=frames), carry
    )


def weightless(mechanism: Mechanism) -> Mechanism:
    """Without the inertias between merged joints, and without their motors and armatures."""
    between = {
        joint.child
        for joint in mechanism.joints
        for change in mechanism.changes.values()
        if joint.name in change.merges[:-1]
    }
    balls = {name for name, change in mechanism.changes.items() if change.merges}
    return mechanism.replace(
        links=tuple(
            link.model_copy(update={"inertia": None}) if link.name in between else link for link in mechanism.links
        ),
        changes={
            name: change.model_copy(update={"armature": None}) if name in balls else change
            for name, change in mechanism.changes.items()
        },
        actuators=tuple(each for each in mechanism.actuators if each.joint not in balls),
    )


def unmerged(mechanism: Mechanism) -> Mechanism:
    """Without the merges and without configurations, which would name joints that do not exist."""
    changes = {name: change for name, change in mechanism.changes.items() if not change.merges}
    return mechanism.replace(changes=changes, configurations={})


def axes_at_zero(mechanism: Mechanism, merged: tuple[str, ...]) -> Matrix:
    """The axes of three joints, one per row, in the last joint's frame."""
    joints = {joint.name: joint for joint in mechanism.joints}
    frame, seen = np.eye(4), []
    for name in merged:
        frame = frame @ matrix_of(joints[name].origin)
        axis = np.array(joints[name].axis)
        seen.append(frame[:3, :3] @ axis / np.linalg.norm(axis))
    return np.array(seen) @ inverse(frame)[:3, :3].T


def turned(axes: Matrix, angles: list[float]) -> tuple[Matrix, Matrix]:
    """R, and A of ω = A θ̇."""
    first, second, third = (rotation(axis, angle) for axis, angle in zip(axes, angles, strict=True))
    A = np.array([third.T @ second.T @ axes[0], third.T @ axes[1], axes[2]]).T
    return first @ second @ third, A


def has_merged(mechanism: Mechanism) -> bool:
    """Whether joints are merged."""
    return any(change.merges for change in mechanism.changes.values())


PROPERTIES = (
    Property(
        "merging",
        "A merged spherical joint moves as the three joints that it replaces.",
        ("EU-JNT-022", "EU-JNT-015", "EU-JNT-026", "EU-INR-005"),
        (Level.KINEMATICS, Level.DYNAMICS),
        related(merging),
        versions=("2",),
        applies=has_merged,
    ),
)
