"""Replacing a 3d closure by a spherical joint and a 6d closure leaves the possible motions the same."""

from __future__ import annotations

import numpy as np

from eurdf_conformance.comparison.difference import Difference
from eurdf_conformance.level import Level, Version
from eurdf_conformance.properties.conditioning import scaled
from eurdf_conformance.properties.document import configuration
from eurdf_conformance.properties.example import Example
from eurdf_conformance.properties.harness import Harness
from eurdf_conformance.properties.mechanism import Change, Inertia, Joint, Link, Mechanism
from eurdf_conformance.properties.placement import Matrix, pose_of, quaternion_of
from eurdf_conformance.properties.property import Property
from eurdf_conformance.properties.query import query_of
from eurdf_conformance.properties.relations.saying import with_inline_frames
from eurdf_conformance.properties.truth import truth
from eurdf_conformance.protocol.message import Values

#: Of an orthonormal basis; what is more is no rounding.
_NEAR = 1e-5

_BALL = Inertia(mass=0.5, moments=(0.01, 0.0, 0.0, 0.01, 0.0, 0.01))


def ball_closure(harness: Harness, example: Example, version: Version, level: Level) -> list[Difference]:
    """The null space of K equals that of the twin's K without the motions of the added spherical joints."""
    one, other = example.mechanism, with_balls(example.mechanism)
    before, after = (motions(harness, mechanism, version) for mechanism in (one, other))
    robot = truth(one, version)
    kept = [truth(other, version).velocities.index(column) for column in robot.velocities]
    projected = after[kept]
    wrong = []
    if after.shape[1] != before.shape[1]:
        why = "mobility with each 3d closure as a 6d closure on a spherical joint"
        wrong.append(Difference("/values/0/jacobian", before.shape[1], after.shape[1], why))
    elif before.size:
        basis = np.linalg.qr(projected)[0]
        off = float(np.abs(basis - before @ (before.T @ basis)).max())
        if off > _NEAR:
            why = "distance between the motions of the two mechanisms"
            wrong.append(Difference("/values/0/jacobian", 0.0, off, why))
    return wrong


def motions(harness: Harness, mechanism: Mechanism, version: Version) -> Matrix:
    """An orthonormal basis of the null space of K at the closed configuration, in unit-free velocities."""
    at = {"assembled": mechanism.configurations["assembled"]}
    robot, q = truth(mechanism, version), configuration(mechanism, at["assembled"], version)
    (values,) = harness.evaluate(query_of(mechanism, version, at=at, frames=[]), ("jacobian",))
    _, sizes, Vt = np.linalg.svd(scaled(stacked(values), robot, q))
    rank = int(np.sum(sizes > 1e-5 * sizes.max(initial=1.0)))
    return np.asarray(Vt[rank:].T)


def stacked(values: Values) -> Matrix:
    """All rows of K."""
    assert values.jacobian is not None
    return np.vstack([np.array(rows) for rows in values.jacobian.rows.values()])


def with_balls(mechanism: Mechanism) -> Mechanism:
    """Each 3d closure replaced by a 6d one between frame A and a link on a spherical joint at frame B."""
    mechanism = with_inline_frames(mechanism)
    robot, q = truth(mechanism, "2"), dict(mechanism.configurations["assembled"])
    at = robot.kinematics(q)
    links, joints, changes = list(mechanism.links), list(mechanism.joints), dict(mechanism.changes)
    closures = []
    for closure in mechanism.closures:
        if closure.type == "6d":
            closures.append(closure)
            continue
        name = f"ball of {closure.name}"
        _, a, b = robot.closures[closure.name]
        carrier = next(link for link, place in robot.tree.links.items() if place.body == b.body)
        origin = pose_of(np.linalg.inv(robot.tree.links[carrier].pose) @ b.pose)
        links.append(Link(name=name, inertia=_BALL))
        joints.append(Joint(name=f"{name}, joint", type="continuous", parent=carrier, child=name, origin=origin))
        changes[f"{name}, joint"] = Change(type="spherical")
        q[f"{name}, joint"] = quaternion_of(at.pose(b)[:3, :3].T @ at.pose(a)[:3, :3])
        closures.append(closure.model_copy(update={"type": "6d", "b": name}))
    return mechanism.replace(
        links=tuple(links),
        joints=tuple(joints),
        changes=changes,
        closures=tuple(closures),
        configurations={"assembled": q},
    )


def has_3d(mechanism: Mechanism) -> bool:
    """Whether the mechanism has a 3d closure."""
    return any(closure.type == "3d" for closure in mechanism.closures)


PROPERTIES = (
    Property(
        "ball-closure",
        "A 3d closure constrains a mechanism as a 6d closure on an added spherical joint does.",
        ("EU-CLO-009", "EU-CLO-008", "EU-CLO-010", "EU-JNT-015"),
        (Level.KINEMATICS,),
        ball_closure,
        versions=("2",),
        applies=has_3d,
        closures=1,
    ),
)
