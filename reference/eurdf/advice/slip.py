"""A slip of who wrote the files of a robot: what is likely meant, and where that is written."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

from eurdf.advice.stated_pose import Change, Side, StatedPose
from eurdf.closures import CLOSED
from eurdf.diagnostics import Edit, Fix
from eurdf.format.closure_model import ClosureEntry
from eurdf.linking.robot_files import ReadRobot
from eurdf.reading.source import Source

#: What closes loops exactly, m or rad: twice what counts as closed.
EXACT = 2.0 * CLOSED

#: How likely slips are.
SURE, LIKELY, POSSIBLE, RARE, GUESSED = range(5)
#: What it adds that a pose now is, up to signs, as on the other side of the robot.
AS_THERE = 3

# One is certain if no other is less than this behind it; or if names fit better by the other.
_CLEARLY = 2
_BETTER = 0.5

_DECIMAL = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?")

# Loops that are looked at.
_MOST_LOOPS = 8


class Token(NamedTuple):
    """A name or a number in a file."""

    source: Source
    start: int
    end: int

    @property
    def text(self) -> str:
        """As it is written."""
        return self.source.text[self.start : self.end]

    def edit(self, text: str) -> Edit:
        """An edit that writes something else."""
        return self.source.edit(self.start, self.end, text)

    @property
    def is_number(self) -> bool:
        """Whether it is a number in decimal digits, and neither an alias nor a list."""
        return _DECIMAL.fullmatch(self.text) is not None

    def parts(self) -> list[Token]:
        """The words of an attribute."""
        words = re.finditer(r"\S+", self.text)
        return [Token(self.source, self.start + word.start(), self.start + word.end()) for word in words]


@dataclass(frozen=True, slots=True)
class Slip:
    """What is likely meant.

    Attributes:
        rank: How likely it is, `SURE` most.
        change: The mechanism that is meant.
        summary: What to do, in the imperative.
        question: The same as a question.
        edits: What to write, and for what; None where nothing is written.
        score: How well names fit, of slips of one rank.
        closed: The number of loops that it closes.
    """

    rank: int
    change: Change
    summary: str
    question: str
    edits: Sequence[tuple[Token | None, str]] = ()
    score: float = 0.0
    closed: int = 0

    @property
    def order(self) -> tuple[float, ...]:
        """The likeliest slip comes first."""
        return -self.closed, self.rank, -self.score

    @property
    def fix(self) -> Fix:
        """What `Diagnostics.report` takes: without edits if one of them has no place in a file that somebody wrote."""
        made = [token.edit(text) for token, text in self.edits if token is not None and token.text != text]
        lacks = any(token is None or token.source.made_from for token, _ in self.edits)
        return Fix(self.summary, () if lacks else tuple(made), self.question)

    def is_likelier_than(self, other: Slip) -> bool:
        """Whether there is no doubt about which of the two it is."""
        if other.closed < self.closed or other.rank >= self.rank + _CLEARLY:
            return True
        return other.rank >= self.rank and other.score <= self.score - _BETTER


def written(
    rank: int,
    change: Change,
    what: str,
    new: str,
    old: str,
    edits: Iterable[tuple[Token | None, str]] = (),
    *,
    score: float = 0.0,
    note: str = "",
) -> Slip:
    """That something is written in place of something else."""
    summary = f"write {new} in place of {old}{note} as {what}: the loops then close"
    return Slip(
        rank, change, summary, f"the loops close if {what} is {new}, not {old}{note}: is it?", tuple(edits), score
    )


def exchanged(
    rank: int, change: Change, what: str, pairs: Iterable[Sequence[Token | None]] = (), score: float = 0.0
) -> Slip:
    """That two things are in the place of each other; pairs are the same parts of both."""
    edits = [(to, "" if of is None else of.text) for one, other in pairs for to, of in ((one, other), (other, one))]
    question = f"the loops close if {what} are exchanged: are they?"
    return Slip(rank, change, f"exchange {what}: the loops then close", question, edits, score)


@dataclass(frozen=True)
class OpenLoops:
    """The loops that are open at one configuration, and where the files state what they depend on.

    Attributes:
        read: The robot as read.
        pose: It at the configuration.
        configuration: Its name; None for neutral.
        exact: By how much loops are open that close exactly, m or rad.
        indices: The numbers of the open constraints, of many only the first.
        sides: The frames of the closures among them.
        joints: The joints that move these, with the frames that each moves.
    """

    read: ReadRobot
    pose: StatedPose
    configuration: str | None
    exact: float
    indices: list[int] = field(init=False)
    sides: list[Side] = field(init=False)
    joints: dict[str, list[Side]] = field(init=False)

    def __post_init__(self) -> None:
        constraints, joints = self.pose.constraints, dict[str, list[Side]]()
        indices = [index for index in range(len(constraints)) if not self.pose.opening(index) <= CLOSED][:_MOST_LOOPS]
        sides = [(index, of) for index in indices if constraints[index].anchors for of in (0, 1)]
        for index, of in sides:
            for name in self.pose.between(index)[of]:
                joints.setdefault(name, []).append((index, of))
        for name, value in (("indices", indices), ("sides", sides), ("joints", joints)):
            object.__setattr__(self, name, value)

    def entry(self, index: int) -> ClosureEntry:
        """What the description states of a closure."""
        name = self.pose.constraints[index].name
        return next(entry for entry in self.read.description.closures if entry.name == name)

    def in_yaml(self, *pointer: str | int) -> Token | None:
        """A value in the description; None if it is not written there, or as a block."""
        document = self.read.description.document
        data: Any = document.data
        for step in pointer:
            if step not in (data if isinstance(data, dict) else range(len(data)) if isinstance(data, list) else ()):
                return None
            data = data[step]
        start, end = document.span(pointer)
        return None if end is None else Token(document.source, start, end)

    def in_urdf(self, joint: str, tag: str, attribute: str) -> Token | None:
        """The value of an attribute of an element of a joint; None if it is not written."""
        urdf = self.read.urdf
        element = urdf.joints[joint].element.find(tag)
        if element is None or element.get(attribute) is None:
            return None
        return Token(urdf.document.source, *urdf.document.span(element, attribute))
