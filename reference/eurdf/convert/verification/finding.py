"""What is wrong with an exported file, and why."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Finding:
    """Something that is wrong with a file that was read back.

    Attributes:
        message: What is wrong, with its values.
        causes: What was seen of the cause, and what to do, each a sentence.
    """

    message: str
    causes: tuple[str, ...] = ()

    def __str__(self) -> str:
        return "; ".join((self.message, *self.causes))
