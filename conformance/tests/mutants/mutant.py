"""A wrong parser, and how to make one: what it reads, what it means, what it answers."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any
from unittest.mock import patch

from lxml import etree

from eurdf_conformance.adapters.reference import Reference
from eurdf_conformance.corpus.clause import read_clauses
from eurdf_conformance.corpus.coverage import said_in
from eurdf_conformance.judging.verdict import Verdict
from eurdf_conformance.level import Level, Version
from eurdf_conformance.oracle import NotRead, OracleRobot, read
from eurdf_conformance.oracle.yaml_text import value_of
from eurdf_conformance.protocol.message import Accepted, CanonicalRobot, Issue, Rejected, Values
from eurdf_conformance.protocol.reply import rejected

Answer = Accepted | Rejected
Deviation = AbstractContextManager[Any]
Members = dict[str, Any]


@dataclass(frozen=True)
class Mutant:
    """A parser with one thing wrong.

    Attributes:
        clause: The clause that it violates.
        breaks: What is wrong, as a sentence; no other mutant has the same.
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


#: All mutants, by what is wrong. Each module of this package adds its own.
MUTANTS: dict[str, Mutant] = {}


def add(
    clause: str,
    breaks: str,
    parser: Callable[[], Any],
    *,
    level: Level | None = None,
    versions: tuple[Version, ...] | None = None,
    verdict: Verdict = Verdict.FAILED,
) -> None:
    """Add a mutant. Level and versions are those of its clause, unless stated."""
    breaks = " ".join(breaks.split())
    assert breaks not in MUTANTS, f"two mutants are wrong alike: {breaks}"
    stated = read_clauses()[clause]
    MUTANTS[breaks] = Mutant(
        clause,
        breaks,
        parser,
        level or Level(stated.level),
        versions or said_in(stated),
        frozenset({verdict}),
    )


Register = Callable[..., Any]


def _mutant(clause: str, make: Callable[[Callable[..., Any]], Any], **stated: Any) -> Register:
    """Adds mutants of a clause: ``wrong(sentence, deviation)``, or as a decorator of a deviation with a docstring."""

    def register(*row: Any) -> Any:
        breaks, deviate = row if len(row) == 2 else (row[0].__doc__ or "", row[0])
        add(clause, breaks, lambda: make(deviate), **stated)
        return deviate

    return register


class _Misreading(Reference):
    """Reads other files than it is given."""

    def __init__(self, change: Callable[[Path, Path, Path], tuple[Path, Path]]) -> None:
        super().__init__()
        self._change = change

    def load(self, description: Path, urdf: Path) -> Answer:
        with TemporaryDirectory() as folder:
            return super().load(*self._change(description, urdf, Path(folder)))


def _rewritten(path: Path, folder: Path, change: Callable[[str], str | None]) -> Path:
    """A copy of a file with another text; the file itself if it cannot be read, or is not changed."""
    try:
        text = path.read_bytes().decode()
    except (OSError, UnicodeDecodeError):
        return path
    if (other := change(text)) in (None, text):
        return path
    copy = folder / path.name
    copy.write_bytes(other.encode("utf-8", "surrogatepass"))
    return copy


def reads_yaml(clause: str, **stated: Any) -> Register:
    """A mutant that reads another text of the description: f(text) -> text."""

    def make(change: Callable[[str], str | None]) -> _Misreading:
        return _Misreading(lambda description, urdf, folder: (_rewritten(description, folder, change), urdf))

    return _mutant(clause, make, **stated)


def reads_description(clause: str, **stated: Any) -> Register:
    """A mutant that changes the data of the description, which is valid YAML: f(data), in place."""

    def make(change: Callable[[Members], None]) -> _Misreading:
        def text(source: str) -> str | None:
            try:
                data = value_of(source.removeprefix("\ufeff"))
            except (NotRead, RecursionError):
                return None
            if not isinstance(data, dict):
                return None
            before = json.dumps(data)
            change(data)
            return None if (after := json.dumps(data)) == before else after

        return _Misreading(lambda description, urdf, folder: (_rewritten(description, folder, text), urdf))

    return _mutant(clause, make, **stated)


def reads_xml(clause: str, **stated: Any) -> Register:
    """A mutant that reads another text of the URDF: f(text) -> text."""

    def make(change: Callable[[str], str]) -> _Misreading:
        return _Misreading(lambda description, urdf, folder: (description, _rewritten(urdf, folder, change)))

    return _mutant(clause, make, **stated)


