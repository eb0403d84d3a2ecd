"""A named configuration written into the text of a description; all else stays character by character."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from itertools import takewhile
from typing import Any

from eurdf.diagnostics.lines import BREAK
from eurdf.format.model import VERSION2
from eurdf.format.yaml_text import Value, flow, lines_of
from eurdf.reading.yaml_node import YamlCollection, end_of, start_of
from eurdf.reading.yaml_reader import YamlDocument, plain_data


class NotEditable(Exception):  # noqa: N818 - shown to the user as it is
    """The file has a form in which the configuration cannot be changed without changing something else."""


def with_configuration(document: YamlDocument, name: str, coordinates: Mapping[str, Sequence[float]]) -> str:
    """The text of a description of version 2 with a named configuration added, or its coordinates replaced.

    The coordinates are given by joint, as files have them. Comments, also those inside a configuration that is
    replaced, and the rest of the text stay as they are. A joint that the file states and ``coordinates`` does not is an
    error: where it is at its neutral, state that.

    Raises:
        NotEditable: The result does not read back as it should, such as where an anchor is involved.
    """
    value: dict[str, Value] = {joint: _plain(values) for joint, values in coordinates.items()}
    text = _ChangedText(document).stated(name, value)
    if not _reads_back(text, document.data, name, value):
        raise NotEditable(f"configuration '{name}' cannot be written without changing other parts of the file")
    return text


class _ChangedText:
    """One text and the changes to it."""

    def __init__(self, document: YamlDocument) -> None:
        self._text = document.source.text
        self._root = document.root
        self._as_json = document.root.is_flow
        found = BREAK.search(self._text)
        self._break = found.group() if found else "\n"
        self._changes: list[tuple[int, int, str]] = []

    def stated(self, name: str, value: dict[str, Value]) -> str:
        configurations = self._root.nodes.get("configurations")
        if configurations is None:
            before = tuple(takewhile(lambda key: key != "configurations", VERSION2.all_keys))
            last = [key for key in self._root.nodes if key in before][-1]
            self._add(self._root, last, {"configurations": {name: value}})
        elif not isinstance(configurations, YamlCollection):
            raise NotEditable("'configurations' is an alias")
        elif name in configurations.nodes:
            self._replace(configurations, name, value)
        elif configurations.nodes:
            self._add(configurations, list(configurations.nodes)[-1], {name: value})
        else:
            self._fill(self._root, "configurations", {name: value})
        text = self._text
        for start, end, new in sorted(self._changes, reverse=True):
            text = text[:start] + new + text[end:]
        return text

    def _replace(self, configurations: YamlCollection, name: str, value: dict[str, Value]) -> None:
        """Give a configuration that is there its new coordinates, joint by joint, for comments may be between them."""
        old = configurations.nodes[name]
        if isinstance(old, YamlCollection) and not old.nodes:
            self._fill(configurations, name, value)
            return
        if not isinstance(old, YamlCollection):  # an alias of a configuration
            self._change(start_of(old), end_of(old), self._flow(value))
            return
        for joint, coordinates in value.items():
            if joint in old.nodes and not _same(old.data[joint], coordinates):
                start = start_of(old.nodes[joint])
                # The items of a list may be below their key, which nothing else may.
                deeper = "  " if self._indent(start) is not None and self._text[start] == "-" else ""
                self._change(start, end_of(old.nodes[joint]), deeper + self._flow(coordinates))
        new = {joint: coordinates for joint, coordinates in value.items() if joint not in old.nodes}
        if new:
            self._add(old, list(old.nodes)[-1], new)

    def _add(self, mapping: YamlCollection, last: str | int, entries: Mapping[str, Value]) -> None:
        """Add entries behind one that a mapping has."""
        key_start, key_end = mapping.keys[last]
        end = max(end_of(mapping.nodes[last]), key_end or 0)
        indent = self._indent(key_start)
        if mapping.is_flow:
            # On a line of its own where that one is.
            separator = ", " if indent is None else f",{self._break}{indent}"
            text = "".join(f"{separator}{self._flow({key: value})[1:-1]}" for key, value in entries.items())
            self._change(end, end, text)
            return
        if indent is None:
            raise NotEditable("a key does not begin its line")
        lines = [line for key, value in entries.items() for line in _lines(key, value)]
        at = self._line_after(end)
        text = "".join(f"{indent}{line}{self._break}" for line in lines)
        begins_line = at == 0 or self._text[at - 1] in "\r\n"
        self._change(at, at, text if begins_line else self._break + text)

    def _fill(self, around: YamlCollection, key: str, value: Mapping[str, Value]) -> None:
        """Give an empty mapping its entries: between its braces, or in lines below its key."""
        lines = _lines(key, value)[1:]
        start, end = start_of(around.nodes[key]), end_of(around.nodes[key])
        indent = self._indent(around.keys[key][0])
        if not lines or around.is_flow or indent is None:
            self._change(start, end, self._flow(value))
            return
        while self._text[start - 1] == " ":  # behind the colon
            start -= 1
        self._change(start, end, (self._break + indent).join(("", *lines)))

    def _flow(self, value: Value) -> str:
        return _json(value) if self._as_json else flow(value)

    def _change(self, start: int, end: int, new: str) -> None:
        self._changes.append((start, end, new))

    def _indent(self, index: int) -> str | None:
        """What is before a character on its line, where that is blanks alone."""
        begin = max(self._text.rfind("\n", 0, index), self._text.rfind("\r", 0, index)) + 1
        before = self._text[begin:index]
        return before if not before.strip(" ") else None

    def _line_after(self, index: int) -> int:
        """Where the line after a character begins; a block scalar ends there itself."""
        if index and self._text[index - 1] in "\r\n":
            return index
        found = BREAK.search(self._text, index)
        return found.end() if found else len(self._text)


def _lines(key: str, value: Value) -> Sequence[str]:
    """The lines of an entry; each configuration begins one."""
    if key == "configurations" and isinstance(value, Mapping):
        return f"{key}:", *(f"  {line}" for name, inner in value.items() for line in lines_of(name, inner))
    return lines_of(key, value)


def _json(value: Value) -> str:
    """A value in JSON, in which YAML too takes every character."""
    text = json.dumps(value, ensure_ascii=False)
    return "".join(one if one.isprintable() or ord(one) > 0xFFFF else f"\\u{ord(one):04x}" for one in text)


def _plain(values: Sequence[float]) -> Value:
    """Coordinates as a file has them: whole numbers without a point, one alone without brackets."""
    numbers: list[int | float] = [int(value) if value == int(value) else value for value in map(float, values)]
    return numbers[0] if len(numbers) == 1 else numbers


def _same(old: object, new: Value) -> bool:
    """Whether coordinates are the same numbers, however they are written."""
    as_list = [value if isinstance(value, list) else [value] for value in (old, new)]
    return as_list[0] == as_list[1]


def _reads_back(text: str, before: Mapping[str, Any], name: str, value: Mapping[str, Value]) -> bool:
    """Whether a text has the data of before, and the coordinates in the configuration."""
    after = plain_data(text)
    if after is None:
        return False
    found = after["configurations"].pop(name)
    others = {key: other for key, other in before.get("configurations", {}).items() if key != name}
    same_rest = _canonical({**before, "configurations": others}) == _canonical(after)
    return same_rest and found.keys() == value.keys() and all(_same(found[joint], value[joint]) for joint in value)


def _canonical(value: object) -> str:
    """Plain data as text: 1, 1.0 and true differ in it, the order of keys does not."""
    return json.dumps(value, sort_keys=True)
