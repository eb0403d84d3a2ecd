"""Compares values of a parser with other values of the same parser; both may have the allowed error."""

from __future__ import annotations

import numpy as np

from eurdf_conformance.comparison.array import TOLERANCE, array_differences
from eurdf_conformance.comparison.difference import Difference
from eurdf_conformance.comparison.values import values_differences
from eurdf_conformance.protocol.message import Values

#: EU-PRO-008, EU-PRO-009: each of two right answers may have an error of 1e-8; computing with one enlarges it.
NEAR = 100.0 * TOLERANCE


def same_values(expected: Values, given: Values, size: float, pointer: str) -> list[Difference]:
    """Values that differ by more than two right answers may.

    Args:
        expected: What follows from another answer; what is None is not compared.
        given: Values.
        size: Of the robot, m.
        pointer: Where they are in the answer.
    """
    inert = {"mass_matrix": None, "mass": None}
    found = values_differences(expected.model_copy(update=inert), given, size, NEAR)
    if expected.mass is not None:
        one = expected.mass
        found += array_differences(one, given.mass, NEAR * abs(one), "/mass", "mass, kg")
    if expected.mass_matrix is not None and given.mass_matrix is not None:
        M, other = np.array(expected.mass_matrix.matrix), np.array(given.mass_matrix.matrix)
        order = [given.mass_matrix.columns.index(column) for column in expected.mass_matrix.columns]
        near = NEAR * float(np.abs(M).max(initial=0.0))
        other = other[np.ix_(order, order)] if order else other
        found += array_differences(M.tolist(), other.tolist(), near, "/mass_matrix/matrix", "M")
    return [each.within(pointer) for each in found]
