"""Checks the shape of values: each frame, closure and velocity once, with the right number of numbers."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from eurdf_conformance.comparison.array import name_differences
from eurdf_conformance.comparison.columns import Column, column_differences
from eurdf_conformance.comparison.difference import ABSENT, Difference
from eurdf_conformance.json_pointer import step
from eurdf_conformance.oracle import OracleRobot
from eurdf_conformance.protocol.message import Jacobian, MassMatrix, Quantity, Values

#: In any unit: larger than any number of a mechanism; squares of larger numbers may overflow.
HUGE = 1e100


class WrongShape(Exception):  # noqa: N818 - it says what the values are
    """The values do not have the requested shape.

    Attributes:
        differences: Where they are not.
    """

    def __init__(self, differences: Sequence[Difference]) -> None:
        self.differences = tuple(differences)
        super().__init__("\n".join(map(str, differences)))


def shaped(
    values: Values, robot: OracleRobot, frames: Sequence[str], quantities: Sequence[Quantity], pointer: str
) -> Values:
    """The requested quantities, with their columns in the oracle's order.

    Args:
        values: As a parser gave them.
        robot: The robot.
        frames: The frames that were asked for.
        quantities: What was asked for.
        pointer: Where the values are in the answer.

    Raises:
        WrongShape: They are not of the shape asked for.
    """
    values = values.model_copy(update={name: None for name in Values.model_fields if name not in quantities})
    wrong = [*_differences(values, robot, frames, quantities), *_huge_numbers(values.model_dump(), "")]
    if wrong:
        raise WrongShape([each.within(pointer) for each in wrong])
    columns = robot.velocities
    ordered: dict[str, object] = {}
    if (K := values.jacobian) is not None:
        order = [K.columns.index(column) for column in columns]
        rows = {name: [[row[i] for i in order] for row in rows] for name, rows in K.rows.items()}
        ordered["jacobian"] = K.model_copy(update={"columns": columns, "rows": rows})
    if (M := values.mass_matrix) is not None:
        order = [M.columns.index(column) for column in columns]
        matrix = [[M.matrix[i][j] for j in order] for i in order]
        ordered["mass_matrix"] = M.model_copy(update={"columns": columns, "matrix": matrix})
    return values.model_copy(update=ordered)


def _differences(
    values: Values, robot: OracleRobot, frames: Sequence[str], quantities: Sequence[Quantity]
) -> Iterator[Difference]:
    weightless = not any(inertia.mass for inertia, _ in robot.masses)
    for quantity in quantities:
        if getattr(values, quantity) is None and not (quantity == "center_of_mass" and weightless):
            yield Difference(f"/{quantity}", quantity, ABSENT, f"{quantity} was requested but is missing")
    if values.poses is not None:
        yield from name_differences(dict.fromkeys(frames, "a pose"), values.poses, "/poses", "frame")
    rows = {name: len(sizes) for name, sizes in robot.row_sizes(1.0).items()}
    if values.residuals is not None:
        yield from _row_differences(rows, values.residuals, "/residuals")
    if values.jacobian is not None:
        yield from _jacobian_differences(values.jacobian, rows, robot.velocities)
    if values.mass_matrix is not None:
        yield from _mass_matrix_differences(values.mass_matrix, robot.velocities)


def _row_differences(rows: dict[str, int], given: dict[str, list[float]], pointer: str) -> Iterator[Difference]:
    yield from name_differences(rows, given, pointer, "closure")
    for name, count in rows.items():
        if name in given and len(given[name]) != count:
            yield Difference(pointer + step(name), count, len(given[name]), f"number of rows of closure '{name}'")


def _jacobian_differences(K: Jacobian, rows: dict[str, int], columns: Sequence[Column]) -> Iterator[Difference]:
    yield from column_differences(columns, K.columns, "/jacobian/columns")
    yield from name_differences(rows, K.rows, "/jacobian/rows", "closure")
    for name, count in rows.items():
        widths = [len(row) for row in K.rows.get(name, [])]
        if name in K.rows and widths != [len(columns)] * count:
            why = f"length of each row of K of closure '{name}'"
            yield Difference("/jacobian/rows" + step(name), [len(columns)] * count, widths, why)


def _mass_matrix_differences(M: MassMatrix, columns: Sequence[Column]) -> Iterator[Difference]:
    yield from column_differences(columns, M.columns, "/mass_matrix/columns")
    widths = [len(row) for row in M.matrix]
    if widths != [len(columns)] * len(columns):
        yield Difference("/mass_matrix/matrix", [len(columns)] * len(columns), widths, "length of each row of M")


def _huge_numbers(value: Any, pointer: str) -> Iterator[Difference]:
    if isinstance(value, dict):
        for name, each in value.items():
            yield from _huge_numbers(each, pointer + step(name))
    elif isinstance(value, list) and not _is_tame(value):
        for index, each in enumerate(value):
            yield from _huge_numbers(each, pointer + step(index))
    elif isinstance(value, float) and abs(value) > HUGE:
        yield Difference(pointer, f"at most {HUGE:g}", value, "the number is too large for any mechanism")


def _is_tame(values: list[Any]) -> bool:
    """Whether all entries are numbers and none is huge: a quick test that nearly every row passes."""
    return all(isinstance(each, float) and -HUGE <= each <= HUGE for each in values)
