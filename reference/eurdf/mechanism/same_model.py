"""Whether two descriptions, of either version, make the same model of one URDF."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import TypeVar

from eurdf.mechanism.body import Anchor, Body, Frame
from eurdf.mechanism.constraint import Constraint
from eurdf.mechanism.joint import Joint
from eurdf.mechanism.mechanism import Mechanism

_Named = TypeVar("_Named", Body, Joint, Frame, Constraint)


def differences(one: Mechanism, other: Mechanism) -> list[str]:
    """The differences of two mechanisms, one sentence each; none if they are the same model.

    Two revolutes that version 1 made of a joint are the same as one universal joint; their coordinates are the same two
    angles. The order of joints follows from their names. Versions, metadata and user data are not compared.
    """
    a, b = with_universal_joints(one), with_universal_joints(other)
    found = []
    if a.name != b.name or a.root != b.root:
        found.append("the root differs")
    for what, before, after in (
        ("body", _by_name(a.bodies), _by_name(b.bodies)),
        ("joint", _by_name(a.joints), _by_name(b.joints)),
        ("frame", _by_name(a.frames), _by_name(b.frames)),
        ("closure", _by_name(a.closures), _by_name(b.closures)),
        ("coupling", _by_name(a.couplings), _by_name(b.couplings)),
        ("configuration", a.configurations, b.configurations),
    ):
        found += _differing(what, before, after)
    if not found and a.constraints != b.constraints:
        found.append("the order of the closures differs")
    if a.actuators != b.actuators:
        found.append("the actuators or their order differ")
    if a.motors != b.motors:
        found.append("the names or control ranges of actuators differ")
    return found


def with_universal_joints(mechanism: Mechanism) -> Mechanism:
    """The mechanism with one universal joint in place of each two that version 1 split a joint into (EU-ONE-006)."""
    virtual = {body.name for body in mechanism.bodies if body.virtual}
    if not virtual:
        return mechanism
    carried = {joint.child: joint for joint in mechanism.joints}
    halves: dict[str, str] = {}
    joints = []
    for joint in mechanism.joints:
        if joint.child in virtual:
            continue
        if joint.parent in virtual:
            first = carried[joint.parent]
            universal = first.universal(joint, first.name[: -len("_X")])
            halves[first.name] = halves[joint.name] = universal.name
            joints.append(universal)
        else:
            joints.append(joint)
    names = set(halves.values())

    def renamed(anchor: Anchor) -> Anchor:
        return anchor if anchor.body in virtual else replace(anchor, frame=halves.get(anchor.frame, anchor.frame))

    closures = tuple(replace(closure, a=renamed(closure.a), b=renamed(closure.b)) for closure in mechanism.closures)
    actuators: list[str] = []
    for name in mechanism.actuators:
        # Both halves, the first before the second, are the universal joint; one half alone stays a revolute.
        if name in halves and actuators and actuators[-1] == _other(name, halves, mechanism):
            actuators[-1] = halves[name]
        else:
            actuators.append(name)
    return replace(
        mechanism,
        bodies=tuple(body for body in mechanism.bodies if not body.virtual),
        joints=tuple(joints),
        frames=tuple(frame for frame in mechanism.frames if frame.name not in names),
        closures=closures,
        actuators=tuple(actuators),
    )


def with_whole_joints(mechanism: Mechanism) -> Mechanism:
    """The same, as version 2 can have it: unless only one of two such joints is actuated."""
    joined = with_universal_joints(mechanism)
    return joined if {joint.name for joint in joined.joints}.issuperset(joined.actuators) else mechanism


def _other(name: str, halves: Mapping[str, str], mechanism: Mechanism) -> str | None:
    """The first half of a universal joint, given the second."""
    first, second = (joint.name for joint in mechanism.joints if halves.get(joint.name) == halves[name])
    return first if name == second else None


def _by_name(items: Iterable[_Named]) -> dict[str, _Named]:
    return {item.name: item for item in items}


def _differing(what: str, before: Mapping[str, object], after: Mapping[str, object]) -> list[str]:
    found = [f"{what} '{name}' is missing" for name in before if name not in after]
    found += [f"{what} '{name}' is new" for name in after if name not in before]
    found += [f"{what} '{name}' differs" for name in before if name in after and before[name] != after[name]]
    return found
