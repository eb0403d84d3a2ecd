"""Configurations whose coordinates are bounded, completed or written otherwise."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

from eurdf.format.read_extension import VERSION_KEY
from eurdf.linking import configurations
from eurdf.linking.description import Description
from eurdf.mechanism.joint import Joint
from eurdf.mechanism.joint_type import COORDINATES, JointType
from eurdf.mechanism.mechanism import ROOT_JOINT, Mechanism
from eurdf_conformance.adapters import reference, reference_values
from eurdf_conformance.adapters.reference import Reference
from eurdf_conformance.level import Level
from eurdf_conformance.mutants.deviation import Deviation, around, instead
from eurdf_conformance.mutants.mutant import mutant
from eurdf_conformance.mutants.of_the_reference import refused
from eurdf_conformance.protocol.message import CanonicalRobot


def _left_out(stands: Any) -> Deviation:
    """Joints that a configuration leaves out stand somewhere else in the canonical description."""

    def canonical(original: Any, robot: Mechanism) -> CanonicalRobot:
        said: CanonicalRobot = original(robot)
        others = {joint.name: stands(joint) for joint in robot.joints if joint.type is not JointType.FIXED}
        there = {name: at for name, at in others.items() if at is not None}
        return said.model_copy(
            update={"configurations": {name: {**there, **at} for name, at in said.configurations.items()}}
        )

    return around(reference, "canonical_robot", canonical)


def _middle(joint: Joint) -> list[float] | None:
    if joint.coordinates.nv != 1 or joint.mimic or math.isinf(joint.lower[0]) or math.isinf(joint.upper[0]):
        return None
    return [(joint.lower[0] + joint.upper[0]) / 2.0]


@mutant("EU-CFG-005")
def left_out_joints_stand_in_the_middle() -> Deviation:
    """A joint that a configuration leaves out stands in the middle of its range."""
    return _left_out(_middle)


@mutant("EU-CFG-005")
def left_out_joints_stand_as_at_assembled() -> Deviation:
    """A joint that a configuration leaves out stands where `assembled` has it."""

    def canonical(original: Any, robot: Mechanism) -> CanonicalRobot:
        said: CanonicalRobot = original(robot)
        there = said.configurations.get("assembled", {})
        return said.model_copy(
            update={"configurations": {name: {**there, **at} for name, at in said.configurations.items()}}
        )

    return around(reference, "canonical_robot", canonical)


@mutant("EU-CFG-005", level=Level.KINEMATICS)
def left_out_joints_are_placed_in_the_middle() -> Deviation:
    """Where values are asked for, a joint that is left out stands in the middle of its range."""

    def placed(original: Any, robot: Mechanism, model: Any, given: Any, *at: Any) -> Any:
        middles = {joint.name: _middle(joint) for joint in robot.joints if joint.type is not JointType.FIXED}
        return original(robot, model, {**{n: c for n, c in middles.items() if c is not None}, **given}, *at)

    return around(reference_values, "configuration_vector", placed)


@mutant("EU-CAN-004")
def left_out_quaternions_are_0() -> Deviation:
    """All coordinates of a joint that a configuration leaves out are 0, those of a quaternion too."""
    return _left_out(
        lambda joint: [0.0] * len(COORDINATES[joint.type].names) if joint.coordinates.quaternion == 0 else None
    )


@mutant("EU-CAN-004")
def left_out_joints_within_their_limits() -> Deviation:
    """A joint that a configuration leaves out stands at its neutral, or at the limit nearest to it."""

    def nearest(joint: Joint) -> list[float] | None:
        if joint.coordinates.nv != 1 or joint.mimic:
            return None
        return [min(max(0.0, joint.lower[0]), joint.upper[0])]

    return _left_out(nearest)


@mutant("EU-CFG-006")
def quaternions_as_written() -> Deviation:
    """A quaternion is kept as it is written."""
    return _as_written(lambda joint: True)


@mutant("EU-CFG-006")
def quaternions_of_floating_joints_as_written() -> Deviation:
    """The quaternion of a floating joint, the root's aside, is kept as it is written."""
    return _as_written(lambda joint: joint.type is JointType.FLOATING and joint.name != ROOT_JOINT)


@mutant("EU-CFG-006")
def quaternion_of_the_root_as_written() -> Deviation:
    """The quaternion of a floating root is kept as it is written."""
    return _as_written(lambda joint: joint.name == ROOT_JOINT)


def _as_written(which: Callable[[Joint], bool]) -> Deviation:
    """The coordinates of such joints are kept as they are written."""

    def checked(original: Any, joint: Joint, values: Any, *arguments: Any) -> Any:
        found = original(joint, values, *arguments)
        return values if found is not None and which(joint) else found

    return around(configurations, "_coordinates", checked)


@mutant("EU-CFG-003")
def quaternion_within_a_thousandth() -> Deviation:
    """The length of a quaternion may be off by 1e-3."""
    return instead(configurations, "QUATERNION_TOLERANCE", 1e-3)


@mutant("EU-CFG-003")
def quaternion_to_rounding() -> Deviation:
    """The length of a quaternion may be off by 1e-12."""
    return instead(configurations, "QUATERNION_TOLERANCE", 1e-12)


@mutant("EU-CFG-004")
def limits_to_a_tenth_of_a_millimetre() -> Deviation:
    """A coordinate may be beyond its limit by 1e-4."""
    return instead(configurations, "LIMIT_TOLERANCE", 1e-4)


@mutant("EU-CFG-004")
def limits_to_the_last_bit() -> Deviation:
    """A coordinate may not be beyond its limit at all."""
    return instead(configurations, "LIMIT_TOLERANCE", 0.0)


