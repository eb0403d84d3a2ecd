"""Mimics that count where they have no effect: in version 1, and on a fixed joint."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

from eurdf.format.urdf import Urdf, UrdfJoint
from eurdf.linking import description, replacement
from eurdf.linking.description import Description
from eurdf.mechanism.mechanism import Mechanism
from eurdf_conformance.mutants.deviation import Deviation, around, together
from eurdf_conformance.mutants.mutant import mutant
from eurdf_conformance.mutants.of_the_reference import described, issues, refused


def _in_version1(where: Callable[[Description, UrdfJoint], bool]) -> Deviation:
    """A description of version 1 is refused for a joint of its URDF that has a mimic."""

    def wrong(read: Description) -> bool:
        if read.extension is None or read.extension.version != "1" or read.urdf is None:
            return False
        return any(where(read, joint) for joint in read.urdf.joints.values() if joint.mimic)

    return refused(wrong)


@mutant("EU-ONE-009")
def mimic_joints_of_version_1_follow() -> Deviation:
    """In version 1 a mimic joint depends on its leader, as in version 2."""

    def followed(read: Description) -> Description:
        assert read.urdf is not None
        if read.extension is None or read.extension.version != "1":
            return read
        laws = {joint.name: joint.mimic for joint in read.urdf.joints.values() if joint.mimic}
        return replace(read, mechanism=_following(read.mechanism, laws))

    return described(followed)


def _following(robot: Mechanism | None, laws: dict[str, Any]) -> Mechanism:
    assert robot is not None
    moving = {joint.name for joint in robot.joints if joint.coordinates.nv == 1}
    kept = {name: law for name, law in laws.items() if {name, law.joint} <= moving and name not in robot.actuators}
    return replace(robot, joints=tuple(replace(joint, mimic=kept.get(joint.name)) for joint in robot.joints))


@mutant("EU-ONE-009")
def mimics_of_version_1_must_name_a_joint() -> Deviation:
    """In version 1 a joint may not mimic one that does not exist."""
    return _in_version1(lambda read, joint: _target(read, joint) is None)


@mutant("EU-ONE-009")
def mimics_of_version_1_must_end() -> Deviation:
    """In version 1 joints may not mimic one another in a cycle."""

    def endless(read: Description, joint: UrdfJoint) -> bool:
        seen: set[str] = set()
        at: UrdfJoint | None = joint
        while at is not None and at.name not in seen:
            seen.add(at.name)
            at = _target(read, at)
        return at is not None

    return _in_version1(endless)


@mutant("EU-ONE-009")
def mimics_of_version_1_must_be_of_single_joints() -> Deviation:
    """In version 1 only a joint of one coordinate may mimic, and only such a one."""

    def odd(read: Description, joint: UrdfJoint) -> bool:
        return any(each is not None and each.type in ("floating", "fixed") for each in (joint, _target(read, joint)))

    return _in_version1(odd)


@mutant("EU-ONE-009")
def motors_of_version_1_must_not_be_on_mimic_joints() -> Deviation:
    """In version 1 a joint that mimics may not be actuated."""
    return _in_version1(lambda read, joint: joint.name in {entry.joint for entry in _extension(read).actuators})


@mutant("EU-ONE-009")
def mimic_joints_of_version_1_stay() -> Deviation:
    """In version 1 a joint that mimics, or that is mimicked, may not be replaced."""

    def changed(read: Description, joint: UrdfJoint) -> bool:
        assert joint.mimic is not None
        return not {joint.name, joint.mimic.joint}.isdisjoint(entry.name for entry in _extension(read).joints)

    return _in_version1(changed)


@mutant("EU-ONE-009")
def mimic_joints_of_version_1_are_not_merged() -> Deviation:
    """In version 1 three joints stay three where one of them mimics."""
    return _merged_but_for(lambda joint: [joint.name])


@mutant("EU-ONE-009")
def mimicked_joints_of_version_1_are_not_merged() -> Deviation:
    """In version 1 three joints stay three where one of them is mimicked."""
    return _merged_but_for(lambda joint: [] if joint.mimic is None else [joint.mimic.joint])


def _merged_but_for(names: Callable[[UrdfJoint], list[str]]) -> Deviation:
    kept: set[str] = set()

    def linked(original: Any, urdf: Urdf, *arguments: Any, **named: Any) -> Any:
        kept.clear()
        kept.update(name for joint in urdf.joints.values() if joint.mimic for name in names(joint))
        return original(urdf, *arguments, **named)

    def chains(original: Any, urdf: Urdf, joints: Any, excluded: set[str], links: Any) -> Any:
        return original(urdf, joints, excluded | kept, links)

    return together(around(description, "link", linked), around(replacement, "find_chains", chains))


@mutant("EU-URD-036")
def mimics_of_fixed_joints_are_wrong() -> Deviation:
    """That a fixed joint mimics is an error."""
    return issues(
        lambda found: [
            each.model_copy(update={"severity": "error"}) if each.code == "urdf-mimic-fixed" else each for each in found
        ]
    )


def _target(read: Description, joint: UrdfJoint) -> UrdfJoint | None:
    assert read.urdf is not None
    return None if joint.mimic is None else read.urdf.joints.get(joint.mimic.joint)


def _extension(read: Description) -> Any:
    assert read.extension is not None
    return read.extension
