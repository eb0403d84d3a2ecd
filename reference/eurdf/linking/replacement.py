"""The joints that the description makes of the URDF's: new types, splits, merges, locks and overrides."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Iterator, Mapping
from contextlib import suppress
from dataclasses import replace
from functools import partial
from itertools import permutations, product
from typing import NamedTuple

from eurdf.diagnostics import Fix, Hint, Proposals
from eurdf.format.closure_model import AXES
from eurdf.format.conventions import HINT, is_too_small, too_small
from eurdf.format.fixes import free_name, named, removed, restated, swapped
from eurdf.format.joint_model import JointEntry
from eurdf.linking.joints import Joints
from eurdf.linking.merging import PARALLEL, NotMergeable, check_chain, find_chains, merge
from eurdf.mechanism.body import Body
from eurdf.mechanism.joint import Joint, JointProperties
from eurdf.mechanism.joint_types import JointType
from eurdf.mechanism.pose import Vector3, cross, direction

_RATES = ("velocity", "acceleration", "deceleration", "jerk")
_FORCES = ("effort", "friction")
#: Properties of which a joint has one for each velocity, in the URDF or by default.
_BY_VELOCITY = (*_RATES, *_FORCES, "damping", "armature", "gear_ratio", "rotor_inertia")


def replace_joints(
    joints: Joints, entries: Iterable[JointEntry], closure_links: Collection[str], *, version: str
) -> None:
    """Apply every entry of the description to the URDF's joints, in place, then the three-revolute rule of version 1.

    Version 1 merges three revolutes by itself, unless a link between them carries a frame of a closure. Since version
    2.1 a description may state springs and losses of mimic joints.
    """
    urdf, diagnostics = joints.urdf, joints.reporter.diagnostics
    mimicking = {joint.name: joint.mimic.joint for joint in urdf.joints.values() if joint.mimic}
    mimicked = {target: name for name, target in mimicking.items()}
    merged = {name: entry.name for entry in entries for name in entry.merges if name != entry.name}
    seen: set[str] = set()
    for entry in entries:
        replacement = _Replacement(entry, joints, mimicking, mimicked, closure_links, version)
        if entry.name in merged and entry.name in urdf.joints:
            message = f"joint '{entry.name}' is both changed and merged into '{merged[entry.name]}'"
            hint = f"change '{merged[entry.name]}' instead, or remove '{entry.name}' from its 'merges'"
            replacement.report("duplicate-replacement", message, hint=hint)
            continue
        if entry.name in seen:
            message = f"joint '{entry.name}' is listed twice"
            replacement.report("duplicate-replacement", message, hint="keep one of the two")
            continue
        seen.add(entry.name)
        before = len(diagnostics)
        replacement.apply()
        if len(diagnostics) > before:
            joints.faulty.update({entry.name, *entry.merges, *(f"{entry.name}_{letter}" for letter in entry.split)})
    if version == "1":
        for chain in find_chains(urdf, joints.by_name, seen, closure_links):
            first, second, ball = merge(chain, chain.joints[2].name)
            for joint in (first, second, ball):
                joints.by_name[joint.name] = joint
            joints.merged.update({first.name: ball.name, second.name: ball.name})


class _Replacement(NamedTuple):
    """One entry at work."""

    entry: JointEntry
    joints: Joints
    mimicking: Mapping[str, str]
    mimicked: Mapping[str, str]
    closure_links: Collection[str]
    version: str

    def report(
        self,
        code: str,
        message: str,
        *keys: str | int,
        hint: Hint = None,
        proposals: Proposals = (),
        key: bool = False,
    ) -> None:
        """Report at the entry, or at what it has under the keys."""
        self.joints.reporter.report(code, message, (*self.entry.pointer, *keys), hint, proposals, key=key)

    def apply(self) -> None:
        entry = self.entry
        if entry.merges:
            joint = self.merge()
        else:
            joint = self.target(entry.name)
            if joint is None or self.mimics(joint):
                return
            if entry.type is not None:
                joint = self.retype(joint, entry.type)
        if joint is None:
            return
        # The type is valid even if an override is not, and what else names the joint means the new one.
        self.joints.by_name[joint.name] = self.override(joint) or joint

    def target(self, name: str, *keys: str | int) -> Joint | None:
        """EU-JNT-001: a joint that the description names is in the URDF."""
        joint = self.joints.by_name.get(name) if name in self.joints.urdf.joints else None
        if joint is None:
            message, at = f"'{name}' is not a joint of the robot", (*self.entry.pointer, *keys)
            self.joints.report_name("unknown-joint", message, at, name, self.joints.urdf.joints, key=at[-1:] == (name,))
        return joint

    def mimics(self, joint: Joint, *keys: str | int) -> bool:
        """EU-JNT-004: joints that mimic or are mimicked stay as the URDF has them.

        EU-JNT-030: since version 2.1, a mimic joint may have losses, an armature and springs of its own.
        """
        stays = self.entry.type is None and not self.entry.merges
        leader = self.mimicking.get(joint.name)
        if leader is not None and stays and self.version == "2.1":
            if self.entry.limits is None:
                return False
            message = f"the limits of joint '{joint.name}' cannot be changed: it mimics '{leader}'"
            hint = f"change the limits of '{leader}', or free the joint with mimic: false"
            self.report("joint-mimics", message, *keys, "limits", hint=hint)
            return True
        if leader is not None:
            why = f"it mimics '{leader}'"
        elif joint.name in self.mimicked and self.entry.type is not None:
            why = f"'{self.mimicked[joint.name]}' mimics it"
        else:
            return False
        way = "free the mimic joint with mimic: false" if self.version == "2.1" else "remove <mimic> from the URDF"
        hint = f"{way}, or do not change the joint"
        self.report("joint-mimics", f"joint '{joint.name}' cannot be changed: {why}", *keys, hint=hint)
        return True

    # -- merging --------------------------------------------------------------------------------------------------

    def merge(self) -> Joint | None:
        entry, joints = self.entry, self.joints
        chain = []
        for index, name in enumerate(entry.merges):
            at = ("merges", index)
            if name in entry.merges[:index]:
                message = f"joint '{name}' occurs twice among the joints to merge"
                hint, fixes = "name three different joints", partial(self.chains, name)
                self.report("duplicate-replacement", message, *at, hint=hint, proposals=fixes)
                return None
            if name in joints.merged:
                message = f"joint '{name}' is already merged into '{joints.merged[name]}'"
                self.report("duplicate-replacement", message, *at)
                return None
            joint = self.target(name, *at)
            if joint is None or self.mimics(joint, *at):
                return None
            chain.append(joint)
        first, second, third = chain
        # A name of the URDF is free if it is that of the last joint, another if no joint has got it.
        if entry.name != third.name if entry.name in joints.urdf.joints else entry.name in joints.by_name:
            message = f"there is already a joint '{entry.name}'"
            hint = f"give the merged joint a new name, or the name of the last of the three joints, '{third.name}'"
            other = free_name(entry.name, {*joints.urdf.joints, *joints.by_name})
            fix = Fix(f"name it {other}", named(joints.reporter.document, entry.pointer, True, other))
            self.report("duplicate-joint-name", message, hint=hint, key=True, proposals=[fix])
            return None
        try:
            *inner, ball = merge(check_chain((first, second, third), joints.urdf, self.closure_links), entry.name)
        except NotMergeable as why:
            names = ", ".join(f"'{name}'" for name in entry.merges)
            document, pointer = joints.reporter.document, (*entry.pointer, "merges")
            orders = list(permutations(entry.merges))[1:] if why.code == "merge-not-chain" else []
            proposals = [restated(document, pointer, order) for order in orders]
            self.report(why.code, f"{names} cannot be merged: {why.message}", "merges", proposals=proposals)
            return None
        joints.by_name.update({joint.name: joint for joint in inner})
        del joints.by_name[third.name]
        joints.merged.update({joint.name: entry.name for joint in chain if joint.name != entry.name})
        return ball

    def chains(self, twice: str) -> Iterator[Fix]:
        """Proposals for a joint that occurs twice among those to merge: another one, for which they are a chain."""
        joints, pointer = self.joints, (*self.entry.pointer, "merges")
        for name, index in product(joints.urdf.joints, range(3)):
            merges = [*self.entry.merges]
            if merges[index] != twice or name in merges or name in joints.merged:
                continue
            merges[index] = name
            with suppress(NotMergeable, KeyError):
                first, second, third = (joints.by_name[each] for each in merges)
                check_chain((first, second, third), joints.urdf, self.closure_links)
                yield replace(restated(joints.reporter.document, pointer, merges), rivals=True)

    # -- new types ------------------------------------------------------------------------------------------------

    def retype(self, joint: Joint, new: str) -> Joint | None:
        """EU-JNT-005: each new type replaces a joint that moves like a part of it; fixed, every joint that moves."""
        replaces = JointType(new).replaces
        if joint.type.is_fixed if new == "fixed" else joint.type not in replaces:
            wanted = sorted(replaces) or ["moving"]
            message = f"joint '{joint.name}' is {joint.type} in the URDF and cannot become {new}"
            hint = f"only a {' or '.join(wanted)} joint can become {new}"
            self.report("joint-kind", message, "type", hint=hint)
            return None
        if new == "fixed":
            return joint.fixed()
        if new == "universal":
            return self.universal(joint)
        if new == "cylindrical":
            return self.cylindrical(joint)
        if new == "helical":
            return self.helical(joint)
        return self._spread(joint, JointType(new), ())

    def _spread(
        self,
        joint: Joint,
        kind: JointType,
        axes: tuple[Vector3, ...],
        limits: tuple[tuple[float, ...], tuple[float, ...]] | None = None,
    ) -> Joint:
        """EU-JNT-020, -021: the joint with another type; its rates and dynamics are those of each of its velocities."""
        own, properties = joint.properties, JointProperties.unlimited(kind)
        if own is not JointProperties.unlimited(joint.type):
            lower, upper = limits or (properties.lower, properties.upper)
            by_velocity = {name: getattr(own, name) * kind.nv for name in _BY_VELOCITY}
            properties = JointProperties(lower, upper, **by_velocity)
        return Joint(joint.name, kind, joint.parent, joint.child, joint.placement, axes=axes, properties=properties)

    def universal(self, joint: Joint) -> Joint | None:
        """EU-JNT-006, EU-JNT-007: the two axes have directions, and different ones."""
        if self.entry.split:
            return self.split(joint)
        axes = self.entry.axes
        for index, axis in enumerate(axes):
            if not any(axis):
                message = f"an axis of universal joint '{joint.name}' is zero"
                self.report("joint-axis-zero", message, "axes", index)
                return None
        first, second = map(direction, axes)
        if math.hypot(*cross(first, second)) < PARALLEL:
            self.report("joint-axes-parallel", f"the two axes of universal joint '{joint.name}' are parallel", "axes")
            return None
        lower, upper = joint.properties.lower, joint.properties.upper
        return self._spread(joint, JointType.UNIVERSAL, axes, (lower * 2, upper * 2))

    def split(self, joint: Joint) -> Joint | None:
        """EU-ONE-006: version 1's universal joint is two revolutes, ``j_A`` and then ``j_B``, each with j's limits."""
        names = tuple(f"{joint.name}_{letter}" for letter in self.entry.split)
        for name in names:
            if name in self.joints.urdf.joints:
                message = f"universal joint '{joint.name}' creates a joint '{name}', which already exists"
                self.report("duplicate-joint-name", message, hint="rename the other joint in the URDF")
                return None
        first, second = names
        between = Body(first, virtual=True)
        while between.name in self.joints.urdf.links:
            between = Body(between.name + "'", virtual=True)
        self.joints.bodies.append(between)
        one, other = (AXES[letter] for letter in self.entry.split.lower())
        del self.joints.by_name[joint.name]
        self.joints.by_name[first] = replace(joint, name=first, child=between.name, axes=(one,))
        self.joints.split[joint.name] = (first, second)
        return Joint(second, joint.type, between.name, joint.child, axes=(other,), properties=joint.properties)

    def cylindrical(self, joint: Joint) -> Joint:
        """EU-JNT-027: limits of the URDF's joint stay with the coordinate of its kind; the other has none."""
        (lower,), (upper,) = joint.properties.lower, joint.properties.upper
        if joint.type.slides:
            limits = (lower, -math.inf), (upper, math.inf)
        else:
            limits = (-math.inf, lower), (math.inf, upper)
        return self._spread(joint, JointType.CYLINDRICAL, joint.axes, limits)

    def helical(self, joint: Joint) -> Joint | None:
        """EU-JNT-008, EU-JNT-029: a helix has a pitch; what the URDF says of a slide holds of the screw's angle."""
        pitch = self.entry.pitch
        if pitch == 0.0:
            self.report("joint-pitch-zero", f"the pitch of helical joint '{joint.name}' is 0", "pitch")
            return None
        if is_too_small(pitch):
            message = f"the pitch of helical joint '{joint.name}' is {too_small(pitch)}"
            self.report("number-out-of-bounds", message, "pitch", hint=HINT)
            return None
        properties = joint.properties
        if joint.type.slides:
            lead = pitch / (2.0 * math.pi)
            # No negative zero, where the pitch is negative.
            lower, upper = sorted((properties.lower[0] / lead + 0.0, properties.upper[0] / lead + 0.0))
            by_angle = {
                name: tuple(value * factor for value in getattr(properties, name))
                for names, factor in ((_RATES, 1.0 / abs(lead)), (_FORCES, abs(lead)), (("damping",), lead * lead))
                for name in names
            }
            properties = replace(properties, lower=(lower,), upper=(upper,), **by_angle)
        return replace(joint, type=JointType.HELICAL, pitch=pitch, properties=properties)

    # -- overrides ------------------------------------------------------------------------------------------------

    def override(self, joint: Joint) -> Joint | None:
        """EU-JNT-009, EU-JNT-010, EU-JNT-031: properties in the description replace those of the URDF."""
        entry = self.entry
        stated = entry.properties
        if not stated:
            return joint
        if joint.type.is_fixed:
            keys = next(iter(stated))
            message = f"fixed joint '{joint.name}' cannot have the property '{keys[-1]}'"
            document, at = self.joints.reporter.document, entry.pointer
            if entry.type is None:
                hint = "is its type in the URDF wrong, or the name of the joint?"
                self.report("joint-property", message, *keys, hint=hint)
            else:
                fixes = removed(document, (*at, *keys), f"'{keys[-1]}'")
                self.report("joint-property", message, *keys, proposals=fixes)
            return None
        changes: dict[str, tuple[float, ...]] = {}
        for keys, numbers in stated.items():
            attribute = keys[-1]
            bounds_position = attribute in ("lower", "upper")
            if bounds_position and not joint.type.limited:
                self.report("joint-property", f"{joint.type} joint '{joint.name}' cannot have position limits", *keys)
                return None
            if attribute in ("stiffness", "rest") and joint.type.moving_frame:
                self.report("joint-property", f"{joint.type} joint '{joint.name}' cannot have a spring", *keys)
                return None
            n = joint.type.nv
            values = numbers if isinstance(numbers, tuple) else (numbers,) * n
            if len(values) != n:
                wanted = "be one number" if n == 1 else f"have {n}, or be one number for all"
                self.report(
                    "joint-property",
                    f"'{keys[-1]}' of {joint.type} joint '{joint.name}' has {len(values)} numbers; it must {wanted}",
                    *keys,
                )
                return None
            changes[attribute] = values
        if "stiffness" in changes:
            changes.setdefault("rest", (0.0,) * joint.type.nv)
        properties = replace(joint.properties, **changes)
        if "armature" in changes:
            self.joints.armature_given.add(joint.name)
        for lower, upper in zip(properties.lower, properties.upper, strict=True):
            if lower > upper:
                key = "lower" if "lower" in changes else "upper"
                left_out = {"lower", "upper"} - set(changes)
                at = (*entry.pointer, "limits")
                document = self.joints.reporter.document
                proposals = () if left_out else swapped(document, (*at, "lower"), (*at, "upper"))
                self.report(
                    "joint-limits-reversed",
                    f"joint '{joint.name}': lower limit {lower:g} is above upper limit {upper:g}",
                    "limits",
                    key,
                    hint=f"the {left_out.pop()} limit comes from the URDF; state both limits"
                    if left_out
                    else "are they in the wrong order, or is a sign wrong?",
                    proposals=proposals,
                )
                return None
        return joint.with_properties(properties)
