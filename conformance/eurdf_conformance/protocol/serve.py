"""A Python parser as a process: ``python -m eurdf_conformance.protocol.serve package.module:object``."""

from __future__ import annotations

import importlib
import inspect
import json
import os
import sys
import traceback
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Any, Protocol, runtime_checkable

from pydantic import ValidationError

from eurdf_conformance.feature import Feature
from eurdf_conformance.level import Level, Version
from eurdf_conformance.protocol import message
from eurdf_conformance.protocol.error_text import error_text
from eurdf_conformance.protocol.json_text import may_have_errors, read_json
from eurdf_conformance.protocol.message import (
    NO_ANSWER,
    PROTOCOL,
    REQUEST,
    Accepted,
    Answer,
    AnyAnswer,
    AnyRequest,
    Errored,
    Evaluate,
    Evaluated,
    Load,
    ParserInfo,
    Quantity,
    Rejected,
    Skipped,
    Start,
    Started,
    Stop,
    Stopped,
    Unsupported,
    Value,
    Values,
)
from eurdf_conformance.protocol.python_parser import described, parser_error
from eurdf_conformance.protocol.reply import WrongReply

Configuration = Mapping[str, Sequence[float]]


class PythonParser(Protocol):
    """A parser in Python. It is also an `Evaluator` if it claims kinematics or dynamics.

    If it lacks features of the format, an attribute `lacks` lists them.
    """

    @property
    def name(self) -> str:
        """Name of the parser."""

    @property
    def version(self) -> str:
        """Version of the parser."""

    @property
    def language(self) -> str:
        """The language that the parser is written in."""

    @property
    def claims(self) -> Mapping[Version, Sequence[Level]]:
        """For each version of the format, the levels claimed."""

    def load(self, description: Path, urdf: Path) -> Accepted | Rejected | Unsupported | Skipped:
        """Read a robot and return an answer made by `protocol.reply`. An exception means that the parser failed."""


@runtime_checkable
class Evaluator(Protocol):
    """A parser that computes poses and other quantities."""

    def evaluate(
        self, configurations: Sequence[Configuration], frames: Sequence[str], quantities: Sequence[Quantity]
    ) -> list[Values] | Unsupported | Skipped:
        """The requested quantities of the robot of the last `load`, which was accepted, at each configuration."""


def serve(parser: PythonParser, requests: Iterable[bytes], answers: IO[bytes]) -> None:
    """EU-PRO-001, EU-PRO-005: answer each request by one line, up to and including `stop`.

    Args:
        parser: The parser.
        requests: Lines with requests.
        answers: The file that gets the lines with answers.
    """
    for line in requests:
        answer = _answer_to(parser, line)
        answers.write(_written(answer) + b"\n")
        answers.flush()
        if isinstance(answer, Stopped):
            return


class NoParser(Exception):  # noqa: N818 - it says what there is not
    """The parser does not exist; the text gives the reason."""


def find_object(path: str) -> Any:
    """The object that ``package.module:object`` names, or an instance if it is a class.

    Raises:
        NoParser: The module or the object does not exist, or the class needs arguments.
    """
    module, _, name = path.partition(":")
    try:
        found: Any = importlib.import_module(module)
    except ModuleNotFoundError as error:
        missing = error.name or ""
        if not f"{module}.".startswith(f"{missing}."):
            raise  # what the module imports is missing
        where = f"neither in the working folder, {Path.cwd()}, nor in PYTHONPATH, nor installed for {sys.executable}"
        raise NoParser(f"no module '{missing}': it is {where}") from None
    for part in name.split("."):
        if not hasattr(found, part):
            raise NoParser(f"{module} has no '{name}'")
        found = getattr(found, part)
    if not isinstance(found, type):
        return found
    try:
        inspect.signature(found).bind()
    except TypeError:
        raise NoParser(f"the class {path} needs arguments; name an instance instead") from None
    except ValueError:  # the signature is unknown
        pass
    return found()


def main(path: str) -> None:
    """Serve an object over standard input and output, which the object itself cannot use.

    EU-PRO-002: what the object or a library prints to standard output goes to standard error. If the object is not a
    parser, the process ends at once with a message there.
    """
    requests, answers = os.fdopen(os.dup(0), "rb"), os.fdopen(os.dup(1), "wb")
    nothing = os.open(os.devnull, os.O_RDONLY)
    os.dup2(nothing, 0)
    os.close(nothing)
    os.dup2(2, 1)
    sys.stdout = sys.stderr
    try:
        parser = find_object(path)
        problem = parser_error(parser)
    except NoParser as why:
        sys.exit(str(why))
    except Exception as error:
        _print_traceback(error)
        sys.exit(1)
    if problem:
        sys.exit(f"{path} is not a parser: {problem}")
    serve(parser, requests, answers)


