"""One difference between an answer and the expectation."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum
from itertools import islice
from typing import Any, Final

from pydantic import BaseModel

from eurdf_conformance.visible import cut

#: Longest text of a value that is shown in one line.
_WIDTH = 200


class Absent(Enum):
    """Used in place of a value if there is none; null is a value."""

    ABSENT = "nothing"


ABSENT: Final = Absent.ABSENT


@dataclass(frozen=True, slots=True)
class Difference:
    """One difference between an answer and the expectation.

    Attributes:
        pointer: JSON pointer (RFC 6901) into the answer, of the value given, or of where it should be.
        expected: A JSON value, or `ABSENT`.
        given: A JSON value, or `ABSENT`.
        why: What is wrong, in words.
    """

    pointer: str
    expected: Any
    given: Any
    why: str

    def __str__(self) -> str:
        where = cut(self.pointer, _WIDTH) or "(the answer)"
        return f"{where}: {cut(self.why, _WIDTH)}: expected {shown(self.expected)}, got {shown(self.given)}"

    def within(self, pointer: str) -> Difference:
        """The same difference with a pointer into an answer that contains this one."""
        return Difference(pointer + self.pointer, self.expected, self.given, self.why)


def shown(value: Any) -> str:
    """A value on one line, cut if it is long."""
    if value is ABSENT:
        return "nothing"
    text = json.dumps(_beginning(plain(value)), ensure_ascii=False)
    return text if len(text) <= _WIDTH else text[: _WIDTH - 4] + " ..."


def _beginning(value: Any) -> Any:
    """A JSON value without what is not shown of it: the rest of long texts, and of long lists and mappings."""
    if isinstance(value, str):
        return value[: _WIDTH + 1]
    if isinstance(value, dict):
        return {_beginning(key): _beginning(each) for key, each in islice(value.items(), _WIDTH)}
    return [_beginning(each) for each in value[:_WIDTH]] if isinstance(value, list) else value


def plain(value: Any) -> Any:
    """A part of a message, or a list or mapping of parts, as a JSON value."""
    if isinstance(value, BaseModel):
        return value.model_dump(mode="json")
    if isinstance(value, dict):
        return {key: plain(each) for key, each in value.items()}
    if isinstance(value, Sequence) and not isinstance(value, str):
        return [plain(each) for each in value]
    return value
