"""A wrong parser, and how to make one: what it reads, what it means, what it answers.

A module of this package has tables with the names of `MAKERS`. A key is the clause that is violated; with it may be
the versions of the format, the level or the verdict, if they are not those of the clause. A row is a sentence that says
what is wrong, which no other mutant has, and how: a deviation.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, ExitStack, contextmanager
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any
from unittest.mock import patch

from lxml import etree

from eurdf_conformance.adapters.reference import Reference
from eurdf_conformance.corpus.clause import read_clauses
from eurdf_conformance.corpus.coverage import said_in
from eurdf_conformance.judging.verdict import Verdict
from eurdf_conformance.level import VERSIONS, Level, Version
from eurdf_conformance.oracle import NotRead, OracleRobot, read
from eurdf_conformance.oracle.yaml_text import value_of
from eurdf_conformance.protocol.message import Accepted, CanonicalRobot, Issue, Rejected, Values
from eurdf_conformance.protocol.reply import accepted, rejected

Answer = Accepted | Rejected
Deviation = AbstractContextManager[Any]
Members = dict[str, Any]


@dataclass(frozen=True)
class Mutant:
    """A parser with one thing wrong.

    Attributes:
        clause: The clause that it violates.
        breaks: What is wrong, as a sentence.
        parser: Makes the parser, with nothing loaded.
        level: The level at which it must be caught.
        versions: The versions of the format in which it must be caught.
        verdicts: What counts as caught.
    """

    clause: str
    breaks: str
    parser: Callable[[], Any]
    level: Level
    versions: tuple[Version, ...]
    verdicts: frozenset[Verdict]


def mutants_of(module: Any) -> Iterator[Mutant]:
    """The rows of all tables of a module."""
    for name, make in MAKERS.items():
        for key, rows in getattr(module, name, {}).items():
            clause, *stated = (key,) if isinstance(key, str) else key
            defined = read_clauses()[clause]
            level = next((each for each in stated if isinstance(each, Level)), Level(defined.level))
            versions = tuple(each for each in stated if each in VERSIONS) or said_in(defined)
            verdicts = {each for each in stated if isinstance(each, Verdict)} or {Verdict.FAILED}
            for breaks, deviation in rows.items():
                yield Mutant(clause, breaks, partial(make, deviation), level, versions, frozenset(verdicts))


# -- What is read -----------------------------------------------------------------------------------------------------


class _Misreading(Reference):
    """Reads other texts than those of the files; a change that gives none leaves the file as it is."""

    def __init__(self, *changes: Callable[[str], str | None] | None) -> None:
        super().__init__()
        self._changes = changes

    def load(self, *files: Path) -> Answer:
        with TemporaryDirectory() as folder:
            return super().load(*map(partial(_rewritten, Path(folder)), files, self._changes))


def _rewritten(folder: Path, path: Path, change: Callable[[str], str | None] | None) -> Path:
    try:
        text = path.read_bytes().decode()
    except (OSError, UnicodeDecodeError):
        return path
    if change is None or (other := change(text)) in (None, text):
        return path
    (folder / path.name).write_bytes(other.encode("utf-8", "surrogatepass"))
    return folder / path.name


def _with_data(change: Callable[[Members], None], source: str) -> str | None:
    try:
        data = value_of(source.removeprefix("\ufeff"))
    except (NotRead, RecursionError):
        return None
    if not isinstance(data, dict):
        return None
    before = json.dumps(data)
    change(data)
    return None if (after := json.dumps(data)) == before else after


def _with_elements(change: Callable[[Any], None], source: str) -> str | None:
    try:
        root = etree.fromstring(source.encode())
    except etree.XMLSyntaxError:
        return None
    before = etree.tostring(root)
    change(root)
    after = etree.tostring(root)
    return None if after == before else after.decode()


# -- What is answered -------------------------------------------------------------------------------------------------


class _Answering(Reference):
    """Answers `load` with something else."""

    def __init__(self, change: Callable[[Answer, Path, Path], Any]) -> None:
        super().__init__()
        self._change = change

    def load(self, description: Path, urdf: Path) -> Any:
        return self._change(super().load(description, urdf), description, urdf)


def _describing(change: Callable[[CanonicalRobot], Members]) -> _Answering:
    def answer(right: Answer, *_: Path) -> Answer:
        if not isinstance(right, Accepted) or right.robot is None:
            return right
        return right.model_copy(update={"robot": right.robot.model_copy(update=change(right.robot))})

    return _Answering(answer)


def _reporting(change: Callable[[list[Issue], Path, Path], list[Issue]]) -> _Answering:
    return _Answering(lambda right, *files: right.model_copy(update={"issues": change(right.issues, *files)}))


def _refusing(where: Callable[[Members, Any], Any]) -> _Answering:
    return _Answering(
        rejecting(lambda description, urdf: where(value_of(text_of(description)), etree.parse(urdf).getroot()))
    )


class _Evaluating(Reference):
    """Answers `evaluate` with other values."""

    def __init__(self, change: Callable[[Values], Members]) -> None:
        super().__init__()
        self._change = change

    def evaluate(self, *request: Any) -> list[Values]:
        found = super().evaluate(*request)
        return [
            values.model_copy(update={k: v for k, v in self._change(values).items() if getattr(values, k) is not None})
            for values in found
        ]


# -- What is meant ----------------------------------------------------------------------------------------------------


class _Misunderstanding(Reference):
    """Gives one thing another meaning: a deviating oracle describes and evaluates what the reference accepts."""

    def __init__(self, deviation: Deviation | tuple[Deviation, ...]) -> None:
        super().__init__()
        self._deviations = deviation if isinstance(deviation, tuple) else (deviation,)
        self._understood: OracleRobot | None = None

    @contextmanager
    def _deviating(self) -> Iterator[None]:
        with ExitStack() as stack:
            for each in self._deviations:
                stack.enter_context(each)
            yield

    def load(self, description: Path, urdf: Path) -> Answer:
        right = super().load(description, urdf)
        if isinstance(right, Rejected):
            return right
        with self._deviating():
            try:
                self._understood = read(description, urdf)
            except NotRead as error:
                return rejected(str(error))
            return right.model_copy(update={"robot": self._understood.canonical()})

    def evaluate(
        self, configurations: Sequence[Mapping[str, Sequence[float]]], frames: Sequence[str], quantities: Sequence[Any]
    ) -> list[Values]:
        assert self._understood is not None
        with self._deviating():
            return [self._understood.evaluate(q, frames, quantities) for q in configurations]


#: How a parser is made of a deviation, by the name of the table that has it.
MAKERS: dict[str, Callable[[Any], Reference]] = {
    # f(text) -> text
    "READS_YAML": lambda change: _Misreading(change, None),
    "READS_XML": lambda change: _Misreading(None, change),
    # f(data of the description, or root element of the URDF), which changes it in place
    "READS_DESCRIPTION": lambda change: _Misreading(partial(_with_data, change), None),
    "READS_URDF": lambda change: _Misreading(None, partial(_with_elements, change)),
    # f(answer, description, urdf) -> another answer; the reference gives what it is called with
    "ANSWERS": _Answering,
    # f(robot) -> the members of the canonical description that differ
    "DESCRIBES": _describing,
    # f(issues, description, urdf) -> other issues
    "REPORTS": _reporting,
    # f(data of the description, root element of the URDF) -> whether to reject what is valid
    "REFUSES": _refusing,
    # f(values) -> the quantities that differ
    "EVALUATES": _Evaluating,
    # a deviation of the oracle, or several: `instead`, or a patch
    "MEANS": _Misunderstanding,
}


# -- Deviations -------------------------------------------------------------------------------------------------------


def instead(owner: Any, name: str, other: Callable[..., Any]) -> Deviation:
    """A function of the oracle is another, which gets the right one before its arguments."""
    right = getattr(owner, name)
    return patch.object(owner, name, lambda *arguments, **named: other(right, *arguments, **named))


def text_of(path: Path) -> str:
    """The text of a file; empty if there is none."""
    return path.read_bytes().decode("utf-8-sig", "replace") if path.is_file() else ""


def rejecting(where: Callable[[Path, Path], Any]) -> Callable[..., Answer]:
    """What is valid is rejected in some files."""

    def answer(right: Answer, *files: Path) -> Answer:
        return rejected("this is not supported") if isinstance(right, Accepted) and where(*files) else right

    return answer


def accepting(code: str, where: Callable[[Issue, Path, Path], Any] = lambda *_: True) -> Callable[..., Answer]:
    """What must be rejected with a code is accepted, if there are no other errors, and where that is so of each."""

    def answer(right: Answer, *files: Path) -> Answer:
        errors = [issue for issue in right.issues if issue.severity == "error"]
        wrong = isinstance(right, Rejected) and all(issue.code == code and where(issue, *files) for issue in errors)
        return accepted() if wrong else right

    return answer


def silent(code: str, where: Callable[[Issue, Path, Path], Any] = lambda *_: True) -> Callable[..., list[Issue]]:
    """Issues of a code are not reported, where that is so of one."""
    return lambda found, *files: [each for each in found if each.code != code or not where(each, *files)]
