"""Rules of inertia that draw their line elsewhere."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

from eurdf.linking import description, inertia
from eurdf.mechanism.joint import Joint
from eurdf.mechanism.joint_type import JointType
from eurdf.mechanism.mechanism import Mechanism
from eurdf_conformance.mutants.deviation import Deviation, around, instead
from eurdf_conformance.mutants.mutant import mutant


@mutant("EU-INR-001")
def mass_must_be_positive() -> Deviation:
    """A mass of 0 is told to be negative."""

    def check(original: Any, urdf: Any, diagnostics: Any) -> Any:
        for link in urdf.links.values():
            if link.inertia is not None and link.inertia.mass == 0.0:
                inertia._report(urdf, diagnostics, link, "negative-mass", "it weighs nothing", "mass")
        return original(urdf, diagnostics)

    return around(description, "check_inertias", check)


@mutant("EU-INR-002")
def rounding_is_negative() -> Deviation:
    """A principal moment that is negative by rounding is told."""
    return instead(inertia, "MOMENT_TOLERANCE", 1e-14)


@mutant("EU-INR-002")
def hundredth_is_rounding() -> Deviation:
    """A principal moment may be negative by a hundredth of the largest."""
    return instead(inertia, "MOMENT_TOLERANCE", 1e-2)


@mutant("EU-INR-002")
def diagonal_alone_is_looked_at() -> Deviation:
    """An inertia is positive semidefinite where its diagonal is not negative."""

    def check(original: Any, urdf: Any, diagnostics: Any) -> Any:
        def sound(moments: Any) -> bool:
            return bool(min(moments[0], moments[3], moments[5]) >= 0.0)

        with instead(inertia, "_plainly_sound", sound):
            return original(urdf, diagnostics)

    return around(description, "check_inertias", check)


@mutant("EU-INR-004")
def links_without_inertia_are_told() -> Deviation:
    """Any link that moves and weighs nothing is told, not only at the end of the tree."""

    def check(original: Any, robot: Mechanism, urdf: Any, diagnostics: Any, faulty: Any) -> None:
        original(robot, urdf, diagnostics, faulty)
        parents = {joint.parent for joint in robot.joints}
        for joint in robot.joints:
            link = urdf.links.get(joint.child)
            if joint.type is not JointType.FIXED and link and link.inertia is None and joint.child in parents:
                inertia._report(urdf, diagnostics, link, "leaf-without-inertia", "it weighs nothing")

    return around(description, "check_leaves", check)


@mutant("EU-INR-004")
def mass_is_enough() -> Deviation:
    """What moves at the end of the tree has inertia where it has mass."""

    def immaterial(original: Any, joint: Any, members: Any) -> str | None:
        members = list(members)
        told: str | None = original(joint, members)
        return None if any(of.mass > 0.0 for _, of in members) else told

    return around(inertia, "_immaterial", immaterial)


@mutant("EU-INR-004", versions=("2",))  # version 1 has no armatures
def armature_is_no_inertia() -> Deviation:
    """What moves at the end of the tree must have inertia though its joint have an armature."""

    def check(original: Any, robot: Mechanism, *arguments: Any) -> None:
        bare = tuple(replace(joint, armature=(0.0,) * len(joint.armature)) for joint in robot.joints)
        original(replace(robot, joints=bare), *arguments)

    return around(description, "check_leaves", check)


@mutant("EU-INR-004", versions=("2",))  # version 1 has no armatures
def one_armature_is_enough() -> Deviation:
    """A joint has an armature where one of its velocities has."""

    def check(original: Any, robot: Mechanism, *arguments: Any) -> None:
        most = (replace(joint, armature=(max(joint.armature, default=0.0),)) for joint in robot.joints)
        original(replace(robot, joints=tuple(most)), *arguments)

    return around(description, "check_leaves", check)


@mutant("EU-INR-004", versions=("2",))  # in version 1 no joint mimics
def followers_must_have_inertia() -> Deviation:
    """A leaf must have inertia though its joint mimics another."""

    def check(original: Any, robot: Mechanism, *arguments: Any) -> None:
        original(replace(robot, joints=tuple(replace(joint, mimic=None) for joint in robot.joints)), *arguments)

    return around(description, "check_leaves", check)


@mutant("EU-INR-004")
def what_carries_a_fixed_joint_is_no_leaf() -> Deviation:
    """A link that carries a joint is no leaf, be that joint fixed."""

    def check(original: Any, robot: Mechanism, *arguments: Any) -> None:
        parents = {joint.parent for joint in robot.joints}
        joints = (replace(joint, armature=(1.0,)) if joint.child in parents else joint for joint in robot.joints)
        original(replace(robot, joints=tuple(joints)), *arguments)

    return around(description, "check_leaves", check)


def _leaves(change: Callable[[Any, Joint, Any], str | None]) -> Deviation:
    """Whether a leaf has inertia is seen otherwise."""

    def immaterial(original: Any, joint: Joint, members: Any) -> str | None:
        return change(original, joint, list(members))

    return around(inertia, "_immaterial", immaterial)


def _passed_over(*kinds: JointType) -> Deviation:
    return _leaves(lambda original, joint, members: None if joint.type in kinds else original(joint, members))


@mutant("EU-INR-004")
def leaves_of_free_joints_are_passed_over() -> Deviation:
    """A leaf on a planar or a floating joint may have no inertia."""
    return _passed_over(JointType.PLANAR, JointType.FLOATING)


@mutant("EU-INR-004")
def leaves_that_spin_are_passed_over() -> Deviation:
    """A leaf on a continuous joint may have no inertia."""
    return _passed_over(JointType.CONTINUOUS)


@mutant("EU-INR-004")
def leaves_of_balls_are_passed_over() -> Deviation:
    """A leaf on a spherical joint may have no inertia."""
    return _passed_over(JointType.SPHERICAL)


@mutant("EU-INR-004", versions=("2",))  # version 1 has two hinges, and no screws
def leaves_of_universal_joints_and_screws_are_passed_over() -> Deviation:
    """A leaf on a universal or helical joint may have no inertia."""
    return _passed_over(JointType.UNIVERSAL, JointType.HELICAL)


@mutant("EU-INR-004", versions=("2",))  # version 1 has two hinges
def universal_joint_counts_by_its_first_axis() -> Deviation:
    """A leaf on a universal joint must have inertia about the first axis, which it carries with it."""

    def first(original: Any, joint: Joint, members: Any) -> str | None:
        turned = replace(joint, axes=joint.axes[::-1]) if joint.type is JointType.UNIVERSAL else joint
        told: str | None = original(turned, members)
        return told

    return _leaves(first)


@mutant("EU-INR-004")
def free_joints_turn_about_their_origin() -> Deviation:
    """A leaf on a planar or a floating joint has the moment about the joint's origin, as if it could not slide."""
    return instead(inertia, "_centred", lambda members, mass: members)


