"""The expectation for a parser on a valid case: `<name>.expected.json`."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated, Any

from pydantic import Field

from eurdf_conformance.corpus.content import Part
from eurdf_conformance.protocol.message import CanonicalRobot, Values

#: Values of these many levels of nesting below the top are on a line of their own.
_OPEN_LEVELS = 4


class Expected(Part):
    """The meaning of the two files of a valid case."""

    bodies: list[list[str]] = Field(description="For each body, the links that fixed or locked joints hold together.")
    robot: CanonicalRobot
    values: list[Values] = Field([], description="One a configuration of the case, in their order.")
    sizes: list[Annotated[float, Field(ge=0, allow_inf_nan=False)]] = Field(
        [], description="At each configuration the largest distance of two frames of the robot, m."
    )


def read_expected(path: Path) -> Expected:
    """Read an `expected.json`.

    Raises:
        pydantic.ValidationError: It is none.
    """
    return Expected.model_validate_json(path.read_bytes())


def expected_text(expected: Expected) -> str:
    """The text of an `expected.json`: one line per joint, pose and row of a matrix."""
    return _text(expected.model_dump(mode="json", exclude_none=False), 0) + "\n"


def _text(value: Any, depth: int) -> str:
    if isinstance(value, dict | list) and value and depth < _OPEN_LEVELS and not _is_flat(value):
        pad, end = "  " * (depth + 1), "  " * depth
        if isinstance(value, dict):
            inside = [
                f"{pad}{json.dumps(key, ensure_ascii=False)}: {_text(each, depth + 1)}" for key, each in value.items()
            ]
            return "{\n" + ",\n".join(inside) + f"\n{end}}}"
        return "[\n" + ",\n".join(pad + _text(each, depth + 1) for each in value) + f"\n{end}]"
    return json.dumps(value, ensure_ascii=False)


def _is_flat(value: dict[str, Any] | list[Any]) -> bool:
    """Whether it contains only numbers and words, or only lists and mappings of them: a pose, a joint."""
    inside = list(value.values() if isinstance(value, dict) else value)
    return all(not isinstance(each, dict | list) for each in inside)
