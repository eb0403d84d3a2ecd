"""Parsers that give joints other limits, damping, friction or armature."""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from eurdf_conformance.oracle import canonical, configuration, joint_property, robot
from mutants.mutant import Deviation, instead

_nearest = partial(instead, joint_property, "nearest")


def _properties(where: Callable[[Any], Any], change: Callable[[Any, Any], dict[str, Any]]) -> Deviation:
    """The properties of some joints are others: change(properties, joint)."""

    def changed(right: Any, joint: Any, actuator: Any) -> Any:
        found = right(joint, actuator)
        return replace(found, **change(found, joint)) if where(joint) else found

    return instead(canonical, "properties", changed)


def _replaced(change: Callable[[Any, int], dict[str, Any]]) -> Deviation:
    """The properties of joints that are replaced are others: change(properties, number of velocities)."""
    return _properties(
        lambda joint: joint.change.type and len(joint.source) == 1, lambda found, joint: change(found, joint.kind.nv)
    )


def _limits_of(kind: str, count: int) -> Deviation:
    """The limits of the joint that became one of this type bound so many numbers."""
    return _properties(
        lambda joint: joint.type == kind and joint.source[0].lower is not None,
        lambda found, joint: {side: [getattr(joint.source[0], side)] * count for side in ("lower", "upper")},
    )


def _negated(found: Any, joint: Any) -> dict[str, Any]:
    names = {"velocity", "effort", "friction"}.difference(joint.change.stated)
    return {name: [-one for one in getattr(found, name)] for name in names}


def _is_left_handed(joint: Any) -> bool:
    return joint.type == "helical" and joint.pitch < 0


def _armature(change: Callable[[Any], Any]) -> Deviation:
    return instead(canonical, "properties", lambda right, joint, motor: right(joint, motor and change(motor)))


def _spring(change: Callable[[Any, Any], tuple[Any, Any]]) -> Deviation:
    """Stiffness and rest position of a joint are others."""

    def changed(found: Any, joint: Any) -> dict[str, Any]:
        if found.stiffness is None:
            return {}
        return dict(zip(("stiffness", "rest"), change(found.stiffness, found.rest), strict=True))

    return _properties(lambda joint: joint.change.stated, changed)


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


MEANS = {
    "EU-JNT-020": {
        "A joint that is replaced has no velocity and effort limits, as in the published loader.": _replaced(
            lambda found, nv: dict.fromkeys(("velocity", "effort"), [None] * nv)
        ),
        "A joint that is replaced has neither damping nor friction, as in the published loader.": _replaced(
            lambda found, nv: dict.fromkeys(("damping", "friction"), [0.0] * nv)
        ),
        "Damping and friction of a joint that is replaced are swapped.": _replaced(
            lambda found, nv: {"damping": found.friction, "friction": found.damping}
        ),
    },
    "EU-JNT-021": {"The limits of an angle bound each number of a quaternion.": _limits_of("spherical", 4)},
    "EU-JNT-024": {
        "The properties of merged joints are those of the first for x, the second for y, the third for z.": _nearest(
            lambda right, axes: [0, 1, 2]
        ),
        "The properties of merged joints are those of the last one, for each axis.": _nearest(
            lambda right, axes: [2, 2, 2]
        ),
        "Each axis of merged joints takes the properties of the nearest joint, though one may serve twice.": _nearest(
            lambda right, axes: list(np.argmax(np.abs(axes), axis=0))
        ),
    },
    "EU-JNT-028": {
        "Of equal sums the one is taken that gives x the joint nearest to the leaf.": _nearest(
            lambda right, axes: [2 - i for i in right(axes[::-1])]
        ),
    },
    "EU-JNT-027": {
        "A joint that is replaced has no position limits.": _replaced(
            lambda found, nv: dict.fromkeys(("lower", "upper"), [None] * len(found.lower))
        ),
    },
    ("EU-JNT-027", "2"): {  # version 1 makes none
        "The limits of a joint bound the length and the angle of the cylindrical joint that it becomes.": _limits_of(
            "cylindrical", 2
        ),
    },
    "EU-JNT-029": {
        "A prismatic joint that becomes helical keeps its numbers for velocity, effort, damping and friction.": instead(
            joint_property, "length_of_a_radian", lambda right, joint: 1.0
        ),
        "The velocity limit, damping and friction of a left-handed screw made of a slide have the sign of its pitch.": (
            _properties(_is_left_handed, _negated)
        ),
        "The limits of a left-handed screw made of a slide are the lower one first, then the upper one, unsorted.": (
            instead(
                joint_property,
                "position_limits",
                lambda right, joint: right(joint)[::-1] if _is_left_handed(joint) else right(joint),
            )
        ),
    },
    "EU-ACT-006": {
        "The armature of an actuated joint is gear_ratio · rotor_inertia.": _armature(
            lambda motor: replace(motor, gear_ratio=abs(motor.gear_ratio) ** 0.5)
        ),
        "The armature of an actuated joint is the inertia of its rotor.": _armature(
            lambda motor: replace(motor, gear_ratio=1.0)
        ),
        "A motor adds no armature.": _armature(lambda motor: None),
    },
    "EU-JNT-031": {
        "The rest position of a spring is 0, whatever the description states.": _spring(
            lambda k, rest: (k, [0.0] * len(rest))
        ),
        "A joint with several coordinates has a spring on the first one only.": _spring(
            lambda k, rest: ([k[0], *[0.0] * (len(k) - 1)], rest)
        ),
        "A joint has no spring.": _spring(lambda k, rest: (None, None)),
    },
    "EU-JNT-032": {
        "The mass matrix contains the armatures of joints that mimic no other only.": _at_leader(
            lambda multiplier: 0.0
        ),
        "The armature of a mimic joint counts at its leader multiplied by the multiplier, not by its square.": (
            _at_leader(abs)
        ),
        "The armature of a mimic joint counts at its leader as it is.": _at_leader(lambda multiplier: 1.0),
    },
    "EU-JNT-034": {
        "A joint that the description frees mimics its leader all the same.": instead(
            sys.modules["eurdf_conformance.oracle.read"],  # the package has a function of that name
            "freed",
            lambda right, urdf, description: urdf,
        ),
    },
}


def _states_of_mimics(data: Any, urdf: Any) -> bool:
    mimics = urdf.xpath("joint[mimic]/@name")
    joints = data.get("joints", {})
    return any(name in mimics and "mimic" not in entry for name, entry in joints.items() if isinstance(entry, dict))


REFUSES = {
    "EU-JNT-030": {"Rejects a description that states properties of a mimic joint.": _states_of_mimics},
}
