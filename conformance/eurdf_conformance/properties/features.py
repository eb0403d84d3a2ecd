"""The features of the format that a mechanism uses."""

from __future__ import annotations

from collections.abc import Iterator

from eurdf_conformance.properties.mechanism import Mechanism, Spot

_LIMITS = ("lower", "upper", "velocity", "effort")


def features(mechanism: Mechanism) -> frozenset[str]:
    """The features, each in a few words."""
    return frozenset(_features(mechanism))


def _features(mechanism: Mechanism) -> Iterator[str]:
    yield f"root {mechanism.root}"
    yield f"{len(mechanism.closures)} closures"
    for joint in mechanism.joints:
        kind = mechanism.type_of(joint)
        yield kind if kind == joint.type else f"{kind} from {joint.type}"
        if joint.mimic is not None:
            followed = next(each for each in mechanism.joints if each.name == joint.mimic.joint)
            yield "mimic of a mimic" if followed.mimic else "mimic"
            if not mechanism.mimics(joint):
                yield "freed mimic"
            elif joint.name in mechanism.changes:
                yield "mimic with a property"
        if joint.axis is None and kind in ("revolute", "continuous", "prismatic"):
            yield "axis left out"
    for name, change in mechanism.changes.items():
        if change.axes is not None:
            yield "axes as letters" if isinstance(change.axes, str) else "axes as vectors"
        if change.merges:
            yield "merged, under the last one's name" if name in change.merges else "merged, under a name of its own"
        for each in (*_LIMITS, "damping", "friction", "armature", "stiffness", "rest"):
            if (value := getattr(change, each)) is not None:
                yield f"{each} {'each' if isinstance(value, tuple) else 'for all'}"
        if change.type is None:
            yield "joint that keeps its type"
        if change.own:
            yield "own data in a joint"
    for closure in mechanism.closures:
        yield f"{closure.type} closure"
        for part in ("axis", "axes", "compliance"):
            if getattr(closure, part) is not None:
                yield f"{part} of a closure"
        for frame in (closure.a, closure.b):
            yield f"frame on a {frame.on}" if isinstance(frame, Spot) else "frame by name"
    for coupling in mechanism.couplings:
        yield f"coupling of {len(coupling.joints)}"
        for name in coupling.joints:
            yield f"coupled {mechanism.types()[name]}"
    for motor in mechanism.actuators:
        if motor.name:
            yield "named motor"
        if motor.control:
            yield "control"
        yield f"motor on {mechanism.types()[motor.joint]}"
        if motor.rotor_inertia:
            yield "rotor"
