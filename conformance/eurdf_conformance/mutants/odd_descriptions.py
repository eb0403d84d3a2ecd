"""Descriptions of version 2 that say too little of a joint, or speak of the joint of a floating root."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

from eurdf.format import version2
from eurdf.linking.description import Description
from eurdf.linking.frame_names import FrameNames
from eurdf.mechanism.pose import Pose
from eurdf_conformance.adapters.reference import Reference
from eurdf_conformance.mutants.deviation import Deviation, around, instead, result
from eurdf_conformance.mutants.mutant import mutant
from eurdf_conformance.mutants.of_the_reference import data_of_version2, each_issue, refused
from eurdf_conformance.protocol.message import Accepted, Rejected
from eurdf_conformance.protocol.reply import accepted


def _joints(change: Callable[[dict[str, Any]], dict[str, Any]]) -> Deviation:
    """What is said of each joint in a mapping is read otherwise."""

    def changed(data: Any) -> Any:
        if not isinstance(data.get("joints"), dict):
            return data
        joints = {name: change(said) if isinstance(said, dict) else said for name, said in data["joints"].items()}
        return {**data, "joints": joints}

    return data_of_version2(changed)


def _with_type(key: str, kind: str) -> Deviation:
    return _joints(lambda said: {"type": kind, **said} if key in said else said)


@mutant("EU-SCH-001", versions=("2",))
def axes_say_universal() -> Deviation:
    """A joint that has axes is universal, be it said or not."""
    return _with_type("axes", "universal")


@mutant("EU-SCH-001", versions=("2",))
def pitch_says_helical() -> Deviation:
    """A joint that has a pitch is helical, be it said or not."""
    return _with_type("pitch", "helical")


@mutant("EU-SCH-001", versions=("2",))
def merges_say_spherical() -> Deviation:
    """A joint that merges is spherical, be it said or not."""
    return _with_type("merges", "spherical")


@mutant("EU-DIA-001", versions=("2",))
def axes_without_type_are_unknown() -> Deviation:
    """Axes, pitch and merges are unknown keys in a joint that keeps its type."""
    return instead(version2, "_TOLD_BY", {})


@mutant("EU-DIA-001", versions=("2",))
def number_is_an_unknown_version() -> Deviation:
    """A version that is a number is one that is not known."""
    return each_issue(
        lambda issue: {"code": "unsupported-version"} if "'extended_urdf' must be text" in issue.message else {}
    )


def _with_root_joint(code: str) -> Deviation:
    def change(answer: Accepted | Rejected) -> Accepted | Rejected:
        if isinstance(answer, Rejected) and all(
            issue.code == code and "'root_joint'" in issue.message for issue in answer.issues
        ):
            return accepted()
        return answer

    return result(Reference, "load", change)


@mutant("EU-ACT-001", versions=("2",))
def motor_on_the_floating_root() -> Deviation:
    """The joint of a floating root may have a motor."""
    return _with_root_joint("unknown-actuator")


@mutant("EU-JNT-001", versions=("2",))
def floating_root_is_changed() -> Deviation:
    """The joint of a floating root may have properties."""
    return _with_root_joint("unknown-joint")


@mutant("EU-FRM-001", versions=("2",))
def frame_on_the_floating_root() -> Deviation:
    """The joint of a floating root is the name of a frame."""
    return _with_root_joint("unknown-frame")


@mutant("EU-DIA-001", versions=("2",))
def floating_root_is_immobile() -> Deviation:
    """A motor on the joint of a floating root is one on a joint that cannot move."""
    return each_issue(
        lambda issue: (
            {"code": "actuator-immobile"}
            if issue.code == "unknown-actuator" and "'root_joint'" in issue.message
            else {}
        )
    )


@mutant("EU-CLO-004", versions=("2",))
def near_frames_are_the_same() -> Deviation:
    """Two frames that are less than a micrometre apart are the same."""

    def find(original: Any, self: Any, reference: Any) -> Any:
        found = original(self, reference)
        if found is None:
            return None
        return replace(found, pose=Pose(tuple(round(x, 6) for x in found.pose.xyz), found.pose.quaternion))

    return around(FrameNames, "find", find)


@mutant("EU-CFG-004", versions=("2",))
def neutral_must_be_within_the_limits() -> Deviation:
    """A joint that a configuration leaves out must have its neutral within its limits."""

    def beyond(read: Description) -> bool:
        assert read.mechanism is not None
        outside = {
            joint.name for joint in read.mechanism.joints if any(low > 0.0 for low in joint.lower) and not joint.mimic
        }
        return any(outside - configuration.keys() for configuration in read.mechanism.configurations.values())

    return refused(beyond)
