"""Joints that move their child otherwise than their type says."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

from eurdf.format.urdf import _Reader
from eurdf.linking import replacement
from eurdf.linking.description import Description
from eurdf.mechanism.joint import Joint
from eurdf.mechanism.joint_transform import joint_transform
from eurdf.mechanism.joint_type import JointType
from eurdf.mechanism.mechanism import ROOT_JOINT
from eurdf.mechanism.pose import Pose
from eurdf.pinocchio import configuration, joint_model
from eurdf_conformance.adapters import reference_values
from eurdf_conformance.mutants.deviation import Deviation, around, result, together
from eurdf_conformance.mutants.mutant import mutant
from eurdf_conformance.mutants.of_the_reference import coordinates, described, joints


@mutant("EU-JNT-015")
def quaternion_w_first() -> Deviation:
    """The quaternion of a spherical joint is w, x, y, z, as in MuJoCo."""
    return coordinates(JointType.SPHERICAL, lambda c: [*c[1:], c[0]])


@mutant("EU-JNT-015")
def quaternion_the_other_way() -> Deviation:
    """The quaternion of a spherical joint is that of the parent in the child."""
    return coordinates(JointType.SPHERICAL, lambda c: [-c[0], -c[1], -c[2], c[3]])


@mutant("EU-JNT-015")
def ball_at_half_a_turn_is_at_rest() -> Deviation:
    """A quaternion is divided by its w, and one whose w is 0 taken for no rotation."""
    return coordinates(JointType.SPHERICAL, lambda c: c if c[3] else [0.0, 0.0, 0.0, 1.0])


@mutant("EU-JNT-015")
def ball_about_the_childs_axes() -> Deviation:
    """A spherical joint turns about one axis, that of the URDF, by the angle of its quaternion."""
    return coordinates(JointType.SPHERICAL, lambda c: [math.hypot(*c[:3]), 0.0, 0.0, c[3]])


@mutant("EU-JNT-025")
def floating_joint_at_half_a_turn_is_not_turned() -> Deviation:
    """The quaternion of a floating joint is divided by its w, and one whose w is 0 taken for no rotation."""
    return coordinates(JointType.FLOATING, lambda c: c if c[6] else [*c[:3], 0.0, 0.0, 0.0, 1.0])


@mutant("EU-JNT-025", versions=("2",))  # the root of version 1 is fixed
def root_at_half_a_turn_is_not_turned() -> Deviation:
    """The quaternion of a floating root is divided by its w, and one whose w is 0 taken for no rotation."""

    def checked(original: Any, name: str, values: list[float], of: Any) -> Any:
        turned = name != ROOT_JOINT or values[-1]
        return original(name, values if turned else [*values[:3], 0.0, 0.0, 0.0, 1.0], of)

    return around(configuration, "_checked", checked)


@mutant("EU-JNT-016", versions=("2",))  # of version 1 it is second_axis_first
def axes_of_a_universal_joint_swapped() -> Deviation:
    """A universal joint turns about its second axis first."""
    return around(joint_model, "_universal", lambda original, first, second: original(second, first))


@mutant("EU-JNT-016", versions=("2",))  # version 1 has two hinges, each on the one before
def second_axis_fixed_to_the_parent() -> Deviation:
    """The second axis of a universal joint is fixed to the parent: it turns by R(a₂, θ₂) R(a₁, θ₁)."""
    return together(
        around(joint_model, "_universal", lambda original, first, second: original(second, first)),
        coordinates(JointType.UNIVERSAL, lambda c: c[::-1]),
    )


@mutant("EU-JNT-016", versions=("2",))  # those of version 1 are so
def axes_of_a_universal_joint_made_perpendicular() -> Deviation:
    """The second axis of a universal joint is made perpendicular to the first."""

    def universal(original: Any, first: Any, second: Any) -> Any:
        (a, b, c), (x, y, z) = joint_model.unit(first), joint_model.unit(second)
        along = a * x + b * y + c * z
        return original(first, (x - along * a, y - along * b, z - along * c))

    return around(joint_model, "_universal", universal)


@mutant("EU-JNT-016", versions=("2",))  # version 1 has two hinges
def axes_of_a_universal_joint_in_the_parents_frame() -> Deviation:
    """The axes of a universal joint are in the frame of the parent link."""

    def turned(joint: Joint) -> Joint:
        back = joint.placement.inverse()
        axes = tuple(map(back.rotate, joint.axes))
        return replace(joint, axes=axes) if joint.type is JointType.UNIVERSAL else joint

    return joints(turned)


@mutant("EU-JNT-017")
def angle_before_length() -> Deviation:
    """The coordinates of a cylindrical joint are an angle, then a length."""
    return coordinates(JointType.CYLINDRICAL, lambda c: c[::-1])


@mutant("EU-JNT-017")
def cylinder_along_z() -> Deviation:
    """A cylindrical joint slides along z, and turns about it, whatever the axis of the URDF."""
    return joints(
        lambda joint: replace(joint, axes=((0.0, 0.0, 1.0),)) if joint.type is JointType.CYLINDRICAL else joint
    )


@mutant("EU-JNT-018")
def pitch_a_radian() -> Deviation:
    """The pitch of a helical joint is metres a radian."""
    return _pitch(2.0 * math.pi)


@mutant("EU-JNT-018")
def left_handed() -> Deviation:
    """A helical joint of a positive pitch is left-handed."""
    return _pitch(-1.0)


@mutant("EU-JNT-018")
def screw_that_does_not_advance() -> Deviation:
    """A helical joint only turns."""
    return _pitch(0.0)


def _pitch(factor: float) -> Deviation:
    return around(joint_model, "_helical", lambda original, axis, pitch: original(axis, factor * pitch))


@mutant("EU-JNT-019")
def locked_in_the_middle() -> Deviation:
    """A joint that becomes fixed is locked in the middle of its range."""

    def fixed(original: Any, joint: Joint) -> Joint:
        locked: Joint = original(joint)
        if joint.coordinates.nv != 1 or math.isinf(joint.lower[0]) or math.isinf(joint.upper[0]):
            return locked
        return replace(
            locked, placement=joint.placement * joint_transform(joint, ((joint.lower[0] + joint.upper[0]) / 2.0,))
        )

    return around(replacement, "fixed", fixed)


@mutant("EU-JNT-019")
def locked_within_its_limits() -> Deviation:
    """A joint that becomes fixed, and may not stand at its neutral, is locked at the limit nearest to that."""

    def fixed(original: Any, joint: Joint) -> Joint:
        locked: Joint = original(joint)
        if joint.coordinates.nv != 1:
            return locked
        nearest = min(max(0.0, joint.lower[0]), joint.upper[0])
        return replace(locked, placement=joint.placement * joint_transform(joint, (nearest,)))

    return around(replacement, "fixed", fixed)


@mutant("EU-JNT-019")
def locked_on_its_parent() -> Deviation:
    """What a locked joint carries is put where its parent is."""
    return result(replacement, "fixed", lambda joint: replace(joint, placement=type(joint.placement)()))


@mutant("EU-JNT-019")
def closures_lost_by_locking() -> Deviation:
    """Where the description locks a joint, closures are lost, as by Pinocchio's buildReducedModel."""

    def reduced(read: Description) -> Description:
        assert read.mechanism is not None
        locks = read.extension is not None and any(entry.type == "fixed" for entry in read.extension.joints)
        return replace(read, mechanism=replace(read.mechanism, closures=())) if locks else read

    return described(reduced)