@mutant("EU-CFG-004")
def limits_of_the_first_coordinate() -> Deviation:
    """Of a joint of several coordinates the first alone is compared with its limits."""

    def checked(original: Any, joint: Joint, values: Any, *arguments: Any) -> Any:
        first = values[:1] + tuple(
            min(max(value, lower), upper)
            for value, lower, upper in list(zip(values, joint.lower, joint.upper, strict=False))[1:]
        )
        return original(joint, first if len(values) == 2 == len(joint.lower) else values, *arguments)

    return around(configurations, "_coordinates", checked)


@mutant("EU-CFG-004")
def ranges_of_zero_are_ranges() -> Deviation:
    """A coordinate whose limits are both 0 must be 0."""
    return _with_limits(lambda lower, upper: (lower or -1e-300, upper or 1e-300))


@mutant("EU-CFG-004")
def ranges_of_zero_width_are_none() -> Deviation:
    """Limits that are equal are no limits, whatever they are."""
    return _with_limits(lambda lower, upper: (-math.inf, math.inf) if lower == upper else (lower, upper))


@mutant("EU-CFG-004")
def limits_of_zero_are_none() -> Deviation:
    """A limit of 0 is no limit, whatever the other is."""
    return _with_limits(lambda lower, upper: (lower or -math.inf, upper or math.inf))


@mutant("EU-CFG-004")
def one_coordinate_without_a_range_frees_the_others() -> Deviation:
    """A joint has no limits where those of one of its coordinates are both 0."""

    def checked(original: Any, joint: Joint, *arguments: Any) -> Any:
        if any(lower == upper == 0.0 for lower, upper in zip(joint.lower, joint.upper, strict=True)):
            count = len(joint.lower)
            joint = replace(joint, lower=(-math.inf,) * count, upper=(math.inf,) * count)
        return original(joint, *arguments)

    return around(configurations, "_coordinates", checked)


def _with_limits(limits: Callable[[float, float], tuple[float, float]]) -> Deviation:
    """Coordinates are compared with other limits than those of their joint."""

    def checked(original: Any, joint: Joint, *arguments: Any) -> Any:
        pairs = [limits(lower, upper) for lower, upper in zip(joint.lower, joint.upper, strict=True)]
        changed = replace(joint, lower=tuple(low for low, _ in pairs), upper=tuple(high for _, high in pairs))
        return original(changed, *arguments)

    return around(configurations, "_coordinates", checked)


@mutant("EU-CFG-002")
def quaternion_may_lack_w() -> Deviation:
    """Of a quaternion three numbers may be given, w being what makes its length 1."""

    def checked(original: Any, joint: Joint, values: Any, *arguments: Any) -> Any:
        if joint.type is JointType.SPHERICAL and len(values) == 3:
            values = (*values, math.sqrt(max(0.0, 1.0 - sum(value * value for value in values))))
        return original(joint, values, *arguments)

    return around(configurations, "_coordinates", checked)


@mutant("EU-CFG-002")
def one_number_without_a_list() -> Deviation:
    """A number alone is refused: coordinates are a list."""

    def alone(read: Description) -> bool:
        assert read.document is not None
        said = read.document.data.get("configurations", {}) if VERSION_KEY in read.document.data else {}
        return any(not isinstance(c, list) for each in said.values() if isinstance(each, dict) for c in each.values())

    return refused(alone)


@mutant("EU-CFG-001")
def locked_joints_may_stand_somewhere() -> Deviation:
    """A configuration may name a joint that is fixed, without effect."""

    def joint(original: Any, name: str, joints: Any, *arguments: Any) -> Any:
        known = joints.get(name)
        if known is not None and known.type is JointType.FIXED:
            return None
        return original(name, joints, *arguments)

    return around(configurations, "_joint", joint)


@mutant("EU-CFG-001")
def followers_may_stand_somewhere() -> Deviation:
    """A configuration may name a joint that mimics, without effect."""

    def joint(original: Any, name: str, joints: Any, *arguments: Any) -> Any:
        known = joints.get(name)
        return None if known is not None and known.mimic is not None else original(name, joints, *arguments)

    return around(configurations, "_joint", joint)


@mutant("EU-CFG-003")
def quaternion_of_zeros_is_no_rotation() -> Deviation:
    """A quaternion of zeros, which no length can be brought to 1, is the neutral one."""

    def checked(original: Any, joint: Joint, values: Any, *arguments: Any) -> Any:
        start = joint.coordinates.quaternion
        if start is not None and len(values) == start + 4 and not any(values[start:]):
            values = (*values[:start], 0.0, 0.0, 0.0, 1.0)
        return original(joint, values, *arguments)

    return around(configurations, "_coordinates", checked)


@mutant("EU-CFG-004")
def screws_have_no_limits() -> Deviation:
    """Where a screw stands is not compared with its limits."""

    def checked(original: Any, joint: Joint, *arguments: Any) -> Any:
        if joint.type is JointType.HELICAL:
            joint = replace(joint, lower=(-math.inf,), upper=(math.inf,))
        return original(joint, *arguments)

    return around(configurations, "_coordinates", checked)


@mutant("EU-CFG-005", level=Level.KINEMATICS)
def left_out_joints_stay_where_they_were() -> Deviation:
    """Where values are asked for, a joint that is left out stands where the configuration before had it."""

    def evaluated(original: Any, self: Any, configurations: Any, *arguments: Any) -> Any:
        stands: dict[str, Any] = {}
        return original(self, [stands := stands | each for each in configurations], *arguments)

    return around(Reference, "evaluate", evaluated)
