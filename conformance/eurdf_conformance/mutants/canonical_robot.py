"""Canonical descriptions that say something else than what was read."""

from __future__ import annotations

import math
from typing import Any

from eurdf.mechanism.mechanism import Mechanism
from eurdf_conformance.adapters import reference
from eurdf_conformance.adapters.reference import Reference
from eurdf_conformance.mutants.deviation import Deviation, around, instead
from eurdf_conformance.mutants.mutant import mutant
from eurdf_conformance.mutants.of_the_reference import canonical, canonical_joints
from eurdf_conformance.protocol.message import CanonicalJoint, CanonicalRobot


@mutant("EU-CAN-001")
def nothing_is_said_of_the_robot() -> Deviation:
    """The robot that was read is not said."""
    return instead(Reference, "canonical", lambda self, mechanism: None)


@mutant("EU-CAN-001")
def limits_in_degrees() -> Deviation:
    """Position limits are in degrees."""

    def degrees(values: Any) -> list[float | None]:
        return [None if value is None else math.degrees(value) for value in values]

    return canonical_joints(lambda joint: {"lower": degrees(joint.lower), "upper": degrees(joint.upper)})


@mutant("EU-CAN-001")
def no_limit_is_a_large_one() -> Deviation:
    """Where there is no limit, there is a large number."""

    def large(values: Any) -> list[float | None]:
        return [1e9 if value is None else value for value in values]

    return canonical_joints(lambda joint: {"velocity": large(joint.velocity), "effort": large(joint.effort)})


@mutant("EU-CAN-001")
def links_of_fixed_joints_are_not_said() -> Deviation:
    """Only the first link of each body is said."""
    return canonical(
        lambda robot: {"links": [n for n in robot.links if n in {e for j in robot.joints for e in (j.parent, j.child)}]}
    )


@mutant("EU-CAN-001")
def closures_are_not_said() -> Deviation:
    """Closures are not said."""
    return canonical(lambda robot: {"closures": []})


@mutant("EU-CAN-001")
def robot_without_a_name() -> Deviation:
    """The robot's name is that of its file."""
    return canonical(lambda robot: {"name": "robot"})


@mutant("EU-CAN-001")
def parent_and_child_swapped() -> Deviation:
    """The child of a joint is said to be its parent."""
    return canonical_joints(lambda joint: {"parent": joint.child, "child": joint.parent})


@mutant("EU-CAN-001", versions=("2",))  # in version 1 no joint mimics
def mimics_are_not_said() -> Deviation:
    """That a joint mimics is not said."""
    return canonical_joints(lambda joint: {"mimic": None})


@mutant("EU-CAN-001", versions=("2",))  # version 1 has two hinges, which is right
def universal_joints_are_two_hinges() -> Deviation:
    """A universal joint is said as two revolute ones, as in MJCF."""

    def hinge(joint: CanonicalJoint, half: int) -> CanonicalJoint:
        per_axis = ("lower", "upper", "velocity", "effort", "damping", "friction", "armature")
        own = {key: getattr(joint, key)[half : half + 1] for key in per_axis}
        return joint.model_copy(update={**own, "name": f"{joint.name}_{half + 1}", "type": "revolute"})

    def hinges(joint: CanonicalJoint) -> list[CanonicalJoint]:
        return [hinge(joint, 0), hinge(joint, 1)] if joint.type == "universal" else [joint]

    return canonical(lambda robot: {"joints": [each for joint in robot.joints for each in hinges(joint)]})


@mutant("EU-CAN-001")
def damping_is_not_said() -> Deviation:
    """Damping is 0."""
    return canonical_joints(lambda joint: {"damping": [0.0] * len(joint.damping)})


@mutant("EU-CAN-001", versions=("2",))  # version 1 has no configurations
def configurations_are_not_said() -> Deviation:
    """Configurations are not said."""
    return canonical(lambda robot: {"configurations": {}})


@mutant("EU-CAN-001", versions=("2",))  # version 1 has no configurations
def angles_as_cosine_and_sine() -> Deviation:
    """In configurations the angle of a continuous joint is its cosine and its sine, as in Pinocchio."""

    def held(robot: CanonicalRobot) -> dict[str, Any]:
        turning = {joint.name for joint in robot.joints if joint.type == "continuous"}
        return {
            "configurations": {
                name: {joint: [math.cos(c[0]), math.sin(c[0])] if joint in turning else c for joint, c in at.items()}
                for name, at in robot.configurations.items()
            }
        }

    return canonical(held)


@mutant("EU-ONE-006")
def bodies_between_are_links() -> Deviation:
    """The body between the two joints that a universal one is split into is said to be a link."""

    def with_bodies(original: Any, mechanism: Mechanism) -> CanonicalRobot:
        said: CanonicalRobot = original(mechanism)
        return said.model_copy(update={"links": [body.name for body in mechanism.bodies]})

    return around(reference, "canonical_robot", with_bodies)
