"""Limits, damping, friction, armature and springs of a joint: chapter Joints, Properties, and EU-ACT-006."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from eurdf_conformance.oracle.description import Actuator
from eurdf_conformance.oracle.merging import nearest
from eurdf_conformance.oracle.not_read import NotRead
from eurdf_conformance.oracle.tree import Joint
from eurdf_conformance.oracle.urdf import UrdfJoint

Limits = list[float | None]


@dataclass(frozen=True)
class Properties:
    """Of one joint: position limits one a coordinate, the rest one a velocity; None where there is no limit."""

    lower: Limits
    upper: Limits
    velocity: Limits
    effort: Limits
    damping: list[float]
    friction: list[float]
    armature: list[float]
    #: One a coordinate; None where there is no spring.
    stiffness: list[float] | None
    rest: list[float] | None


def properties(joint: Joint, actuator: Actuator | None) -> Properties:
    """What the description states of a joint, and else what the URDF says of it."""
    nv, springs = joint.kind.nv, len(joint.kind.bounded)  # a coordinate that can have limits can have a spring
    if "stiffness" in joint.change.stated and not springs:
        raise NotRead(f"a spring of {joint.name!r}")
    armature = actuator.gear_ratio**2 * actuator.rotor_inertia if actuator else 0.0  # EU-ACT-006
    each = sources(joint)
    k = length_of_a_radian(joint)
    lower, upper = position_limits(joint)
    stated = {name: [*value] for name, value in joint.change.stated.items()}

    def of(name: str, count: int, otherwise: Any) -> Any:
        value = stated.get(name, otherwise)
        if len(value) == 1:
            value = value * count
        if len(value) != count:
            raise NotRead(f"{len(value)} numbers for {name} of {joint.name!r}")
        return value

    def limit(name: str, count: int, otherwise: Limits) -> Limits:
        return [*of(name, count, [])] if name in stated else otherwise

    return Properties(
        lower=limit("lower", len(joint.kind.bounded), lower),
        upper=limit("upper", len(joint.kind.bounded), upper),
        velocity=limit("velocity", nv, [scaled(source.velocity if source else None, 1.0 / k) for source in each]),
        effort=limit("effort", nv, [scaled(source.effort if source else None, k) for source in each]),
        damping=of("damping", nv, [source.damping * k**2 if source else 0.0 for source in each]),
        friction=of("friction", nv, [source.friction * k if source else 0.0 for source in each]),
        armature=of("armature", nv, [armature] * nv),
        stiffness=of("stiffness", springs, []) if "stiffness" in stated else None,
        rest=of("rest", springs, [0.0] * springs) if "stiffness" in stated else None,
    )


def length_of_a_radian(joint: Joint) -> float:
    """The length k = |h| / 2π, m/rad, where a prismatic joint of the URDF becomes helical; else 1: EU-JNT-029."""
    slides = bool(joint.source) and joint.source[0].type == "prismatic"
    return abs(joint.pitch) / (2.0 * np.pi) if slides and joint.type == "helical" else 1.0


def scaled(limit: float | None, factor: float) -> float | None:
    """A limit in another unit."""
    return None if limit is None else limit * factor


def sources(joint: Joint) -> list[UrdfJoint | None]:
    """The joint of the URDF whose properties each velocity takes, EU-JNT-020 and 024; None for a floating root."""
    if len(joint.source) == 3:
        return [joint.source[i] for i in nearest(joint.axes)]
    return [joint.source[0] if joint.source else None] * joint.kind.nv


def position_limits(joint: Joint) -> tuple[Limits, Limits]:
    """Those of the URDF, on coordinates of the same kind, angle or length: EU-JNT-027; none on a ball: EU-JNT-021.

    Of a slide that becomes a screw, EU-JNT-029.
    """
    kinds = joint.kind.bounded
    if not joint.source:
        return [], []
    source = joint.source[0]
    if source.type == "prismatic" and joint.type == "helical":
        # They bound its length, h/2π θ, and so θ: they change places where h is negative.
        metre = 2.0 * np.pi / joint.pitch
        low, high = [scaled(source.lower, metre)], [scaled(source.upper, metre)]
        return (low, high) if metre > 0.0 else (high, low)
    kind = "l" if source.type == "prismatic" else "a"
    return (
        [source.lower if each == kind else None for each in kinds],
        [source.upper if each == kind else None for each in kinds],
    )
