"""Readers of URDFs that have a rule too many, or one that is stricter than the specification."""

from __future__ import annotations

import math
import sys
from collections.abc import Iterator
from typing import Any

from eurdf.format import urdf as urdf_format
from eurdf.format.urdf import _KNOWN_CHILDREN, Urdf
from eurdf.mechanism.joint_type import JointType
from eurdf_conformance.mutants.deviation import Deviation, around
from eurdf_conformance.mutants.mutant import mutant
from eurdf_conformance.mutants.of_the_reference import refused_by_urdf

_RANGED = (JointType.REVOLUTE, JointType.PRISMATIC)


def _elements(urdf: Urdf, tag: str) -> Iterator[Any]:
    return urdf.document.root.iter(tag)


@mutant("EU-URD-004")
def continuous_joint_needs_limits() -> Deviation:
    """A continuous joint must have a limit."""
    return refused_by_urdf(
        lambda urdf: any(j.type is JointType.CONTINUOUS and j.limit is None for j in urdf.joints.values())
    )


@mutant("EU-URD-004")
def link_needs_inertia() -> Deviation:
    """A link must have an inertial element."""
    return refused_by_urdf(lambda urdf: any(link.inertia is None for link in urdf.links.values()))


@mutant("EU-URD-005")
def limits_must_say_positions() -> Deviation:
    """A limit must say lower and upper."""
    return refused_by_urdf(
        lambda urdf: any(e.get("lower") is None or e.get("upper") is None for e in _elements(urdf, "limit"))
    )


@mutant("EU-URD-005")
def origin_must_say_both() -> Deviation:
    """An origin must say xyz and rpy."""
    return refused_by_urdf(
        lambda urdf: any(e.get("xyz") is None or e.get("rpy") is None for e in _elements(urdf, "origin"))
    )


@mutant("EU-URD-006")
def one_visual_a_link() -> Deviation:
    """A link may have one visual and one collision."""
    return refused_by_urdf(
        lambda urdf: any(
            len(link.findall(tag)) > 1 for link in _elements(urdf, "link") for tag in ("visual", "collision")
        )
    )


@mutant("EU-URD-007")
def numbers_without_exponent() -> Deviation:
    """A number may not have an exponent."""
    return refused_by_urdf(
        lambda urdf: any(
            "e" in element.get(key, "").lower()
            for tag, key in (
                ("origin", "xyz"),
                ("inertia", "ixx"),
                ("mass", "value"),
                ("limit", "upper"),
                ("axis", "xyz"),
            )
            for element in _elements(urdf, tag)
        )
    )


@mutant("EU-URD-007")
def numbers_nearly_zero_refused() -> Deviation:
    """A number that is nearer to 0 than the numbers of full precision is out of range, as for std::stod."""

    def floats(original: Any, text: str, separator: str | None = None) -> tuple[float, ...] | None:
        found: tuple[float, ...] | None = original(text, separator)
        words = text.split(separator)
        return found if found is None or not any(map(_underflows, words, found)) else None

    return around(urdf_format, "_floats", floats)


def _underflows(word: str, value: float) -> bool:
    zero = not set("123456789") & set(word.lower().partition("e")[0])
    return abs(value) < sys.float_info.min and not zero


@mutant("EU-URD-011")
def root_joint_refused() -> Deviation:
    """Nothing may be named root_joint, be the root fixed."""
    return refused_by_urdf(lambda urdf: "root_joint" in urdf.links or "root_joint" in urdf.joints)


@mutant("EU-URD-013")
def short_axis_refused() -> Deviation:
    """An axis must be of unit length, to a thousandth."""
    return refused_by_urdf(
        lambda urdf: any(abs(sum(x * x for x in joint.axis) - 1.0) > 1e-3 for joint in urdf.joints.values())
    )


@mutant("EU-URD-013")
def axis_whose_square_is_out_of_range_refused() -> Deviation:
    """An axis is zero where the sum of its squares is, and none where that is infinite."""
    return refused_by_urdf(
        lambda urdf: any(not 0.0 < sum(x * x for x in joint.axis) < math.inf for joint in urdf.joints.values())
    )


@mutant("EU-URD-019")
def equal_limits_refused() -> Deviation:
    """A lower limit must be below the upper one."""
    return refused_by_urdf(
        lambda urdf: any(
            j.type in _RANGED and j.limit is not None and j.limit.lower == j.limit.upper for j in urdf.joints.values()
        )
    )


@mutant("EU-URD-020")
def limits_of_zero_refused() -> Deviation:
    """Limits of effort and velocity must be more than 0."""
    return refused_by_urdf(
        lambda urdf: any(
            j.limit is not None and 0.0 in (j.limit.effort, j.limit.velocity) for j in urdf.joints.values()
        )
    )


@mutant("EU-URD-022")
def chain_of_mimics_refused() -> Deviation:
    """A joint may not mimic one that mimics."""
    return refused_by_urdf(
        lambda urdf: any(j.mimic is not None and urdf.joints[j.mimic.joint].mimic for j in urdf.joints.values())
    )


@mutant("EU-URD-023")
def mimic_of_another_type_refused() -> Deviation:
    """A joint may not mimic one of another type."""
    return refused_by_urdf(
        lambda urdf: any(
            j.mimic is not None and urdf.joints[j.mimic.joint].type is not j.type for j in urdf.joints.values()
        )
    )


@mutant("EU-URD-024")
def capsule_refused() -> Deviation:
    """A capsule is no shape."""
    return refused_by_urdf(lambda urdf: any(True for _ in _elements(urdf, "capsule")))


@mutant("EU-CNF-002")
def unknown_elements_refused() -> Deviation:
    """An element that URDF lacks is refused, and those of other programs with it."""
    return refused_by_urdf(
        lambda urdf: any(
            isinstance(child.tag, str) and child.tag not in _KNOWN_CHILDREN[tag] - {"gazebo", "transmission"}
            for tag in ("robot", "link", "joint")
            for element in _elements(urdf, tag)
            for child in element
        )
    )


@mutant("EU-FIL-002")
def a_thousand_links_at_most() -> Deviation:
    """A robot of more than 1000 links is refused."""
    return refused_by_urdf(lambda urdf: len(urdf.links) > 1000)


@mutant("EU-FIL-002")
def two_dozen_joints_on_a_link_at_most() -> Deviation:
    """A robot with more than 24 joints on one link is refused."""
    return refused_by_urdf(lambda urdf: any(len(joints) > 24 for joints in urdf.children.values()))
