"""Reads YAML text as plain values, EU-YML-001 to 010.

The library only finds the structure. What a scalar means is decided by `core_schema`, and by nothing else.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

from ruamel.yaml import YAML
from ruamel.yaml.error import YAMLError
from ruamel.yaml.events import (
    AliasEvent,
    DocumentStartEvent,
    Event,
    MappingEndEvent,
    MappingStartEvent,
    NodeEvent,
    ScalarEvent,
    SequenceEndEvent,
    SequenceStartEvent,
)

from eurdf_conformance.oracle.core_schema import CORE, plain, tagged
from eurdf_conformance.oracle.not_read import NotRead

#: Nodes that all aliases together may add, EU-YML-006, and how deep mappings and lists may be nested, EU-YML-007.
MOST_COPIES = 100_000
DEEPEST = 64

#: Line ends of YAML 1.1, at which the library still breaks lines.
_OLD_BREAKS = "\x85\u2028\u2029"
_MARK = "\ufeff"
_SURROGATE = re.compile("[\ud800-\udfff]")


def value_of(source: str) -> Any:
    """The one document of a text, as dicts with string keys, lists, strings, numbers, booleans and None."""
    unused = (chr(code) for code in range(0xE000, 0xF900) if chr(code) not in source)
    stand_ins = str.maketrans(dict(zip(_OLD_BREAKS, unused, strict=False)))
    if len(stand_ins) < len(_OLD_BREAKS):
        raise NotRead("every character of the private use area")
    try:
        events = list(YAML(typ="safe", pure=True).parse(source.translate(stand_ins)))
    except (YAMLError, AssertionError) as error:  # the second where a directive names a version unknown to it
        raise NotRead(str(error)) from error
    require_marks_in_quotes(source, events)
    starts = [event for event in events if isinstance(event, DocumentStartEvent)]
    if len(starts) != 1:
        raise NotRead(f"{len(starts)} documents")
    if starts[0].version not in (None, (1, 2)):
        raise NotRead(f"YAML version {starts[0].version}")
    originals = {ord(stand_in): code for code, stand_in in stand_ins.items()}
    for event in events:
        if isinstance(event, ScalarEvent):
            event.value = event.value.translate(originals)
    return _Document(iter(events[events.index(starts[0]) + 1 :])).node()[0]


def require_marks_in_quotes(source: str, events: list[Event]) -> None:
    """A byte order mark after the start of a file is inside quotes."""
    outside, end = "", 0
    for event in events:
        if isinstance(event, ScalarEvent) and event.style in ("'", '"'):
            outside, end = outside + source[end : event.start_mark.index], event.end_mark.index
    if _MARK in outside + source[end:]:
        raise NotRead("a byte order mark outside quotes")


class _Document:
    """The events of a document, read once from start to end, and the anchors so far."""

    def __init__(self, events: Iterator[Event]) -> None:
        self.events = events
        self.anchors: dict[str, tuple[Any, int]] = {}
        self.marked: dict[str, int] = {}  # how often each anchor was set
        #: Of each anchor, how many mappings and lists are nested in what it marks.
        self.heights: dict[str, int] = {}
        self.deepest = 0
        self.copies = 0

    def node(self, event: Event | None = None, depth: int = 1) -> tuple[Any, int]:
        """The next node, which would be at a depth, and of how many it is made.

        `event` is its first, if it is taken already.
        """
        event = event or next(self.events)
        if isinstance(event, AliasEvent):
            self.reach(depth - 1 + self.heights.get(event.anchor, 0))
            return self.copy(event.anchor)
        before, self.deepest = self.deepest, depth - 1
        anchor, begun = event.anchor if isinstance(event, NodeEvent) else None, 0
        if anchor is not None:
            # Inside what it marks it means nothing, EU-YML-006, nor for what it marked before.
            self.anchors.pop(anchor, None)
            self.marked[anchor] = begun = self.marked.get(anchor, 0) + 1
        if isinstance(event, SequenceStartEvent):
            found: tuple[Any, int] = self.sequence(event, depth)
        elif isinstance(event, MappingStartEvent):
            found = self.mapping(event, depth)
        elif isinstance(event, ScalarEvent):
            found = scalar(event), 1
        else:
            raise NotRead(f"{event} where a node was due")
        if anchor is not None and self.marked[anchor] == begun:  # else it was set once more inside, which is later
            self.anchors[anchor] = found
            self.heights[anchor] = self.deepest - (depth - 1)
        self.deepest = max(self.deepest, before)
        return found

    def reach(self, depth: int) -> None:
        """Check the depth of a mapping or list, EU-YML-007."""
        self.deepest = max(self.deepest, depth)
        if depth > DEEPEST:
            raise NotRead(f"mappings and lists nested deeper than {DEEPEST}")

    def copy(self, anchor: str) -> tuple[Any, int]:
        """The value of an alias."""
        if anchor not in self.anchors:
            raise NotRead(f"no anchor {anchor!r} before its alias")
        self.copies += self.anchors[anchor][1]
        if self.copies > MOST_COPIES:
            raise NotRead(f"aliases copy more than {MOST_COPIES} nodes")
        return self.anchors[anchor]

    def sequence(self, start: SequenceStartEvent, depth: int) -> tuple[list[Any], int]:
        """A sequence, from the event after its start to its end."""
        require_tag(start, "seq")
        self.reach(depth)
        items, size = [], 1
        while not isinstance(event := next(self.events), SequenceEndEvent):
            item, nodes = self.node(event, depth + 1)
            items.append(item)
            size += nodes
        return items, size

    def mapping(self, start: MappingStartEvent, depth: int) -> tuple[dict[str, Any], int]:
        """A mapping, from the event after its start to its end."""
        require_tag(start, "map")
        self.reach(depth)
        members: dict[str, Any] = {}
        size = 1
        while not isinstance(event := next(self.events), MappingEndEvent):
            key, _ = self.node(event, depth + 1)
            if not isinstance(key, str):
                raise NotRead(f"the key {key!r} is no string")
            if key in members:
                raise NotRead(f"the key {key!r} occurs twice")
            members[key], nodes = self.node(None, depth + 1)
            size += 1 + nodes
        return members, size


def require_tag(event: SequenceStartEvent | MappingStartEvent, kind: str) -> None:
    """A collection has no tag but its own, EU-YML-005."""
    if event.tag not in (None, "!", CORE + kind):
        raise NotRead(f"tag {event.tag}")


def scalar(event: ScalarEvent) -> Any:
    """What a scalar means: with a tag what that says, quoted a string, and plain what it looks like."""
    if _SURROGATE.search(event.value):
        raise NotRead("half a character")
    if event.tag is not None:
        return tagged(event.tag, event.value)
    return event.value if event.style else plain(event.value)
