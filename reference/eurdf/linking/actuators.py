"""The actuated joints: each exists, can move by itself, and is listed once."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

from eurdf.diagnostics import Fix, renamings
from eurdf.diagnostics.wording import similar
from eurdf.format.fixes import named, removed, renumbered, swapped
from eurdf.format.joint_model import Geared
from eurdf.linking.joints import Joints
from eurdf.linking.merging import MASSLESS
from eurdf.mechanism.joint import Joint
from eurdf.reading.yaml_node import Pointer
from eurdf.reading.yaml_reader import YamlDocument, YamlReporter


def link_actuators(entries: Sequence[Geared], joints: Joints) -> tuple[str, ...]:
    """Check every actuator against the joints as the description makes them; returns the names, in file order."""
    reporter = joints.reporter
    stated = {entry.joint for entry in entries}
    others = [joint for joint in joints.by_name.values() if joint.name not in stated]
    listed: dict[str, None] = {}
    joint_of: dict[str, str] = {}  # by name of an actuator
    for entry in entries:
        name = entry.joint
        pointer = name_in(entry, reporter.document)
        joint = joints.by_name.get(name)
        if name in joints.merged:
            ball = joints.merged[name]
            # Version 1 merges by itself.
            apart = "do not merge the three joints"
            if entry.pointer[0] == "name_mot":
                apart = f"keep the three joints apart: give a link between them a mass of at least {MASSLESS:g} kg"
            reporter.report(
                "actuator-merged",
                f"joint '{name}' cannot be actuated: it was merged into the spherical joint '{ball}'",
                pointer,
                f"actuate '{ball}', or {apart}",
            )
        elif name in joints.split:
            first, second = joints.split[name]
            message = f"joint '{name}' was split into two joints by version 1"
            reporter.report("unknown-actuator", message, pointer, f"actuate '{first}' or '{second}'")
        elif joint is None:
            moving = (other.name for other in others if not other.type.is_fixed)
            message = f"actuator '{name}' is not a joint of the robot"
            joints.report_name("unknown-actuator", message, pointer, name, moving)
        elif name in listed:
            free = [other.name for other in others if not other.type.is_fixed and other.mimic is None]
            fixes = partial(_of_repeated, reporter.document, entry, pointer, free)
            message = f"joint '{name}' is actuated twice"
            reporter.report("actuator-duplicate", message, pointer, "which of them is another joint?", fixes)
        elif joint.type.is_fixed:
            hint = "remove it, or actuate a joint that moves"
            reporter.report("actuator-immobile", f"joint '{name}' is fixed and cannot be actuated", pointer, hint)
        elif joint.mimic is not None:
            reporter.report(
                "actuator-mimic",
                f"joint '{name}' mimics '{joint.mimic.joint}' and cannot be actuated",
                pointer,
                f"'{joint.mimic.joint}', which it follows, is the joint to actuate",
                _leader(entry, joint.mimic.joint, joint_of, reporter.document),
            )
        elif _has_motor(entry, joint_of, reporter):
            listed[name] = None
            joint_of[entry.name or name] = name
    return tuple(listed)


def _leader(entry: Geared, leader: str, joint_of: Mapping[str, str], document: YamlDocument) -> Sequence[Fix]:
    """The joint that a mimic joint follows in its place; none of them if that is actuated already."""
    if leader in joint_of.values():
        return removed(document, entry.pointer, f"'{entry.joint}': it moves with '{leader}', which is actuated")
    return (Fix(f"actuate '{leader}'", named(document, name_in(entry, document), False, leader)),)


def _of_repeated(document: YamlDocument, entry: Geared, pointer: Pointer, free: Sequence[str]) -> list[Fix]:
    """Proposals for a joint that is actuated twice: actuate it once, or a joint with a similar name that is not yet."""
    once = removed(document, pointer, f"the second '{entry.joint}'") if pointer == entry.pointer else ()
    others = renamings(similar(entry.joint, free), partial(named, document, pointer, False))
    return [*(replace(fix, rivals=True) for fix in once), *others]


def _has_motor(entry: Geared, named: Mapping[str, str], reporter: YamlReporter) -> bool:
    """EU-ACT-008, EU-ACT-009: the name of an actuator is unique, and its control range is in order."""
    name = entry.name or entry.joint
    if name in named:
        pointer = name_in(entry, reporter.document) if entry.name is None else (*entry.pointer, "name")
        reporter.report(
            "duplicate-actuator-name",
            f"there is already an actuator '{name}', of joint '{named[name]}'",
            pointer,
            "give every actuator a unique name; an actuator without a name has that of its joint",
            () if entry.name is None else partial(renumbered, reporter.document, pointer, name, named),
        )
        return False
    if entry.control is not None and entry.control[0] > entry.control[1]:
        lower, upper = entry.control
        reporter.report(
            "actuator-control-reversed",
            f"the lower bound {lower:g} of the control range of actuator '{name}' is above the upper bound {upper:g}",
            (*entry.pointer, "control"),
            "are they in the wrong order, or is a sign wrong?",
            swapped(reporter.document, (*entry.pointer, "control", 0), (*entry.pointer, "control", 1)),
        )
        return False
    return True


def with_motor(joint: Joint, entry: Geared, *, armature_given: bool) -> Joint:
    """The joint with the motor's gear ratio and rotor inertia.

    EU-ACT-006: the armature of an actuated joint, where it is not given, is gear_ratio² · rotor_inertia, the rotor's
    inertia as the joint feels it.
    """
    if entry.gear_ratio is None and entry.rotor_inertia is None:
        return joint
    nv = joint.type.nv
    ratio = 1.0 if entry.gear_ratio is None else entry.gear_ratio
    rotor = 0.0 if entry.rotor_inertia is None else entry.rotor_inertia
    motor = replace(joint.properties, gear_ratio=(ratio,) * nv, rotor_inertia=(rotor,) * nv)
    return joint.with_properties(motor if armature_given else replace(motor, armature=(ratio * ratio * rotor,) * nv))


def name_in(entry: Geared, document: YamlDocument) -> Pointer:
    """Where an entry of the list of actuators has the name of its joint."""
    value: Any = document.data
    for key in entry.pointer:
        value = value[key]
    return (*entry.pointer, "joint") if isinstance(value, dict) else entry.pointer
