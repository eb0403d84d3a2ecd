"""Text of a file or a path, made safe to be printed in a terminal or a log."""

from __future__ import annotations


def visible(text: str) -> str:
    r"""The text with invisible and control characters replaced by escapes (``\x1b``)."""
    if text.isprintable():
        return text
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode("ascii") for c in text)


def no_command(line: str) -> str:
    r"""A line that is not a command of a workflow: GitHub runs what begins with ``::``, here ``\x3a:``."""
    text = line.lstrip()
    return line[: len(line) - len(text)] + r"\x3a" + text[1:] if text.startswith("::") else line