def reads_urdf(clause: str, **stated: Any) -> Register:
    """A mutant that changes the elements of the URDF, which is well-formed XML: f(robot), in place."""

    def make(change: Callable[[Any], None]) -> _Misreading:
        def text(source: str) -> str | None:
            try:
                root = etree.fromstring(source.encode())
            except etree.XMLSyntaxError:
                return None
            before = etree.tostring(root)
            change(root)
            after = etree.tostring(root)
            return None if after == before else after.decode()

        return _Misreading(lambda description, urdf, folder: (description, _rewritten(urdf, folder, text)))

    return _mutant(clause, make, **stated)


class _Answering(Reference):
    """Answers `load` with something else."""

    def __init__(self, change: Callable[[Answer, Path, Path], Any]) -> None:
        super().__init__()
        self._change = change

    def load(self, description: Path, urdf: Path) -> Any:
        return self._change(super().load(description, urdf), description, urdf)


def answers(clause: str, **stated: Any) -> Register:
    """A mutant that answers `load` with something else: f(answer, description, urdf) -> answer."""
    return _mutant(clause, _Answering, **stated)


def describes(clause: str, **stated: Any) -> Register:
    """A mutant that answers with another canonical description: f(robot) -> the members that differ."""

    def make(change: Callable[[CanonicalRobot], Members]) -> _Answering:
        def answer(right: Answer, *_: Path) -> Answer:
            if not isinstance(right, Accepted) or right.robot is None:
                return right
            return right.model_copy(update={"robot": right.robot.model_copy(update=change(right.robot))})

        return _Answering(answer)

    return _mutant(clause, make, **stated)


def reports(clause: str, **stated: Any) -> Register:
    """A mutant that reports other issues: f(issues, description, urdf) -> issues."""

    def make(change: Callable[[list[Issue], Path, Path], list[Issue]]) -> _Answering:
        def answer(right: Answer, description: Path, urdf: Path) -> Answer:
            return right.model_copy(update={"issues": change(right.issues, description, urdf)})

        return _Answering(answer)

    return _mutant(clause, make, **stated)


def refuses(clause: str, **stated: Any) -> Register:
    """A mutant that rejects what is valid: f(data of the description, root element of the URDF) -> whether."""

    def make(where: Callable[[Members, Any], Any]) -> _Answering:
        def answer(right: Answer, description: Path, urdf: Path) -> Answer:
            if isinstance(right, Accepted) and where(
                value_of(description.read_bytes().decode("utf-8-sig")), etree.parse(urdf).getroot()
            ):
                return rejected("this is not supported")
            return right

        return _Answering(answer)

    return _mutant(clause, make, **stated)


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


def evaluates(clause: str, **stated: Any) -> Register:
    """A mutant that answers with other values: f(values) -> the quantities that differ."""
    return _mutant(clause, _Evaluating, **stated)


class _Misunderstanding(Reference):
    """Gives one thing another meaning: a deviating oracle describes and evaluates what the reference accepts."""

    def __init__(self, deviation: Callable[[], Deviation]) -> None:
        super().__init__()
        self._deviation = deviation
        self._understood: OracleRobot | None = None

    def load(self, description: Path, urdf: Path) -> Answer:
        right = super().load(description, urdf)
        if isinstance(right, Rejected):
            return right
        with self._deviation():
            try:
                self._understood = read(description, urdf)
            except NotRead as error:
                return rejected(str(error))
            return right.model_copy(update={"robot": self._understood.canonical()})

    def evaluate(
        self, configurations: Sequence[Mapping[str, Sequence[float]]], frames: Sequence[str], quantities: Sequence[Any]
    ) -> list[Values]:
        assert self._understood is not None
        with self._deviation():
            return [self._understood.evaluate(q, frames, quantities) for q in configurations]


def means(clause: str, **stated: Any) -> Register:
    """A mutant that gives something another meaning: f() -> a deviation of the oracle."""
    return _mutant(clause, _Misunderstanding, **stated)


def instead(owner: Any, name: str, other: Callable[..., Any]) -> Deviation:
    """A function of the oracle is another, which gets the right one before its arguments."""
    right = getattr(owner, name)
    return patch.object(owner, name, lambda *arguments, **named: other(right, *arguments, **named))
