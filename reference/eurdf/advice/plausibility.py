"""Advice on inertias, drives and mimic joints whose numbers are beyond what robots have: most are in another unit."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from functools import partial
from typing import NamedTuple

from eurdf.diagnostics import Diagnostics, Place
from eurdf.diagnostics.registry import REGISTRY, Phase
from eurdf.linking.configurations import within_limits
from eurdf.linking.robot_files import ReadRobot
from eurdf.mechanism.joint import Joint
from eurdf.mechanism.mechanism import Mechanism

# Densities of the ball that has the mass and the moments of a link, kg/m³: no metal has the first, and what has the
# second is lighter than air. In a hundred published robots they are 0.3 to 10,400, except for a few placeholders.
_DENSEST, _LIGHTEST = 2.3e4, 1.2

# Links with less of the mass of the robot than this often have a placeholder as their inertia: too small, too large.
_LITTLE = (0.01, 0.001)

# A link with more of the mass of the robot than this has its moments stated.
_MOST = 0.5

# A link is a point if the trace of its moments is at most this part of its mass at the reach of the robot. It is one on
# purpose unless it is the only one, and so many links are none.
_POINT, _OTHERS = 1e-9, 3

# Nothing is known of a robot that reaches less than this, m, as one of a single link.
_SMALLEST = 1e-6

# A radius of gyration of more than this many times the reach of the robot is one of another unit.
_BEYOND = 2.0

# No robot's joint turns so fast, rad/s, or m/s.
_FASTEST = 500.0

# A reflected inertia of more than this many times the mass of the robot at the end of its reach is one of another unit.
_REFLECTED = 10.0

# The part of the range of a mimic joint, as its leader makes it, that is at least within its own limits.
_WITHIN = 0.5

# Codes of actuators that are not those of the robot: what is wrong with their drives says nothing then.
_OF_ACTUATORS = {"x-actuator-several", "x-dependent-actuators", "x-motor-not-actuated", "x-uncontrolled-motion"}


class _Implausible(NamedTuple):
    message: str
    place: Callable[[], Place]
    hint: str


def advise_on_plausibility(read: ReadRobot, diagnostics: Diagnostics) -> None:
    """Report the first of the numbers of each kind that are not plausible, and how many more there are."""
    reach = reach_of(read.mechanism)
    total = sum(body.inertia.mass for body in read.mechanism.bodies if body.inertia is not None)
    # What is reported already may have the same cause.
    known = diagnostics.counts().keys()
    efforts = () if _OF_ACTUATORS & known else _without_effort(read)
    is_known = any(REGISTRY[code].phase is Phase.INERTIA for code in known)
    for code, of_a_kind in (
        ("x-implausible-inertia", () if is_known else _inertias(read, total, reach)),
        ("x-implausible-drive", efforts),
        ("x-implausible-drive", _fast(read)),
        ("x-implausible-drive", _inverse_gears(read)),
        ("x-implausible-drive", _heavy_rotors(read, total, reach)),
        ("x-implausible-mimic", _mimics(read)),
    ):
        found = list(of_a_kind)
        if found:
            more = f"; {len(found) - 1} more like it" if len(found) > 1 else ""
            diagnostics.report(code, found[0].message + more, found[0].place, found[0].hint)


def spring_notes(mechanism: Mechanism) -> tuple[str, ...]:
    """A sentence about each spring that is never at rest within the limits of its joint: it may be preloaded."""
    return tuple(
        f"the spring of joint '{joint.name}' never relaxes: its rest, {rest:g} {_unit(joint)}, is beyond the limits "
        f"{lower:g} to {upper:g} {_unit(joint)}"
        for joint in mechanism.joints
        if any(joint.properties.stiffness)
        for rest, (lower, upper) in zip(joint.properties.rest, joint.ranges, strict=False)
        if not within_limits(rest, lower, upper)
    )


def _unit(joint: Joint) -> str:
    """Of a coordinate."""
    return "m" if joint.type.slides else "rad"


def reach_of(mechanism: Mechanism) -> float:
    """The longest path from the root, from joint to joint and to the centre of mass of the last link, m."""
    path = {mechanism.bodies[0].name: 0.0}
    for joint in mechanism.joints:
        path[joint.child] = path[joint.parent] + math.hypot(*joint.placement.xyz) + math.hypot(*joint.offset.xyz)
    ends = ((body.name, body.inertia.pose.xyz) for body in mechanism.bodies if body.inertia is not None)
    return max((*path.values(), *(path[name] + math.hypot(*centre) for name, centre in ends)))


def _inertias(read: ReadRobot, total: float, reach: float) -> Iterator[_Implausible]:
    """Inertias of a body that is denser than any metal, or larger than the robot and lighter than air.

    Of all bodies of a mass m and a density, a ball has the smallest trace of the moments: 6/5 m r².
    """
    points: list[_Implausible] = []
    others = 0
    if reach < _SMALLEST:
        return
    for body in read.mechanism.bodies:
        inertia, link = body.inertia, read.urdf.links.get(body.name)
        if inertia is None or link is None or link.inertial is None or inertia.mass <= _LITTLE[1] * total:
            continue
        moments = inertia.moments[0], inertia.moments[3], inertia.moments[5]
        trace, place = sum(moments), partial(read.urdf.document.place, link.inertial)
        is_unknown = len(set(moments)) == 1 and _is_power_of_ten(trace / 3.0)  # which stands for unknown moments
        if is_unknown and inertia.mass <= _MOST * total:
            continue
        what, large = f"link '{body.name}' has a mass of {inertia.mass:.4g} kg", inertia.mass > _LITTLE[0] * total
        if trace <= _POINT * inertia.mass * reach * reach:
            if large:
                hint = "is it a point, or are its moments of inertia missing?"
                points.append(_Implausible(f"{what} and no moments of inertia", place, hint))
            continue
        others += 1
        gyration = math.sqrt(0.5 * trace / inertia.mass)
        radius = gyration * math.sqrt(5.0 / 3.0)
        density = inertia.mass / (4.0 / 3.0 * math.pi * radius**3)
        if density > _DENSEST and large:
            message = f"{what}, and moments of inertia as of a ball of {radius:.2g} m: it is denser than any metal"
            hint = f"is the mass in kg ({inertia.mass:.4g} g are {inertia.mass / 1e3:.4g} kg), the inertia in kg·m²?"
            yield _Implausible(message, place, hint)
        elif density < _LIGHTEST and gyration > _BEYOND * reach:
            message = f"{what} and a radius of gyration of {gyration:.3g} m; the whole robot reaches {reach:.3g} m"
            hint = "are its moments in kg·m²? 1 kg·mm² is 1e-6, 1 g·cm² 1e-7, 1 g·mm² 1e-9 kg·m²"
            yield _Implausible(message, place, hint)
    if len(points) == 1 and others >= _OTHERS:
        yield from points


def _is_power_of_ten(value: float) -> bool:
    return f"{value:e}".startswith("1.000000e")


def _without_effort(read: ReadRobot) -> Iterator[_Implausible]:
    actuators = set(read.mechanism.actuators)
    for joint in read.mechanism.joints:
        if joint.name in actuators and any(effort == 0.0 for effort in joint.properties.effort):
            message = f"actuator '{joint.name}' has the effort limit 0, so its motor can do nothing"
            hint = f"does a motor move '{joint.name}'? If so, what is its largest torque or force?"
            yield _Implausible(message, partial(place_of, read, joint.name, "effort"), hint)


def _fast(read: ReadRobot) -> Iterator[_Implausible]:
    for joint in read.mechanism.joints:
        for speed in joint.properties.velocity if joint.type.is_axial else ():  # a helical joint turns fast
            # A power of ten stands for no limit.
            if _FASTEST < speed < math.inf and not _is_power_of_ten(speed):
                unit = _unit(joint) + "/s"
                other, factor = ("mm/s", 1e-3) if joint.type.slides else ("rpm", math.pi / 30.0)
                message = f"the velocity limit of joint '{joint.name}' is {speed:g} {unit}"
                hint = f"is it in {other}? {speed:g} {other} are {speed * factor:.4g} {unit}"
                yield _Implausible(message, partial(place_of, read, joint.name, "velocity"), hint)


def _inverse_gears(read: ReadRobot) -> Iterator[_Implausible]:
    for joint in read.mechanism.joints:
        for ratio in () if joint.type.slides else joint.properties.gear_ratio:
            if 0.0 < abs(ratio) < 1.0:
                message = f"the gear ratio of joint '{joint.name}' is {ratio:g}: its motor turns more slowly than it"
                hint = f"the gear ratio is motor revolutions per joint revolution: is it {1.0 / ratio:.4g}?"
                yield _Implausible(message, partial(place_of, read, joint.name, "gear_ratio"), hint)


def _heavy_rotors(read: ReadRobot, total: float, reach: float) -> Iterator[_Implausible]:
    whole = total * reach * reach
    for joint in read.mechanism.joints:
        for armature in () if joint.type.slides else joint.properties.armature:
            if armature > _REFLECTED * whole > 0.0:
                message = (
                    f"the armature of joint '{joint.name}' is {armature:.3g} kg·m²; the whole robot at its reach, "
                    f"{total:.3g} kg at {reach:.3g} m, has {whole:.3g} kg·m²"
                )
                hint = "is the rotor's inertia in kg·m²? 1 g·cm² is 1e-7 kg·m²"
                yield _Implausible(message, partial(place_of, read, joint.name, "armature"), hint)


def _mimics(read: ReadRobot) -> Iterator[_Implausible]:
    """Mimic joints whose own limits exclude most of the range in which they are for the limits of their leaders."""
    joints = {joint.name: joint for joint in read.mechanism.joints}
    for name, mimic in read.mechanism.leaders.items():
        leader, joint = joints.get(mimic.joint), joints[name]
        if leader is None or len(leader.ranges) != 1 or not all(map(math.isfinite, leader.ranges[0])):
            continue
        least, most = sorted(mimic.multiplier * end + mimic.offset for end in leader.ranges[0])
        lower, upper = joint.ranges[0]
        if min(most, upper) - max(least, lower) < _WITHIN * (most - least):
            ranges = f"from {least:.4g} to {most:.4g} {_unit(joint)}, and its own limits are {lower:.4g} to {upper:.4g}"
            message = f"joint '{name}' mimics '{mimic.joint}' {ranges} {_unit(joint)}"
            hint = "is the sign of the multiplier right, and the offset in rad or m?"
            yield _Implausible(message, partial(place_of, read, joint.name, "mimic"), hint)


def place_of(read: ReadRobot, joint: str, what: str = "") -> Place:
    """Where a joint is stated in the URDF, or a property of it: there, in its entry, or in that of its actuator."""
    if what and read.yaml is not None:
        for entry in read.yaml.joints:
            keys = next((keys for keys in entry.properties if keys[-1] == what), None)
            if entry.name == joint and keys is not None:
                return read.yaml.document.place((*entry.pointer, *keys))
        for actuator in read.yaml.actuators:
            if actuator.joint == joint and what in ("armature", "gear_ratio", "rotor_inertia"):
                return read.yaml.document.place(actuator.pointer)
    urdf = read.urdf
    if joint not in urdf.joints:
        return urdf.document.place(urdf.document.root)
    element = urdf.joints[joint].element
    inner = {"mimic": "mimic", "damping": "dynamics", "friction": "dynamics"}.get(what, "limit")
    return urdf.document.place(next(element.iterchildren(inner), element) if what else element, what or None)
