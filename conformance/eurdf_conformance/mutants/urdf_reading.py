"""What a URDF says, misread."""

from __future__ import annotations

import math
import unicodedata
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

from eurdf.diagnostics import Fault
from eurdf.format import urdf
from eurdf.format.urdf import _Reader
from eurdf.mechanism.joint_type import JointType
from eurdf.mechanism.mechanism import Mechanism
from eurdf.mechanism.mimic import Mimic
from eurdf.pinocchio import mimic, robot
from eurdf.reading import xml_reader
from eurdf_conformance.adapters import reference_values
from eurdf_conformance.mutants.accepting import accepting
from eurdf_conformance.mutants.deviation import Deviation, around, instead, result
from eurdf_conformance.mutants.mutant import mutant

accepts_entities = accepting("xml-doctype", "EU-SEC-002", "accepts_entities")


def _mimic(change: Callable[[Mimic], Mimic]) -> Deviation:
    """What a joint that mimics does is read otherwise."""
    return result(_Reader, "mimic", lambda found: found and change(found))


@mutant("EU-URD-032")
def offset_dropped() -> Deviation:
    """A joint that mimics stands at multiplier · q."""
    return _mimic(lambda found: replace(found, offset=0.0))


@mutant("EU-URD-032")
def multiplier_dropped() -> Deviation:
    """A joint that mimics stands at q + offset."""
    return _mimic(lambda found: replace(found, multiplier=1.0))


@mutant("EU-URD-032")
def multiplier_of_0_is_1() -> Deviation:
    """A multiplier of 0 counts as none, which is 1."""
    return _mimic(lambda found: replace(found, multiplier=found.multiplier or 1.0))


@mutant("EU-URD-032")
def offset_before_multiplier() -> Deviation:
    """A joint that mimics stands at multiplier · (q + offset)."""
    return _mimic(lambda found: replace(found, offset=found.multiplier * found.offset))


@mutant("EU-URD-032")
def multiplier_the_other_way() -> Deviation:
    """A joint that mimics stands at (q − offset) / multiplier."""
    return _mimic(lambda found: Mimic(found.joint, 1.0 / found.multiplier, -found.offset / found.multiplier))


@mutant("EU-URD-032")
def chain_of_mimics_cut() -> Deviation:
    """Of a joint that mimics one that mimics, its own law alone counts."""

    def drivers(original: Any, mimics: Mapping[str, Mimic]) -> dict[str, Mimic]:
        laws = original(mimics)
        return {follower: replace(mimics[follower], joint=law.joint) for follower, law in laws.items()}

    return around(mimic, "drivers", drivers)


@mutant("EU-URD-032")
def chain_of_three_mimics_cut() -> Deviation:
    """Of a chain of joints that mimic, the two laws nearest to a joint count, as if what they lead to led them all."""

    def drivers(original: Any, mimics: Mapping[str, Mimic]) -> dict[str, Mimic]:
        laws: dict[str, Mimic] = original(mimics)
        for follower, law in laws.items():
            one = mimics[follower]
            other = mimics.get(one.joint)
            if other is not None and other.joint in mimics:
                offset = one.multiplier * other.offset + one.offset
                laws[follower] = Mimic(law.joint, one.multiplier * other.multiplier, offset)
        return laws

    return around(mimic, "drivers", drivers)


def _without_turns(kind: JointType) -> Deviation:
    """The angles of joints of one type, of which the others follow some, are brought within half a turn."""

    def vector(original: Any, mechanism: Mechanism, model: Any, given: Mapping[str, Any], *at: Any) -> Any:
        turning = {joint.name for joint in mechanism.joints if joint.type is kind} & given.keys()
        within = {name: [math.remainder(given[name][0], math.tau)] for name in turning}
        return original(mechanism, model, {**given, **within}, *at)

    return around(reference_values, "configuration_vector", vector)


@mutant("EU-URD-032")
def turns_of_a_leader_lost() -> Deviation:
    """Of a continuous joint, those that follow it know the cosine and the sine, and no whole turns: Pinocchio."""
    return _without_turns(JointType.CONTINUOUS)


@mutant("EU-URD-032")
def turns_of_a_revolute_leader_lost() -> Deviation:
    """Of a revolute joint, those that follow it know the angle within half a turn."""
    return _without_turns(JointType.REVOLUTE)


@mutant("EU-URD-032")
def mimics_are_free() -> Deviation:
    """A joint that mimics moves by itself, as in Pinocchio unless it is asked."""

    def build(original: Any, mechanism: Mechanism) -> Any:
        return original(replace(mechanism, joints=tuple(replace(joint, mimic=None) for joint in mechanism.joints)))

    return around(robot, "build_model", build)


