"""A fresh case: what a process that draws writes as JSON, and what the suite asks about."""

from __future__ import annotations

import hashlib
import json
import re
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any, Literal

from pydantic import Field, TypeAdapter

from eurdf_conformance.corpus.case import CasePlace, InvalidCase, ValidCase
from eurdf_conformance.corpus.content import Part
from eurdf_conformance.corpus.expected import Expected
from eurdf_conformance.corpus.read import CorpusCase, suite_cases
from eurdf_conformance.level import Level, Version
from eurdf_conformance.level_spec import Compared, levels_comparing
from eurdf_conformance.properties.files import DESCRIPTION, URDF

#: Topic of fresh cases: the first part of their names.
FRESH = "fresh"

#: Fresh cases of each version and validity.
COUNT = 8

#: What was drawn from a seed.
_texts: dict[int, str] = {}

_CLAUSES = {True: "EU-CNF-002", False: "EU-CNF-001"}

_TITLES = {
    True: "A mechanism that was drawn for this run.",
    False: "A mechanism that was drawn for this run, with one error.",
}

_NUMBER = re.compile(r"(?<![\w.])-?\d+\.\d+(e-?\d+)?")

_PROGRAM = "eurdf_conformance.fresh.draw"


class CannotDraw(Exception):  # noqa: N818 - shown to the user as it is
    """Fresh cases cannot be drawn; its text says why."""


class Drawn(Part):
    """A fresh case as it was drawn.

    Attributes:
        version: Version of the format.
        valid: Whether it is valid.
        files: Texts by name.
        configurations: Of a valid case, where the robot is evaluated.
        frames: Of a valid case, names of frames whose poses are asked for.
        expected: Of a valid case, what the oracle expects.
        error: Of an invalid case: what is wrong, in words.
        code: Of an invalid case: of its diagnostic.
        place: Of an invalid case: of its diagnostic.
        fix: Of an invalid case: what to do about the error, as a sentence.
    """

    version: Version
    valid: bool
    files: dict[str, str]
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

    @property
    def levels(self) -> tuple[Level, ...]:
        """The levels at which it is tested."""
        return fresh_levels(self.drawn.valid)


def fresh_levels(valid: bool) -> tuple[Level, ...]:
    """The levels at which a fresh case is tested. Of a valid one no warnings are known."""
    return levels_comparing(Compared.OUTCOME, *((Compared.ROBOT, Compared.VALUES) if valid else (Compared.ISSUES,)))


def fresh_name(version: Version, valid: bool, number: int) -> str:
    """The name of a fresh case."""
    return f"{FRESH}/{'valid' if valid else 'invalid'}-{version.replace('.', '-')}-{number}"


def fresh_title(valid: bool) -> str:
    """The title of a fresh case, whatever it is."""
    return _TITLES[valid]


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


def drawn_hash(seed: int) -> str:
    """A hash that shows whether two runs drew the same files, but for the last digits of their numbers.

    These depend on the processor; and what is drawn from a seed, on the version of Hypothesis.
    """
    texts = [text for case in fresh_cases(seed).values() for text in case.drawn.files.values()]
    rounded = "\0".join(_NUMBER.sub(lambda number: f"{float(number[0]):.6g}", text) for text in texts)
    return f"sha256:{hashlib.sha256(rounded.encode()).hexdigest()}"


@cache
def _cases(text: str) -> Sequence[FreshCase]:
    numbers: dict[tuple[Version, bool], int] = {}
    cases = []
    for drawn in _DRAWN.validate_json(text):
        kind = drawn.version, drawn.valid
        numbers[kind] = numbers.get(kind, 0) + 1
        name = fresh_name(*kind, numbers[kind])
        cases.append(FreshCase(_said(drawn), name, Path(f"{name}.yaml"), suite_cases(), drawn))
    return cases


def _said(drawn: Drawn) -> ValidCase | InvalidCase:
    common: dict[str, Any] = {
        "id": "fresh0",
        "title": _TITLES[drawn.valid],
        "version": drawn.version,
        "clauses": [_CLAUSES[drawn.valid]],
        "description": DESCRIPTION,
        "urdf": URDF,
    }
    if drawn.valid:
        return ValidCase(valid=True, configurations=drawn.configurations, frames=drawn.frames, **common)
    valid: Literal[False] = False
    # Not checked: the valid twin and the edit are not those of a stored case.
    return InvalidCase.model_construct(
        valid=valid, code=drawn.code, place=drawn.place, fix=drawn.fix, either=False, features=[], **common
    )
