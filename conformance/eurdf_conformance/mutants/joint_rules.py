"""Rules of joints that draw their line elsewhere."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

from eurdf.linking import merging, replacement
from eurdf.linking.merging import Chain
from eurdf.mechanism.joint_type import JointType
from eurdf_conformance.mutants.deviation import Deviation, around, instead, together
from eurdf_conformance.mutants.mutant import mutant


def _parallel(sine: float) -> Deviation:
    return together(instead(merging, "PARALLEL", sine), instead(replacement, "PARALLEL", sine))


@mutant("EU-JNT-007")
def sine_of_a_thousandth_is_parallel() -> Deviation:
    """Axes are parallel where the sine of their angle is below 1e-3."""
    return _parallel(1e-3)


@mutant("EU-JNT-007")
def sine_of_1e_9_is_not_parallel() -> Deviation:
    """Axes are parallel where the sine of their angle is below 1e-9."""
    return _parallel(1e-9)


@mutant("EU-JNT-011")
def continuous_joints_do_not_merge() -> Deviation:
    """Only revolute joints may be merged."""
    return instead(merging.check_chain, "__kwdefaults__", {"rotary": (JointType.REVOLUTE,)})


@mutant("EU-JNT-012")
def links_between_of_a_gram() -> Deviation:
    """Links between merged joints may weigh up to a gram."""
    return instead(merging, "MASSLESS", 1e-3)


@mutant("EU-JNT-012")
def links_between_without_mass() -> Deviation:
    """Links between merged joints may weigh nothing at all."""
    return instead(merging, "MASSLESS", 1e-12)


@mutant("EU-JNT-012")
def links_between_weigh_together() -> Deviation:
    """The two links between merged joints must together weigh less than 1e-5 kg."""

    def check(original: Any, chain: Any, urdf: Any, links: Any, **named: Any) -> Chain:
        found: Chain = original(chain, urdf, links, **named)
        between = [urdf.links[joint.child].inertia for joint in chain[:2]]
        if sum(inertia.mass for inertia in between if inertia is not None) >= merging.MASSLESS:
            raise merging.NotMergeable("merge-inertia", "the links between them weigh too much together")
        return found

    return around(replacement, "check_chain", check)


@mutant("EU-JNT-014")
def axes_within_a_millimetre() -> Deviation:
    """Axes meet that pass a point within a millimetre."""
    return instead(merging, "MEETING", 1e-3)


@mutant("EU-JNT-014")
def axes_within_a_micrometre() -> Deviation:
    """Axes meet only where they pass a point within a micrometre."""
    return instead(merging, "MEETING", 1e-6)


@mutant("EU-JNT-013")
def link_before_merged_joints_counts() -> Deviation:
    """Neither the link before the merged joints, nor that behind them, may carry a frame of a closure."""

    def check(original: Any, chain: Any, urdf: Any, links: Any, **named: Any) -> Chain:
        if {chain[0].parent, chain[2].child} & set(links):
            raise merging.NotMergeable("merge-closure-frame", "a link beside them carries a frame of a closure")
        found: Chain = original(chain, urdf, links, **named)
        return found

    return around(replacement, "check_chain", check)


@mutant("EU-JNT-004", versions=("2",))  # version 1 changes no properties
def properties_of_a_mimicked_joint_stay() -> Deviation:
    """A joint that is mimicked may not be changed, be it in its properties only."""

    def mimics(original: Any, self: Any, joint: Any, pointer: Any) -> bool:
        self.entry = replace(self.entry, type=self.entry.type or "fixed")
        found: bool = original(self, joint, pointer)
        return found

    return around(replacement._Replacement, "mimics", mimics)


@mutant("EU-JNT-009")
def list_for_each_property() -> Deviation:
    """A property of a joint of several velocities must be a list."""

    def override(original: Any, self: Any, joint: Any) -> Any:
        for key, keys in replacement._PROPERTIES.items():
            if isinstance(getattr(self.entry, key), float) and joint.coordinates.nv > 1:
                self.report("joint-property", "it must be a list", *keys)
                return None
        return original(self, joint)

    return around(replacement._Replacement, "override", override)


@mutant("EU-JNT-009")
def list_of_one_is_for_all() -> Deviation:
    """A list of one number is for all velocities."""

    def override(original: Any, self: Any, joint: Any) -> Any:
        lists = {
            key: given * joint.coordinates.nv
            for key in replacement._PROPERTIES
            if isinstance(given := getattr(self.entry, key), tuple) and len(given) == 1
        }
        self.entry = replace(self.entry, **lists)
        return original(self, joint)

    return around(replacement._Replacement, "override", override)


@mutant("EU-JNT-010")
def limits_stated_must_be_both() -> Deviation:
    """A lower limit that is stated without the upper one is compared with 0."""

    def override(original: Any, self: Any, joint: Any) -> Any:
        lower = self.entry.lower
        if isinstance(lower, float | int) and self.entry.upper is None and lower > 0.0:
            self.report("joint-limits-reversed", "it is above 0", "limits", "lower")
            return None
        return original(self, joint)

    return around(replacement._Replacement, "override", override)


@mutant("EU-JNT-003", versions=("2",))  # version 1 names no merged joint
def name_of_the_last_merged_joint_taken() -> Deviation:
    """A merged joint may not have the name of the last of the three."""

    def merge(original: Any, self: Any) -> Any:
        if self.entry.name == self.entry.merges[2]:
            self.report("duplicate-joint-name", "it is taken")
            return None
        return original(self)

    return around(replacement._Replacement, "merge", merge)


@mutant("EU-JNT-006")
def axes_of_a_universal_joint_of_unit_length() -> Deviation:
    """The axes of a universal joint must be of unit length."""

    def universal(original: Any, self: Any, joint: Any) -> Any:
        if any(abs(math.hypot(*axis) - 1.0) > 1e-6 for axis in self.entry.axes):
            self.report("joint-axis-zero", "it is not of unit length", "axes")
            return None
        return original(self, joint)

    return around(replacement._Replacement, "universal", universal)
