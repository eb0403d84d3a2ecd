"""Requests about cases, put to one parser. A case is loaded once for all levels."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Protocol

from eurdf_conformance.corpus.case import ValidCase
from eurdf_conformance.corpus.read import CorpusCase
from eurdf_conformance.feature import Feature
from eurdf_conformance.judging.handout import Handout
from eurdf_conformance.protocol.message import Accepted, Quantity
from eurdf_conformance.runner.outcome import Answered, Outcome


class Parser(Protocol):
    """What answers requests: a `Session`, or a parser in this process."""

    def load(self, description: Path, urdf: Path) -> Outcome:
        """Ask to read a robot."""

    def evaluate(
        self,
        configurations: Sequence[Mapping[str, Sequence[float]]],
        frames: Sequence[str],
        quantities: Sequence[Quantity],
    ) -> Outcome:
        """Ask for values of the robot of the last `load`, which was accepted."""


class Conversation:
    """Requests about cases, put to one parser.

    Attributes:
        parser: The parser.
        handout: The files that it receives.
        lacks: The features that it lacks.
    """

    def __init__(self, parser: Parser) -> None:
        self.parser = parser
        self.handout = Handout()
        self.lacks: frozenset[Feature] = frozenset()
        self._case: CorpusCase | None = None
        self._loaded: Outcome | None = None

    def load(self, case: CorpusCase) -> Outcome:
        """The outcome of loading a case. The parser is asked once for consecutive calls with the same case."""
        if self._loaded is None or self._case is not case:
            self._case = case
            self._loaded = self.parser.load(*self.handout.files(case))
        return self._loaded

    def forget(self) -> None:
        """Load the next case even if it is the same: the parser has had other requests in between."""
        self._loaded = None

    def evaluate(self, case: CorpusCase, quantities: Sequence[Quantity]) -> Outcome:
        """The outcome of evaluating a valid case at its configurations, or of loading it if it was not accepted."""
        assert isinstance(case.case, ValidCase)
        loaded = self.load(case)
        if not (isinstance(loaded, Answered) and isinstance(loaded.answer, Accepted)):
            return loaded
        outcome = self.parser.evaluate(case.case.configurations, case.case.frames, quantities)
        if not isinstance(outcome, Answered):
            self._loaded = None  # the process that held the robot may be gone
        return outcome
