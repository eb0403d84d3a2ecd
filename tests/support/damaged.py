"""A text with random damage, and what reading it must come to: a document, or an error with a place."""

from __future__ import annotations

import random
from collections.abc import Callable, Sequence
from typing import Any

from eurdf.diagnostics import FileError


def damaged(sample: str, junk: Sequence[str], read: Callable[[str], Any], use: Callable[[Any], object]) -> set[str]:
    """Read damaged copies of a text and use what is read; returns the codes of errors, and "read"."""
    chance, outcomes = random.Random(1), set()
    for _ in range(3000):
        text = sample
        for _ in range(chance.randint(1, 4)):
            start = chance.randrange(len(text))
            end = start + chance.choice([0, 1, 1, 8])
            text = text[:start] + chance.choice(["", *junk]) + text[end:]
        try:
            document = read(text)
        except FileError as error:
            found = error.diagnostic
            assert found.message
            assert not found.message.endswith(".")
            assert found.line is not None
            assert found.line <= text.count("\n") + text.count("\r") + 1
            outcomes.add(found.code)
        else:
            use(document)
            outcomes.add("read")
    return outcomes
