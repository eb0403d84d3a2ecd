"""A reader, and the questions that laws put to it."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from eurdf_conformance.comparison.difference import Difference
from eurdf_conformance.corpus.expect import DYNAMICS, KINEMATICS
from eurdf_conformance.level import Level
from eurdf_conformance.properties.asked import Asked
from eurdf_conformance.properties.files import Files
from eurdf_conformance.properties.shape import WrongShape, shaped
from eurdf_conformance.properties.truth import truth
from eurdf_conformance.protocol.message import Accepted, CanonicalRobot, Evaluated, Quantity, Values
from eurdf_conformance.runner.outcome import Answered, Outcome
from eurdf_conformance.suite.conversation import Reader

#: What a level asks for.
QUANTITIES: dict[Level, tuple[Quantity, ...]] = {Level.KINEMATICS: KINEMATICS, Level.DYNAMICS: DYNAMICS}


class NotAnswered(Exception):  # noqa: N818 - it says what happened
    """A reader did not say what it was asked.

    Attributes:
        expected: The word that the answer should be.
        outcome: What came of it instead.
    """

    def __init__(self, expected: str, outcome: Outcome) -> None:
        self.expected = expected
        self.outcome = outcome
        super().__init__(str(outcome))


class Bench:
    """A reader that is asked about one mechanism after the other.

    Attributes:
        folder: Where files are written for the reader.
        asked: What it was asked about since `begin`, and where the files of that are.
    """

    def __init__(self, reader: Reader, folder: Path) -> None:
        self.folder = folder
        self.asked: list[tuple[Asked, tuple[Path, Path]]] = []
        self._reader = reader
        self._written = 0
        self._files: tuple[Files, tuple[Path, Path]] | None = None
        self._accepted: Accepted | None = None

    def begin(self) -> None:
        """Another example."""
        self.asked.clear()

    def load(self, asked: Asked) -> Accepted:
        """Let it read two files, if they are not those that it read last.

        Raises:
            NotAnswered: It does not accept them.
        """
        if self._files is None or self._files[0] != asked.files:
            self._files, self._accepted = (asked.files, self._write(asked.files)), None
        self.asked.append((asked, self._files[1]))
        if self._accepted is None:
            outcome = self._reader.load(*self._files[1])
            if not (isinstance(outcome, Answered) and isinstance(outcome.answer, Accepted)):
                raise NotAnswered("accepted", outcome)
            self._accepted = outcome.answer
        return self._accepted

    def read(self, asked: Asked) -> CanonicalRobot | None:
        """What it has read; None where it does not say.

        Raises:
            NotAnswered: It does not accept the files.
        """
        return self.load(asked).robot

    def evaluate(self, asked: Asked, quantities: Sequence[Quantity]) -> list[Values]:
        """What it says at each configuration, and nothing but that, the columns in the order of the oracle's.

        Raises:
            NotAnswered: It does not accept the files, or does not say.
            WrongShape: What it says is not what was asked for.
        """
        self.load(asked)
        outcome = self._reader.evaluate(asked.configurations, asked.frames, quantities)
        if not (isinstance(outcome, Answered) and isinstance(outcome.answer, Evaluated)):
            self._accepted = None  # the process that held the robot may be gone
            raise NotAnswered("evaluated", outcome)
        given, count = outcome.answer.values, len(asked.configurations)
        if len(given) != count:
            raise WrongShape([Difference("/values", count, len(given), "how many configurations")])
        robot = truth(asked.mechanism, asked.version)
        return [
            shaped(values, robot, asked.frames, quantities, f"/values/{index}") for index, values in enumerate(given)
        ]

    def _write(self, files: Files) -> tuple[Path, Path]:
        """Into a folder of their own: no reader can take one file for the one that stood there before."""
        self._written += 1
        folder = self.folder / str(self._written)
        folder.mkdir()
        return files.write(folder)