@mutant("EU-URD-007")
def numbers_of_python() -> Deviation:
    """A number is what Python takes for a float: nan, inf and 1_0 too."""

    def floats(text: str, separator: str | None = None) -> tuple[float, ...] | None:
        try:
            return tuple(map(float, text.split(separator)))
        except ValueError:
            return None

    return instead(urdf, "_floats", floats)


@mutant("EU-URD-007")
def decimal_commas() -> Deviation:
    """A number may have a comma for its point, as where the locale says so."""

    def numbers(original: Any, self: Any, element: Any, attribute: str, text: str, count: int) -> Any:
        return original(self, element, attribute, text.replace(",", "."), count)

    return around(_Reader, "numbers", numbers)


@mutant("EU-FRM-001")
def names_are_trimmed() -> Deviation:
    """Names of the URDF are read without the white space around them."""
    return result(_Reader, "name", lambda name: name and name.strip())


@mutant("EU-FRM-001")
def names_are_normalised() -> Deviation:
    """Names of the URDF are brought to Unicode's composed form."""
    return result(_Reader, "name", lambda name: name and unicodedata.normalize("NFC", name))


@mutant("EU-FRM-001")
def case_of_names_does_not_matter() -> Deviation:
    """Names of the URDF are read in lower case."""
    return result(_Reader, "name", lambda name: name and name.lower())


@mutant("EU-URD-012")
def types_in_any_case() -> Deviation:
    """A joint's type may be in upper case."""

    def joint_type(original: Any, self: Any, element: Any) -> Any:
        known = urdf.URDF_JOINT_TYPES.get(element.get("type", "").lower())
        return known or original(self, element)

    return around(_Reader, "joint_type", joint_type)


@mutant("EU-URD-012")
def ball_of_the_urdf() -> Deviation:
    """A URDF may say that a joint is spherical, as SDF does."""
    kinds = {**urdf.URDF_JOINT_TYPES, "spherical": JointType.CONTINUOUS, "ball": JointType.CONTINUOUS}
    return instead(urdf, "URDF_JOINT_TYPES", kinds)


@mutant("EU-URD-001")
def namespaces_must_be_declared() -> Deviation:
    """A prefix that is not declared is a fault of syntax."""

    def read(source: Any) -> Any:
        raise Fault("xml-syntax", "a prefix is not declared", source.place(0))

    return instead(xml_reader, "_read_with_namespace_errors", read)


@mutant("EU-URD-014")
def links_must_come_first() -> Deviation:
    """A joint must stand after the links that it names."""

    def tree(original: Any, self: Any, name: str, links: Any, joints: Any) -> Any:
        order = {element: index for index, element in enumerate(self.document.root)}
        at = {link.name: order[link.element] for link in links}
        if any(at.get(end, 0) > order[joint.element] for joint in joints for end in (joint.parent, joint.child)):
            self.report("urdf-unknown-link", "a link comes later", self.document.root)
            return None
        return original(self, name, links, joints)

    return around(_Reader, "tree", tree)


@mutant("EU-URD-021")
def leaders_must_come_first() -> Deviation:
    """A joint must stand after the one that it mimics."""

    def mimics(original: Any, self: Any, joints: Any) -> None:
        order = {name: index for index, name in enumerate(joints)}
        for joint in joints.values():
            if joint.mimic and order.get(joint.mimic.joint, 0) > order[joint.name]:
                self.report("urdf-mimic-unknown", "the joint comes later", joint.element)
        original(self, joints)

    return around(_Reader, "mimics", mimics)


@mutant("EU-URD-018")
def first_link_is_the_root() -> Deviation:
    """The first link of the file is the root, and may have no parent."""

    def tree(original: Any, self: Any, name: str, links: Any, joints: Any) -> Any:
        if links and any(joint.child == links[0].name for joint in joints):
            self.report("urdf-two-roots", "the first link has a parent", links[0].element)
            return None
        return original(self, name, links, joints)

    return around(_Reader, "tree", tree)


@mutant("EU-URD-015")
def robot_of_one_link_refused() -> Deviation:
    """A robot must have a joint."""

    def tree(original: Any, self: Any, name: str, links: Any, joints: Any) -> Any:
        if not joints:
            self.report("urdf-no-link", "there is no joint", self.document.root)
            return None
        return original(self, name, links, joints)

    return around(_Reader, "tree", tree)
