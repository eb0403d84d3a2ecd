"""Advice on angles that are so large that they are likely in degrees."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from functools import partial

from eurdf.diagnostics import Diagnostics, Place
from eurdf.format.model import Description
from eurdf.format.urdf.data import Urdf
from eurdf.linking.robot_files import ReadRobot
from eurdf.mechanism.mechanism import Mechanism
from eurdf.reading.yaml_node import Pointer

# An orientation or the rest of a spring beyond one turn, and another joint angle beyond two, is looked at, in rad.
# Wrists and steering wheels turn up to one and a half times to either side; of published robots, limits are at most
# 10 rad or else beyond `_MOST`.
_MOST_ORIENTATION = 2.0 * math.pi * 1.001
_MOST_POSITION = 4.0 * math.pi * 1.001

# Nobody gives an angle of more than two turns in degrees; larger limits, such as 1e16, mean no limit.
_MOST = 720.0

# Limits of either sign that people write where there is none.
_NO_LIMIT = frozenset({20.0, 50.0, 100.0, 200.0, 500.0})

# Half degrees: angles in degrees are rarely finer, and angles in rad rarely as coarse.
_PER_DEGREE = 2.0

# A multiple of a quarter turn in rad, to this rounding of its digits, is one on purpose; a whole number is not such.
_ROUNDING = 0.01

_Place = Callable[[], Place]
_Found = tuple[float, str, _Place]


def advise_on_angles(read: ReadRobot, diagnostics: Diagnostics) -> None:
    """Report the angles of each file that are likely in degrees, at the first of them."""
    _report([*_in_urdf(read.urdf)], diagnostics)
    if read.yaml is not None:
        _report([*_in_description(read.description, read.mechanism)], diagnostics)


def _report(found: list[_Found], diagnostics: Diagnostics) -> None:
    if not found:
        return
    value, what, place = found[0]
    more = len(found) - 1
    others = "" if not more else f"; this file has {more} more such {'angle' if more == 1 else 'angles'}"
    diagnostics.report(
        "x-angle-in-degrees",
        f"{what} is {value:g} rad, {abs(value) / (2.0 * math.pi):.3g} turns{others}",
        place,
        f"angles are in rad: {value:g} degrees are {math.radians(value):.6g} rad",
    )


def _in_urdf(urdf: Urdf) -> Iterator[_Found]:
    limits: list[_Found] = []
    open_ended: list[_Found] = []
    for joint in urdf.joints.values():
        if not joint.type.is_ranged or joint.type.slides or joint.limit is None:
            continue
        element = next(child for child in joint.element if child.tag == "limit")
        for side in ("lower", "upper"):
            value = getattr(joint.limit, side)
            if _position_in_degrees(value):
                place = partial(urdf.document.place, element, side)
                maybe_none = joint.limit.lower == -joint.limit.upper and abs(value) in _NO_LIMIT
                (open_ended if maybe_none else limits).append((value, f"limit '{side}' of joint '{joint.name}'", place))
    for origin in urdf.document.root.iter("origin"):
        owner = origin.getparent()
        if owner is None or owner.tag not in ("joint", "inertial", "visual", "collision"):
            continue
        above = owner if owner.tag == "joint" else owner.getparent()
        if above is None or above.tag not in ("joint", "link") or above.getparent() is not urdf.document.root:
            continue  # elements such as <gazebo> are not checked as URDF
        for value in map(float, (origin.get("rpy") or "").split()):
            if _orientation_in_degrees(value):
                what = f"an angle of 'rpy' of {above.tag!s} '{above.get('name')}'"
                limits.append((value, what, partial(urdf.document.place, origin, "rpy")))
    # A limit that may mean no limit is one in degrees only where another angle is.
    yield from limits
    if limits:
        yield from open_ended


def _in_description(description: Description, mechanism: Mechanism) -> Iterator[_Found]:
    place_at = description.document.place

    def found(value: float, what: str, pointer: Pointer) -> _Found:
        return value, what, partial(place_at, pointer)

    for reference in description.references:
        for index, value in enumerate(reference.rpy):
            if _orientation_in_degrees(value):
                yield found(value, "an angle of 'rpy'", (*reference.pointer, "rpy", index))
    angles = {
        joint.name: [index for index, name in enumerate(joint.type.coordinates) if name == "angle"]
        for joint in mechanism.joints
    }
    for entry in description.joints:
        for side in ("lower", "upper"):
            given = entry.properties.get(("limits", side))
            for value in given if isinstance(given, tuple) else () if given is None else (given,):
                if angles.get(entry.name) and _position_in_degrees(value):
                    yield found(value, f"limit '{side}' of joint '{entry.name}'", (*entry.pointer, "limits", side))
        for index in angles.get(entry.name, ()):
            rest = entry.rest[index] if isinstance(entry.rest, tuple) else entry.rest
            if rest is not None and _position_in_degrees(rest, _MOST_ORIENTATION):
                yield found(rest, f"'rest' of joint '{entry.name}'", (*entry.pointer, "rest"))
                break
    for key, configuration in description.configurations.items():
        for name, values in configuration.items():
            for index in angles.get(name, ()):
                if _position_in_degrees(values[index]):
                    what = f"joint '{name}' in configuration '{key}'"
                    yield found(values[index], what, ("configurations", key, name))


def _orientation_in_degrees(value: float) -> bool:
    return _MOST_ORIENTATION < abs(value) <= _MOST and not _is_quarter_turns(value)


def _position_in_degrees(value: float, most: float = _MOST_POSITION) -> bool:
    return most < abs(value) <= _MOST and (value * _PER_DEGREE).is_integer() and not _is_quarter_turns(value)


def _is_quarter_turns(value: float) -> bool:
    quarters = value / (0.5 * math.pi)
    return abs(quarters - round(quarters)) * 0.5 * math.pi <= _ROUNDING and not value.is_integer()