@dataclass(frozen=True)
class _NoAnswer:
    """The adapter returned no valid answer to the request with this id; `why` gives the reason."""

    id: int
    why: str


def _answer_to(parser: PythonParser, line: bytes) -> AnyAnswer | _NoAnswer:
    try:
        request = REQUEST.validate_json(line)
    except ValidationError as error:
        return Errored(id=_id_in(line), message=f"not a request of protocol {PROTOCOL}: {error_text(error)}")
    if may_have_errors(line, request) and (found := read_json(line)[1]):
        return Errored(id=request.id, message=f"not a request of protocol {PROTOCOL}: {found[0]}")
    return _answer(parser, request)


def _answer(parser: PythonParser, request: AnyRequest) -> AnyAnswer | _NoAnswer:
    """The parser's answer. An exception means that the parser failed, or that the adapter is wrong."""
    try:
        match request:
            case Start():
                who = ParserInfo(name=parser.name, version=parser.version, language=parser.language)
                claims = {version: [Level(level) for level in levels] for version, levels in parser.claims.items()}
                lacks = [Feature(feature) for feature in getattr(parser, "lacks", ())]
                return Started(id=request.id, protocol=PROTOCOL, parser=who, claims=claims, lacks=lacks)
            case Load():
                reply = parser.load(Path(request.description), Path(request.urdf))
                return _with_id(reply, request, "use accepted, rejected, unsupported or skipped")
            case Evaluate():
                return _evaluated(parser, request)
            case Stop():
                return Stopped(id=request.id)
    except Exception as error:
        _print_traceback(error)
        if isinstance(error, WrongReply):
            return _NoAnswer(request.id, str(error))
        if isinstance(error, ValidationError) and error.title in _PARTS:
            return _NoAnswer(request.id, f"{error.title}: {error_text(error)}")
        return Errored(id=request.id, message=f"{type(error).__name__}: {error}")


def _evaluated(parser: PythonParser, request: Evaluate) -> AnyAnswer | _NoAnswer:
    if not isinstance(parser, Evaluator):
        return Unsupported(id=request.id, feature="evaluate")
    values = parser.evaluate(request.configurations, request.frames, request.quantities)
    if isinstance(values, list):
        return Evaluated(id=request.id, values=values)
    return _with_id(values, request, "give a list of Values, one a configuration, or use unsupported or skipped")


def _with_id(reply: Any, request: Load | Evaluate, what_to_do: str) -> AnyAnswer | _NoAnswer:
    """What a method returned, as the answer to a request."""
    if isinstance(reply, Answer):
        answer: AnyAnswer = reply.model_copy(update={"id": request.id})  # type: ignore[assignment]
        return answer
    why = f"{request.command} returned {described(reply)}; {what_to_do} of eurdf_conformance.protocol.reply"
    return _NoAnswer(request.id, why)


def _written(answer: AnyAnswer | _NoAnswer) -> bytes:
    if isinstance(answer, _NoAnswer):
        return json.dumps({"id": answer.id, NO_ANSWER: answer.why}).encode()
    try:
        return answer.model_dump_json().encode()
    except ValueError as error:  # a lone surrogate, which UTF-8 cannot represent
        return Errored(id=answer.id, message=f"the answer cannot be written: {error}").model_dump_json().encode()


def _print_traceback(error: Exception) -> None:
    """Write the traceback to the log, without the frames of this file."""
    trace = error.__traceback__
    ours = (__file__, importlib.__file__, "<frozen importlib._bootstrap>", "<frozen importlib._bootstrap_external>")
    while trace is not None and trace.tb_frame.f_code.co_filename in ours:
        trace = trace.tb_next
    traceback.print_exception(error.with_traceback(trace))


def _id_in(line: bytes) -> int:
    """The id of an invalid request; 0 if it has none."""
    try:
        given = json.loads(line)
    except (ValueError, RecursionError):
        return 0
    found = given.get("id") if isinstance(given, dict) else None
    return found if type(found) is int else 0


#: Names of the classes that an adapter may construct; pydantic's errors name them.
_PARTS = {name for name, found in vars(message).items() if isinstance(found, type) and issubclass(found, Value)}


if __name__ == "__main__":
    main(sys.argv[1])
