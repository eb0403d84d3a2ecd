"""Each joint with several velocities, or with a pitch, moves as a row of prismatic and revolute joints."""

from __future__ import annotations

import numpy as np

from eurdf_conformance.level import Level, Version
from eurdf_conformance.properties.example import Example
from eurdf_conformance.properties.mechanism import Configuration, Joint, Limit, Link, Mechanism
from eurdf_conformance.properties.pair import Pair, related
from eurdf_conformance.properties.property import Property
from eurdf_conformance.properties.query import all_frames, query_of
from eurdf_conformance.properties.relations.changing import in_velocities, with_poses_of
from eurdf_conformance.properties.relations.joint_row import KINDS, JointRow, row_of
from eurdf_conformance.properties.truth import truth
from eurdf_conformance.protocol.message import Values

_WIDE = Limit(effort=1.0, velocity=1.0, lower=-100.0, upper=100.0)


def elementary(example: Example, version: Version) -> Pair:
    """A mechanism of prismatic and revolute joints, and the one that it was made from.

    With w the velocities of the second and v = J w those of the first, K′ = K J and M′ = Jᵀ M J.
    """
    mechanism = without_armature(example.mechanism)
    rows = {joint.name: row for joint in mechanism.joints if (row := row_of(mechanism, joint)) is not None}
    one, robot = in_rows(mechanism, rows), truth(mechanism, version)
    before, columns = truth(one, version).velocities, robot.velocities
    configurations = list(mechanism.configurations.values())
    neutral = robot.neutral()

    def carry(values: Values, index: int) -> Values:
        q = {**neutral, **configurations[index]}
        J = np.zeros((len(before), len(columns)))
        for i, (name, number) in enumerate(columns):
            if name not in rows:
                J[before.index((name, number)), i] = 1.0
                continue
            at = [k for part in rows[name].movers for k, column in enumerate(before) if column[0] == part]
            J[at, i] = rows[name].velocities(tuple(q[name]))[:, number]
        return with_poses_of(in_velocities(values, J, columns), all_frames(mechanism))

    return Pair(query_of(one, version), query_of(mechanism, version), carry)


def in_rows(mechanism: Mechanism, rows: dict[str, JointRow]) -> Mechanism:
    """Some joints replaced by rows of joints, with massless links between them."""
    links, joints = list(mechanism.links), []
    for joint in mechanism.joints:
        if joint.name not in rows:
            joints.append(joint)
            continue
        parts = parts_of(joint, rows[joint.name])
        links += [Link(name=part.child) for part in parts[:-1]]
        joints += parts
    kept = {name: change for name, change in mechanism.changes.items() if name not in rows}
    made = {name: row.change for name, row in rows.items() if row.change}
    return mechanism.replace(
        links=tuple(links),
        joints=tuple(joints),
        changes=kept | made,
        configurations={name: _in_rows(q, rows) for name, q in mechanism.configurations.items()},
    )


def parts_of(joint: Joint, row: JointRow) -> list[Joint]:
    """The joints of a row, in order."""
    ends = [joint.parent, *(f"link of {name}" for name, _, _ in row.parts[:-1]), joint.child]
    parts = [
        Joint(name=name, type=kind, parent=ends[i], child=ends[i + 1], axis=axis, limit=_WIDE)
        for i, (name, kind, axis) in enumerate(row.parts)
    ]
    parts[0] = parts[0].model_copy(update={"origin": joint.origin, "mimic": row.mimic})
    return parts


def without_armature(mechanism: Mechanism) -> Mechanism:
    """Without motors, and without armatures of replaced joints, whose velocities are others."""
    types = mechanism.types()
    return mechanism.replace(
        actuators=(),
        changes={
            name: change.model_copy(update={"armature": None}) if types.get(name) in KINDS else change
            for name, change in mechanism.changes.items()
        },
    )


def has_row(mechanism: Mechanism) -> bool:
    """Whether a joint can be replaced by a row."""
    return any(mechanism.type_of(joint) in KINDS for joint in mechanism.joints)


def _in_rows(configuration: Configuration, rows: dict[str, JointRow]) -> Configuration:
    found: Configuration = {}
    for name, q in configuration.items():
        row = rows.get(name)
        found |= {name: q} if row is None else dict(zip(row.movers, row.coordinates(q), strict=True))
    return found


PROPERTIES = (
    Property(
        "elementary-joints",
        "Universal, cylindrical, helical, planar and floating joints move as chains of prismatic and revolute joints.",
        ("EU-JNT-025", "EU-JNT-026", "EU-JNT-016", "EU-JNT-017", "EU-JNT-018", "EU-URD-032", "EU-JNT-015"),
        (Level.KINEMATICS, Level.DYNAMICS),
        related(elementary),
        versions=("2",),
        applies=has_row,
    ),
)
