"""Results as values of JSON, and what their JSON Schema, made of their fields, says of a value beside its type."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import fields, is_dataclass
from typing import Annotated, Any

from eurdf.diagnostics.wording import encodable


class Keywords:
    """Keywords of JSON Schema, in the annotation of a field; None removes one, a function gives its value."""

    def __init__(self, **keywords: Any) -> None:
        self.keywords = keywords

    def __get_pydantic_json_schema__(self, schema: Any, handler: Callable[[Any], dict[str, Any]]) -> dict[str, Any]:
        """Pydantic asks for them; an annotation with its own would import it, which a command does without."""
        keywords = {name: value() if callable(value) else value for name, value in self.keywords.items()}
        return {name: value for name, value in {**handler(schema), **keywords}.items() if value is not None}


class Values:
    """The keywords of an array of NumPy, in the annotation of a field: what JSON has is a list of lists.

    Args:
        dimensions: How many the array has; 0 if that differs.
        last: Its last dimension, if it is the same everywhere.
    """

    def __init__(self, dimensions: int, last: int | None = None) -> None:
        self.dimensions, self.last = dimensions, last

    def __get_pydantic_json_schema__(self, schema: Any, handler: Callable[[Any], dict[str, Any]]) -> dict[str, Any]:
        """Pydantic asks for them."""
        if not self.dimensions:
            return {"type": "array", "items": {}}
        number = {"type": "number"}
        found: dict[str, Any] = {"type": "array", "items": number}
        if self.last is not None:
            found = {"type": "array", "minItems": self.last, "maxItems": self.last, "prefixItems": [number] * self.last}
        for _ in range(self.dimensions - 1):
            found = {"type": "array", "items": found}
        return found


#: Arrays (n,), (n, m) and (n, 2).
ROW, ROWS, PAIRS = Values(1), Values(2), Values(2, 2)

#: An array of any dimensions.
LISTS = Values(0)

#: The metadata of a field that is left out of JSON.
HIDDEN = {"exclude": True}

#: A number of things.
Count = Annotated[int, Keywords(minimum=0)]

#: A number that is null in JSON where it is not finite.
NullIfInfinite = Annotated[float, Keywords(type=None, anyOf=[{"type": "number"}, {"type": "null"}])]


def to_json(result: Any) -> Any:
    """A result, or part of one, as a value of JSON: what is not finite is null, and hidden fields are left out."""
    if is_dataclass(result):
        shown = (field.name for field in fields(result) if not field.metadata.get("exclude"))
        return {name: to_json(getattr(result, name)) for name in shown}
    if isinstance(result, str):
        return encodable(str(result))
    if isinstance(result, float):
        return float(result) if math.isfinite(result) else None
    if hasattr(result, "tolist"):  # an array
        return to_json(result.tolist())
    if isinstance(result, Mapping):
        return {key: to_json(value) for key, value in result.items()}
    return [to_json(value) for value in result] if isinstance(result, (list, tuple)) else result
