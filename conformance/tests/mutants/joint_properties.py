"""Parsers that give joints other limits, damping, friction or armature."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from importlib import import_module
from typing import Any

import numpy as np

from eurdf_conformance.oracle import canonical, configuration, joint_property, robot
from mutants.mutant import Deviation, describes, instead, means, refuses


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


wrong = means("EU-JNT-020")
wrong(
    "A joint that is replaced has no velocity and effort limits, as in the published loader.",
    lambda: _properties(_replaced, lambda found, joint: dict.fromkeys(("velocity", "effort"), [None] * joint.kind.nv)),
)
wrong(
    "A joint that is replaced has neither damping nor friction, as in the published loader.",
    lambda: _properties(_replaced, lambda found, joint: dict.fromkeys(("damping", "friction"), _zeros(joint))),
)
wrong(
    "Damping and friction of a joint that is replaced are swapped.",
    lambda: _properties(_replaced, lambda found, joint: {"damping": found.friction, "friction": found.damping}),
)


@means("EU-JNT-021")
def angle_limits_bound_quaternions() -> Deviation:
    """The limits of an angle bound each number of a quaternion."""

    def limits(found: Any, joint: Any) -> dict[str, Any]:
        return {"lower": [joint.source[0].lower] * 4, "upper": [joint.source[0].upper] * 4}

    return _properties(lambda joint: joint.type == "spherical" and joint.source[0].lower is not None, limits)


wrong = means("EU-JNT-024")
wrong(
    "The properties of merged joints are those of the first for x, the second for y, the third for z.",
    lambda: instead(joint_property, "nearest", lambda right, axes: [0, 1, 2]),
)
wrong(
    "The properties of merged joints are those of the last one, for each axis.",
    lambda: instead(joint_property, "nearest", lambda right, axes: [2, 2, 2]),
)
wrong(
    "Each axis of merged joints takes the properties of the nearest joint, though one may serve twice.",
    lambda: instead(joint_property, "nearest", lambda right, axes: list(np.argmax(np.abs(axes), axis=0))),
)


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


wrong = means("EU-JNT-029")
wrong(
    "A prismatic joint that becomes helical keeps its numbers for velocity, effort, damping and friction.",
    lambda: instead(joint_property, "length_of_a_radian", lambda right, joint: 1.0),
)


@means("EU-JNT-029")
def left_hand_screws_negate_properties() -> Deviation:
    """The velocity limit, damping and friction of a left-handed screw made of a slide have the sign of its pitch."""

    def negated(found: Any, joint: Any) -> dict[str, Any]:
        values = {name: getattr(found, name) for name in ("velocity", "effort", "friction")}
        stated = joint.change.stated
        return {name: [-one for one in value] for name, value in values.items() if name not in stated}

    return _properties(lambda joint: joint.type == "helical" and joint.pitch < 0, negated)


@means("EU-JNT-029")
def screws_reverse_their_limits() -> Deviation:
    """The limits of a left-handed screw made of a slide are the lower one first, then the upper one, unsorted."""

    def limits(right: Any, joint: Any) -> Any:
        lower, upper = right(joint)
        return (upper, lower) if joint.type == "helical" and joint.pitch < 0 else (lower, upper)

    return instead(joint_property, "position_limits", limits)


wrong = means("EU-ACT-006")
wrong(
    "The armature of an actuated joint is gear_ratio · rotor_inertia.",
    lambda: _armature(lambda motor: replace(motor, gear_ratio=abs(motor.gear_ratio) ** 0.5)),
)
wrong(
    "The armature of an actuated joint is the inertia of its rotor.",
    lambda: _armature(lambda motor: replace(motor, gear_ratio=1.0)),
)
wrong("A motor adds no armature.", lambda: _armature(lambda motor: None))

wrong = means("EU-JNT-031")
wrong(
    "The rest position of a spring is 0, whatever the description states.",
    lambda: _properties(lambda joint: joint.change.stated, _spring(lambda k, rest: (k, [0.0] * len(rest)))),
)
wrong(
    "A joint with several coordinates has a spring on the first one only.",
    lambda: _properties(
        lambda joint: joint.change.stated, _spring(lambda k, rest: ([k[0], *[0.0] * (len(k) - 1)], rest))
    ),
)
wrong(
    "A joint has no spring.",
    lambda: _properties(lambda joint: joint.change.stated, lambda found, joint: {"stiffness": None, "rest": None}),
)


def _spring(change: Callable[[Any, Any], Any]) -> Callable[[Any, Any], dict[str, Any]]:
    def changed(found: Any, joint: Any) -> dict[str, Any]:
        if found.stiffness is None:
            return {}
        return dict(zip(("stiffness", "rest"), change(found.stiffness, found.rest), strict=True))

    return changed


wrong = means("EU-JNT-032")
wrong(
    "The mass matrix contains the armatures of joints that mimic no other only.",
    lambda: _at_leader(lambda multiplier: 0.0),
)
wrong(
    "The armature of a mimic joint counts at its leader multiplied by the multiplier, not by its square.",
    lambda: _at_leader(abs),
)
wrong("The armature of a mimic joint counts at its leader as it is.", lambda: _at_leader(lambda multiplier: 1.0))


def _at_leader(factor: Callable[[float], float]) -> Deviation:
    def armature(right: Any, of: Any) -> Any:
        found = np.zeros(len(of.velocities))
        columns = {column: i for i, column in enumerate(of.velocities)}
        motors = {actuator.joint: actuator for actuator in of.description.actuators}
        for joint, (driver, multiplier, _) in zip(of.tree.joints, configuration.drivers(of.tree), strict=True):
            for i, own in enumerate(joint_property.properties(joint, motors.get(joint.name)).armature):
                found[columns[of.tree.joints[driver].name, i]] += own * (factor(multiplier) if joint.mimic else 1.0)
        return found

    return instead(robot, "armature_at_leaders", armature)


wrong = means("EU-JNT-034")
# The package has a function of the name of the module.
wrong(
    "A joint that the description frees mimics its leader all the same.",
    lambda: instead(import_module("eurdf_conformance.oracle.read"), "freed", lambda right, urdf, description: urdf),
)


@refuses("EU-JNT-030")
def mimic_joints_have_no_properties(data: Any, urdf: Any) -> bool:
    """Rejects a description that states properties of a mimic joint."""
    mimics = {joint.get("name") for joint in urdf.iter("joint") if joint.find("mimic") is not None}
    joints = data.get("joints", {})
    return any(name in mimics and "mimic" not in entry for name, entry in joints.items() if isinstance(entry, dict))


wrong = describes("EU-CLO-021")
wrong(
    "A closure has no compliance.",
    lambda robot: {"closures": [each.model_copy(update={"compliance": None}) for each in robot.closures]},
)

wrong = describes("EU-ACT-010")
wrong(
    "An actuator has the name of its joint, whatever the description states.",
    lambda robot: {"actuators": [each.model_copy(update={"name": None}) for each in robot.actuators]},
)
wrong(
    "An actuator has no control range.",
    lambda robot: {"actuators": [each.model_copy(update={"control": None}) for each in robot.actuators]},
)


def _armature(change: Callable[[Any], Any]) -> Deviation:
    return instead(canonical, "properties", lambda right, joint, motor: right(joint, motor and change(motor)))
