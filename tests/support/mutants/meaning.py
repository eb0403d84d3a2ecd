"""Parsers that read the files, and take joints, closures or inertias for others."""

from __future__ import annotations

import math
import sys
from collections.abc import Callable
from contextlib import ExitStack, contextmanager
from dataclasses import replace
from typing import Any
from unittest.mock import patch

import numpy as np

from eurdf_conformance.oracle import (
    canonical,
    configuration,
    jacobian,
    joint_property,
    kinematics,
    mass_matrix,
    merging,
    robot,
    tree,
    urdf,
)
from eurdf_conformance.oracle.logarithm import log6
from eurdf_conformance.oracle.spatial import inverse, pose, rotation, skew
from support.mutants.mutant import Deviation, instead, means

# -- Joints ---------------------------------------------------------------------------------------------------------


def _coordinates(kind: str, change: Callable[[Any], Any]) -> Deviation:
    """The coordinates of a type of joint are others."""

    def changed(right: Any, of: str, axes: Any, pitch: float, q: Any) -> Any:
        return right(of, axes, pitch, np.array(change(q)) if of == kind else q)

    return instead(kinematics, "transform", changed)


def _pitch(change: Callable[[float], float]) -> Deviation:
    return instead(kinematics, "transform", lambda right, of, axes, pitch, q: right(of, axes, change(pitch), q))


def _w_first(q: Any) -> Any:
    return [*q[1:], q[0]]


@means("EU-JNT-015")
def quaternions_w_first() -> Deviation:
    """The quaternion of a spherical joint is w, x, y, z, as in MuJoCo."""
    return _coordinates("spherical", _w_first)


@means("EU-JNT-015")
def quaternions_of_the_parent() -> Deviation:
    """The quaternion of a spherical joint is the orientation of the parent in the child."""
    return _coordinates("spherical", lambda q: [*-q[:3], q[3]])


@means("EU-JNT-016")
def universal_joints_turn_about_the_second_axis_first() -> Deviation:
    """A universal joint turns about its second axis first."""

    def joint(right: Any, found: Any, of: Any, change: Any) -> None:
        right(found, of, replace(change, axes=change.axes[::-1]))

    return instead(tree, "add_joint", joint)


@means("EU-JNT-016", versions=("2",))  # in version 1 it is two joints
def second_axis_of_universal_joints_is_fixed() -> Deviation:
    """The second axis of a universal joint is fixed to the parent."""

    def changed(right: Any, of: str, axes: Any, pitch: float, q: Any) -> Any:
        if of != "universal":
            return right(of, axes, pitch, q)
        return pose(rotation(axes[1], q[1]) @ rotation(axes[0], q[0]))

    return instead(kinematics, "transform", changed)


@means("EU-JNT-017")
def cylindrical_angle_first() -> Deviation:
    """The coordinates of a cylindrical joint are an angle, then a length."""
    return _coordinates("cylindrical", lambda q: q[::-1])


@means("EU-JNT-018")
def pitch_per_radian() -> Deviation:
    """The pitch of a helical joint is metres per radian."""
    return _pitch(lambda pitch: pitch * 2 * math.pi)


@means("EU-JNT-018")
def left_handed_screws() -> Deviation:
    """A helical joint of positive pitch is left-handed."""
    return _pitch(lambda pitch: -pitch)


@means("EU-JNT-025")
def revolute_joints_turn_clockwise() -> Deviation:
    """A revolute joint turns clockwise about its axis."""
    return _coordinates("revolute", lambda q: -q)


@means("EU-JNT-025")
def continuous_joints_in_degrees() -> Deviation:
    """The angle of a continuous joint is in degrees."""
    return _coordinates("continuous", np.radians)


@means("EU-JNT-025")
def prismatic_joints_in_millimetres() -> Deviation:
    """The length of a prismatic joint is in millimetres."""
    return _coordinates("prismatic", lambda q: q / 1000)