@mutant("EU-JNT-025")
def revolute_the_other_way() -> Deviation:
    """A revolute joint turns clockwise."""
    return coordinates(JointType.REVOLUTE, lambda c: [-c[0]])


@mutant("EU-JNT-025")
def joints_stop_at_their_limits() -> Deviation:
    """A joint that is asked to stand beyond a limit stands at it."""

    def vector(original: Any, robot: Any, model: Any, given: Any, *at: Any) -> Any:
        bounds = {joint.name: (joint.lower, joint.upper) for joint in robot.joints if joint.lower}

        def within(name: str, coordinates: Any) -> Any:
            if name not in bounds:
                return coordinates
            return [min(max(c, low), high) for c, low, high in zip(coordinates, *bounds[name], strict=True)]

        return original(robot, model, {name: within(name, coordinates) for name, coordinates in given.items()}, *at)

    return around(reference_values, "configuration_vector", vector)


@mutant("EU-JNT-025")
def planar_without_an_axis_about_x() -> Deviation:
    """A planar joint whose axis is left out, and is therefore x, moves in the plane of y and z."""
    left_out: set[str] = set()

    def axis(original: Any, self: Any, name: str, kind: JointType, element: Any) -> Any:
        if kind is JointType.PLANAR and element is None:
            left_out.add(name)
        return original(self, name, kind, element)

    def turned(joint: Joint) -> Joint:
        turn = Pose((0.0, 0.0, 0.0), (0.0, math.sqrt(0.5), 0.0, math.sqrt(0.5)))
        return replace(joint, placement=joint.placement * turn) if joint.name in left_out else joint

    return together(around(_Reader, "axis", axis), joints(turned))


