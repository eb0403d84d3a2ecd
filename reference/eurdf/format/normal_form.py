"""Both versions in one form: a file that a model has accepted, as an `Extension`."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

from eurdf.format import actuator2_1, compliance, joint2_1, version2, version2_1
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
from eurdf.format.field import is_own_key
from eurdf.format.version1 import Version1
from eurdf.format.version2 import Version2
from eurdf.mechanism.constraint import Compliance
from eurdf.mechanism.pose import Vector3
from eurdf.reading.yaml_node import Pointer
from eurdf.reading.yaml_reader import YamlDocument

_UNIT = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}


def from_version1(model: Version1, document: YamlDocument) -> Extension:
    """The description in a file of version 1, whose parallel lists are of equal length.

    Keys other than the five are kept (EU-ONE-008). Closures are named ``closure_1``, ``closure_2``, … in file order
    (EU-ONE-005), and are 6d where the key ``type`` is left out (EU-ONE-004).
    """
    types = model.type if "type" in model.model_fields_set else ["6d"] * len(model.closed_loop)
    closures = tuple(
        ClosureEntry(
            pointer=("closed_loop", index),
            name=f"closure_{index + 1}",
            type=closure_type.lower(),
            a=FrameReference(("closed_loop", index, 0), name=a),
            b=FrameReference(("closed_loop", index, 1), name=b),
        )
        for index, ((a, b), closure_type) in enumerate(zip(model.closed_loop, types, strict=True))
    )
    joints = tuple(
        _version1_joint(("joint_name", index), name, joint_type)
        for index, (name, joint_type) in enumerate(zip(model.joint_name, model.joint_type, strict=True))
    )
    return Extension(
        document,
        version="1",
        closures=closures,
        joints=joints,
        actuators=tuple(ActuatorEntry(("name_mot", index), name) for index, name in enumerate(model.name_mot)),
        own_data={(key,): value for key, value in (model.model_extra or {}).items()},
    )


def _version1_joint(pointer: Pointer, name: str, joint_type: str) -> JointEntry:
    if joint_type == "SPHERICAL":
        return JointEntry(pointer, name, type="spherical")
    if joint_type == "FIXED":
        return JointEntry(pointer, name, type="fixed")
    return JointEntry(pointer, name, type="universal", split=joint_type.removeprefix("UJOINT_"))


def from_version2(model: Version2, document: YamlDocument) -> Extension:
    """The description in a file of version 2.0 or 2.1.

    Args:
        model: The file, accepted.
        document: The file as written, which is searched for user-defined keys.
    """
    return Extension(
        document,
        version=model.extended_urdf,
        urdf=model.urdf,
        root=model.root,
        closures=tuple(_closure(("closures", index), closure) for index, closure in enumerate(model.closures)),
        couplings=tuple(_couplings(model)),
        joints=tuple(_joint(name, joint) for name, joint in model.joints.items()),
        actuators=tuple(_actuator(("actuators", index), actuator) for index, actuator in enumerate(model.actuators)),
        frames=tuple(
            FrameEntry(("frames", index), frame.name, _reference(("frames", index), frame))
            for index, frame in enumerate(model.frames)
        ),
        configurations=tuple(
            ConfigurationEntry(
                ("configurations", name),
                name,
                {joint: tuple(q) if isinstance(q, list) else (q,) for joint, q in joints.items()},
            )
            for name, joints in model.configurations.items()
        ),
        metadata=model.metadata,
        own_data=dict(_own_data(document.data, ())),
    )


def _reference(pointer: Pointer, frame: str | version2.PoseOnLink | version2.PoseOnJoint) -> FrameReference:
    if isinstance(frame, str):
        return FrameReference(pointer, name=frame)
    xyz, rpy = _vector(frame.xyz), _vector(frame.rpy)
    if isinstance(frame, version2.PoseOnLink):
        return FrameReference(pointer, frame.link, "link", xyz=xyz, rpy=rpy)
    return FrameReference(pointer, frame.joint, "joint", xyz=xyz, rpy=rpy)


def _closure(pointer: Pointer, closure: version2.Closure | version2_1.AnyClosure) -> ClosureEntry:
    a, b = closure.frames
    axes: tuple[Vector3, Vector3] | None = None
    axes_pointer: Pointer = ()
    if isinstance(closure, version2_1.HingeAboutTwo):
        axes = _vector(closure.axes[0]), _vector(closure.axes[1])
        axes_pointer = (*pointer, "axes")
    elif isinstance(closure, version2_1.Hinge):
        axes = _vector(closure.axis), _vector(closure.axis)
        axes_pointer = (*pointer, "axis")
    return ClosureEntry(
        pointer,
        closure.name,
        closure.type,
        _reference((*pointer, "frames", 0), a),
        _reference((*pointer, "frames", 1), b),
        axes,
        axes_pointer,
        closure.length if isinstance(closure, version2_1.Distance) else None,
        _compliance(closure.compliance) if isinstance(closure, compliance.Compliant) else None,
    )


def _compliance(written: compliance.Compliance | None) -> Compliance | None:
    return None if written is None else Compliance(written.linear or 0.0, written.angular or 0.0)


def _couplings(model: Version2) -> Iterator[CouplingEntry]:
    for index, coupling in enumerate(model.couplings if isinstance(model, version2_1.Version2_1) else ()):
        yield CouplingEntry(("couplings", index), coupling.name, coupling.joints, coupling.offset)


def _joint(name: str, joint: version2.Joint) -> JointEntry:
    pointer = ("joints", name)
    if isinstance(joint, str):
        return JointEntry(pointer, name, type=joint)
    limits = joint.limits or version2.Limits.model_construct()
    axes: tuple[Vector3, ...] = ()
    if isinstance(joint, version2.Universal):
        written = joint.axes
        axes = tuple(_UNIT[axis] if isinstance(axis, str) else _vector(axis) for axis in written)
    return JointEntry(
        pointer,
        name,
        type=None if isinstance(joint, version2.Overridden) else joint.type,
        axes=axes,
        pitch=joint.pitch if isinstance(joint, version2.Helical) else 0.0,
        merges=tuple(joint.merges or ()) if isinstance(joint, version2.Spherical) else (),
        lower=_numbers(limits.lower),
        upper=_numbers(limits.upper),
        velocity=_numbers(limits.velocity),
        effort=_numbers(limits.effort),
        damping=_numbers(joint.damping),
        friction=_numbers(joint.friction),
        armature=_numbers(joint.armature),
        stiffness=_numbers(joint.stiffness) if isinstance(joint, joint2_1.Added) else None,
        rest=_numbers(joint.rest) if isinstance(joint, joint2_1.Added) else None,
        freed=isinstance(joint, joint2_1.Added) and joint.mimic is False,
    )


def _actuator(pointer: Pointer, actuator: str | version2.Geared) -> ActuatorEntry:
    if isinstance(actuator, str):
        return ActuatorEntry(pointer, actuator)
    entry = ActuatorEntry(pointer, actuator.joint, actuator.gear_ratio, actuator.rotor_inertia)
    if not isinstance(actuator, actuator2_1.Geared):
        return entry
    control = None if actuator.control is None else (actuator.control[0], actuator.control[1])
    return replace(entry, name=actuator.name, control=control)


def _vector(numbers: Sequence[float]) -> Vector3:
    x, y, z = numbers
    return (x, y, z)


def _numbers(value: float | list[float] | None) -> float | tuple[float, ...] | None:
    return tuple(value) if isinstance(value, list) else value


def _own_data(value: object, pointer: Pointer) -> Iterator[tuple[Pointer, object]]:
    """EU-EXT-002: the value of a key ``x-…``, at any level; its content is ignored."""
    if isinstance(value, Mapping):
        for key, inner in value.items():
            if is_own_key(key):
                yield (*pointer, key), inner
            else:
                yield from _own_data(inner, (*pointer, key))
    elif isinstance(value, list):
        for index, inner in enumerate(value):
            yield from _own_data(inner, (*pointer, index))
