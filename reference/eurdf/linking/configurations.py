"""Named configurations: known joints, the right number of coordinates, unit quaternions, within limits."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Mapping
from functools import partial

from eurdf.diagnostics import Hint, did_you_mean
from eurdf.format.extension import ConfigurationEntry
from eurdf.mechanism.joint import Joint
from eurdf.mechanism.joint_type import JointType
from eurdf.reading.reporter import YamlReporter

#: A quaternion in a file may be off unit length by this much; it is normalised when read (EU-CFG-003).
QUATERNION_TOLERANCE = 1e-6

#: A coordinate may be beyond its limit by this much, in rad or m (EU-CFG-004).
LIMIT_TOLERANCE = 1e-9


def link_configurations(
    entries: Iterable[ConfigurationEntry],
    joints: Mapping[str, Joint],
    merged: Mapping[str, str],
    skip: Collection[str],
    reporter: YamlReporter,
) -> dict[str, dict[str, tuple[float, ...]]]:
    """Check every configuration against the joints of the mechanism; EU-CFG-006: quaternions come back of unit length.

    Args:
        entries: As written.
        joints: Joints of the mechanism, and that of a floating root.
        merged: For each joint that was merged away, the joint it became part of.
        skip: Joints that are not checked, since their own entry is invalid.
        reporter: Gets what is found.
    """
    configurations = {}
    for entry in entries:
        configuration = {}
        for name, values in entry.joints.items():
            if name in skip:
                continue
            joint = _joint(name, joints, merged, entry, reporter)
            checked = None if joint is None else _coordinates(joint, values, entry, reporter)
            if checked is not None:
                configuration[name] = checked
        configurations[entry.name] = configuration
    return configurations


def _joint(
    name: str,
    joints: Mapping[str, Joint],
    merged: Mapping[str, str],
    entry: ConfigurationEntry,
    reporter: YamlReporter,
) -> Joint | None:
    """EU-CFG-001: a configuration names joints that have coordinates of their own."""
    joint = joints.get(name)
    if joint is not None and joint.type is not JointType.FIXED and joint.mimic is None:
        return joint
    hint: Hint = None
    if joint is None:
        why = "is not a joint of the robot"
        free = (other.name for other in joints.values() if other.type is not JointType.FIXED and not other.mimic)
        hint = partial(did_you_mean, name, free)
    elif name in merged:
        why = f"was merged into the spherical joint '{merged[name]}'"
        hint = f"give the coordinates of '{merged[name]}', a quaternion x, y, z, w"
    elif joint.mimic is not None:
        why = f"mimics '{joint.mimic.joint}' and has no coordinate of its own"
    else:
        why = "is fixed and has no coordinate"
    reporter.report(
        "configuration-joint",
        f"'{name}' in configuration '{entry.name}' {why}",
        (*entry.pointer, name),
        hint,
        key=True,
    )
    return None


def within_limits(value: float, lower: float, upper: float) -> bool:
    """EU-CFG-004: whether a coordinate is within its range, rad or m, one of `Joint.ranges`."""
    return lower - LIMIT_TOLERANCE <= value <= upper + LIMIT_TOLERANCE


def _coordinates(
    joint: Joint,
    values: tuple[float, ...],
    entry: ConfigurationEntry,
    reporter: YamlReporter,
) -> tuple[float, ...] | None:
    coordinates = joint.coordinates
    if len(values) != len(coordinates.names):
        reporter.report(
            "configuration-length",
            f"{joint.type} joint '{joint.name}' has {len(values)} coordinates in configuration '{entry.name}'; "
            f"it must have {len(coordinates.names)}: {', '.join(coordinates.names)}",
            (*entry.pointer, joint.name),
        )
        return None
    start = coordinates.quaternion
    if start is not None:
        norm = math.sqrt(sum(value * value for value in values[start : start + 4]))
        if abs(norm - 1.0) > QUATERNION_TOLERANCE:
            unit = [round(value / norm, 6) for value in values[start : start + 4]] if norm > 1e-9 else [0, 0, 0, 1]
            reporter.report(
                "configuration-quaternion",
                f"the quaternion of joint '{joint.name}' in configuration '{entry.name}' has length {norm:.9g}, not 1",
                (*entry.pointer, joint.name),
                f"write a unit quaternion x, y, z, w: {unit}",
            )
            return None
        return (*values[:start], *(value / norm for value in values[start : start + 4]))
    for value, (lower, upper), name in zip(values, joint.ranges, coordinates.names, strict=True):
        if not within_limits(value, lower, upper):
            reporter.report(
                "configuration-limits",
                f"{name} {value:.12g} of joint '{joint.name}' in configuration '{entry.name}' is outside its limits "
                f"{lower:.12g} to {upper:.12g}",
                (*entry.pointer, joint.name),
            )
            return None
    return values
