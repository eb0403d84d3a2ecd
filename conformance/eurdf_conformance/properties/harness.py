"""A parser and the queries that properties send to it."""

from __future__ import annotations

import secrets
from collections.abc import Sequence
from pathlib import Path

from eurdf_conformance.comparison.difference import Difference
from eurdf_conformance.feature import Feature
from eurdf_conformance.judging.conversation import Parser
from eurdf_conformance.judging.judge import Judgement, judge_lacking
from eurdf_conformance.judging.verdict import Verdict
from eurdf_conformance.properties.files import Files
from eurdf_conformance.properties.query import Query
from eurdf_conformance.properties.shape import WrongShape, shaped
from eurdf_conformance.properties.truth import truth
from eurdf_conformance.properties.used import features_of_query
from eurdf_conformance.protocol.message import Accepted, CanonicalRobot, Evaluated, Quantity, Values
from eurdf_conformance.runner.outcome import Answered, Outcome


class NotAnswered(Exception):  # noqa: N818 - it says what happened
    """The parser gave no answer of the requested kind.

    Attributes:
        expected: The word that the answer should be.
        outcome: What came of it instead.
    """

    def __init__(self, expected: str, outcome: Outcome) -> None:
        self.expected = expected
        self.outcome = outcome
        super().__init__(str(outcome))


class Lacked(Exception):  # noqa: N818 - it says what happened
    """The parser answers that it lacks a feature, which it names in `lacks` and the files use.

    Attributes:
        judgement: The judgement on that.
    """

    def __init__(self, judgement: Judgement) -> None:
        self.judgement = judgement
        super().__init__(judgement.reason)


class Harness:
    """Sends queries about one mechanism after the other to a parser.

    Attributes:
        folder: Where files are written for the parser.
        asked: What it was asked about since `begin`, and where the files of that are.
    """

    def __init__(self, parser: Parser, folder: Path, lacks: frozenset[Feature] = frozenset()) -> None:
        self.folder = folder
        self.queries: list[tuple[Query, tuple[Path, Path]]] = []
        self._parser = parser
        self._lacks = lacks
        self._files: tuple[Files, tuple[Path, Path]] | None = None
        self._accepted: Accepted | None = None

    def begin(self) -> None:
        """Begin another example."""
        self.queries.clear()

    def load(self, query: Query) -> Accepted:
        """Ask it to read two files, unless it read them last.

        Raises:
            Lacked: It lacks a feature that they use.
            NotAnswered: It does not accept them.
        """
        if self._files is None or self._files[0] != query.files:
            self._files, self._accepted = (query.files, self._write(query.files)), None
        self.queries.append((query, self._files[1]))
        if self._accepted is None:
            outcome = self._parser.load(*self._files[1])
            lacked = self._lacks and self._lacks & features_of_query(query)
            if lacked and (found := judge_lacking(outcome, lacked)) and found.verdict == Verdict.EXCUSED:
                raise Lacked(found)
            if not (isinstance(outcome, Answered) and isinstance(outcome.answer, Accepted)):
                raise NotAnswered("accepted", outcome)
            self._accepted = outcome.answer
        return self._accepted

    def read(self, query: Query) -> CanonicalRobot | None:
        """The canonical description that it read; None if it gives none.

        Raises:
            NotAnswered: It does not accept the files.
        """
        return self.load(query).robot

    def evaluate(self, query: Query, quantities: Sequence[Quantity]) -> list[Values]:
        """Its values at each configuration, as requested, with the columns in the oracle's order.

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
        """Write files into a new folder, so that no parser can confuse them with earlier ones."""
        folder = self.folder / secrets.token_hex(8)
        folder.mkdir()
        return files.write(folder)
