"""Edits of the text of a description: entries and items that are added, replaced or removed; all else stays."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from itertools import takewhile

from eurdf.diagnostics import Edit
from eurdf.diagnostics.lines import BREAK
from eurdf.format.model import VERSION2
from eurdf.format.yaml_text import Value, entries_of, flow, item_of_mapping, lines_of, lines_of_item
from eurdf.reading.yaml_node import YamlCollection, end_of, start_of
from eurdf.reading.yaml_reader import YamlDocument

# What is before an item of a list on its line.
_DASH = re.compile(r" *(?=-\s+$)")


class NotEditable(Exception):  # noqa: N818 - shown to the user as it is
    """The file has a form in which a part of it cannot be changed without changing something else."""


class YamlEdits:
    """One text and the changes to it."""

    def __init__(self, document: YamlDocument) -> None:
        self._source = document.source
        self._text = document.source.text
        self._root = document.root
        self._as_json = document.root.is_flow
        found = BREAK.search(self._text)
        self._break = found.group() if found else "\n"
        self._changes: list[tuple[int, int, str]] = []

    def text(self) -> str:
        """The text with the changes."""
        text = self._text
        for start, end, new in sorted(self._changes, reverse=True):
            text = text[:start] + new + text[end:]
        return text

    def edits(self) -> tuple[Edit, ...]:
        """The changes as edits of the file."""
        return tuple(self._source.edit(*change) for change in self._changes)

    def add_at_top(self, key: str, value: Value) -> None:
        """Add a key that the file does not have, behind those that come before it."""
        before = tuple(takewhile(lambda other: other != key, VERSION2.all_keys))
        # In a file of version 1, behind the last.
        last = [other for other in self._root.nodes if other in before or key not in VERSION2.all_keys][-1]
        self.add(self._root, last, {key: value})

    def add_entries(self, key: str, entries: Mapping[str, Value]) -> None:
        """Add entries to a mapping at the top level, which is made if there is none."""
        mapping = self._collection(key)
        if not entries:
            return
        if mapping is None:
            self.add_at_top(key, entries)
        elif mapping.nodes:
            self.add(mapping, list(mapping.nodes)[-1], entries)
        else:
            self.fill(self._root, key, entries)

    def add_items(self, key: str, values: Sequence[Value]) -> None:
        """Add items to a list at the top level, which is made if there is none."""
        items = self._collection(key)
        if items is None:
            self.add_at_top(key, values)
            return
        if not items.nodes:
            self.change(start_of(items), end_of(items), self.flow(values))
            return
        last = items.nodes[len(items.nodes) - 1]
        if items.is_flow:
            self.change(end_of(last), end_of(last), "".join(f", {self.flow(value)}" for value in values))
            return
        indent = self._of_item(start_of(last))
        as_block = isinstance(last, YamlCollection) and not last.is_flow
        for value in values:
            lines = item_of_mapping(value) if as_block and isinstance(value, Mapping) else lines_of_item(value)
            self._insert_lines(end_of(last), (f"{indent}{line}" for line in lines))

    def _collection(self, key: str) -> YamlCollection | None:
        found = self._root.nodes.get(key)
        if found is not None and not isinstance(found, YamlCollection):
            raise NotEditable(f"'{key}' is an alias, or empty")
        return found

    def add(self, mapping: YamlCollection, last: str | int, entries: Mapping[str, Value]) -> None:
        """Add entries behind one that a mapping has."""
        key_start, key_end = mapping.keys[last]
        end = max(end_of(mapping.nodes[last]), key_end or 0)
        indent = self.indent(key_start)
        if mapping.is_flow:
            # On a line of its own where that one is.
            separator = ", " if indent is None else f",{self._break}{indent}"
            text = "".join(f"{separator}{self.flow({key: value})[1:-1]}" for key, value in entries.items())
            self.change(end, end, text)
            return
        if indent is None:
            raise NotEditable("a key does not begin its line")
        self._insert_lines(end, (f"{indent}{line}" for key, value in entries.items() for line in _lines(key, value)))

    def _insert_lines(self, index: int, lines: Iterable[str]) -> None:
        """Insert lines behind that of a character."""
        at = self._line_after(index)
        text = "".join(f"{line}{self._break}" for line in lines)
        begins_line = at == 0 or self._text[at - 1] in "\r\n"
        self.change(at, at, text if begins_line else self._break + text)

    def fill(self, around: YamlCollection, key: str, value: Mapping[str, Value]) -> None:
        """Give an empty mapping its entries: between its braces, or in lines below its key."""
        lines = _lines(key, value)[1:]
        start, end = start_of(around.nodes[key]), end_of(around.nodes[key])
        indent = self.indent(around.keys[key][0])
        if not lines or around.is_flow or indent is None:
            self.change(start, end, self.flow(value))
            return
        while self._text[start - 1] == " ":  # behind the colon
            start -= 1
        self.change(start, end, (self._break + indent).join(("", *lines)))

    def flow(self, value: Value) -> str:
        """A value on one line; in JSON if the file is."""
        return _json(value) if self._as_json else flow(value)

    def change(self, start: int, end: int, new: str) -> None:
        """Write a text in the place of the characters from ``start`` to before ``end``."""
        self._changes.append((start, end, new))

    def indent(self, index: int) -> str | None:
        """What is before a character on its line, where that is blanks alone."""
        before = self._text[self._line_before(index) : index]
        return before if not before.strip(" ") else None

    def _of_item(self, index: int) -> str:
        """The blanks before the dash of an item of a list."""
        found = _DASH.match(self._text[self._line_before(index) : index])
        if found is None:
            raise NotEditable("an item does not begin its line")
        return found.group()

    def _line_before(self, index: int) -> int:
        """Where the line of a character begins."""
        return max(self._text.rfind("\n", 0, index), self._text.rfind("\r", 0, index)) + 1

    def _line_after(self, index: int) -> int:
        """Where the line after a character begins; a block scalar ends there itself."""
        if index and self._text[index - 1] in "\r\n":
            return index
        found = BREAK.search(self._text, index)
        return found.end() if found else len(self._text)


def edited(document: YamlDocument, change: Callable[[YamlEdits], None]) -> tuple[Edit, ...]:
    """The edits that a change makes; none if the file has a form that does not allow it."""
    edits = YamlEdits(document)
    try:
        change(edits)
    except NotEditable:
        return ()
    return edits.edits()


def _lines(key: str, value: Value) -> Sequence[str]:
    """The lines of an entry; each element of a section begins one."""
    if isinstance(value, Mapping) or (isinstance(value, list) and value and isinstance(value[0], Mapping)):
        return tuple(next(entries_of({key: value})).text())
    return lines_of(key, value)


def _json(value: Value) -> str:
    """A value in JSON, in which YAML too takes every character."""
    text = json.dumps(value, ensure_ascii=False)
    return "".join(one if one.isprintable() or ord(one) > 0xFFFF else f"\\u{ord(one):04x}" for one in text)
