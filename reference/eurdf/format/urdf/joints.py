"""The joints of a URDF."""

from __future__ import annotations

import math
from collections.abc import Mapping
from functools import partial

from eurdf.diagnostics import Fix
from eurdf.format.conventions import is_too_small, lower_limit, too_small, upper_limit
from eurdf.format.urdf.data import Limit, UrdfJoint
from eurdf.format.urdf.elements import RATES, RESERVED, URDF_JOINT_TYPES, UrdfReader, named
from eurdf.mechanism.joint import Mimic
from eurdf.mechanism.joint_types import JointType
from eurdf.mechanism.pose import IDENTITY, Vector3
from eurdf.reading.xml_reader import Element

_X: Vector3 = (1.0, 0.0, 0.0)

# Attributes of one number each, and their defaults.
_LIMIT = {"lower": "0", "upper": "0", "effort": None, "velocity": None}
_RANGE_1_2 = ("lower", "upper")
_LIMIT_1_2 = ("effort", "velocity", *RATES)
_NO_LIMIT = {"upper": math.inf, "velocity": math.inf, "effort": math.inf}
_DYNAMICS = {"damping": "0", "friction": "0"}
_MIMIC = {"multiplier": "1", "offset": "0"}


def read_joint(reader: UrdfReader, element: Element) -> UrdfJoint | None:
    """A joint; None if it lacks a name, a type or a link, which was reported."""
    name = reader.name(element)
    found = reader.children(element)
    kind = _type(reader, element)
    parent, child = _link(reader, element, found, "parent"), _link(reader, element, found, "child")
    placement = reader.origin(found["origin"]) if "origin" in found else IDENTITY
    if kind is None:
        return None
    axis = _axis(reader, name, kind, found["axis"]) if "axis" in found else _X
    limit = _limit(reader, name, kind, element, found.get("limit"))
    damping = friction = 0.0
    if "dynamics" in found:
        damping, friction = _dynamics(reader, found["dynamics"])
    mimic = _mimic(reader, name, kind, found["mimic"]) if "mimic" in found else None
    if name is None or parent is None or child is None or axis is None:
        return None
    if name == RESERVED:
        reader.refuse_reserved(element)
    return UrdfJoint(name, kind, element, parent, child, placement, axis, limit, damping, friction, mimic)


def _link(reader: UrdfReader, joint: Element, found: Mapping[str, Element], tag: str) -> str | None:
    element = reader.need(joint, found, tag)
    return None if element is None else reader.name(element, "link")


def _type(reader: UrdfReader, element: Element) -> JointType | None:
    """EU-URD-012: the type of a joint is one of URDF's six."""
    text = element.get("type")
    if text is None:
        reader.missing_attribute(element, "type")
        return None
    kind = URDF_JOINT_TYPES.get(text)
    if kind is None:
        message = f"'{text}' is not a joint type of URDF"
        if text in ("spherical", "ball", "universal", "cylindrical", "helical", "screw"):
            hint = "write 'revolute' or 'continuous' here, and the type under 'joints' in the YAML file"
            reader.report("urdf-joint-type", message, element, "type", hint)
        else:
            reader.reporter.report_name("urdf-joint-type", message, element, "type", URDF_JOINT_TYPES)
    return kind


def _axis(reader: UrdfReader, name: str | None, kind: JointType, element: Element) -> Vector3 | None:
    """EU-URD-013, EU-URD-035: the axis of a joint that turns about it or slides along it; x if left out."""
    axis = reader.required(element, "xyz", 3)
    if axis is None:
        return None
    x, y, z = axis
    if kind is JointType.PLANAR:
        if x != 0.0 or y != 0.0:
            reader.report(
                "urdf-planar-axis",
                f"planar joint '{name}' moves in its own xy plane; its axis is ignored",
                element,
                "xyz",
                "rotate the joint's origin until its z axis is normal to the plane, and write the axis 0 0 1",
            )
    elif not kind.is_axial:
        return _X
    elif x == y == z == 0.0:
        reader.report("urdf-zero-axis", f"the axis of joint '{name}' is zero", element, "xyz")
        return None
    return (x, y, z)


