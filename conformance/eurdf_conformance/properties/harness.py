"""A parser, and the questions that properties put to it."""

from __future__ import annotations

import secrets
from collections.abc import Sequence
from pathlib import Path

from eurdf_conformance.comparison.difference import Difference
from eurdf_conformance.judging.conversation import Parser
from eurdf_conformance.properties.files import Files
from eurdf_conformance.properties.query import Query
from eurdf_conformance.properties.shape import WrongShape, shaped
from eurdf_conformance.properties.truth import truth
from eurdf_conformance.protocol.message import Accepted, CanonicalRobot, Evaluated, Quantity, Values
from eurdf_conformance.runner.outcome import Answered, Outcome


class NotAnswered(Exception):  # noqa: N818 - it says what happened
    """A parser did not say what it was asked.

    Attributes:
        expected: The word that the answer should be.
        outcome: What came of it instead.
    """

    def __init__(self, expected: str, outcome: Outcome) -> None:
        self.expected = expected
        self.outcome = outcome
        super().__init__(str(outcome))


class Harness:
    """A parser that is asked about one mechanism after the other.

    Attributes:
        folder: Where files are written for the parser.
        asked: What it was asked about since `begin`, and where the files of that are.
    """

    def __init__(self, parser: Parser, folder: Path) -> None:
        self.folder = folder
        self.queries: list[tuple[Query, tuple[Path, Path]]] = []
        self._parser = parser
        self._files: tuple[Files, tuple[Path, Path]] | None = None
        self._accepted: Accepted | None = None

    def begin(self) -> None:
        """Another example."""
        self.queries.clear()

    def load(self, query: Query) -> Accepted:
        """Let it read two files, if they are not those that it read last.

        Raises:
            NotAnswered: It does not accept them.
        """
        if self._files is None or self._files[0] != query.files:
            self._files, self._accepted = (query.files, self._write(query.files)), None
        self.queries.append((query, self._files[1]))
        if self._accepted is None:
            outcome = self._parser.load(*self._files[1])
            if not (isinstance(outcome, Answered) and isinstance(outcome.answer, Accepted)):
                raise NotAnswered("accepted", outcome)
            self._accepted = outcome.answer
        return self._accepted

    def read(self, query: Query) -> CanonicalRobot | None:
        """What it has read; None where it does not say.

        Raises:
            NotAnswered: It does not accept the files.
        """
        return self.load(query).robot

    def evaluate(self, query: Query, quantities: Sequence[Quantity]) -> list[Values]:
        """What it says at each configuration, and nothing but that, the columns in the order of the oracle's.

        Raises:
            NotAnswered: It does not accept the files, or does not say.
            WrongShape: What it says is not what was asked for.
        """
        self.load(query)
        outcome = self._parser.evaluate(query.configurations, query.frames, quantities)
        if not (isinstance(outcome, Answered) and isinstance(outcome.answer, Evaluated)):
            self._accepted = None  # the process that held the robot may be gone
            raise NotAnswered("evaluated", outcome)
        given, count = outcome.answer.values, len(query.configurations)
        if len(given) != count:
            raise WrongShape([Difference("/values", count, len(given), "number of configurations")])
        robot = truth(query.mechanism, query.version)
        return [
            shaped(values, robot, query.frames, quantities, f"/values/{index}") for index, values in enumerate(given)
        ]

    def _write(self, files: Files) -> tuple[Path, Path]:
        """Into a folder of their own: no parser can take one file for the one that was there before."""
        folder = self.folder / secrets.token_hex(8)
        folder.mkdir()
        return files.write(folder)
