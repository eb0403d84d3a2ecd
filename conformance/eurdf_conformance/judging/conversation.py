"""A parser asked about cases, each of which it loads once for all levels."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Protocol

from eurdf_conformance.corpus.case import ValidCase
from eurdf_conformance.corpus.read import CorpusCase
from eurdf_conformance.protocol.message import Accepted, Quantity
from eurdf_conformance.runner.outcome import Answered, Outcome


class Parser(Protocol):
    """Who is asked: a `Session`, or a parser in this process."""

    def load(self, description: Path, urdf: Path) -> Outcome:
        """Ask to read a robot."""

    def evaluate(
        self,
        configurations: Sequence[Mapping[str, Sequence[float]]],
        frames: Sequence[str],
        quantities: Sequence[Quantity],
    ) -> Outcome:
        """Ask for values of the robot accepted last."""


class Conversation:
    """The questions on cases, put to one parser.

    Attributes:
        parser: Who is asked.
    """

    def __init__(self, parser: Parser) -> None:
        self.parser = parser
        self._files: tuple[Path, Path] | None = None
        self._loaded: Outcome | None = None

    def load(self, case: CorpusCase) -> Outcome:
        """What came of loading a case; asked once, where the case before was the same."""
        if self._loaded is None or self._files != (case.description, case.urdf):
            self._files = case.description, case.urdf
            self._loaded = self.parser.load(*self._files)
        return self._loaded

    def forget(self) -> None:
        """Load the next case whatever it is: the parser was asked for something else meanwhile."""
        self._loaded = None

    def evaluate(self, case: CorpusCase, quantities: Sequence[Quantity]) -> Outcome:
        """What came of evaluating a valid case at its configurations; where it was not accepted, of loading it."""
        assert isinstance(case.case, ValidCase)
        loaded = self.load(case)
        if not (isinstance(loaded, Answered) and isinstance(loaded.answer, Accepted)):
            return loaded
        outcome = self.parser.evaluate(case.case.configurations, case.case.frames, quantities)
        if not isinstance(outcome, Answered):
            self._loaded = None  # the process that held the robot may be gone
        return outcome