def _limit(
    reader: UrdfReader, name: str | None, kind: JointType, joint: Element, element: Element | None
) -> Limit | None:
    """EU-URD-004, EU-URD-019: a joint with a range of motion has a ``limit``, whose ends are in order."""
    if element is None:
        if kind.is_ranged:
            hint = "does it rotate without limits? then its type is 'continuous'" if kind == "revolute" else None
            proposals = partial(reader.retaggings_to, joint, "limit")
            message = f"{kind} joint '{name}' has no <limit>"
            reader.report("urdf-missing-element", message, joint, hint=hint, proposals=proposals)
        return None
    limit = _limit_1_2(reader, kind, element) if reader.version >= "1.2" else _limit_1_0(reader, element)
    if limit is None:
        return None
    if min(limit[2:]) < 0.0:
        _report_negative(reader, element, **{key: getattr(limit, key) for key in _LIMIT_1_2})
    if limit.lower > limit.upper and (kind.is_ranged or reader.version >= "1.2"):
        message = f"joint '{name}': lower limit {limit.lower:g} is above upper limit {limit.upper:g}"
        hint = "are they in the wrong order, or is a sign wrong?"
        reader.report(
            "urdf-reversed-limits", message, element, "lower", hint, partial(_swapped, reader, element, limit)
        )
    return limit


def _swapped(reader: UrdfReader, element: Element, limit: Limit) -> list[Fix]:
    """The proposal to exchange limits, the lower one above 0 and the upper one below; else a sign may be wrong."""
    if not limit.lower > 0.0 > limit.upper:
        return []
    write, lower, upper = reader.reporter.document.restated, element.get("lower", ""), element.get("upper", "")
    return [Fix("swap the two limits", (*write(element, "lower", upper), *write(element, "upper", lower)))]


def _limit_1_0(reader: UrdfReader, element: Element) -> Limit | None:
    """A ``limit`` before URDF 1.2."""
    values = reader.single_numbers(element, _LIMIT)
    for attribute in map(str, element.keys()):
        if attribute in RATES:
            reader.later(element, attribute, "1.2")
    return None if values is None else _limits(dict(zip(_LIMIT, values, strict=True)))


def _limit_1_2(reader: UrdfReader, kind: JointType, element: Element) -> Limit | None:
    """A ``limit`` from URDF 1.2 on: what is left out does not limit; a joint with a range of motion states it."""
    required, optional = (_RANGE_1_2, _LIMIT_1_2) if kind.is_ranged else ((), (*_RANGE_1_2, *_LIMIT_1_2))
    stated = dict.fromkeys((*required, *(attribute for attribute in optional if attribute in element.attrib)))
    values = reader.single_numbers(element, stated, optional)
    return None if values is None else _limits(dict(zip(stated, values, strict=True)))


def _limits(stated: dict[str, float]) -> Limit:
    """EU-FIL-006: the limits that are stated; those that are left out, or too large to be one, do not limit."""
    lower = lower_limit(stated.pop("lower", -math.inf))
    return Limit(lower, **{**_NO_LIMIT, **{name: upper_limit(value) for name, value in stated.items()}})


def _dynamics(reader: UrdfReader, element: Element) -> tuple[float, ...]:
    damping, friction = reader.single_numbers(element, _DYNAMICS) or (0.0, 0.0)
    if damping < 0.0 or friction < 0.0:
        _report_negative(reader, element, damping=damping, friction=friction)
    return damping, friction


def _report_negative(reader: UrdfReader, element: Element, **values: float) -> None:
    """EU-URD-020: magnitudes are not negative."""
    for attribute, value in values.items():
        if value < 0.0:
            message = f"'{attribute}' of {named(element)} is {value:g}; it must not be negative"
            reader.report("urdf-negative-limit", message, element, attribute)


def _mimic(reader: UrdfReader, name: str | None, kind: JointType, element: Element) -> Mimic | None:
    """EU-URD-036: a fixed joint has no coordinate, so a `<mimic>` in it has no effect."""
    joint = reader.name(element, "joint")
    values = reader.single_numbers(element, _MIMIC)
    if values is not None and is_too_small(values[0]):
        reader.out_of_bounds(element, "multiplier", too_small(values[0]))
        return None
    if joint is None or values is None:
        return None
    if kind.is_fixed:
        reader.mimic_reporter.report(
            "urdf-mimic-fixed",
            f"joint '{name}' is fixed: its <mimic> of '{joint}' has no effect",
            element,
            hint="remove <mimic>, or change the type if the joint moves",
        )
        return None
    return Mimic(joint, *values)
