"""Right answers with every change that the schema of a message allows."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, TypeVar

from pydantic import BaseModel, ValidationError

from eurdf_conformance.protocol.message import Accepted, Evaluated, Quantity
from eurdf_conformance.runner.in_process import InProcess
from eurdf_conformance.runner.outcome import Answered, Outcome
from parsers.oracle import OracleParser

#: The place of a value in an answer; None is any index of a list, or any name of a mapping from names.
Place = tuple[str | None, ...]
Spoil = tuple[Place, str]
Message = TypeVar("Message", bound=BaseModel)

LISTS: Mapping[str, Callable[[list[Any]], list[Any]]] = {
    "without the first": lambda items: items[1:],
    "without the last": lambda items: items[:-1],
    "with one twice": lambda items: [*items, *items[-1:]],
    "backwards": lambda items: items[::-1],
    "empty": lambda items: [],
}
MAPPINGS: Mapping[str, Callable[[dict[str, Any]], dict[str, Any]]] = {
    "without the first name": lambda named: dict(list(named.items())[1:]),
    "with a name more": lambda named: {**named, "nobody's": next(iter(named.values()), [])},
    "with a name for another": lambda named: {f"other/{name}" if i == 0 else name: x for i, (name, x) in pairs(named)},
    "with a name that is no pointer": lambda named: {"joints": {}, **{name[1:]: x for name, x in named.items()}},
    "empty": lambda named: {},
}
SCALARS: Mapping[str, Callable[[Any], Any]] = {
    "another name": lambda value: f"{value}'" if isinstance(value, str) else value,
    "no name": lambda value: "" if isinstance(value, str) else value,
    "one of another list": lambda value: {"fixed": "floating", "3d": "6d"}.get(str(value), "spherical"),
    "huge": lambda value: 1.7e308 if isinstance(value, int | float) else value,
    "huge and negative": lambda value: -1.7e308 if isinstance(value, int | float) else value,
    "one more": lambda value: value + 1 if isinstance(value, int | float) else value,
    "a list": lambda value: [value],
}


def pairs(named: dict[str, Any]) -> Iterator[tuple[int, tuple[str, Any]]]:
    return iter(enumerate(named.items()))


def ways(value: Any) -> Mapping[str, Callable[[Any], Any]]:
    """How a value can be spoiled in itself; null can replace any."""
    own: Mapping[str, Callable[[Any], Any]]
    own = LISTS if isinstance(value, list) else MAPPINGS if isinstance(value, dict) else SCALARS
    return {**own, "null": lambda value: None}


def spoils(messages: Sequence[BaseModel], part: int, parts: int) -> list[Spoil]:
    """One of some parts of all ways to spoil messages of one kind, one a place.

    What leaves each message as it was, or no message, is no way.
    """
    found = dict.fromkeys(spoil for message in messages for spoil in _spoils(message.model_dump(mode="json"), ()))
    chosen = list(found)[part % parts :: parts]
    return [spoil for spoil in chosen if any(spoiled(message, spoil) not in (None, message) for message in messages)]


def spoiled(message: Message, spoil: Spoil) -> Message | None:
    """A message that is spoiled; None where it is no message any more."""
    try:
        return type(message).model_validate_json(json.dumps(_spoiled(message.model_dump(mode="json"), *spoil)))
    except ValidationError:
        return None


def _spoils(value: Any, place: Place) -> Iterator[Spoil]:
    yield from ((place, way) for way in ways(value))
    if isinstance(value, dict):
        for name, each in value.items():
            # Members have names that the schema knows; what else has names is a mapping from them.
            yield from _spoils(each, (*place, name if name.isidentifier() and name in _MEMBERS else None))
    for each in value if isinstance(value, list) else ():
        yield from _spoils(each, (*place, None))


def _spoiled(value: Any, place: Place, way: str) -> Any:
    """Of several values at a place, one is spoiled: the first that can be."""
    if not place:
        return ways(value)[way](value) if way in ways(value) else value
    head, *rest = place
    if isinstance(value, dict):
        keys: Sequence[Any] = [head] if head is not None else list(value)
    else:
        keys = range(len(value)) if isinstance(value, list) else ()
    for key in keys:
        if isinstance(value, dict) and key not in value:
            continue
        if (other := _spoiled(value[key], tuple(rest), way)) != value[key]:
            if isinstance(value, dict):
                return {**value, key: other}
            return [*value[:key], other, *value[key + 1 :]]
    return value


def _members(kind: type[BaseModel]) -> set[str]:
    schema = kind.model_json_schema()
    parts = [schema, *schema.get("$defs", {}).values()]
    return {name for part in parts for name in part.get("properties", {})}


_MEMBERS = _members(Accepted) | _members(Evaluated)


class Remembering:
    """The oracle, which is asked each question once."""

    def __init__(self) -> None:
        self._parser = InProcess(OracleParser())
        self._answers: dict[object, Outcome] = {}
        self._loaded: tuple[Path, Path] | None = None
        self._files: object = None

    def load(self, description: Path, urdf: Path) -> Outcome:
        self._files, self._loaded = (description.read_bytes(), urdf.read_bytes()), (description, urdf)
        if self._files not in self._answers:
            self._answers[self._files] = self._parser.load(description, urdf)
        return self._answers[self._files]

    def evaluate(
        self,
        configurations: Sequence[Mapping[str, Sequence[float]]],
        frames: Sequence[str],
        quantities: Sequence[Quantity],
    ) -> Outcome:
        asked = (self._files, repr(configurations), tuple(frames), tuple(quantities))
        if asked not in self._answers:
            assert self._loaded is not None
            self._parser.load(*self._loaded)
            self._answers[asked] = self._parser.evaluate(configurations, frames, quantities)
        return self._answers[asked]

    @property
    def said(self) -> list[BaseModel]:
        """What it answered, without repeated ones: robots, and lists of values."""
        given = [outcome.answer for outcome in self._answers.values() if isinstance(outcome, Answered)]
        return [answer for answer in given if isinstance(answer, Accepted | Evaluated)]


class Spoiling:
    """One whose answers of one kind are spoiled in one way.

    Args:
        right: Who says what is right.
        kind: The kind of answer.
        spoil: The way.
        which: Of the answers of that kind, which are spoiled, the first one is 0; None for each.
    """

    def __init__(self, right: Remembering, kind: type[Accepted | Evaluated], spoil: Spoil, which: int | None) -> None:
        self._right, self._kind, self._spoil, self._which = right, kind, spoil, which
        self._count = 0

    def load(self, description: Path, urdf: Path) -> Outcome:
        return self._said(self._right.load(description, urdf))

    def evaluate(self, *asked: Any) -> Outcome:
        return self._said(self._right.evaluate(*asked))

    def _said(self, outcome: Outcome) -> Outcome:
        if not (isinstance(outcome, Answered) and isinstance(outcome.answer, self._kind)):
            return outcome
        self._count += 1
        if self._which not in (None, self._count - 1):
            return outcome
        answer = spoiled(outcome.answer, self._spoil)
        return outcome if answer is None else Answered(answer, outcome.seconds)
