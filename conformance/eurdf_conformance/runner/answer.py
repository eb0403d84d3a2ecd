"""Reads a line of standard output as the answer to a request."""

from __future__ import annotations

import json
from typing import Any, TypeVar

from pydantic import ValidationError

from eurdf_conformance.protocol.error_text import error_text
from eurdf_conformance.protocol.json_text import Doubled, may_have_errors, read_json
from eurdf_conformance.protocol.message import (
    ANSWER,
    NO_ANSWER,
    Accepted,
    AnyAnswer,
    AnyRequest,
    Errored,
    Evaluate,
    Evaluated,
    Rejected,
    Skipped,
    Started,
    Stop,
    Unsupported,
    Value,
)
from eurdf_conformance.runner.outcome import Malformed, Misplaced
from eurdf_conformance.visible import LONGEST, LONGEST_NAME, cut

#: Number of characters kept of a line that is not an answer.
SHOWN = 2000

_Value = TypeVar("_Value", bound=Value)

_ANY_TIME = ("unsupported", "skipped", "errored")


def read_answer(line: bytes, request: AnyRequest) -> AnyAnswer | Malformed | Misplaced:
    """Read a line as the answer to one request.

    Args:
        line: Without the line feed that ends it.
        request: What was asked.
    """
    try:
        answer = ANSWER.validate_json(line)
    except ValidationError as error:
        return _unfit(line, request, error)
    if may_have_errors(line, answer):  # pydantic takes the last of two values, and NaN where any value is allowed
        value, found = read_json(line)
        if found:
            return _elsewhere(value, line, request) or Malformed(shown(line), found[0], placed=True)
    return _placed(answer, line, request)


def shown(line: bytes) -> str:
    """The beginning of a line as text."""
    text = line[: 4 * SHOWN].decode("utf-8", "backslashreplace")
    return text if len(text) <= SHOWN and len(line) <= 4 * SHOWN else f"{text[:SHOWN]}… ({len(line):,} bytes)"


def _bounded(answer: AnyAnswer) -> AnyAnswer:
    """The answer with its texts for people cut where they are long."""
    match answer:
        case Accepted(issues=issues) | Rejected(issues=issues):
            return answer.model_copy(update={"issues": [_cut(issue, "message") for issue in issues]})
        case Errored():
            return _cut(answer, "message")
        case Skipped():
            return _cut(answer, "reason")
        case Unsupported():
            return _cut(answer, "feature", "reason")
        case Started(parser=parser):
            names = {name: cut(text, LONGEST_NAME) for name, text in parser.model_dump().items()}
            return answer.model_copy(update={"parser": parser.model_copy(update=names)})
    return answer


def _cut(value: _Value, *members: str) -> _Value:
    """A part of a message with some of its texts cut where they are long."""
    if all(len(getattr(value, name)) <= LONGEST for name in members):
        return value
    return value.model_copy(update={name: cut(getattr(value, name)) for name in members})


def _placed(answer: AnyAnswer, line: bytes, request: AnyRequest) -> AnyAnswer | Malformed | Misplaced:
    """The answer, if its kind and size fit the request."""
    if answer.id != request.id:
        return Misplaced(shown(line), request.id, answer.id)
    allowed = request.outcomes if isinstance(request, Stop) else (*request.outcomes, *_ANY_TIME)
    if answer.outcome not in allowed:
        return Malformed(shown(line), f"'{answer.outcome}' is not an answer to '{request.command}'", placed=True)
    if isinstance(answer, Evaluated) and isinstance(request, Evaluate):
        given, asked = len(answer.values), len(request.configurations)
        if given != asked:
            return Malformed(shown(line), f"values at {given} configurations, expected {asked}", placed=True)
    return _bounded(answer)


def _unfit(line: bytes, request: AnyRequest, error: ValidationError) -> AnyAnswer | Malformed | Misplaced:
    """Why a line fits no schema of an answer, or the answer if it fits one after normalization."""
    try:
        value, found = read_json(line)
    except (ValueError, RecursionError) as why:
        return Malformed(shown(line), _reason(why))
    if not isinstance(value, dict):
        return Malformed(shown(line), "a JSON value that is not an object")
    if elsewhere := _elsewhere(value, line, request):
        return elsewhere
    if found:
        return Malformed(shown(line), found[0], placed=True)
    if isinstance(why_not := value.get(NO_ANSWER), str):
        words = " ".join(why_not.split()).encode("utf-8", "backslashreplace")
        return Malformed("", shown(words), placed=True)  # the line says no more
    # 2.0 is a whole number in JSON Schema, and some libraries have no others.
    try:
        return _placed(ANSWER.validate_json(json.dumps(_whole(value))), line, request)
    except (ValidationError, RecursionError):
        return Malformed(shown(line), f"schema violation: {error_text(error, skip=1)}", placed=True)


def _elsewhere(value: dict[str, Any], line: bytes, request: AnyRequest) -> Malformed | Misplaced | None:
    """Why an object is no answer to the request: it has no id, two ids, or another request's id."""
    if isinstance(value, Doubled) and "id" in value.keys_twice:
        return Malformed(shown(line), "duplicate key 'id'")
    given_id = value.get("id")
    if isinstance(given_id, float) and given_id.is_integer():
        given_id = int(given_id)
    if not isinstance(given_id, int) or isinstance(given_id, bool):
        return Malformed(shown(line), "the 'id' of the request, an integer, is missing")
    return None if given_id == request.id else Misplaced(shown(line), request.id, given_id)


def _whole(value: Any) -> Any:
    if isinstance(value, float) and value.is_integer():
        return int(value)
    if isinstance(value, list):
        return [_whole(item) for item in value]
    if isinstance(value, dict):
        return {key: _whole(item) for key, item in value.items()}
    return value


def _reason(why: Exception) -> str:
    match why:
        case UnicodeDecodeError():
            return f"not UTF-8, from byte {why.start + 1} on"
        case json.JSONDecodeError():
            if why.doc.startswith("\ufeff"):
                return "it begins with a byte order mark, which JSON does not allow"
            return f"not JSON: {why.msg} at character {why.pos + 1}"
        case RecursionError():
            return "JSON nested too deep"
        case _:
            return str(why)
