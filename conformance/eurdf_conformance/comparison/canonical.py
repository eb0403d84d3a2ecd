"""Compares two canonical descriptions by EU-CAN-005."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

from eurdf_conformance.comparison.coordinates import neutral, same_coordinates
from eurdf_conformance.comparison.difference import ABSENT, Difference
from eurdf_conformance.comparison.json_value import value_differences
from eurdf_conformance.comparison.plain_robot import Part, Placed, PlainRobot, plain_robot
from eurdf_conformance.json_pointer import step
from eurdf_conformance.protocol.message import CanonicalRobot, CanonicalShape


def canonical_differences(
    expected: CanonicalRobot, given: CanonicalRobot, bodies: Iterable[Iterable[str]]
) -> list[Difference]:
    """EU-CAN-005: where a canonical description is not equal to the expected one; pointers lead into the one given.

    Args:
        expected: What was to be read.
        given: What was read.
        bodies: For each body of the robot, the links that fixed or locked joints hold together.
    """
    # The usual answer. For Python, true is 1; as texts they differ, where infinity is null.
    if given == expected and given.model_dump_json() == expected.model_dump_json():
        return []
    bodies = [list(body) for body in bodies]
    one = plain_robot(expected, bodies, expected.links)
    # The links of the URDF come from the expectation, not from the parser.
    other = plain_robot(given, bodies, expected.links)
    return [
        *value_differences(expected.name, given.name, "/name", "name of the robot"),
        *value_differences(expected.version, given.version, "/version", "version of the description"),
        *value_differences(expected.root, given.root, "/root", "root"),
        *_set_differences(one.links, other.links, "/links", "link", given.links),
        *_set_differences(one.frames, other.frames, "/frames", "frame", given.frames),
        *other.repeated,
        *_part_differences(one.joints, other.joints, "/joints", "joint"),
        *_part_differences(one.closures, other.closures, "/closures", "closure"),
        *_part_differences(one.couplings, other.couplings, "/couplings", "coupling"),
        *_part_differences(one.actuators, other.actuators, "/actuators", "actuator of joint"),
        *_shape_differences(expected, given),
        *_configuration_differences(one, other, expected.root),
        *value_differences(expected.own, given.own, "/own", "user data"),
    ]


def _set_differences(
    expected: frozenset[str], given: frozenset[str], pointer: str, kind: str, as_given: list[str]
) -> Iterator[Difference]:
    for name in sorted(expected - given):
        yield Difference(pointer, name, ABSENT, f"{kind} '{name}' is missing")
    for name in sorted(given - expected):
        yield Difference(pointer + step(as_given.index(name)), ABSENT, name, f"unexpected {kind} '{name}'")


def _part_differences(
    expected: Mapping[str, Placed[Part]], given: Mapping[str, Placed[Part]], pointer: str, kind: str
) -> Iterator[Difference]:
    for name, placed in expected.items():
        if name not in given:
            yield Difference(pointer, placed.part, ABSENT, f"{kind} '{name}' is missing")
            continue
        found = given[name]
        if found.part == placed.part:
            continue
        for member in type(placed.part).model_fields:
            one, other = getattr(placed.part, member), getattr(found.part, member)
            if one != other:
                where = found.pointer + step(member)
                yield from value_differences(one, other, where, f"{kind} '{name}', {member}")
    for name, found in given.items():
        if name not in expected:
            yield Difference(found.pointer, ABSENT, found.part, f"unexpected {kind} '{name}'")


def _shape_differences(expected: CanonicalRobot, given: CanonicalRobot) -> Iterator[Difference]:
    """EU-CAN-006: shapes by link and use, in their order."""
    one, other = _shapes(expected), _shapes(given)
    for key in dict.fromkeys((*one, *other)):
        there, here = one.get(key, []), other.get(key, [])
        link, use = key
        if len(there) != len(here):
            where = here[-1].pointer if len(here) > len(there) else "/shapes"
            yield Difference(where, len(there), len(here), f"number of {use} shapes of link '{link}'")
            continue
        for number, (right, found) in enumerate(zip(there, here, strict=True), 1):
            why = f"{use} shape {number} of link '{link}'"
            yield from value_differences(right.part, found.part, found.pointer, why)


def _shapes(robot: CanonicalRobot) -> dict[tuple[str, str], list[Placed[CanonicalShape]]]:
    found: dict[tuple[str, str], list[Placed[CanonicalShape]]] = {}
    for index, shape in enumerate(robot.shapes):
        found.setdefault((shape.link, shape.use), []).append(Placed(shape, "/shapes" + step(index)))
    return found


def _configuration_differences(expected: PlainRobot, given: PlainRobot, root: str) -> Iterator[Difference]:
    """EU-CAN-004, and EU-CAN-005, step 5: a joint left out is at its neutral."""
    names = dict.fromkeys((*expected.configurations, *given.configurations))
    for name in names:
        pointer = "/configurations" + step(name)
        one, other = expected.configurations.get(name), given.configurations.get(name)
        if one is None or other is None:
            why = f"configuration '{name}' is missing" if other is None else f"unexpected configuration '{name}'"
            yield Difference(pointer, ABSENT if one is None else one, ABSENT if other is None else other, why)
            continue
        for joint in dict.fromkeys((*one, *other)):
            kind = expected.type_of(joint, root)
            if kind is None:
                coordinates = one.get(joint, ABSENT), other.get(joint, ABSENT)
                yield Difference(pointer + step(joint), *coordinates, f"'{joint}' is not a moving joint")
                continue
            there, here = one.get(joint, neutral(kind)), other.get(joint, neutral(kind))
            if not same_coordinates(kind, there, here):
                why = f"coordinates of joint '{joint}' in configuration '{name}'"
                yield Difference(pointer + step(joint), there, other.get(joint, ABSENT), why)
