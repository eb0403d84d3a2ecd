"""Parsers that give joints other limits, damping, friction or armature."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from eurdf_conformance.oracle import canonical, joint_property
from support.mutants.mutant import Deviation, instead, means


def _properties(where: Callable[[Any], Any], change: Callable[[Any, Any], dict[str, Any]]) -> Deviation:
    """The properties of some joints are others: change(properties, joint)."""

    def changed(right: Any, joint: Any, actuator: Any) -> Any:
        found = right(joint, actuator)
        return replace(found, **change(found, joint)) if where(joint) else found

    return instead(canonical, "properties", changed)


def _replaced(joint: Any) -> bool:
    return bool(joint.change.type) and len(joint.source) == 1


def _zeros(joint: Any) -> list[float]:
    return [0.0] * joint.kind.nv


@means("EU-JNT-020")
def replaced_joints_lose_their_limits() -> Deviation:
    """A joint that is replaced has no velocity and effort limits, as in the published loader."""
    return _properties(_replaced, lambda found, joint: dict.fromkeys(("velocity", "effort"), [None] * joint.kind.nv))


@means("EU-JNT-020")
def replaced_joints_lose_their_damping() -> Deviation:
    """A joint that is replaced has neither damping nor friction, as in the published loader."""
    return _properties(_replaced, lambda found, joint: dict.fromkeys(("damping", "friction"), _zeros(joint)))


@means("EU-JNT-020")
def damping_and_friction_are_swapped() -> Deviation:
    """Damping and friction of a joint that is replaced are swapped."""
    return _properties(_replaced, lambda found, joint: {"damping": found.friction, "friction": found.damping})


@means("EU-JNT-021")
def angle_limits_bound_quaternions() -> Deviation:
    """The limits of an angle bound each number of a quaternion."""

    def limits(found: Any, joint: Any) -> dict[str, Any]:
        return {"lower": [joint.source[0].lower] * 4, "upper": [joint.source[0].upper] * 4}

    return _properties(lambda joint: joint.type == "spherical" and joint.source[0].lower is not None, limits)


@means("EU-JNT-024")
def merged_properties_in_the_order_of_the_chain() -> Deviation:
    """The properties of merged joints are those of the first for x, the second for y, the third for z."""
    return instead(joint_property, "nearest", lambda right, axes: [0, 1, 2])


@means("EU-JNT-024")
def merged_properties_of_the_last() -> Deviation:
    """The properties of merged joints are those of the last one, for each axis."""
    return instead(joint_property, "nearest", lambda right, axes: [2, 2, 2])


@means("EU-JNT-024")
def merged_properties_of_the_nearest() -> Deviation:
    """Each axis of merged joints takes the properties of the nearest joint, though one may serve twice."""
    return instead(joint_property, "nearest", lambda right, axes: list(np.argmax(np.abs(axes), axis=0)))


@means("EU-JNT-028")
def merged_properties_of_the_joint_nearest_to_the_leaf() -> Deviation:
    """Of equal sums the one is taken that gives x the joint nearest to the leaf."""

    def nearest(right: Any, axes: Any) -> Any:
        return [2 - i for i in right(axes[::-1])]

    return instead(joint_property, "nearest", nearest)


@means("EU-JNT-027")
def limits_of_replaced_joints_are_lost() -> Deviation:
    """A joint that is replaced has no position limits."""

    def limits(found: Any, joint: Any) -> dict[str, Any]:
        return dict.fromkeys(("lower", "upper"), [None] * len(found.lower))

    return _properties(_replaced, limits)


@means("EU-JNT-027", versions=("2",))  # version 1 makes none
def limits_bound_both_coordinates() -> Deviation:
    """The limits of a joint bound the length and the angle of the cylindrical joint that it becomes."""

    def limits(found: Any, joint: Any) -> dict[str, Any]:
        return {"lower": [joint.source[0].lower] * 2, "upper": [joint.source[0].upper] * 2}

    return _properties(lambda joint: joint.type == "cylindrical" and joint.source[0].lower is not None, limits)


@means("EU-JNT-029")
def screws_keep_the_numbers_of_a_slide() -> Deviation:
    """A prismatic joint that becomes helical keeps its numbers for velocity, effort, damping and friction."""
    return instead(joint_property, "length_of_a_radian", lambda right, joint: 1.0)


@means("EU-JNT-029")
def screws_reverse_their_limits() -> Deviation:
    """The limits of a left-handed screw made of a slide are the lower one first, then the upper one, unsorted."""

    def limits(right: Any, joint: Any) -> Any:
        lower, upper = right(joint)
        return (upper, lower) if joint.type == "helical" and joint.pitch < 0 else (lower, upper)

    return instead(joint_property, "position_limits", limits)


@means("EU-ACT-006")
def gear_ratio_is_not_squared() -> Deviation:
    """The armature of an actuated joint is gear_ratio · rotor_inertia."""
    return _armature(lambda motor: replace(motor, gear_ratio=abs(motor.gear_ratio) ** 0.5))


@means("EU-ACT-006")
def rotor_is_not_geared() -> Deviation:
    """The armature of an actuated joint is the inertia of its rotor."""
    return _armature(lambda motor: replace(motor, gear_ratio=1.0))


@means("EU-ACT-006")
def motors_have_no_armature() -> Deviation:
    """A motor adds no armature."""
    return _armature(lambda motor: None)


def _armature(change: Callable[[Any], Any]) -> Deviation:
    return instead(canonical, "properties", lambda right, joint, motor: right(joint, motor and change(motor)))
