"""The bodies and joints that the URDF alone describes, and the joints that the description makes of these."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial

from eurdf.diagnostics import Diagnostics, Fix, plural, quoted
from eurdf.format.fixes import named, report_name
from eurdf.format.urdf.data import Limit, Urdf, UrdfJoint
from eurdf.mechanism.body import Body
from eurdf.mechanism.joint import Joint, JointProperties, is_no_range
from eurdf.reading.yaml_node import Pointer
from eurdf.reading.yaml_reader import YamlReporter

_NONE = JointProperties()
_UNLIMITED = Limit(-math.inf, math.inf, math.inf, math.inf)


def bodies_of(urdf: Urdf) -> dict[str, Body]:
    """Every link as a body, by name."""
    return {link.name: Body(link.name, link.inertia, link.visuals, link.collisions) for link in urdf.links.values()}


def joint_of(joint: UrdfJoint) -> Joint:
    """A joint of the URDF, before the description changes it.

    Limits and dynamics of planar and floating joints are not read, as in Pinocchio: URDF has one number for all of
    their coordinates, of different units.
    """
    kind = joint.type
    properties = _NONE if kind.is_fixed else JointProperties.unlimited(kind)
    if not kind.is_axial:
        return Joint(joint.name, kind, joint.parent, joint.child, joint.placement, properties=properties)
    if joint.limit is not None or joint.damping or joint.friction:
        lower, upper, velocity, effort, *rates = joint.limit or _UNLIMITED
        acceleration, deceleration, jerk = (() if math.isinf(limit) else (limit,) for limit in rates)
        properties = replace(
            properties,
            lower=(lower,) if kind.limited else properties.lower,
            upper=(upper,) if kind.limited else properties.upper,
            velocity=(velocity,),
            effort=(effort,),
            damping=(joint.damping,),
            friction=(joint.friction,),
            acceleration=acceleration,
            deceleration=deceleration,
            jerk=jerk,
        )
    axes, mimic = (joint.axis,), joint.mimic
    return Joint(
        joint.name, kind, joint.parent, joint.child, joint.placement, axes=axes, properties=properties, mimic=mimic
    )


def check_ranges(urdf: Urdf, joints: Mapping[str, Joint], diagnostics: Diagnostics) -> None:
    """EU-URD-025: a joint that is to move has a range; URDF reads limits that are left out as 0.

    Of ``joints``, those of the mechanism, the ones that the description merges, makes another type or gives limits need
    no range in the URDF.
    """
    found = [
        joint
        for joint in urdf.joints.values()
        if (limit := joint.limit) is not None
        and is_no_range(limit.lower, limit.upper)
        and joint.type.is_ranged
        and (made := joints.get(joint.name)) is not None
        and made.type.is_ranged
        and made.lacks_range
    ]
    hint = "which 'lower' and 'upper' does it have? A joint of type 'continuous' has none"
    report_of_joints("urdf-no-range", found, "the position limits 0 and 0", "limit", hint, urdf, diagnostics)


def report_of_joints(
    code: str, found: Sequence[UrdfJoint], what: str, tag: str, hint: str, urdf: Urdf, diagnostics: Diagnostics
) -> None:
    """Report once what several joints have, if any has it, at the element ``tag`` of the first."""
    if found:
        names = quoted([joint.name for joint in found])
        has = f"{plural(len(found), 'joint')} {'has' if len(found) == 1 else 'have'}"
        place = partial(urdf.document.place, next(found[0].element.iterchildren(tag)))
        diagnostics.report(code, f"{has} {what}: {names}", place, hint)


@dataclass(slots=True, eq=False, repr=False)
class Joints:
    """The joints of the mechanism in the making.

    Attributes:
        urdf: The URDF.
        reporter: Gets what is found in the description.
        by_name: The current joints.
        bodies: Virtual bodies that splits made.
        merged: For each joint that was merged away, the joint it became part of.
        split: For each joint that was split, the two that it became.
        armature_given: Joints whose armature the description states.
        faulty: Joints that an invalid entry refers to, or would have made: errors about them would repeat its error.
    """

    urdf: Urdf
    reporter: YamlReporter
    by_name: dict[str, Joint]
    bodies: list[Body] = field(default_factory=list)
    merged: dict[str, str] = field(default_factory=dict)
    split: dict[str, tuple[str, str]] = field(default_factory=dict)
    armature_given: set[str] = field(default_factory=set)
    faulty: set[str] = field(default_factory=set)

    def report_name(
        self, code: str, message: str, pointer: Pointer, name: str, candidates: Iterable[str], *, key: bool = False
    ) -> None:
        """Report a name that is no joint's, although it should be one of the candidates'."""
        if name not in self.urdf.links:
            report_name(self.reporter, code, message, pointer, name, candidates, key=key)
            return
        candidates = set(candidates)
        movers = [each.name for each in self.by_name.values() if each.child == name and each.name in candidates]
        summary = f"'{name}' is a link: write '{{}}', the joint that moves it"
        write = partial(named, self.reporter.document, pointer, key)
        fixes = [Fix(summary.format(mover), write(mover)) for mover in movers]
        self.reporter.report(code, message, pointer, f"'{name}' is a link; which joint moves it?", fixes, key=key)
