"""Joints that version 1 splits or merges, split or merged otherwise."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

from eurdf.format.urdf import Urdf
from eurdf.linking import merging, replacement
from eurdf.linking.merging import Chain
from eurdf.linking.replacement import _Replacement
from eurdf.linking.urdf_tree import joint_of
from eurdf.mechanism.joint import Joint
from eurdf.mechanism.joint_type import JointType
from eurdf_conformance.adapters.reference import Reference
from eurdf_conformance.mutants.deviation import Deviation, around, instead
from eurdf_conformance.mutants.mutant import mutant
from eurdf_conformance.mutants.of_the_reference import canonical, refused_by_mechanism, said_in_version1
from eurdf_conformance.protocol.reply import unsupported
from eurdf_conformance.verdict.verdict import Verdict


@mutant("EU-ONE-006")
def universal_joint_stays_as_it_is() -> Deviation:
    """UJOINT_AB leaves the joint as the URDF has it."""
    return around(_Replacement, "split", lambda original, self, joint: joint)


def _halves(change: Callable[[_Replacement, Joint, Joint], tuple[Joint, Joint]], letters: str = "") -> Deviation:
    """The two joints that a universal one is split into are others."""

    def split(original: Any, self: _Replacement, joint: Joint) -> Joint | None:
        second: Joint | None = original(self, joint)
        if second is None or (letters and self.entry.split not in letters.split()):
            return second
        first = self.joints.by_name[f"{joint.name}_{self.entry.split[0]}"]
        self.joints.by_name[first.name], second = change(self, first, second)
        return second

    return around(_Replacement, "split", split)


@mutant("EU-ONE-006")
def geometry_on_the_wrong_half() -> Deviation:
    """UJOINT_XZ and UJOINT_YX leave the link on the first of the two joints, as in the published loader."""
    return _halves(
        lambda _, first, second: (
            replace(first, child=second.child),
            replace(second, parent=second.child, child=first.child),
        ),
        "XZ YX",
    )


@mutant("EU-ONE-006")
def second_half_without_limits() -> Deviation:
    """The second of the two joints has no limits, as in the published loader."""
    return _halves(lambda _, first, second: (first, replace(second, lower=(-9.0,), upper=(9.0,), velocity=(9.0,))))


@mutant("EU-ONE-006")
def halves_without_dynamics() -> Deviation:
    """The two joints have neither damping nor friction, as in the published loader."""
    return _halves(
        lambda _, first, second: (
            replace(first, damping=(0.0,), friction=(0.0,)),
            replace(second, damping=(0.0,), friction=(0.0,)),
        )
    )


@mutant("EU-JNT-016", versions=("1",))  # version 2 has no UJOINT
def second_axis_first() -> Deviation:
    """UJOINT_AB turns about B first."""
    return _halves(lambda _, first, second: (replace(first, axes=second.axes), replace(second, axes=first.axes)))


@mutant("EU-ONE-006")
def halves_named_by_number() -> Deviation:
    """The two joints are named j_1 and j_2."""

    def renamed(name: str, names: set[str]) -> str:
        partners = {other for other in names if other[:-2] == name[:-2] and name[-2:] in ("_X", "_Y", "_Z")}
        return name if len(partners) < 2 else f"{name[:-1]}1"

    return canonical(
        lambda robot: {
            "joints": [
                joint.model_copy(update={"name": renamed(joint.name, {each.name for each in robot.joints})})
                for joint in robot.joints
            ]
        }
    )


@mutant("EU-ONE-007")
def nothing_is_merged() -> Deviation:
    """Three revolute joints stay three."""
    return said_in_version1(lambda said: replace(said, merges_revolutes=False))


@mutant("EU-ONE-007")
def continuous_joints_are_merged() -> Deviation:
    """Continuous joints are merged without being asked, too."""
    return around(merging, "check_chain", lambda original, chain, urdf, links, **_: original(chain, urdf, links))


@mutant("EU-ONE-007")
def merged_from_the_leaves() -> Deviation:
    """Three joints to merge are looked for from the leaves inwards."""

    def find(original: Any, urdf: Any, joints: Any, excluded: Any, links: Any) -> list[Chain]:
        chains: list[Chain] = []
        for start in reversed(list(urdf.walk())):
            others = {joint.name for joint in urdf.walk()} - {start.name}
            below, names = start, [start.name]
            for _ in range(2):
                hanging = urdf.children.get(below.child, ())
                below = hanging[0] if len(hanging) == 1 else below
                names.append(below.name)
            if not set(names) & set(excluded):
                found = original(urdf, joints, {*excluded, *(others - set(names))}, links)
                excluded = {*excluded, *(joint.name for chain in found for joint in chain.joints)}
                chains += found
        return chains

    return around(replacement, "find_chains", find)


@mutant("EU-ONE-007")
def neighbours_in_the_list_are_merged() -> Deviation:
    """Three joints are merged that follow one another in the model, whatever hangs from what: the published loader."""

    def find(original: Any, urdf: Any, joints: Any, excluded: Any, links: Any) -> list[Chain]:
        chains: list[Chain] = original(urdf, joints, excluded, links)
        taken = {joint.name for chain in chains for joint in chain.joints}
        walked = [joints[joint.name] for joint in urdf.walk() if joint.name in joints]
        for three in zip(walked, walked[1:], walked[2:], strict=False):
            names = {joint.name for joint in three}
            rotary = all(joint.type is JointType.REVOLUTE for joint in three)
            if rotary and not names & (taken | set(excluded)):
                zero, lines = merging._lines(three)
                taken |= names
                chains.append(Chain(three, zero, tuple(direction for _, direction in lines), zero.xyz))
        return chains

    return around(replacement, "find_chains", find)


@mutant("EU-ONE-007")
def merged_although_a_closure_is_between() -> Deviation:
    """Three joints are merged though a frame of a closure is on a link between them."""
    return around(
        replacement, "find_chains", lambda original, urdf, joints, excluded, _: original(urdf, joints, excluded, ())
    )


@mutant("EU-ONE-007")
def merged_although_heavy() -> Deviation:
    """Three joints are merged though a link between them weighs something."""
    return instead(merging, "MASSLESS", 1e9)


@mutant("EU-ONE-007")
def merged_although_listed() -> Deviation:
    """Three joints are merged though one of them is replaced."""

    def find(original: Any, urdf: Urdf, joints: Any, excluded: Any, links: Any) -> list[Chain]:
        chains: list[Chain] = original(urdf, {name: joint_of(joint) for name, joint in urdf.joints.items()}, (), links)
        return chains

    return around(replacement, "find_chains", find)


@mutant("EU-ONE-007")
def ball_named_after_the_first() -> Deviation:
    """Three joints that are merged keep the name of the first."""

    def merge(original: Any, chain: Chain, name: str) -> tuple[Joint, Joint, Joint]:
        first, second, ball = original(chain, name)
        return replace(first, name=ball.name), second, replace(ball, name=first.name)

    return around(replacement, "merge", merge)


# Version 2 splits no joint.


@mutant("EU-CNF-004", versions=("1",))
def split_that_is_lacked_is_wrong() -> Deviation:
    """A reader that lacks UJOINT says that it is wrong."""
    return refused_by_mechanism(lambda robot: any(body.virtual for body in robot.bodies))


@mutant("EU-CNF-005", caught_by=frozenset({Verdict.UNSUPPORTED}), versions=("1",))
def split_that_is_claimed_is_lacked() -> Deviation:
    """A reader that claims a level lacks UJOINT, and says so."""

    def load(original: Any, self: Any, description: Path, urdf: Path) -> Any:
        return unsupported("UJOINT") if b"UJOINT" in description.read_bytes() else original(self, description, urdf)

    return around(Reference, "load", load)


@mutant("EU-JNT-027", versions=("1",))
def limits_of_the_second_half_lost() -> Deviation:
    """The second of the two joints that a universal one is split into has no position limits."""
    return _halves(lambda _, first, second: (first, replace(second, lower=(-math.inf,), upper=(math.inf,))))
