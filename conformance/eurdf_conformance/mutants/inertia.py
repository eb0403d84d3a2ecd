"""Inertias that are those of other bodies."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pinocchio as pin

from eurdf.mechanism.body import Body, Inertia
from eurdf.mechanism.joint_type import JointType
from eurdf.mechanism.mechanism import Mechanism
from eurdf.mechanism.pose import Pose
from eurdf.pinocchio import model
from eurdf.pinocchio.coordinates import slots
from eurdf.pinocchio.mimic import following
from eurdf.pinocchio.robot import Robot
from eurdf_conformance.adapters import reference_values
from eurdf_conformance.adapters.reference_values import Quantities
from eurdf_conformance.mutants.deviation import Deviation, around, instead, result
from eurdf_conformance.mutants.mutant import mutant
from eurdf_conformance.mutants.of_the_reference import mechanism


def _inertia(change: Callable[[Inertia], Inertia]) -> Deviation:
    """The inertia of each body is another where the model is built."""
    return around(model, "inertia_of", lambda original, of: original(change(of)))


def _behind_fixed_joints(change: Callable[[Body, Pose], Body]) -> Deviation:
    """Each body that a fixed joint carries is another; the second argument is its pose on the one before."""

    def changed(robot: Mechanism) -> Mechanism:
        at = {joint.child: joint.placement for joint in robot.joints if joint.type is JointType.FIXED}
        bodies = (change(body, at[body.name]) if body.name in at else body for body in robot.bodies)
        return replace(robot, bodies=tuple(bodies))

    return mechanism(changed)


@mutant("EU-INR-005")
def links_behind_fixed_joints_are_lost() -> Deviation:
    """A link behind a fixed joint weighs nothing."""
    return _behind_fixed_joints(lambda body, at: replace(body, inertia=None))


@mutant("EU-INR-005")
def links_behind_fixed_joints_are_not_moved() -> Deviation:
    """The inertia of a link behind a fixed joint is taken as if it were where the one before is."""

    def unmoved(body: Body, at: Pose) -> Body:
        if body.inertia is None:
            return body
        return replace(body, inertia=replace(body.inertia, pose=at.inverse() * body.inertia.pose))

    return _behind_fixed_joints(unmoved)


@mutant("EU-INR-005")
def links_behind_fixed_joints_are_points() -> Deviation:
    """Of a link behind a fixed joint only the mass counts, at its centre."""

    def point(body: Body, at: Pose) -> Body:
        return body if body.inertia is None else replace(body, inertia=replace(body.inertia, moments=(0.0,) * 6))

    return _behind_fixed_joints(point)


@mutant("EU-INR-005")
def links_behind_two_fixed_joints_are_not_turned() -> Deviation:
    """The moments of a link two or more fixed joints from its body are along its own axes, not those of `inertial`."""

    def changed(robot: Mechanism) -> Mechanism:
        welded = {joint.child: joint.parent for joint in robot.joints if joint.type is JointType.FIXED}
        twice = {child for child, parent in welded.items() if parent in welded}
        return replace(robot, bodies=tuple(_unturned(body) if body.name in twice else body for body in robot.bodies))

    return mechanism(changed)


def _unturned(body: Body) -> Body:
    inertia = body.inertia
    return body if inertia is None else replace(body, inertia=replace(inertia, pose=Pose(inertia.pose.xyz)))


@mutant("EU-INR-005")
def mass_of_the_root_is_lost() -> Deviation:
    """The mass does not count the root."""

    def masses(original: Any, self: Quantities) -> Any:
        root = self.robot.mechanism.bodies[0].inertia
        return original.func(self)[0 if root is None else 1 :]

    original = vars(Quantities)["_masses"]
    return instead(Quantities, "_masses", property(lambda self: masses(original, self)))


@mutant("EU-INR-005")
def nothing_has_its_centre_at_the_origin() -> Deviation:
    """The centre of mass of what weighs nothing is the origin of the world."""
    return around(Quantities, "center_of_mass", lambda original, self: original(self) or [0.0, 0.0, 0.0])


@mutant("EU-INR-006", versions=("2",))  # version 1 has no armatures
def armature_forgotten() -> Deviation:
    """M lacks the armatures."""

    def limits(original: Any, built: pin.Model, *arguments: Any) -> None:
        original(built, *arguments)
        built.armature = np.zeros(built.nv)

    return around(model, "set_limits", limits)


@mutant("EU-INR-006", versions=("2",))  # version 1 has no armatures
def armature_of_the_first_velocity() -> Deviation:
    """Of a joint of several velocities the armature of the first counts for all."""

    def limits(original: Any, built: pin.Model, joints: Any, *arguments: Any) -> None:
        original(
            built,
            [(replace(joint, armature=joint.armature[:1] * len(joint.armature)), nq) for joint, nq in joints],
            *arguments,
        )

    return around(model, "set_limits", limits)


@mutant("EU-INR-006")
def upper_triangle_of_m() -> Deviation:
    """M is said by its upper triangle, as Pinocchio leaves it."""
    return result(reference_values, "_mass_matrix", np.triu)


@mutant("EU-INR-006", versions=("2",))  # in version 1 no joint mimics
def followers_of_several_branches() -> Deviation:
    """Of the branches that a joint that mimics carries only the first is coupled with it, much as in Pinocchio."""

    def mass_matrix(original: Any, robot: Robot, q: Any) -> Any:
        M, mechanism = original(robot, q), robot.mechanism
        at = slots(mechanism, robot.model)
        for follower, law in following(mechanism).laws.items():
            child = next(joint.child for joint in mechanism.joints if joint.name == follower)
            leads = at[law.joint].idx_v
            for joint in [joint for joint in mechanism.joints if joint.parent == child and joint.name in at][1:]:
                columns = slice(at[joint.name].idx_v, at[joint.name].idx_v + at[joint.name].nv)
                M[leads, columns] = M[columns, leads] = 0.0
        return M

    return around(reference_values, "_mass_matrix", mass_matrix)


@mutant("EU-INR-006")
def inertia_along_the_axes_of_the_link() -> Deviation:
    """The moments of a link are along its own axes, whatever the orientation of `inertial`."""
    return _inertia(lambda of: replace(of, pose=Pose(of.pose.xyz)))


@mutant("EU-INR-006")
def inertia_about_the_origin_of_the_link() -> Deviation:
    """The moments of a link are about its origin, not its centre of mass."""

    def about_origin(original: Any, of: Inertia) -> pin.Inertia:
        body = original(of)
        body.inertia = body.inertia + body.mass * pin.skew(body.lever) @ pin.skew(body.lever)
        return body

    return around(model, "inertia_of", about_origin)


@mutant("EU-INR-006")
def centre_of_mass_at_the_origin() -> Deviation:
    """The centre of mass of a link is at its origin."""
    return _inertia(lambda of: replace(of, pose=Pose((0.0, 0.0, 0.0), of.pose.quaternion)))


@mutant("EU-INR-006")
def sign_of_the_products_of_inertia() -> Deviation:
    """Products of inertia have the other sign, as some CAD programs have it."""

    def negated(of: Inertia) -> Inertia:
        xx, xy, xz, yy, yz, zz = of.moments
        return replace(of, moments=(xx, -xy, -xz, yy, -yz, zz))

    return _inertia(negated)


@mutant("EU-INR-006")
def moments_in_another_order() -> Deviation:
    """The six moments are read as ixx, iyy, izz, ixy, ixz, iyz."""

    def reordered(of: Inertia) -> Inertia:
        xx, xy, xz, yy, yz, zz = of.moments
        return replace(of, moments=(xx, yy, zz, xy, xz, yz))

    return _inertia(reordered)


@mutant("EU-INR-006", versions=("2",))  # in version 1 no joint mimics
def followers_weigh_nothing() -> Deviation:
    """M leaves out what a joint that mimics carries."""

    def changed(robot: Mechanism) -> Mechanism:
        carried = {joint.child for joint in robot.joints if joint.mimic is not None}
        bodies = (replace(body, inertia=None) if body.name in carried else body for body in robot.bodies)
        return replace(robot, bodies=tuple(bodies))

    return mechanism(changed)


@mutant("EU-INR-005")
def centre_of_mass_of_nothing() -> Deviation:
    """The centre of mass of a robot that weighs nothing is said to be at the origin."""
    return result(Quantities, "center_of_mass", lambda center: [0.0, 0.0, 0.0] if center is None else center)
