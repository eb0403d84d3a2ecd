"""A fix: what to write in the place of parts of files, so that a diagnostic is gone."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from functools import cache

from eurdf.diagnostics.lines import Lines
from eurdf.diagnostics.wording import continues, did_you_mean, edits, similar

#: Names that are tried in the place of one that is unknown, at most.
_FEW = 6


@dataclass(frozen=True, slots=True)
class Edit:
    """A part of a file, and what to write in its place.

    Attributes:
        file: Path as the user gave it.
        start: Index of the first character of the part in the text of the file.
        end: Index of the one after its last.
        text: What to write instead.
        lines: The text of the file.
    """

    file: str
    start: int
    end: int
    text: str
    lines: Lines = field(compare=False, repr=False)

    @property
    def region(self) -> tuple[int, int, int, int]:
        """Line and column, from 1, of the first character of the part, and of the one after its last."""
        return *self.lines.position(self.start), *self.lines.position(self.end)

    def overlaps(self, other: Edit) -> bool:
        """Whether both edits change a character, or insert at one place."""
        return self.file == other.file and self.start <= other.end and other.start <= self.end


@dataclass(frozen=True, slots=True)
class Fix:
    """Edits that make a robot right, and what they do.

    Attributes:
        summary: What they do, in the imperative, without a full stop; empty if it is only asked, and a rival of others.
        edits: Parts of files that do not overlap.
        question: The same as a question, for a hint if a trial does not show that the robot becomes right; None if it
            is not worth asking.
        rivals: Whether it is right only if no later proposal is right, too.
    """

    summary: str
    edits: tuple[Edit, ...]
    question: str | None = None
    rivals: bool = False

    def texts(self) -> dict[str, str]:
        """The new text of each file that is changed."""
        changed = {edit.file: edit.lines.text for edit in self.edits}
        for edit in sorted(self.edits, key=lambda each: each.start, reverse=True):
            before = changed[edit.file]
            changed[edit.file] = before[: edit.start] + edit.text + before[edit.end :]
        return changed

    @classmethod
    def together(cls, fixes: Iterable[Fix]) -> Fix:
        """The first of some fixes, and with it those that overlap none before them, as one."""
        edits: list[Edit] = []
        for fix in fixes:
            if not any(mine.overlaps(other) for mine in fix.edits for other in edits):
                edits += fix.edits
        return cls("", tuple(edits))


def misspelt(
    wrong: str, known: Iterable[str], write: Callable[[str], tuple[Edit, ...]], beside: str = ""
) -> tuple[Callable[[], str | None], Callable[[], list[Fix]]]:
    """The hint and the proposals for a name that is unknown, to be found if they are listed; see `similar`.

    Args:
        wrong: The name.
        known: The names that are known.
        write: The edits that put a name in its place.
        beside: The name of the element that contains it.
    """
    names = cache(lambda: list(known))
    return lambda: did_you_mean(wrong, names(), beside), lambda: renamings(
        nearest(wrong, similar(wrong, names(), beside)), write
    )


def nearest(wrong: str, names: Sequence[str]) -> Sequence[str]:
    """Of some names, those that a wrong one is made to by as few edits, or one more; all if each continues it."""
    if len(names) < 2 or all(continues(wrong, name) for name in names):
        return names
    counts = [edits(wrong, name) for name in names]
    return [name for name, count in zip(names, counts, strict=True) if count <= min(counts) + 1]


def renamings(names: Sequence[str], write: Callable[[str], tuple[Edit, ...]]) -> list[Fix]:
    """Proposals to write one of a few names; none if there are more."""
    few = names if len(names) <= _FEW else ()
    return [Fix(f"write '{name}'", write(name), f"did you mean '{name}'?", rivals=True) for name in few]
