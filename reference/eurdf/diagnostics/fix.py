"""A fix: what to write in the place of parts of files, so that a diagnostic is gone."""

from __future__ import annotations

from dataclasses import dataclass, field

from eurdf.diagnostics.lines import Lines


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


@dataclass(frozen=True, slots=True)
class Fix:
    """Edits that make a robot right, and what they do.

    Attributes:
        summary: What they do, in the imperative, without a full stop.
        edits: Parts of files that do not overlap.
        question: The same as a question, for a hint if a trial does not show that the robot becomes right; None if it
            is not worth asking.
    """

    summary: str
    edits: tuple[Edit, ...]
    question: str | None = None

    def texts(self) -> dict[str, str]:
        """The new text of each file that is changed."""
        changed = {edit.file: edit.lines.text for edit in self.edits}
        for edit in sorted(self.edits, key=lambda each: each.start, reverse=True):
            before = changed[edit.file]
            changed[edit.file] = before[: edit.start] + edit.text + before[edit.end :]
        return changed
