"""Both versions in one form: a file that conforms to its schema, as an `Extension`."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, Literal

from eurdf.format.conforms import keys_of
from eurdf.format.extension import (
    ActuatorEntry,
    ClosureEntry,
    ConfigurationEntry,
    CouplingEntry,
    Extension,
    FrameEntry,
    FrameReference,
    JointEntry,
)
from eurdf.format.numbers import lower_limit, upper_limit
from eurdf.format.own_key import is_own_key, may_have_own_keys
from eurdf.mechanism.constraint import Compliance
from eurdf.mechanism.pose import Vector3
from eurdf.reading.yaml_node import Pointer
from eurdf.reading.yaml_reader import YamlDocument

_HERE: Vector3 = (0.0, 0.0, 0.0)
_UNIT = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}

#: Keys of a joint whose values are numbers for each of its coordinates or velocities.
_PROPERTIES = frozenset({"damping", "friction", "armature", "stiffness", "rest"})

#: What a number of a limit means, by its key.
_LIMITS = {"lower": lower_limit, "upper": upper_limit, "velocity": upper_limit, "effort": upper_limit}

#: A part of the file, as plain data.
_Mapping = Mapping[str, Any]


def from_version1(document: YamlDocument) -> Extension:
    """The description in a file of version 1, whose parallel lists are of equal length.

    Keys other than the five are kept (EU-ONE-008). Closures are named ``closure_1``, ``closure_2``, … in file order
    (EU-ONE-005), and are 6d where the key ``type`` is left out (EU-ONE-004).
    """
    data = document.data
    closed_loop = data.get("closed_loop", ())
    types = data.get("type", ["6d"] * len(closed_loop))
    closures = tuple(
        ClosureEntry(
            pointer=("closed_loop", index),
            name=f"closure_{index + 1}",
            type=closure_type.lower(),
            a=FrameReference(("closed_loop", index, 0), name=a),
            b=FrameReference(("closed_loop", index, 1), name=b),
        )
        for index, ((a, b), closure_type) in enumerate(zip(closed_loop, types, strict=True))
    )
    joints = tuple(
        _version1_joint(("joint_name", index), name, joint_type)
        for index, (name, joint_type) in enumerate(
            zip(data.get("joint_name", ()), data.get("joint_type", ()), strict=True)
        )
    )
    known = keys_of("1")
    return Extension(
        document,
        version="1",
        closures=closures,
        joints=joints,
        actuators=tuple(
            ActuatorEntry(("name_mot", index), name) for index, name in enumerate(data.get("name_mot", ()))
        ),
        own_data={(key,): value for key, value in data.items() if key not in known},
    )


def _version1_joint(pointer: Pointer, name: str, joint_type: str) -> JointEntry:
    if joint_type == "SPHERICAL":
        return JointEntry(pointer, name, type="spherical")
    if joint_type == "FIXED":
        return JointEntry(pointer, name, type="fixed")
    return JointEntry(pointer, name, type="universal", split=joint_type.removeprefix("UJOINT_"))


def from_version2(version: Literal["2.0", "2.1"], document: YamlDocument) -> Extension:
    """The description in a file of version 2.0 or 2.1."""
    data = document.data
    return Extension(
        document,
        version=version,
        urdf=data.get("urdf", "robot.urdf"),
        root=data.get("root", "fixed"),
        closures=tuple(
            [_closure(("closures", index), closure) for index, closure in enumerate(data.get("closures", ()))]
        ),
        couplings=tuple(
            [_coupling(("couplings", index), coupling) for index, coupling in enumerate(data.get("couplings", ()))]
        ),
        joints=tuple([_joint(name, joint) for name, joint in _named(data.get("joints", {}))]),
        actuators=tuple(
            [_actuator(("actuators", index), actuator) for index, actuator in enumerate(data.get("actuators", ()))]
        ),
        frames=tuple(
            [
                FrameEntry(("frames", index), frame["name"], _reference(("frames", index), frame))
                for index, frame in enumerate(data.get("frames", ()))
            ]
        ),
        configurations=tuple(
            [
                ConfigurationEntry(
                    ("configurations", name),
                    name,
                    {joint: q if type(q) is tuple else (q,) for joint, q in _numbers_by_name(joints)},
                )
                for name, joints in _named(data.get("configurations", {}))
            ]
        ),
        metadata=data.get("metadata", {}),
        own_data=dict(_own_data(data, ())) if may_have_own_keys(document.source.text) else {},
    )


def _named(entries: _Mapping) -> Iterator[tuple[str, Any]]:
    """EU-EXT-004: the entries by name, without user-defined keys."""
    return ((name, entry) for name, entry in entries.items() if not is_own_key(name))


def _numbers_by_name(entries: _Mapping) -> Iterator[tuple[str, Any]]:
    return ((name, _numbers(value)) for name, value in _named(entries))


def _reference(pointer: Pointer, frame: str | _Mapping) -> FrameReference:
    if isinstance(frame, str):
        return FrameReference(pointer, name=frame)
    xyz, rpy = _vector(frame.get("xyz", _HERE)), _vector(frame.get("rpy", _HERE))
    if "link" in frame:
        return FrameReference(pointer, frame["link"], "link", xyz=xyz, rpy=rpy)
    return FrameReference(pointer, frame["joint"], "joint", xyz=xyz, rpy=rpy)


def _closure(pointer: Pointer, closure: _Mapping) -> ClosureEntry:
    a, b = closure["frames"]
    kind = closure["type"]
    axes: tuple[Vector3, Vector3] | None = None
    axes_pointer: Pointer = ()
    if "axes" in closure:
        axes = _vector(closure["axes"][0]), _vector(closure["axes"][1])
        axes_pointer = (*pointer, "axes")
    elif kind == "hinge":
        axis = _vector(closure.get("axis", _UNIT["z"]))
        axes, axes_pointer = (axis, axis), (*pointer, "axis")
    return ClosureEntry(
        pointer,
        closure["name"],
        kind,
        _reference((*pointer, "frames", 0), a),
        _reference((*pointer, "frames", 1), b),
        axes,
        axes_pointer,
        float(closure["length"]) if "length" in closure else None,
        _compliance(closure["compliance"]) if "compliance" in closure else None,
    )


def _compliance(written: _Mapping) -> Compliance:
    return Compliance(float(written.get("linear", 0.0)), float(written.get("angular", 0.0)))


def _coupling(pointer: Pointer, coupling: _Mapping) -> CouplingEntry:
    joints = {name: float(coefficient) for name, coefficient in _named(coupling["joints"])}
    return CouplingEntry(pointer, coupling["name"], joints, float(coupling.get("offset", 0.0)))


def _joint(name: str, joint: Any) -> JointEntry:
    pointer = ("joints", name)
    if isinstance(joint, str):
        return JointEntry(pointer, name, type=joint)  # type: ignore[arg-type]
    axes = joint.get("axes", ())
    numbers = {key: _numbers(value) for key, value in joint.items() if key in _PROPERTIES}
    for key, value in joint.get("limits", {}).items():
        if key in _LIMITS:
            limit, stated = _LIMITS[key], _numbers(value)
            numbers[key] = tuple(map(limit, stated)) if isinstance(stated, tuple) else limit(stated)
    return JointEntry(
        pointer,
        name,
        type=joint.get("type"),
        axes=tuple(_UNIT[axis] if isinstance(axis, str) else _vector(axis) for axis in axes),
        pitch=float(joint.get("pitch", 0.0)),
        merges=tuple(joint.get("merges", ())),
        freed=joint.get("mimic") is False,
        **numbers,  # type: ignore[arg-type]
    )


def _actuator(pointer: Pointer, actuator: str | _Mapping) -> ActuatorEntry:
    if isinstance(actuator, str):
        return ActuatorEntry(pointer, actuator)
    control = actuator.get("control")
    return ActuatorEntry(
        pointer,
        actuator["joint"],
        _number(actuator.get("gear_ratio")),
        _number(actuator.get("rotor_inertia")),
        actuator.get("name"),
        None if control is None else (float(control[0]), float(control[1])),
    )


def _vector(numbers: Any) -> Vector3:
    x, y, z = numbers
    return (float(x), float(y), float(z))


def _number(value: float | None) -> float | None:
    return None if value is None else float(value)


def _numbers(value: float | list[float]) -> float | tuple[float, ...]:
    return tuple(map(float, value)) if isinstance(value, list) else float(value)


def _own_data(value: Any, pointer: Pointer) -> Iterator[tuple[Pointer, object]]:
    """EU-EXT-002: the value of a key ``x-…``, at any level; its content is ignored."""
    for key, inner in value.items() if type(value) is dict else enumerate(value):
        if type(key) is str and is_own_key(key):
            yield (*pointer, key), inner
        elif type(inner) is dict or type(inner) is list:
            yield from _own_data(inner, (*pointer, key))
