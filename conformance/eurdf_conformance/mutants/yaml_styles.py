"""Scalars of a description whose quotes, blocks and anchors are misread."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Any

from yaml.events import ScalarEvent

from eurdf.reading.core_schema import resolve
from eurdf.reading.yaml_reader import _Reader
from eurdf_conformance.level import Level
from eurdf_conformance.mutants.deviation import Deviation, around, together
from eurdf_conformance.mutants.mutant import mutant


def _text(style: str, change: Callable[[str], str]) -> Deviation:
    """The text of scalars of some styles, told by their first character, is another."""

    def scalar(original: Any, self: Any, event: ScalarEvent) -> None:
        if event.style and event.style in style:
            event.value = change(event.value)
        original(self, event)

    return around(_Reader, "_scalar", scalar)


def _plain(where: Callable[[ScalarEvent], bool]) -> Deviation:
    """Some scalars are resolved as if they were plain."""

    def scalar(original: Any, self: Any, event: ScalarEvent) -> None:
        if where(event):
            event.value, event.implicit = event.value.strip(), (True, False)
        original(self, event)

    return around(_Reader, "_scalar", scalar)


@mutant("EU-YML-011")
def folded_block_is_literal() -> Deviation:
    """The lines of a folded block are not joined."""
    return _text(">", lambda text: text.replace(" ", "\n"))


@mutant("EU-YML-011")
def literal_block_is_folded() -> Deviation:
    """The lines of a literal block are joined, as those of a folded one."""
    return _text("|", lambda text: re.sub(r"(?<!\n)\n(?!\n|$)", " ", text))


@mutant("EU-YML-011")
def end_of_a_block_is_dropped() -> Deviation:
    """A block scalar does not end with a line break."""
    return _text("|>", lambda text: text.rstrip("\n"))


@mutant("EU-YML-011")
def end_of_a_block_is_one_line_break() -> Deviation:
    """A block scalar ends with one line break at most, though all are to be kept."""
    return _text("|>", lambda text: re.sub("\n+$", "\n", text))


@mutant("EU-YML-011")
def blocks_are_resolved() -> Deviation:
    """A block scalar that looks like a number is one."""
    return _plain(lambda event: event.style in ("|", ">"))


@mutant("EU-YML-011")
def empty_quotes_are_null() -> Deviation:
    """A text of no characters, in quotes, is null."""
    return _plain(lambda event: event.style in ("'", '"') and event.value == "")


@mutant("EU-YML-011")
def quoted_text_is_trimmed() -> Deviation:
    """The blanks at both ends of a text in quotes are dropped."""
    return _text("'\"", str.strip)


@mutant("EU-YML-011")
def single_quotes_have_escapes() -> Deviation:
    r"""A \n or \t in single quotes is a line break or a tab, as in double ones."""
    return _text("'", lambda text: text.replace("\\n", "\n").replace("\\t", "\t"))


@mutant("EU-YML-011")
def doubled_quote_is_two() -> Deviation:
    """A quote that is doubled within single quotes is two."""
    return _text("'", lambda text: text.replace("'", "''"))


@mutant("EU-YML-006", level=Level.STRUCTURE)
def alias_of_a_text_is_resolved() -> Deviation:
    """An alias of a text in quotes that looks like a number is the number."""

    def alias(original: Any, self: Any, event: Any) -> None:
        value, where = self._anchors.get(event.anchor, (None, None))
        if isinstance(value, str) and value:
            self._anchors[event.anchor] = resolve(value), where
        original(self, event)

    return around(_Reader, "_alias", alias)


@mutant("EU-YML-006")
def alias_as_a_key_refused() -> Deviation:
    """An alias may not be a key."""

    def alias(original: Any, self: Any, event: Any) -> None:
        if self._open[-1].awaits_key:
            raise self._fault("yaml-key-not-string", "a key is an alias", event)
        original(self, event)

    return around(_Reader, "_alias", alias)


@mutant("EU-YML-006")
def anchors_of_keys_are_unknown() -> Deviation:
    """An anchor before a key marks nothing."""

    def scalar(original: Any, self: Any, event: ScalarEvent) -> None:
        if self._open[-1].awaits_key:
            event.anchor = None
        original(self, event)

    return around(_Reader, "_scalar", scalar)


@mutant("EU-YML-006", level=Level.STRUCTURE)
def anchors_are_set_at_the_end() -> Deviation:
    """An anchor is set where what it marks ends, so that one of the same name within it is the earlier."""

    def end(original: Any, self: Any, event: Any) -> None:
        ended = self._open[-1]
        begun = self._begun.pop()
        original(self, event)
        if begun is not None:
            self._anchors[begun] = ended.data, ended

    def begin(original: Any, self: Any, event: Any, *arguments: Any) -> None:
        self.__dict__.setdefault("_begun", []).append(event.anchor)
        original(self, event, *arguments)

    return together(around(_Reader, "_begin", begin), around(_Reader, "_end", end))


@mutant("EU-YML-011")
def lines_of_text_end_as_in_the_file() -> Deviation:
    """The lines of a text end as they do in the file, where that is not at a line feed."""

    def scalar(original: Any, self: Any, event: Any) -> None:
        written = self._source.text[event.start_mark.index : event.end_mark.index]
        ends = re.search("\r\n?", written)
        event.value = event.value.replace("\n", ends[0]) if ends else event.value
        original(self, event)

    return around(_Reader, "_scalar", scalar)
