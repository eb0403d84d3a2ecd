"""A mechanism with all lengths, or all masses, multiplied by a factor."""

from __future__ import annotations

from typing import Any

from eurdf_conformance.comparison.coordinates import COORDINATES
from eurdf_conformance.properties.mechanism import (
    Actuator,
    Change,
    Configuration,
    Inertia,
    Joint,
    Link,
    Mechanism,
    PerNumber,
    Pose,
    Spot,
)

#: Number of coordinates and velocities that are lengths; they come first.
_LENGTHS = {"prismatic": 1, "cylindrical": 1, "planar": 2, "floating": 3}


def lengthened(mechanism: Mechanism, s: float) -> Mechanism:
    """All lengths multiplied by s, without limits on lengths."""
    types = mechanism.types()

    def pose(pose: Pose) -> Pose:
        x, y, z = pose.xyz
        return Pose(xyz=(s * x, s * y, s * z), rpy=pose.rpy)

    def spot(spot: Spot) -> Spot:
        return spot.model_copy(update={"pose": pose(spot.pose)})

    def said(frame: str | Spot) -> str | Spot:
        return frame if isinstance(frame, str) else spot(frame)

    def joint(joint: Joint) -> Joint:
        changed: dict[str, Any] = {"origin": pose(joint.origin)}
        if joint.limit is not None and joint.limit.lower is not None and joint.limit.upper is not None:
            widened = {"lower": -100.0, "upper": 100.0} if joint.type == "prismatic" else {}
            changed["limit"] = joint.limit.model_copy(update=widened)
        if joint.mimic is not None:
            leader = next(other for other in mechanism.joints if other.name == joint.mimic.joint)
            unit = (s if joint.type == "prismatic" else 1.0, s if leader.type == "prismatic" else 1.0)
            mimic = {
                "multiplier": joint.mimic.multiplier * unit[0] / unit[1],
                "offset": joint.mimic.offset * unit[0],
            }
            changed["mimic"] = joint.mimic.model_copy(update=mimic)
        return joint.model_copy(update=changed)

    return mechanism.replace(
        links=tuple(_scaled(link, 1.0, s) for link in mechanism.links),
        joints=tuple(map(joint, mechanism.joints)),
        changes={name: _longer(change, types.get(name, ""), s) for name, change in armed(mechanism).items()},
        frames=tuple(each.model_copy(update={"spot": spot(each.spot)}) for each in mechanism.frames),
        closures=tuple(each.model_copy(update={"a": said(each.a), "b": said(each.b)}) for each in mechanism.closures),
        actuators=tuple(Actuator(joint=each.joint) for each in mechanism.actuators),
        configurations={name: _stretched(q, types, s) for name, q in mechanism.configurations.items()},
    )


def armed(mechanism: Mechanism) -> dict[str, Change]:
    """The changes with each motor's gear and rotor written as an armature, EU-ACT-006."""
    changes = dict(mechanism.changes)
    for motor in mechanism.actuators:
        change = changes.get(motor.joint, Change())
        if motor.rotor_inertia and change.armature is None:
            armature = (motor.gear_ratio or 1.0) ** 2 * motor.rotor_inertia
            changes[motor.joint] = change.model_copy(update={"armature": armature})
    return changes


def _stretched(configuration: Configuration, types: dict[str, str], s: float) -> Configuration:
    """A configuration with its lengths multiplied by s."""
    return {
        joint: tuple(s * x if i < _LENGTHS.get(types[joint], 0) else x for i, x in enumerate(q))
        for joint, q in configuration.items()
    }


def weighted(mechanism: Mechanism, s: float) -> Mechanism:
    """All masses multiplied by s, and the reflected inertia of motors too."""

    def heavier(value: PerNumber | None) -> PerNumber | None:
        return tuple(s * x for x in value) if isinstance(value, tuple) else None if value is None else s * value

    return mechanism.replace(
        links=tuple(_scaled(link, s, 1.0) for link in mechanism.links),
        changes={
            name: change.model_copy(update={"armature": heavier(change.armature)})
            for name, change in mechanism.changes.items()
        },
        actuators=tuple(
            each.model_copy(update={"rotor_inertia": each.rotor_inertia and s * each.rotor_inertia})
            for each in mechanism.actuators
        ),
    )


def _scaled(link: Link, mass: float, length: float) -> Link:
    if link.inertia is None:
        return link
    x, y, z = link.inertia.pose.xyz
    xx, xy, xz, yy, yz, zz = (moment * mass * length**2 for moment in link.inertia.moments)
    heavier = Inertia(
        mass=link.inertia.mass * mass,
        pose=Pose(xyz=(x * length, y * length, z * length), rpy=link.inertia.pose.rpy),
        moments=(xx, xy, xz, yy, yz, zz),
    )
    return link.model_copy(update={"inertia": heavier})


def _longer(change: Change, kind: str, s: float) -> Change:
    """An armature after scaling of lengths: for rotations it is an inertia, kg·m², else a mass."""
    changed: dict[str, Any] = {}
    if change.pitch is not None:
        changed["pitch"] = s * change.pitch
    lengths, nq = _LENGTHS.get(kind, 0), COORDINATES.get(kind, 0)
    if lengths:
        changed |= {"lower": None, "upper": None}
    if change.armature is not None and kind:
        nv = {"spherical": 3, "floating": 6}.get(kind, nq)
        each = change.armature if isinstance(change.armature, tuple) else (change.armature,) * nv
        changed["armature"] = tuple(x if i < lengths else s * s * x for i, x in enumerate(each))
    return change.model_copy(update=changed)
