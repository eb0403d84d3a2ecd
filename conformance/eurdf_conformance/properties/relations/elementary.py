"""Every joint of several velocities, or of a pitch, is a row of joints that slide or turn."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from eurdf_conformance.level import Level, Version
from eurdf_conformance.properties.asked import all_frames, ask
from eurdf_conformance.properties.example import Example
from eurdf_conformance.properties.law import Law
from eurdf_conformance.properties.mechanism import (
    Change,
    Configuration,
    Coordinates,
    Joint,
    Limit,
    Link,
    Mechanism,
    Mimic,
    Vector,
)
from eurdf_conformance.properties.pair import Pair, related
from eurdf_conformance.properties.placement import Matrix, rotation_of
from eurdf_conformance.properties.relations.changing import in_velocities, with_poses_of
from eurdf_conformance.properties.truth import truth
from eurdf_conformance.protocol.message import Values

_WIDE = Limit(effort=1.0, velocity=1.0, lower=-100.0, upper=100.0)
_X, _Y, _Z = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
_AXES = {"x": _X, "y": _Y, "z": _Z}
KINDS = frozenset({"universal", "cylindrical", "helical", "planar", "floating"})


@dataclass
class Row:
    """What a joint becomes: joints in a row, the last of which has its name.

    Attributes:
        joints: For each its name, type and axis.
        coordinates: From those of the joint, those of each of them.
        velocities: From the coordinates of the joint, the matrix that takes its velocities to theirs.
        change: Of the last one.
        mimic: Of the first one.
    """

    joints: list[tuple[str, Any, Vector | None]]
    coordinates: Callable[[Coordinates], list[Coordinates]]
    velocities: Callable[[Coordinates], Matrix]
    change: Change | None = None
    mimic: Mimic | None = None
    names: list[str] = field(default_factory=list)


def elementary(example: Example, version: Version) -> Pair:
    """A mechanism whose joints slide, or turn, and the one that it was made from.

    With w the velocities of the second and v = J w those of the first, K′ = K J and M′ = Jᵀ M J.
    """
    mechanism = without_armature(example.mechanism)
    rows = {joint.name: row for joint in mechanism.joints if (row := row_of(mechanism, joint)) is not None}
    one, robot = in_rows(mechanism, rows), truth(mechanism, version)
    columns = robot.velocities
    before = truth(one, version).velocities
    configurations = list(mechanism.configurations.values())
    neutral = robot.neutral()

    def carry(values: Values, index: int) -> Values:
        q = {**neutral, **configurations[index]}
        J = np.zeros((len(before), len(columns)))
        for i, (name, number) in enumerate(columns):
            if name not in rows:
                J[before.index((name, number)), i] = 1.0
                continue
            row = rows[name]
            at = [k for part in row.names for k, column in enumerate(before) if column[0] == part]
            J[at, i] = row.velocities(tuple(q[name]))[:, number]
        return with_poses_of(in_velocities(values, J, columns), all_frames(mechanism))

    return Pair(ask(one, version), ask(mechanism, version), carry)


def row_of(mechanism: Mechanism, joint: Joint) -> Row | None:
    """The row that a joint is, if it is one."""
    kind, name = mechanism.type_of(joint), joint.name
    axis = joint.axis or _X
    change = mechanism.changes.get(name, Change())
    parts = [f"{name} part {i}" for i in range(3)]
    match kind:
        case "universal":
            first, second = (_AXES[each] if isinstance(each, str) else each for each in change.axes or ())
            row = Row(
                [(parts[0], "continuous", first), (name, "continuous", second)],
                lambda q: [q[:1], q[1:]],
                lambda q: np.eye(2),
            )
        case "cylindrical":
            row = Row(
                [(parts[0], "prismatic", axis), (name, "continuous", axis)],
                lambda q: [q[:1], q[1:]],
                lambda q: np.eye(2),
            )
        case "helical":
            slope = (change.pitch or 0.0) / (2.0 * np.pi)
            row = Row(
                [(parts[0], "prismatic", axis), (name, "continuous", axis)],
                lambda q: [q],
                lambda q: np.eye(1),
                mimic=Mimic(joint=name, multiplier=slope),
            )
        case "planar":
            row = Row(
                [(parts[0], "prismatic", _X), (parts[1], "prismatic", _Y), (name, "continuous", _Z)],
                lambda q: [q[:1], q[1:2], q[2:]],
                lambda q: _turned(rotation_of((0.0, 0.0, np.sin(q[2] / 2), np.cos(q[2] / 2))), 2),
            )
        case "floating":
            row = Row(
                [*zip(parts, ["prismatic"] * 3, (_X, _Y, _Z), strict=True), (name, "continuous", None)],
                lambda q: [q[:1], q[1:2], q[2:3], q[3:]],
                lambda q: _turned(rotation_of(q[3:]), 3),
                change=Change(type="spherical"),
            )
        case _:
            return None
    row.names = [part for part, _, _ in row.joints if not (row.mimic and part != name)]
    return row


def in_rows(mechanism: Mechanism, rows: dict[str, Row]) -> Mechanism:
    """Each of some joints as a row of others, on links of no mass."""
    links, joints = list(mechanism.links), []
    for joint in mechanism.joints:
        if joint.name not in rows:
            joints.append(joint)
            continue
        parent, origin = joint.parent, joint.origin
        for name, kind, axis in rows[joint.name].joints:
            last = name == joint.name
            child = joint.child if last else f"link of {name}"
            links += [] if last else [Link(name=child)]
            part = Joint(
                name=name,
                type=kind,
                parent=parent,
                child=child,
                axis=axis,
                limit=_WIDE,
                mimic=None if last else rows[joint.name].mimic,
            )
            joints.append(part if parent != joint.parent else part.model_copy(update={"origin": origin}))
            parent = child
    kept = {name: change for name, change in mechanism.changes.items() if name not in rows}
    made = {name: row.change for name, row in rows.items() if row.change}
    return mechanism.replace(
        links=tuple(links),
        joints=tuple(joints),
        changes=kept | made,
        configurations={name: _in_rows(q, rows) for name, q in mechanism.configurations.items()},
    )


def without_armature(mechanism: Mechanism) -> Mechanism:
    """Without motors, and without the armatures of joints that become rows: those are of other velocities."""
    types = mechanism.types()
    return mechanism.replace(
        actuators=(),
        changes={
            name: change.model_copy(update={"armature": None}) if types.get(name) in KINDS else change
            for name, change in mechanism.changes.items()
        },
    )


def _in_rows(configuration: Configuration, rows: dict[str, Row]) -> Configuration:
    found: Configuration = {}
    for name, q in configuration.items():
        row = rows.get(name)
        found |= {name: q} if row is None else dict(zip(row.names, row.coordinates(q), strict=True))
    return found


def _turned(R: Matrix, lengths: int) -> Matrix:
    """What slides is seen from the child's frame, and turned back as the row has it."""
    J = np.eye(lengths + (1 if lengths == 2 else 3))
    J[:lengths, :lengths] = R[:lengths, :lengths]
    return J


def has_row(mechanism: Mechanism) -> bool:
    """Whether a joint is a row of others."""
    return any(mechanism.type_of(joint) in KINDS for joint in mechanism.joints)


LAWS = (
    Law(
        "elementary-joints",
        "Universal, cylindrical, helical, planar and floating joints are rows of joints that slide and turn.",
        ("EU-JNT-025", "EU-JNT-026", "EU-JNT-016", "EU-JNT-017", "EU-JNT-018", "EU-URD-032", "EU-JNT-015"),
        (Level.KINEMATICS, Level.DYNAMICS),
        related(elementary),
        versions=("2",),
        applies=has_row,
    ),
)