@means("EU-JNT-025")
def planar_angle_first() -> Deviation:
    """The coordinates of a planar joint are its angle, then x and y."""
    return _coordinates("planar", lambda q: [q[1], q[2], q[0]])


@means("EU-JNT-025")
def floating_quaternion_first() -> Deviation:
    """The coordinates of a floating joint are its quaternion, then its position."""

    return _coordinates("floating", lambda q: [*q[4:], *q[:4]])


@means("EU-JNT-025")
def floating_quaternion_w_first() -> Deviation:
    """The quaternion of a floating joint is w, x, y, z, as in MuJoCo."""
    return _coordinates("floating", lambda q: [*q[:3], *_w_first(q[3:])])


# -- Velocities -----------------------------------------------------------------------------------------------------


def _motion(kind: str, change: Callable[[Any, Any, Any], Any]) -> Deviation:
    """The columns of a type of joint are others: change(columns, rotation of the child in the joint's frame, q)."""

    def changed(right: Any, of: str, axes: Any, pitch: float, q: Any) -> Any:
        found = right(of, axes, pitch, q)
        if of != kind:
            return found
        return change(found, kinematics.transform(of, axes, pitch, q)[:3, :3], q)

    return instead(kinematics, "motion", changed)


def _both(R: Any) -> Any:
    return np.kron(np.eye(2), R)


@means("EU-JNT-026")
def ball_velocities_along_the_parent() -> Deviation:
    """The angular velocity of a spherical joint is along the axes of its parent's side."""
    return _motion("spherical", lambda columns, R, q: columns @ R.T)


@means("EU-JNT-026")
def floating_velocities_along_the_world() -> Deviation:
    """The velocities of a floating joint are along the axes of its parent's side, the world for a root."""
    return _motion("floating", lambda columns, R, q: columns @ _both(R.T))


@means("EU-JNT-026")
def floating_linear_velocity_along_the_world() -> Deviation:
    """The linear velocity of a floating joint is along the world, the angular one along its child, as in MuJoCo."""
    return _motion("floating", lambda columns, R, q: np.hstack([columns[:, :3] @ R.T, columns[:, 3:]]))


@means("EU-JNT-026")
def floating_angular_velocity_first() -> Deviation:
    """The velocities of a floating joint are angular, then linear, as in Featherstone and Drake."""
    return _motion("floating", lambda columns, R, q: np.roll(columns, 3, axis=1))


@means("EU-JNT-026")
def planar_velocities_are_derivatives() -> Deviation:
    """The velocities of a planar joint are the derivatives of its coordinates."""

    def derivatives(columns: Any, R: Any, q: Any) -> Any:
        return np.hstack([columns[:, :2] @ R[:2, :2].T, columns[:, 2:]])

    return _motion("planar", derivatives)


@means("EU-JNT-026", versions=("2",))  # version 1 has none
def cylindrical_angular_velocity_first() -> Deviation:
    """The velocities of a cylindrical joint are angular, then linear."""
    return _motion("cylindrical", lambda columns, R, q: columns[:, ::-1])


# -- Closures -------------------------------------------------------------------------------------------------------


def _residual(kind: str, change: Callable[[Any], Any]) -> Deviation:
    """The residual of a type of closure is another function of aMb."""

    def changed(right: Any, at: Any, of: str, a: Any, b: Any) -> Any:
        return change(inverse(at.pose(a)) @ at.pose(b)) if of == kind else right(at, of, a, b)

    return instead(robot, "residual", changed)


@means("EU-CLO-008")
def residual_6d_angular_first() -> Deviation:
    """The rows of a 6d closure are angular, then linear."""
    return _residual("6d", lambda aMb: np.roll(log6(aMb), 3))


@means("EU-CLO-008")
def residual_6d_seen_from_b() -> Deviation:
    """The residual of a 6d closure is that of the pose of A in B."""
    return _residual("6d", lambda aMb: log6(inverse(aMb)))


