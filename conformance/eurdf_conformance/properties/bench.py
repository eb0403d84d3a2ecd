"""A reader, and the questions that properties put to it."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from eurdf_conformance.corpus.expect import DYNAMICS, KINEMATICS
from eurdf_conformance.level import Level
from eurdf_conformance.properties.asked import Asked
from eurdf_conformance.properties.files import Files
from eurdf_conformance.properties.shape import shaped
from eurdf_conformance.properties.truth import truth
from eurdf_conformance.protocol.message import Accepted, CanonicalRobot, Evaluated, Quantity, Values
from eurdf_conformance.runner.outcome import Answered, Outcome
from eurdf_conformance.suite.conversation import Reader

#: What a level asks for.
QUANTITIES: dict[Level, tuple[Quantity, ...]] = {Level.KINEMATICS: KINEMATICS, Level.DYNAMICS: DYNAMICS}


class NotAnswered(Exception):  # noqa: N818 - it says what happened
    """A reader did not say what it was asked.

    Attributes:
        outcome: What came of it instead.
    """

    def __init__(self, outcome: Outcome) -> None:
        self.outcome = outcome
        super().__init__(str(outcome))


class Bench:
    """A reader that is asked about one mechanism after the other.

    Attributes:
        asked: What it was asked about last.
        paths: The files of that.
    """

    def __init__(self, reader: Reader, folder: Path) -> None:
        """``folder`` is where files are written for the reader."""
        self.asked: Asked | None = None
        self.paths: tuple[Path, ...] = ()
        self._reader = reader
        self._folder = folder
        self._written = 0
        self._loaded: tuple[Files, Accepted] | None = None

    def load(self, asked: Asked) -> Accepted:
        """Let it read two files, if they are not those that it read last.

        Raises:
            NotAnswered: It does not accept them.
        """
        self.asked = asked
        if self._loaded is not None and self._loaded[0] == asked.files:
            return self._loaded[1]
        self._loaded = None
        # A folder of its own: no reader can take one file for the one that stood there before.
        self._written += 1
        folder = self._folder / str(self._written)
        folder.mkdir()
        description, urdf = self.paths = asked.files.write(folder)
        outcome = self._reader.load(description, urdf)
        if not (isinstance(outcome, Answered) and isinstance(outcome.answer, Accepted)):
            raise NotAnswered(outcome)
        self._loaded = asked.files, outcome.answer
        return outcome.answer

    def read(self, asked: Asked) -> CanonicalRobot | None:
        """What it has read; None where it does not say.

        Raises:
            NotAnswered: It does not accept the files.
        """
        return self.load(asked).robot

    def evaluate(self, asked: Asked, quantities: Sequence[Quantity]) -> list[Values]:
        """What it says at each configuration, the columns in the order of the oracle's.

        Raises:
            NotAnswered: It does not accept the files, or does not say.
            WrongShape: What it says is not what was asked for.
        """
        self.load(asked)
        outcome = self._reader.evaluate(asked.configurations, asked.frames, quantities)
        if not (isinstance(outcome, Answered) and isinstance(outcome.answer, Evaluated)):
            self._loaded = None  # the process that held the robot may be gone
            raise NotAnswered(outcome)
        robot = truth(asked.mechanism, asked.version)
        return [
            shaped(values, robot, asked.frames, quantities, f"/values/{index}")
            for index, values in enumerate(outcome.answer.values)
        ]
