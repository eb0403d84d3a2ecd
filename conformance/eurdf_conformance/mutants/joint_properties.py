"""Joints whose limits, damping or friction are others when the description has changed them."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

from eurdf.linking.replacement import _Replacement
from eurdf.mechanism.joint import Joint
from eurdf.mechanism.joint_type import JointType
from eurdf_conformance.adapters import reference_canonical
from eurdf_conformance.level import Level
from eurdf_conformance.mutants.deviation import Deviation, around, instead, result, together
from eurdf_conformance.mutants.mutant import mutant


def _spread(change: Any) -> Deviation:
    """A joint that is replaced takes over other properties from the one it was."""
    return around(
        _Replacement, "_spread", lambda original, self, joint, kind: change(original(self, joint, kind), joint)
    )


def _screw(change: Callable[[Joint, Joint], Joint]) -> Deviation:
    """A slide becomes another screw."""

    def helical(original: Any, self: Any, joint: Joint) -> Joint | None:
        screw: Joint | None = original(self, joint)
        return change(screw, joint) if screw and joint.type is JointType.PRISMATIC else screw

    return around(_Replacement, "helical", helical)


@mutant("EU-JNT-020")
def limits_of_a_replaced_joint_lost() -> Deviation:
    """A joint that is replaced has no limits of velocity and effort, as in the published loader."""
    return _spread(
        lambda new, old: replace(new, velocity=(math.inf,) * len(new.velocity), effort=(math.inf,) * len(new.effort))
    )


@mutant("EU-JNT-020")
def dynamics_of_a_replaced_joint_lost() -> Deviation:
    """A joint that is replaced has neither damping nor friction, as in the published loader."""
    return _spread(
        lambda new, old: replace(new, damping=(0.0,) * len(new.damping), friction=(0.0,) * len(new.friction))
    )


@mutant("EU-JNT-020")
def limits_for_the_first_velocity_only() -> Deviation:
    """A joint that is replaced keeps its limits and damping for the first of its velocities."""

    def first(new: Joint, old: Joint) -> Joint:
        rest = len(new.velocity) - 1
        return replace(
            new,
            velocity=new.velocity[:1] + (math.inf,) * rest,
            effort=new.effort[:1] + (math.inf,) * rest,
            damping=new.damping[:1] + (0.0,) * rest,
        )

    return _spread(first)


@mutant("EU-JNT-020")
def damping_and_friction_swapped() -> Deviation:
    """Of a joint that is replaced damping is friction, and friction damping."""
    return _spread(lambda new, old: replace(new, damping=new.friction, friction=new.damping))


@mutant("EU-JNT-021")
def limits_of_one_angle_on_a_ball() -> Deviation:
    """The limits of an angle bound each of the numbers of a quaternion."""

    def bounded(new: Joint, old: Joint) -> Joint:
        if new.type is not JointType.SPHERICAL:
            return new
        return replace(new, lower=old.lower * 4, upper=old.upper * 4)

    return together(
        _spread(bounded),
        instead(reference_canonical, "_UNBOUNDED", frozenset({JointType.PLANAR, JointType.FLOATING})),
    )


@mutant("EU-JNT-027", versions=("2",))  # version 1 has no cylindrical joints
def limits_on_the_other_coordinate() -> Deviation:
    """The limits of an angle bound the length of a cylindrical joint, and those of a length its angle."""
    return result(
        _Replacement, "cylindrical", lambda joint: replace(joint, lower=joint.lower[::-1], upper=joint.upper[::-1])
    )


@mutant("EU-JNT-027", versions=("2",))  # version 1 has no cylindrical joints
def limits_on_both_coordinates() -> Deviation:
    """The limits of a joint bound both coordinates of the cylindrical joint that it becomes."""

    def cylindrical(original: Any, self: Any, joint: Joint) -> Joint:
        found: Joint = original(self, joint)
        return replace(found, lower=joint.lower * 2, upper=joint.upper * 2)

    return around(_Replacement, "cylindrical", cylindrical)


@mutant("EU-JNT-029")
def limits_of_a_slide_are_angles() -> Deviation:
    """The limits of a prismatic joint that becomes helical bound its angle as they are."""
    return _screw(lambda screw, slide: replace(screw, lower=slide.lower, upper=slide.upper))


@mutant("EU-JNT-029")
def limits_of_a_left_handed_screw() -> Deviation:
    """The limits of a prismatic joint that becomes a left-handed screw are reversed."""
    return _screw(
        lambda screw, slide: screw if screw.pitch > 0.0 else replace(screw, lower=screw.upper, upper=screw.lower)
    )


@mutant("EU-JNT-029")
def numbers_of_a_slide_on_a_screw() -> Deviation:
    """A prismatic joint that becomes helical keeps its numbers for velocity, effort, damping and friction."""
    kept = ("velocity", "effort", "damping", "friction")
    return _screw(lambda screw, slide: replace(screw, **{name: getattr(slide, name) for name in kept}))


@mutant("EU-JNT-029")
def damping_of_a_screw_by_its_lead() -> Deviation:
    """The damping of a prismatic joint that becomes helical is multiplied by what it advances in a radian, once."""
    return _screw(lambda screw, slide: replace(screw, damping=(slide.damping[0] * abs(screw.pitch) / (2.0 * math.pi),)))


@mutant("EU-JNT-027", versions=("2",))  # of version 1 it is second_half_without_limits
def limits_of_a_universal_joint_lost() -> Deviation:
    """A joint that becomes universal has no position limits."""

    def universal(original: Any, self: Any, joint: Joint) -> Joint | None:
        found: Joint | None = original(self, joint)
        if found is None or found.type is not JointType.UNIVERSAL:
            return found
        return replace(found, lower=(-math.inf,) * 2, upper=(math.inf,) * 2)

    return around(_Replacement, "universal", universal)


@mutant("EU-JNT-009", level=Level.STRUCTURE)
def limits_stated_of_a_screw_are_lengths() -> Deviation:
    """The limits that the description states of a screw made of a prismatic joint are of its length."""

    def overridden(original: Any, self: _Replacement, joint: Joint) -> Joint | None:
        screw: Joint | None = original(self, joint)
        if screw is None or screw.type is not JointType.HELICAL:
            return screw
        if self.urdf.joints[screw.name].type is not JointType.PRISMATIC:
            return screw
        lead = screw.pitch / (2.0 * math.pi)
        lower = screw.lower if self.entry.lower is None else (screw.lower[0] / lead,)
        upper = screw.upper if self.entry.upper is None else (screw.upper[0] / lead,)
        return replace(screw, lower=lower, upper=upper)

    return around(_Replacement, "override", overridden)
