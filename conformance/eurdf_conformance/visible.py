"""Escapes text of unknown origin so that it can be shown safely."""

from __future__ import annotations

import re
import unicodedata

#: Characters that are kept of a text of a parser; and of its name.
LONGEST, LONGEST_NAME = 2000, 200

# They join letters, or part them, as some scripts and many pictures need it.
_JOINERS = "\u200c\u200d"

# GitHub takes a line that begins so for a command of a workflow.
_COMMAND = re.compile(r"(?m)^([^\S\n]*)::")


def visible(text: str, kept: str = "\n\t") -> str:
    r"""The text with every character that is not seen, or that steers a terminal, as its escape (``\x1b``).

    So a parser can neither clear the screen nor reverse the text beside its words, nor give a command to a log.
    Letters, spaces and pictures of all scripts stay as they are.

    Args:
        text: The text.
        kept: What stays as well: where one line is to be one line, nothing.
    """
    text = _COMMAND.sub(r"\1\\x3a:", text)
    if text.isprintable():
        return text
    return "".join(c if c in kept or _is_plain(c) else c.encode("unicode_escape").decode("ascii") for c in text)


def cut(text: str, most: int = LONGEST) -> str:
    """The text, or its beginning where it is long: what a parser writes fills no log."""
    return text if len(text) <= most else f"{text[:most]}… ({len(text):,} characters)"


def _is_plain(character: str) -> bool:
    return character.isprintable() or character in _JOINERS or unicodedata.category(character) == "Zs"
