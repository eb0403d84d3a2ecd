"""Rules of inertia that draw their line elsewhere."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from eurdf import description
from eurdf.mechanism import inertia
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