@mutant("EU-JNT-025")
def continuous_in_degrees() -> Deviation:
    """The angle of a continuous joint is in degrees."""
    return coordinates(JointType.CONTINUOUS, lambda c: [math.radians(c[0])])


@mutant("EU-JNT-025")
def prismatic_in_millimetres() -> Deviation:
    """The length of a prismatic joint is in millimetres."""
    return coordinates(JointType.PRISMATIC, lambda c: [c[0] / 1000.0])


@mutant("EU-JNT-025")
def planar_angle_first() -> Deviation:
    """The coordinates of a planar joint are its angle, then x and y."""
    return coordinates(JointType.PLANAR, lambda c: [*c[1:], c[0]])


@mutant("EU-JNT-025")
def floating_quaternion_first() -> Deviation:
    """The coordinates of a floating joint are its quaternion, then its position."""
    return coordinates(JointType.FLOATING, lambda c: [*c[4:], *c[:4]])


@mutant("EU-JNT-025")
def floating_quaternion_w_first() -> Deviation:
    """The quaternion of a floating joint is w, x, y, z."""
    return coordinates(JointType.FLOATING, lambda c: [*c[:3], *c[4:], c[3]])


@mutant("EU-JNT-025")
def position_as_the_joint_has_turned_it() -> Deviation:
    """A planar joint slides along the axes that it has turned."""

    def turned(c: list[float]) -> list[float]:
        cos, sin = math.cos(c[2]), math.sin(c[2])
        return [cos * c[0] - sin * c[1], sin * c[0] + cos * c[1], c[2]]

    return coordinates(JointType.PLANAR, turned)


@mutant("EU-URD-035")
def axis_of_its_own_length() -> Deviation:
    """A prismatic joint moves by the vector of its axis, whatever its length."""

    def moved(original: Any, robot: Any, model: Any, configuration: Any, *at: Any) -> Any:
        lengths = {joint.name: math.hypot(*joint.axes[0]) for joint in robot.joints if joint.type == "prismatic"}
        scaled = {name: [c * lengths.get(name, 1.0) for c in given] for name, given in configuration.items()}
        return original(robot, model, scaled, *at)

    return around(reference_values, "configuration_vector", moved)


@mutant("EU-URD-035")
def axis_rounded_to_one_of_three() -> Deviation:
    """An axis is the nearest of x, y and z."""

    def rounded(joint: Joint) -> Joint:
        def nearest(axis: Any) -> Any:
            index = max(range(3), key=lambda i: abs(axis[i]))
            return tuple(math.copysign(1.0, axis[index]) if i == index else 0.0 for i in range(3))

        return replace(joint, axes=tuple(map(nearest, joint.axes)))

    return joints(rounded)


@mutant("EU-URD-035")
def axis_in_the_parents_frame() -> Deviation:
    """An axis is a direction in the frame of the parent link."""

    def turned(joint: Joint) -> Joint:
        back = joint.placement.inverse()
        return replace(joint, axes=tuple(map(back.rotate, joint.axes)))

    return joints(turned)


@mutant("EU-URD-035")
def axis_left_out_is_z() -> Deviation:
    """An axis that is left out is z, as in SDF and MJCF."""

    def axis(original: Any, self: Any, name: Any, kind: Any, element: Any) -> Any:
        return (0.0, 0.0, 1.0) if element is None else original(self, name, kind, element)

    return around(_Reader, "axis", axis)