@means("EU-CLO-008")
def residual_6d_of_position_and_log3() -> Deviation:
    """The linear rows of a 6d closure are the position of B in A, not those of log6."""
    return _residual("6d", lambda aMb: np.concatenate([aMb[:3, 3], log6(aMb)[3:]]))


@means("EU-CLO-008")
def residual_6d_of_sines() -> Deviation:
    """The angular rows of a 6d closure are those of the skew part of the rotation, as for small angles."""

    def sines(aMb: Any) -> Any:
        skew_part = (aMb[:3, :3] - aMb[:3, :3].T) / 2
        return np.concatenate([log6(aMb)[:3], skew_part[[2, 0, 1], [1, 2, 0]]])

    return _residual("6d", sines)


@means("EU-CLO-008")
def closures_6d_are_3d() -> Deviation:
    """A 6d closure holds the positions of its frames alone."""
    return _residual("6d", lambda aMb: aMb[:3, 3])


@means("EU-CLO-009")
def closures_3d_are_6d() -> Deviation:
    """A 3d closure holds orientations too."""
    return _residual("3d", log6)


@means("EU-CLO-009")
def residual_3d_seen_from_b() -> Deviation:
    """The residual of a 3d closure is the origin of A in B."""
    return _residual("3d", lambda aMb: inverse(aMb)[:3, 3])


@means("EU-CLO-009")
def residual_3d_from_b_to_a() -> Deviation:
    """The residual of a 3d closure has the opposite sign."""
    return _residual("3d", lambda aMb: -aMb[:3, 3])


@means("EU-CLO-009")
def residual_3d_along_the_world() -> Deviation:
    """The residual of a 3d closure is along the axes of the world."""

    def changed(right: Any, at: Any, of: str, a: Any, b: Any) -> Any:
        found = right(at, of, a, b)
        return (at.root @ at.pose(a))[:3, :3] @ found if of == "3d" else found

    return instead(robot, "residual", changed)


@means("EU-CLO-010")
def k_is_the_twist() -> Deviation:
    """K of a 6d closure is the twist of B relative to A, as if the closure were closed."""
    return instead(jacobian, "log6_derivative", lambda right, r: np.eye(6))


@means("EU-CLO-010")
def k_has_the_inverse_derivative() -> Deviation:
    """K of a 6d closure has the derivative of the exponential for that of the logarithm."""
    return instead(jacobian, "log6_derivative", lambda right, r: np.linalg.inv(right(r)))


@means("EU-CLO-010")
def k_forgets_that_a_turns() -> Deviation:
    """K of a 3d closure leaves out that A turns, as if the closure were closed."""
    return instead(jacobian, "skew", lambda right, p: 0 * skew(p))


def _k(change: Callable[[Any, Any, Any, Any], Any]) -> Deviation:
    """K is another: change(rows, kinematics, A, B)."""

    def changed(right: Any, at: Any, sharing: Any, kind: str, a: Any, b: Any) -> Any:
        return change(right(at, sharing, kind, a, b), at, a, b)

    return instead(robot, "jacobian", changed)


