"""Named configurations: known joints, the right number of coordinates, unit quaternions, within limits."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from functools import partial
from typing import NamedTuple

from eurdf.format.fixes import removed, restated
from eurdf.format.yaml_text import Value, flow
from eurdf.linking.joints import Joints
from eurdf.mechanism.joint import LIMIT_TOLERANCE, Joint
from eurdf.reading.yaml_reader import YamlReporter

#: A quaternion in a file may be off unit length by this much; it is normalised when read (EU-CFG-003).
QUATERNION_TOLERANCE = 1e-6

# A quaternion whose length is off by this much was rounded, as [0, 0, 0.7, 0.7].
_ROUNDED = 0.02

# Maximum number of joints in a message.
_MOST_TOLD = 4


class BeyondLimit(NamedTuple):
    """A coordinate, an angle or a length, that is beyond the limits of its joint; rad or m."""

    joint: str
    coordinate: str
    value: float
    lower: float
    upper: float

    @property
    def unit(self) -> str:
        """Of its numbers."""
        return "m" if self.coordinate == "length" else "rad"

    @property
    def limits(self) -> str:
        """The limits, with their unit."""
        return f"{self.lower:.12g} to {self.upper:.12g} {self.unit}"

    def __str__(self) -> str:
        return f"'{self.joint}' at {self.value:.6g} {self.unit} (limits {self.lower:g} to {self.upper:g})"


def link_configurations(
    stated: Mapping[str, Mapping[str, tuple[float, ...]]], named: Mapping[str, Joint], joints: Joints
) -> dict[str, dict[str, tuple[float, ...]]]:
    """Check every configuration against ``named``, the joints of the mechanism and that of a floating root.

    EU-CFG-006: quaternions come back of unit length.
    """
    configurations = {}
    for configuration, written in stated.items():
        checked = {}
        all_known = True
        for name, values in written.items():
            if name in joints.faulty:
                continue
            joint = _joint(name, named, joints, configuration, written)
            all_known &= joint is not None
            coordinates = None if joint is None else _coordinates(joint, values, configuration, joints.reporter)
            if coordinates is not None:
                checked[name] = coordinates
        if all_known:  # else a joint that seems to be left out may be one whose name is misspelt
            left_out = [joint for name, joint in named.items() if name not in written and name not in joints.faulty]
            _check_left_out(left_out, configuration, joints.reporter)
        configurations[configuration] = checked
    return configurations


def _joint(
    name: str, named: Mapping[str, Joint], joints: Joints, configuration: str, written: Mapping[str, tuple[float, ...]]
) -> Joint | None:
    """EU-CFG-001: a configuration names joints that have coordinates of their own."""
    joint = named.get(name)
    if joint is not None and not joint.type.is_fixed and joint.mimic is None:
        return joint
    pointer, hint = ("configurations", configuration, name), None
    subject = f"'{name}' in configuration '{configuration}'"
    if joint is None:
        free = (other.name for other in named.values() if not other.type.is_fixed and not other.mimic)
        message = f"{subject} is not a joint of the robot"
        joints.report_name("configuration-joint", message, pointer, name, free, key=True)
        return None
    meant: float | None = 0.0  # where the joint is in this configuration anyway
    if name in joints.merged:
        why, meant = f"was merged into the spherical joint '{joints.merged[name]}'", None
        hint = f"give the coordinates of '{joints.merged[name]}', a quaternion x, y, z, w"
    elif (mimic := joint.mimic) is not None:
        why = f"mimics '{mimic.joint}' and has no coordinate of its own"
        meant = mimic.multiplier * written.get(mimic.joint, (0.0,))[0] + mimic.offset
    else:
        why = "is fixed and has no coordinate"
    is_redundant = meant is not None and all(abs(value - meant) <= LIMIT_TOLERANCE for value in written[name])
    fixes = partial(removed, joints.reporter.document, pointer, f"'{name}'") if is_redundant else ()
    joints.reporter.report("configuration-joint", f"{subject} {why}", pointer, hint, fixes, key=True)
    return None


def within_limits(value: float, lower: float, upper: float) -> bool:
    """EU-CFG-004: whether a coordinate is within its range, rad or m, one of `Joint.ranges`."""
    return lower - LIMIT_TOLERANCE <= value <= upper + LIMIT_TOLERANCE


def beyond_limits(joints: Iterable[Joint], coordinates: Mapping[str, Sequence[float]]) -> list[BeyondLimit]:
    """EU-CFG-004: the coordinates of a configuration that are beyond their limits.

    A joint that is left out is at its neutral, or mimics another; joints with a quaternion have no limits.
    """
    return [
        BeyondLimit(joint.name, name, value, lower, upper)
        for joint in joints
        if joint.type.quaternion is None and (joint.mimic is None or joint.name in coordinates)
        for name, value, (lower, upper) in zip(
            joint.type.coordinates, coordinates.get(joint.name, joint.type.neutral), joint.ranges, strict=True
        )
        if not within_limits(value, lower, upper)
    ]


def _check_left_out(joints: Sequence[Joint], configuration: str, reporter: YamlReporter) -> None:
    """EU-CFG-004: joints that a configuration leaves out are within their limits at neutral."""
    beyond = beyond_limits(joints, {})
    if not beyond:
        return
    names = {found.joint for found in beyond}
    example: dict[str, Value] = {joint.name: _nearest(joint) for joint in joints if joint.name in names}
    told = ", ".join(f"'{found.joint}' (limits {found.limits})" for found in beyond[:_MOST_TOLD])
    more = f", and {len(beyond) - _MOST_TOLD} more" if len(beyond) > _MOST_TOLD else ""
    reporter.report(
        "configuration-limits",
        f"configuration '{configuration}' leaves out joints, which are then at 0, outside their limits: {told}{more}",
        ("configurations", configuration),
        f"add coordinates within the limits, for example {flow(example)}",
        key=True,
    )


def _nearest(joint: Joint) -> float | list[float]:
    """The coordinates within the limits that are nearest to neutral, as a file states them."""
    neutral = zip(joint.type.neutral, joint.ranges, strict=True)
    nearest = [value if within_limits(value, *ends) else min(max(value, ends[0]), ends[1]) for value, ends in neutral]
    return nearest[0] if len(nearest) == 1 else nearest


def _coordinates(
    joint: Joint, values: tuple[float, ...], configuration: str, reporter: YamlReporter
) -> tuple[float, ...] | None:
    """EU-CFG-002 to -004, EU-CFG-006: the coordinates of a joint; None, and a diagnostic, where they are invalid."""
    names, start = joint.type.coordinates, joint.type.quaternion
    hint: str | None = None
    exact: Value = None  # what was meant, where only its last digits are wrong
    if len(values) != len(names):
        code = "configuration-length"
        message = (
            f"{joint.type} joint '{joint.name}' has {len(values)} coordinates in configuration '{configuration}'; "
            f"it must have {len(names)}: {', '.join(names)}"
        )
        if joint.type.is_axial and len(values) == 4 and abs(math.hypot(*values) - 1.0) <= _ROUNDED:
            hint = f"is '{joint.name}: spherical' missing under 'joints'? these are the coordinates of a quaternion"
        elif joint.type.is_axial and len(values) == 2 and abs(math.hypot(*values) - 1.0) <= _ROUNDED:
            exact = round(math.atan2(values[1], values[0]), 9)  # cosine and sine, as Pinocchio has them
    elif start is not None:
        quaternion = values[start : start + 4]
        norm = math.sqrt(sum(value * value for value in quaternion))
        if abs(norm - 1.0) <= QUATERNION_TOLERANCE:
            return (*values[:start], *(value / norm for value in quaternion))
        unit = [round(value / norm, 6) for value in quaternion] if norm > 1e-9 else [0, 0, 0, 1]
        if abs(norm - 1.0) <= _ROUNDED:
            exact = [*values[:start], *(round(value / norm, 9) for value in quaternion)]
        code = "configuration-quaternion"
        message = (
            f"the quaternion of joint '{joint.name}' in configuration '{configuration}' has length {norm:.9g}, not 1"
        )
        hint = f"write a unit quaternion x, y, z, w: {unit}"
    elif beyond := beyond_limits([joint], {joint.name: values}):
        found = beyond[0]
        code = "configuration-limits"
        message = (
            f"{found.coordinate} {found.value:.12g} of joint '{joint.name}' in configuration '{configuration}' is "
            f"outside its limits {found.lower:.12g} to {found.upper:.12g}"
        )
        angle = math.radians(found.value)
        fits = within_limits(angle, found.lower, found.upper)
        if found.unit == "rad" and abs(found.value) > (math.pi if fits else math.tau):
            hint = f"is it in degrees? {found.value:g} degrees are {angle:.6g} rad"
        nearest = min(max(found.value, found.lower), found.upper)
        if len(values) == 1 and abs(nearest - found.value) <= QUATERNION_TOLERANCE:
            exact = nearest
    else:
        return values
    pointer = ("configurations", configuration, joint.name)
    fixes = () if exact is None else (restated(reporter.document, pointer, exact),)
    reporter.report(code, message, pointer, hint, fixes)
    return None
