"""Compares a parser's values at one configuration with the expected ones: EU-PRO-008, EU-PRO-009."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from eurdf_conformance.comparison.array import TOLERANCE, Near, agree, array_differences, both, name_differences
from eurdf_conformance.comparison.columns import jacobian_differences, mass_matrix_differences
from eurdf_conformance.comparison.difference import ABSENT, Difference
from eurdf_conformance.comparison.half_turn import is_half_turn, twin_residual
from eurdf_conformance.json_pointer import step
from eurdf_conformance.protocol.message import Pose, Values

Rows = Mapping[str, Sequence[float]]


def values_differences(expected: Values, given: Values, size: float, tolerance: float = TOLERANCE) -> list[Difference]:
    """Where values differ; what is not expected is not looked at, but for the centre of mass of what weighs nothing.

    Args:
        expected: What it should be.
        given: What it is; pointers lead into it.
        size: Largest distance of two frames of the robot at that configuration, m.
        tolerance: By how much poses, residuals and K may be off, of lengths relative to the size above 1 m.
    """
    near = Near.of(size, tolerance)
    twins = _twins(expected.residuals or {}, given.residuals or {}, near)
    found = [
        difference
        for quantity in Values.model_fields
        if getattr(expected, quantity) is not None
        for difference in _quantity_differences(quantity, expected, given, near, twins)
    ]
    if expected.mass == 0.0 and expected.center_of_mass is None and given.center_of_mass is not None:
        why = "centre of mass of a robot without mass"
        found.append(Difference(step("center_of_mass"), ABSENT, given.center_of_mass, why))
    return found


def _quantity_differences(
    quantity: str, expected: Values, given: Values, near: Near, twins: Rows
) -> Iterator[Difference]:
    where = step(quantity)
    match getattr(expected, quantity), getattr(given, quantity):
        case one, None:
            yield Difference(where, one, ABSENT, f"{quantity} was requested but is missing")
        case one, other if quantity == "poses":
            yield from _pose_differences(one, other, near, where)
        case one, other if quantity == "residuals":
            yield from _residual_differences(one, other, near, where, twins)
        case one, other if quantity == "jacobian":
            yield from jacobian_differences(one, other, near, where, twins)
        case one, other if quantity == "mass_matrix":
            yield from mass_matrix_differences(one, other, where)
        case one, other if quantity == "mass":
            yield from array_differences(one, other, TOLERANCE * abs(one), where, "mass, kg")
        case one, other:
            yield from array_differences(one, other, near.length, where, "centre of mass in the world, m")


def _pose_differences(
    expected: Mapping[str, Pose], given: Mapping[str, Pose], near: Near, pointer: str
) -> Iterator[Difference]:
    yield from name_differences(expected, given, pointer, "frame")
    names = both(expected, given)
    for member, what, allowed in (
        ("translation", "origin of frame '{}' in the world, m", near.length),
        ("rotation", "rotation of frame '{}' in the world", near.angle),
    ):
        one, other = ([getattr(poses[name], member) for name in names] for poses in (expected, given))
        if agree(np.array(one), np.array(other), allowed):
            continue
        for name, there, here in zip(names, one, other, strict=True):
            yield from array_differences(there, here, allowed, f"{pointer}{step(name)}/{member}", what.format(name))


def _residual_differences(expected: Rows, given: Rows, near: Near, pointer: str, twins: Rows) -> Iterator[Difference]:
    yield from name_differences(expected, given, pointer, "closure")
    for name in both(expected, given):
        if name not in twins:
            what = f"residual of closure '{name}', m and rad"
            allowed = near.rows(len(expected[name]))
            yield from array_differences(expected[name], given[name], allowed, pointer + step(name), what)


def _twins(expected: Rows, given: Rows, near: Near) -> Rows:
    """EU-CLO-008: the expected residual of closures at a half turn, where the other one of the two is given."""
    found = {}
    for name in both(expected, given):
        one, other = np.array(expected[name]), np.array(given[name])
        if not is_half_turn(one) or other.shape != (6,) or agree(one, other, near.rows(6)):
            continue
        if agree(twin_residual(one), other, near.rows(6)):
            found[name] = expected[name]
    return found
