"""A Python reader as a process: ``python -m eurdf_conformance.protocol.serve package.module:object``."""

from __future__ import annotations

import importlib
import json
import os
import sys
import traceback
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import IO, Any, Protocol, runtime_checkable

from pydantic import ValidationError

from eurdf_conformance.level import Level, Version
from eurdf_conformance.protocol.message import (
    PROTOCOL,
    REQUEST,
    Accepted,
    AnyAnswer,
    AnyRequest,
    Errored,
    Evaluate,
    Evaluated,
    Load,
    Quantity,
    Reader,
    Rejected,
    Skipped,
    Start,
    Started,
    Stop,
    Stopped,
    Unsupported,
    Values,
)

Configuration = Mapping[str, Sequence[float]]


class ReaderObject(Protocol):
    """A reader in Python; an `Evaluator` too, where it claims kinematics or dynamics."""

    @property
    def name(self) -> str:
        """What it is called."""

    @property
    def version(self) -> str:
        """Its own version."""

    @property
    def language(self) -> str:
        """The language it is written in."""

    @property
    def claims(self) -> Mapping[Version, Sequence[Level]]:
        """For each version of the format, the levels claimed."""

    def load(self, description: Path, urdf: Path) -> Accepted | Rejected | Unsupported | Skipped:
        """Read a robot; `protocol.reply` makes what it returns. An exception says that the reader failed."""


@runtime_checkable
class Evaluator(Protocol):
    """A reader that says where things are."""

    def evaluate(
        self, configurations: Sequence[Configuration], frames: Sequence[str], quantities: Sequence[Quantity]
    ) -> list[Values] | Unsupported | Skipped:
        """Of the robot accepted last: what is asked for, at each configuration."""


def serve(reader: ReaderObject, requests: Iterable[bytes], answers: IO[bytes]) -> None:
    """EU-PRO-001, EU-PRO-005: answer each request by one line, up to and with `stop`.

    Args:
        reader: Who answers.
        requests: Lines.
        answers: Where to write the lines that answer.
    """
    for line in requests:
        answer = _answer_to(reader, line)
        answers.write(_written(answer) + b"\n")
        answers.flush()
        if isinstance(answer, Stopped):
            return


def find_object(path: str) -> Any:
    """The object that ``package.module:object`` names; where it is a class, one of it.

    Raises:
        ImportError: There is no such module.
        AttributeError: The module has no such object.
    """
    module, _, name = path.partition(":")
    found: Any = importlib.import_module(module)
    for part in name.split("."):
        found = getattr(found, part)
    return found() if isinstance(found, type) else found


def main(path: str) -> None:
    """Serve an object over standard input and output, of which it gets neither.

    EU-PRO-002: what it, or a library below it, prints to standard output goes to standard error.
    """
    requests, answers = os.fdopen(os.dup(0), "rb"), os.fdopen(os.dup(1), "wb")
    nothing = os.open(os.devnull, os.O_RDONLY)
    os.dup2(nothing, 0)
    os.close(nothing)
    os.dup2(2, 1)
    sys.stdout = sys.stderr
    serve(find_object(path), requests, answers)


def _answer_to(reader: ReaderObject, line: bytes) -> AnyAnswer:
    try:
        request = REQUEST.validate_json(line)
    except ValidationError as error:
        return Errored(id=_id_in(line), message=f"no request of protocol {PROTOCOL}: {error}")
    return _answer(reader, request)


def _answer(reader: ReaderObject, request: AnyRequest) -> AnyAnswer:
    """The reader's answer; an exception is its word that it failed."""
    try:
        match request:
            case Start():
                who = Reader(name=reader.name, version=reader.version, language=reader.language)
                claims = {version: [Level(level) for level in levels] for version, levels in reader.claims.items()}
                return Started(id=request.id, protocol=PROTOCOL, reader=who, claims=claims)
            case Load():
                reply = reader.load(Path(request.description), Path(request.urdf))
                return reply.model_copy(update={"id": request.id})
            case Evaluate():
                return _evaluated(reader, request)
            case Stop():
                return Stopped(id=request.id)
    except Exception as error:
        traceback.print_exc()
        return Errored(id=request.id, message=f"{type(error).__name__}: {error}")


def _evaluated(reader: ReaderObject, request: Evaluate) -> AnyAnswer:
    if not isinstance(reader, Evaluator):
        return Unsupported(id=request.id, feature="evaluate")
    values = reader.evaluate(request.configurations, request.frames, request.quantities)
    if isinstance(values, Unsupported | Skipped):
        return values.model_copy(update={"id": request.id})
    return Evaluated(id=request.id, values=values)


def _written(answer: AnyAnswer) -> bytes:
    try:
        return answer.model_dump_json().encode()
    except ValueError as error:  # half a surrogate pair, which UTF-8 cannot say
        return Errored(id=answer.id, message=f"the answer cannot be written: {error}").model_dump_json().encode()


def _id_in(line: bytes) -> int:
    """The id of what is no request, as far as it has one."""
    try:
        given = json.loads(line)
    except (ValueError, RecursionError):
        return 0
    found = given.get("id") if isinstance(given, dict) else None
    return found if type(found) is int else 0


if __name__ == "__main__":
    main(sys.argv[1])
