"""A fresh case: what a process that draws writes as JSON, and what the suite asks about."""

from __future__ import annotations

import hashlib
import json
import re
import subprocess
import sys
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache, cached_property
from pathlib import Path
from typing import Any

from pydantic import Field, TypeAdapter

from eurdf_conformance.corpus.case import CasePlace, ExpectedWarning, InvalidCase, ValidCase
from eurdf_conformance.corpus.content import Part
from eurdf_conformance.corpus.expected import Expected
from eurdf_conformance.corpus.features import features_of_files
from eurdf_conformance.corpus.read import CorpusCase, suite_cases
from eurdf_conformance.feature import Feature
from eurdf_conformance.fresh.kind import TITLES, FreshKind, accept_clause, fresh_levels
from eurdf_conformance.level import Level, Version
from eurdf_conformance.properties.example import Example
from eurdf_conformance.properties.files import DESCRIPTION, URDF
from eurdf_conformance.properties.query import query_of
from eurdf_conformance.properties.used import features_of_query

#: Topic of fresh cases: the first part of their names.
FRESH = "fresh"

#: What was drawn from a seed.
_texts: dict[int, str] = {}

_NUMBER = re.compile(r"(?<![\w.])-?\d+\.\d+(e-?\d+)?")

_PROGRAM = "eurdf_conformance.fresh.draw"


class CannotDraw(Exception):  # noqa: N818 - shown to the user as it is
    """Fresh cases cannot be drawn; its text says why."""


class Drawn(Part):
    """A fresh case as it was drawn.

    Attributes:
        version: Version of the format.
        kind: Its kind.
        files: Texts by name.
        example: The mechanism that the files are of, before an error was put into them.
        configurations: Of a valid case, where the robot is evaluated.
        frames: Of a valid case, names of frames whose poses are asked for.
        expected: Of a valid case, what the oracle expects.
        error: What is wrong, in words.
        code: Of the diagnostic of the error.
        place: Of the diagnostic of the error.
        fix: What to do about the error, as a sentence.
    """

    version: Version
    kind: FreshKind
    files: dict[str, str]
    example: Example
    configurations: list[dict[str, list[float]]] = Field(default=[])
    frames: list[str] = Field(default=[])
    expected: Expected | None = None
    error: str = ""
    code: str = ""
    place: CasePlace | None = None
    fix: str = ""


_DRAWN = TypeAdapter(tuple[Drawn, ...])


@dataclass(frozen=True)
class FreshCase(CorpusCase):
    """A case that is in no corpus."""

    drawn: Drawn

    @property
    def files(self) -> dict[str, bytes]:
        """The contents of its files, by name."""
        return {name: text.encode() for name, text in self.drawn.files.items()}

    @property
    def expected(self) -> Expected:
        """What is expected of a valid case."""
        assert self.drawn.expected is not None
        return self.drawn.expected

    @cached_property
    def features(self) -> frozenset[Feature]:
        """The features that its files use, with its error or without it."""
        version, mechanism = self.drawn.version, self.drawn.example.mechanism
        stated = features_of_files(self.files[self.case.description], self.files[self.case.urdf])
        return stated | features_of_query(query_of(mechanism, version))

    @property
    def levels(self) -> tuple[Level, ...]:
        """The levels at which it is tested."""
        return fresh_levels(self.drawn.kind)


def fresh_name(version: Version, kind: FreshKind, number: int) -> str:
    """The name of a fresh case."""
    return f"{FRESH}/{kind}-{version.replace('.', '-')}-{number}"


def keep_drawn(seed: int, text: str) -> None:
    """Let this process use what another one has drawn from a seed."""
    _texts[seed] = text


def drawn_text(seed: int) -> str:
    """The fresh cases of a seed as JSON, drawn once, in a process of its own.

    What Hypothesis draws from a seed depends on which modules are loaded: there, always the same ones are.

    Raises:
        CannotDraw: The process failed.
    """
    if seed in _texts:
        return _texts[seed]
    # The package need not be installed where the suite is started from.
    program = "import sys; sys.path[:] = sys.argv[2:]; import runpy; runpy.run_module(sys.argv[1], run_name='__main__')"
    command = [sys.executable, "-c", program, _PROGRAM, *sys.path]
    done = subprocess.run(
        command, input=json.dumps(seed), capture_output=True, text=True, encoding="utf-8", check=False
    )
    if done.returncode:
        raise CannotDraw(f"drawing fresh cases from seed {seed} failed:\n{done.stderr}")
    _texts[seed] = done.stdout
    return done.stdout


def fresh_cases(seed: int) -> dict[str, FreshCase]:
    """The fresh cases of a seed, by name."""
    return {case.name: case for case in _cases(drawn_text(seed))}


def fresh_examples(seed: int, version: Version) -> tuple[Example, ...]:
    """The mechanisms of the valid fresh cases of a seed, for properties."""
    cases = (case.drawn for case in fresh_cases(seed).values())
    return tuple(each.example for each in cases if each.kind is FreshKind.VALID and each.version == version)


def drawn_hash(seed: int) -> str:
    """A hash that shows whether two runs drew the same files, but for the last digits of their numbers.

    These depend on the processor; and what is drawn from a seed, on the version of Hypothesis.
    """
    texts = [text for case in fresh_cases(seed).values() for text in case.drawn.files.values()]
    rounded = "\0".join(_NUMBER.sub(lambda number: f"{float(number[0]):.6g}", text) for text in texts)
    return f"sha256:{hashlib.sha256(rounded.encode()).hexdigest()}"


@cache
def _cases(text: str) -> Sequence[FreshCase]:
    numbers = Counter[tuple[Version, FreshKind]]()
    cases = []
    for drawn in _DRAWN.validate_json(text):
        kind = drawn.version, drawn.kind
        numbers[kind] += 1
        name = fresh_name(*kind, numbers[kind])
        cases.append(FreshCase(_said(drawn), name, Path(f"{name}.yaml"), suite_cases(), drawn))
    return cases


def _said(drawn: Drawn) -> ValidCase | InvalidCase:
    common: dict[str, Any] = {
        "id": "fresh0",
        "title": TITLES[drawn.kind],
        "version": drawn.version,
        "clauses": [accept_clause(drawn.kind)],
        "description": DESCRIPTION,
        "urdf": URDF,
    }
    if drawn.kind in (FreshKind.VALID, FreshKind.WARNED):
        warnings = [ExpectedWarning(code=drawn.code, place=drawn.place)] if drawn.place else []
        at: dict[str, Any] = {"configurations": drawn.configurations, "frames": drawn.frames}
        return ValidCase(valid=True, warnings=warnings, **at, **common)
    either = drawn.kind is FreshKind.EITHER
    # Not checked: there is no edit of a stored case.
    return InvalidCase.model_construct(
        valid=False, code=drawn.code, place=drawn.place, fix=drawn.fix, either=either, features=[], twin=None, **common
    )