@mutant("EU-INR-004")
def mass_is_enough_for_a_slide() -> Deviation:
    """What slides at the end of the tree has inertia where it has mass, turn as it may."""
    slides = (JointType.CYLINDRICAL, JointType.PLANAR, JointType.FLOATING)

    def slid(original: Any, joint: Joint, members: Any) -> str | None:
        told: str | None = original(joint, members)
        return None if joint.type in slides and sum(of.mass for _, of in members) > 0.0 else told

    return _leaves(slid)


def _looked_at(which: Callable[[Any, str], bool]) -> Deviation:
    """Of some links alone the inertia is looked at."""

    def check(original: Any, urdf: Any, diagnostics: Any) -> Any:
        links = {name: link for name, link in urdf.links.items() if which(urdf, name)}
        return original(replace(urdf, links=links), diagnostics)

    return around(description, "check_inertias", check)


@mutant("EU-INR-002")
def inertia_of_the_root_is_passed_over() -> Deviation:
    """The inertia of the root link may be anything."""
    return _looked_at(lambda urdf, name: name != urdf.root)


@mutant("EU-INR-002")
def inertia_without_mass_is_passed_over() -> Deviation:
    """The inertia of a link of no mass may be anything."""
    return _looked_at(lambda urdf, name: urdf.links[name].inertia is None or urdf.links[name].inertia.mass != 0.0)