@means("EU-CLO-010")
def k_along_the_world() -> Deviation:
    """The rows of K are along the axes of the world, Pinocchio's LOCAL_WORLD_ALIGNED."""
    return _k(lambda K, at, a, b: np.kron(np.eye(len(K) // 3), (at.root @ at.pose(a))[:3, :3]) @ K)


@means("EU-CLO-010")
def k_seen_from_b() -> Deviation:
    """The rows of K are along the axes of B."""
    return _k(lambda K, at, a, b: np.kron(np.eye(len(K) // 3), (inverse(at.pose(b)) @ at.pose(a))[:3, :3]) @ K)


@means("EU-CLO-010")
def k_has_the_other_sign() -> Deviation:
    """K is the derivative of the negative residual."""
    return _k(lambda K, at, a, b: -K)


@means("EU-CLO-010")
def k_leaves_out_rows_of_zeros() -> Deviation:
    """K lacks its rows of zeros, as those by which a planar loop closed in 6d is redundant."""
    return _k(lambda K, at, a, b: K[np.any(np.abs(K) > 1e-12, axis=1)])


@means("EU-CLO-010")
def k_forgets_the_branch_of_a() -> Deviation:
    """K leaves out the joints that move A."""

    def changed(right: Any, at: Any, sharing: Any, kind: str, a: Any, b: Any) -> Any:
        moves = at.moves.copy()
        moves[a.body] = False
        return right(replace(at, moves=moves), sharing, kind, a, b)

    return instead(robot, "jacobian", changed)


@means("EU-CLO-010", versions=("2",))  # in version 1 no joint mimics
def k_forgets_mimic_joints() -> Deviation:
    """K leaves out the velocities of joints that mimic."""

    def sharing(right: Any, of: Any) -> Any:
        columns = [not joint.mimic for joint in of.joints for _ in range(joint.kind.nv)]
        return right(of) * np.array(columns)[:, None]

    return instead(configuration, "sharing", sharing)


# -- Inertia --------------------------------------------------------------------------------------------------------


def _inertia(change: Callable[[Any, Any], Any]) -> Deviation:
    """The inertia of a link is another: change(inertia, element of the link)."""

    def changed(right: Any, link: Any) -> Any:
        found = right(link)
        return found and change(found, link)

    return instead(urdf, "inertia", changed)


def _axes(link: Any) -> Any:
    return urdf.origin(link.one("inertial"))[:3, :3]


@means("EU-INR-006")
def inertia_along_the_link() -> Deviation:
    """The moments of a link are along its own axes, whatever the orientation of `inertial`."""
    return _inertia(lambda found, link: replace(found, moments=_axes(link).T @ found.moments @ _axes(link)))


@means("EU-INR-006")
def inertia_about_the_link() -> Deviation:
    """The moments of a link are about its origin, not its centre of mass."""

    def about_origin(found: Any, link: Any) -> Any:
        c = skew(found.center)
        return replace(found, moments=found.moments + found.mass * c @ c)

    return _inertia(about_origin)


@means("EU-INR-006")
def centre_of_mass_at_the_link() -> Deviation:
    """The centre of mass of a link is at its origin."""
    return _inertia(lambda found, link: replace(found, center=np.zeros(3)))


@means("EU-INR-006")
def products_of_inertia_with_the_other_sign() -> Deviation:
    """Products of inertia have the other sign, as in some CAD programs."""
    return _inertia(lambda found, link: replace(found, moments=found.moments * (2 * np.eye(3) - 1)))


@means("EU-INR-006", versions=("2",))  # version 1 has no armature
def armature_is_forgotten() -> Deviation:
    """M lacks the armatures."""
    return instead(
        mass_matrix, "mass_matrix", lambda right, at, sharing, armature, m: right(at, sharing, 0 * armature, m)
    )


@means("EU-INR-005")
def links_behind_fixed_joints_weigh_nothing() -> Deviation:
    """A link behind a fixed joint weighs nothing."""
    return _masses(lambda link, at: np.array_equal(at.pose, np.eye(4)))


@means("EU-INR-005")
def root_weighs_nothing() -> Deviation:
    """The mass does not count the root."""
    return _masses(lambda link, at: at.body > 0)


def _masses(counts: Callable[[Any, Any], bool]) -> Deviation:
    """Some inertias do not count."""

    def masses(right: Any, *arguments: Any) -> Any:
        *others, all_masses = arguments
        return right(*others, [(link, at) for link, at in all_masses if counts(link, at)])

    return _all(*(instead(mass_matrix, name, masses) for name in ("mass", "mass_matrix", "center_of_mass")))


def _all(*deviations: Deviation) -> Deviation:
    @contextmanager
    def entered() -> Any:
        with ExitStack() as stack:
            for deviation in deviations:
                stack.enter_context(deviation)
            yield

    return entered()


@means("EU-INR-005")
def links_behind_fixed_joints_are_not_moved() -> Deviation:
    """The inertia of a link behind a fixed joint counts as if it were at the link before."""
    return instead(kinematics.Kinematics, "pose", lambda right, at, frame: at.bodies[frame.body])


# -- Properties -----------------------------------------------------------------------------------------------------


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


# -- Merged joints --------------------------------------------------------------------------------------------------


def _ball(change: Callable[[Any, Any], Any]) -> Deviation:
    """Where merged joints are is another place: change(pose of the last joint in the link before, ball)."""

    def changed(right: Any, joints: Any) -> Any:
        found = right(joints)
        placement = change(found.placement @ found.link, joints)
        return replace(found, placement=placement, link=inverse(placement) @ found.placement @ found.link)

    return instead(tree, "ball", changed)


@means("EU-JNT-022")
def balls_at_the_last_origin() -> Deviation:
    """Merged joints turn about the origin of the last one, wherever their axes meet."""
    return _ball(lambda pMl, joints: pMl)


@means("EU-JNT-022", versions=("2",))
def balls_turned_as_the_first() -> Deviation:
    """The frame of merged joints has the orientation of the first one."""

    def changed(right: Any, joints: Any) -> Any:
        found = right(joints)
        placement = pose(joints[0].origin[:3, :3], found.placement[:3, 3])
        return replace(found, placement=placement, link=inverse(placement) @ found.placement @ found.link)

    return instead(tree, "ball", changed)


@means("EU-JNT-023")
def links_between_are_at_the_link_before() -> Deviation:
    """The links between merged joints are where the link before them is."""

    def fixed(right: Any, found: Any, joint: Any) -> None:
        right(found, joint)
        if joint.type != "fixed":
            found.links[joint.child] = found.joint_frames[joint.name] = found.links[joint.parent]

    return instead(tree, "add_fixed", fixed)


# -- Version 1 ------------------------------------------------------------------------------------------------------


@means("EU-ONE-007")
def nothing_is_merged() -> Deviation:
    """Three revolute joints of version 1 stay three."""
    return instead(
        sys.modules["eurdf_conformance.oracle.read"], "with_merges_found", lambda right, description, of: description
    )


@means("EU-ONE-007")
def heavy_links_are_merged() -> Deviation:
    """Three joints are merged even if a link between them has a mass."""
    return _constant(merging, "LIGHT", math.inf)


@means("EU-ONE-007")
def axes_that_do_not_meet_are_merged() -> Deviation:
    """Three joints are merged even if their axes do not meet."""
    return _constant(merging, "NEAR", math.inf)


def _constant(owner: Any, name: str, value: float) -> Deviation:
    return patch.object(owner, name, value)


@means("EU-ONE-009")
def mimics_of_version_1_are_followed() -> Deviation:
    """In version 1 a mimic joint depends on its leader, as in version 2."""
    return instead(urdf.Urdf, "without_mimics", lambda right, of: of)


# -- Configurations -------------------------------------------------------------------------------------------------


@means("EU-CFG-006")
def quaternions_as_written() -> Deviation:
    """A quaternion is kept as it is written."""
    return instead(configuration, "normalised", lambda right, joint, q: np.array(q, dtype=float))


@means("EU-CFG-005")
def left_out_joints_are_in_the_middle() -> Deviation:
    """A joint that a configuration leaves out is in the middle of its range."""

    def stated(right: Any, of: Any, q: Any) -> Any:
        middle = {
            joint.name: [(joint.source[0].lower + joint.source[0].upper) / 2]
            for joint in of.joints
            if joint.type in ("revolute", "prismatic") and joint.source and not joint.mimic
        }
        return right(of, middle | dict(q))

    return instead(canonical, "stated", stated)


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
