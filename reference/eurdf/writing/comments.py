"""The comments of a YAML file, and the entries they go with."""

from __future__ import annotations

import re
from bisect import bisect
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

import yaml
from yaml.cyaml import CLoader
from yaml.tokens import BlockEntryToken, FlowSequenceStartToken, KeyToken

from eurdf.reading.source import Source
from eurdf.reading.yaml_node import Pointer
from eurdf.reading.yaml_reader import YamlDocument
from eurdf.reading.yaml_syntax import without_other_breaks

_COMMENT = re.compile("#[^\r\n]*")

# What opens something: a comment behind it speaks of what comes after.
_OPENING = (BlockEntryToken, FlowSequenceStartToken, KeyToken)


@dataclass(frozen=True, slots=True)
class Comment:
    """A comment, from its ``#`` on, and where that is: its index in the text of the file, and line and column from 1.

    It is ``beside`` something on its line, and so about that, or alone.
    """

    text: str
    index: int
    line: int
    column: int
    beside: bool


@dataclass(slots=True)
class Attached:
    """The comments that go with one entry: on lines of their own before it, and beside it."""

    above: list[str] = field(default_factory=list)
    beside: list[str] = field(default_factory=list)


def comments_of(source: Source) -> list[Comment]:
    """All comments of a well-formed YAML file, in their order, but for those in the head of a block scalar."""
    text = source.text
    found = []
    end, busy_line = 0, 0
    scanned, _ = without_other_breaks(source)  # with as many characters
    for token in yaml.scan(scanned, Loader=CLoader):
        # Between two tokens there is nothing but white space and comments.
        for comment in _COMMENT.finditer(text, end, token.start_mark.index):
            line, column = source.position(comment.start())
            found.append(Comment(comment.group().rstrip(" \t"), comment.start(), line, column, line == busy_line))
        end = max(end, token.end_mark.index)
        if token.start_mark.index < end and not isinstance(token, _OPENING):
            busy_line, _ = source.position(end - 1)
    return found


def attach(
    comments: Iterable[Comment], pointers: Iterable[Pointer], document: YamlDocument
) -> Mapping[Pointer, Attached]:
    """Find the entry that each comment goes with.

    A comment beside something goes with the entry that begins last before it; beside a key whose whole value is on
    the same line, with the key. A comment on a line of its own goes with the next entry. What is before the first
    entry, or after all, is under the empty pointer: above or beside.
    """
    spots: list[tuple[int, int, Pointer]] = []
    whole: dict[int, Pointer] = {}
    for pointer in pointers:
        start, _ = document.span(pointer, key=len(pointer) == 1)
        line, column = document.source.position(start)
        spots.append((line, column, pointer))
        value = document.place(pointer)
        if len(pointer) == 1 and value.line == line and value.end_column is not None:
            whole[line] = pointer
    spots.sort(key=lambda spot: spot[:2])
    positions = [spot[:2] for spot in spots]
    attached: dict[Pointer, Attached] = {pointer: Attached() for pointer in ((), *(spot[2] for spot in spots))}
    for comment in comments:
        after = bisect(positions, (comment.line, comment.column))
        if not after:
            attached[()].above.append(comment.text)
        elif comment.beside:
            attached[whole.get(comment.line, spots[after - 1][2])].beside.append(comment.text)
        elif after < len(spots):
            attached[spots[after][2]].above.append(comment.text)
        else:
            attached[()].beside.append(comment.text)
    return attached
