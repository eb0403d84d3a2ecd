"""Compares K and M, whose columns may have any order."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from eurdf_conformance.comparison.array import TOLERANCE, Near, agree, both, name_differences, worst
from eurdf_conformance.comparison.difference import ABSENT, Difference
from eurdf_conformance.comparison.half_turn import Matrix, twin_rows
from eurdf_conformance.json_pointer import step
from eurdf_conformance.protocol.message import Jacobian, MassMatrix

Column = tuple[str, int]


def jacobian_differences(
    expected: Jacobian, given: Jacobian, near: Near, pointer: str, twins: Mapping[str, Sequence[float]]
) -> Iterator[Difference]:
    """EU-PRO-007, EU-PRO-008: where K differs.

    Args:
        expected: What it should be.
        given: What it is.
        near: By how much entries may be off.
        pointer: Where it is in the answer.
        twins: The expected residual of the closures of which the other one of two was given.
    """
    yield from column_differences(expected.columns, given.columns, pointer + "/columns")
    yield from name_differences(expected.rows, given.rows, pointer + "/rows", "closure")
    order, width = _order(expected.columns, given.columns), len(given.columns)
    for name in both(expected.rows, given.rows):
        where, what = pointer + "/rows" + step(name), f"rows of K of closure '{name}'"
        if any(len(row) != width for row in given.rows[name]):
            yield Difference(where, width, [len(row) for row in given.rows[name]], f"{what}: length of each row")
            continue
        if order is None:
            continue
        one, other = _matrix(expected.rows[name], width), _matrix(given.rows[name], width)[:, order]
        if one.shape != other.shape:
            yield Difference(where, len(one), len(other), f"{what}: number of rows")
            continue
        if name in twins:
            one = twin_rows(np.array(twins[name]), one)
        allowed = near.rows(len(one))[:, np.newaxis]
        yield from _entry_differences(one, other, allowed, where, what, range(len(one)), order, given.columns)


def mass_matrix_differences(expected: MassMatrix, given: MassMatrix, pointer: str) -> Iterator[Difference]:
    """EU-PRO-007, EU-PRO-009: where M differs, by more than 1e-8 of its largest entry."""
    yield from column_differences(expected.columns, given.columns, pointer + "/columns")
    order, width = _order(expected.columns, given.columns), len(given.columns)
    where, lengths = pointer + "/matrix", [len(row) for row in given.matrix]
    if lengths != [width] * width:
        yield Difference(where, [width] * width, lengths, "length of each row of M")
    elif order is not None:
        one, other = _matrix(expected.matrix, width), _matrix(given.matrix, width)[np.ix_(order, order)]
        near = TOLERANCE * float(np.abs(one).max(initial=0.0))
        yield from _entry_differences(one, other, near, where, "M", order, order, given.columns)


def column_differences(expected: Sequence[Column], given: Sequence[Column], pointer: str) -> Iterator[Difference]:
    """EU-PRO-007: every velocity is named once."""
    for column in dict.fromkeys(expected):
        if (count := given.count(column)) != 1:
            why = f"velocity {column[1]} of joint '{column[0]}' occurs {count} times"
            yield Difference(pointer, column, [column] * count if count else ABSENT, why)
    for index, column in enumerate(given):
        if column not in expected:
            yield Difference(pointer + step(index), ABSENT, column, f"joint '{column[0]}' has no velocity {column[1]}")


def _order(expected: Sequence[Column], given: Sequence[Column]) -> list[int] | None:
    """For each expected column its index among those given; None if the columns are not the same."""
    return [given.index(column) for column in expected] if sorted(expected) == sorted(given) else None


def _entry_differences(
    expected: Matrix,
    given: Matrix,
    near: float | Matrix,
    pointer: str,
    why: str,
    rows: Sequence[int],
    columns: Sequence[int],
    names: Sequence[Column],
) -> Iterator[Difference]:
    """One difference for a matrix, at its worst entry; ``rows`` and ``columns`` are the indices in the answer."""
    if agree(expected, given, near):
        return
    entry, off = worst(expected, given, near)
    row, column = divmod(entry, expected.shape[1])
    joint, index = names[columns[column]]
    yield Difference(
        pointer + step(rows[row]) + step(columns[column]),
        float(expected[row, column]),
        float(given[row, column]),
        f"{why}, row {rows[row]}, velocity {index} of joint '{joint}', {off}",
    )


def _matrix(rows: Sequence[Sequence[float]], width: int) -> Matrix:
    return np.array(rows, dtype=float).reshape(len(rows), width)
