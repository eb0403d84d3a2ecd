"""The description of a mechanism as a YAML value, in either version."""

from __future__ import annotations

from typing import Any

from eurdf_conformance.level import Version
from eurdf_conformance.properties.mechanism import (
    Actuator,
    Change,
    Closure,
    Configuration,
    Coupling,
    Mechanism,
    Pose,
    Spot,
)

_PROPERTIES = ("damping", "friction", "armature", "stiffness", "rest")
_LIMITS = ("lower", "upper", "velocity", "effort")
_WORDS = {"spherical": "SPHERICAL", "fixed": "FIXED"}

Document = dict[str, Any]


def document(mechanism: Mechanism, version: Version) -> Document:
    """The description. One of version 1 is of a mechanism that version 1 can say."""
    if version == "1":
        return version1(mechanism)
    return version2(mechanism) | ({"extended_urdf": "2.1"} if version == "2.1" else {})


def version2(mechanism: Mechanism) -> Document:
    """The description in version 2; empty parts and a fixed root are left out."""
    found: Document = {"extended_urdf": "2.0"}
    if mechanism.root != "fixed":
        found["root"] = mechanism.root
    parts = {
        "closures": [
            {
                "name": closure.name,
                "type": closure.type,
                "frames": [_reference(closure.a), _reference(closure.b)],
                **_added(closure),
            }
            for closure in mechanism.closures
        ],
        "couplings": [_coupling(coupling) for coupling in mechanism.couplings],
        "joints": {name: _change(change) for name, change in mechanism.changes.items() if change.says_something},
        "actuators": [_actuator(actuator) for actuator in mechanism.actuators],
        "frames": [{"name": frame.name, **_spot(frame.spot)} for frame in mechanism.frames],
        "configurations": {
            name: {joint: list(q) if len(q) > 1 else q[0] for joint, q in stated.items()}
            for name, stated in mechanism.configurations.items()
        },
    }
    return found | {key: value for key, value in parts.items() if value} | mechanism.own


def _added(closure: Closure) -> Document:
    """What version 2.1 adds to a closure."""
    found: Document = {} if closure.axis is None else {"axis": list(closure.axis)}
    if closure.axes is not None:
        found["axes"] = [list(axis) for axis in closure.axes]
    if closure.length is not None:
        found["length"] = closure.length
    if closure.compliance is not None:
        found["compliance"] = closure.compliance.model_dump(exclude_none=True)
    return found


def _coupling(coupling: Coupling) -> Document:
    offset = {"offset": coupling.offset} if coupling.offset else {}
    return {"name": coupling.name, "joints": dict(coupling.joints), **offset}


def version1(mechanism: Mechanism) -> Document:
    """Merges are not written: version 1 finds them. Nor is `type` where all closures are 6d, EU-ONE-004."""
    words = {name: _word(change) for name, change in mechanism.changes.items() if not change.merges}
    types = [closure.type for closure in mechanism.closures]
    motors = [name for actuator in mechanism.actuators for name in names1(mechanism, actuator.joint)]
    found: Document = {
        "closed_loop": [[closure.a, closure.b] for closure in mechanism.closures],
        "type": types if "3d" in types else [],
        "name_mot": motors,
        "joint_name": list(words),
        "joint_type": list(words.values()),
    }
    return {key: value for key, value in found.items() if value} | mechanism.own


def names1(mechanism: Mechanism, joint: str) -> list[str]:
    """The names of a joint in version 1: a universal joint is two joints, EU-ONE-006."""
    change = mechanism.changes.get(joint)
    if change is None or change.type != "universal":
        return [joint]
    assert isinstance(change.axes, str)
    return [f"{joint}_{letter}" for letter in change.axes.upper()]


def configuration(mechanism: Mechanism, stated: Configuration, version: Version) -> Configuration:
    """A configuration of the mechanism, by the joints of a version."""
    if version != "1":
        return stated
    found: Configuration = {}
    for joint, q in stated.items():
        names = names1(mechanism, joint)
        found |= {names[0]: q} if len(names) == 1 else {name: (angle,) for name, angle in zip(names, q, strict=True)}
    return found


def _word(change: Change) -> str:
    assert change.type is not None
    return _WORDS[change.type] if change.type in _WORDS else f"UJOINT_{change.axes}".upper()


def _change(change: Change) -> Any:
    found: Document = {} if change.type is None else {"type": change.type}
    if isinstance(change.axes, str):
        found["axes"] = change.axes
    elif change.axes is not None:
        found["axes"] = [list(axis) for axis in change.axes]
    found |= {} if change.pitch is None else {"pitch": change.pitch}
    found |= {"merges": list(change.merges)} if change.merges else {}
    limits = _stated(change, _LIMITS)
    found |= ({"limits": limits} if limits else {}) | _stated(change, _PROPERTIES)
    found |= ({"mimic": False} if change.freed else {}) | change.own
    return change.type if found.keys() == {"type"} else found


def _stated(change: Change, names: tuple[str, ...]) -> Document:
    values = {name: getattr(change, name) for name in names}
    return {
        name: list(value) if isinstance(value, tuple) else value for name, value in values.items() if value is not None
    }


def _actuator(actuator: Actuator) -> Any:
    stated = actuator.model_dump(exclude={"joint"}, exclude_none=True)
    if actuator.control is not None:
        stated["control"] = list(actuator.control)
    return {"joint": actuator.joint, **stated} if stated else actuator.joint


def _reference(reference: str | Spot) -> Any:
    return reference if isinstance(reference, str) else _spot(reference)


def _spot(spot: Spot) -> Document:
    return {spot.on: spot.of, **_pose(spot.pose)}


def _pose(pose: Pose) -> Document:
    return {key: list(value) for key, value in (("xyz", pose.xyz), ("rpy", pose.rpy)) if any(value)}
