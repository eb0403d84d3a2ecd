"""Places that are counted in another way, or are those of something else."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from eurdf.diagnostics import Place
from eurdf.reading import source, yaml_node
from eurdf.reading.source import Source
from eurdf.reading.xml_reader import XmlDocument
from eurdf.reading.yaml_reader import YamlDocument
from eurdf_conformance.mutants.deviation import Deviation, around, instead
from eurdf_conformance.mutants.mutant import mutant
from eurdf_conformance.mutants.of_the_reference import each_issue
from eurdf_conformance.protocol.message import Issue


def _before(self: Source, index: int) -> str:
    """What stands on the line of a character, before it."""
    start = max((found.end() for found in re.finditer("\r\n?|\n", self.text[:index])), default=0)
    return self.text[start:index]


def _columns(count: Any) -> Deviation:
    """Columns are what is counted on the line before a character."""

    def position(original: Any, self: Source, index: int) -> tuple[int, int]:
        line, _ = original(self, index)
        return line, count(_before(self, index)) + 1

    return around(Source, "position", position)


@mutant("EU-DIA-011")
def lines_from_0() -> Deviation:
    """Lines are counted from 0."""
    return each_issue(lambda issue: {"line": None if issue.line is None else issue.line - 1})


@mutant("EU-DIA-011")
def carriage_return_ends_no_line() -> Deviation:
    """A carriage return alone ends no line."""
    return instead(source, "BREAK", re.compile("\r?\n"))


@mutant("EU-DIA-011")
def carriage_return_and_line_feed_end_two_lines() -> Deviation:
    """A carriage return and a line feed end a line each."""
    return instead(source, "BREAK", re.compile("[\r\n]"))


@mutant("EU-DIA-011")
def lines_of_unicode() -> Deviation:
    """A line ends also where Unicode has a separator, as for str.splitlines and libyaml."""
    return instead(source, "BREAK", re.compile("\r\n|[\n\r\v\f\x1c-\x1e\x85\u2028\u2029]"))


@mutant("EU-DIA-012")
def columns_from_0() -> Deviation:
    """Columns are counted from 0."""
    return each_issue(lambda issue: {"column": None if issue.column is None else issue.column - 1})


@mutant("EU-DIA-012")
def columns_in_bytes() -> Deviation:
    """Columns count bytes of UTF-8."""
    return _columns(lambda before: len(before.encode()))


@mutant("EU-DIA-012")
def columns_in_utf_16() -> Deviation:
    """Columns count code units of UTF-16, as in JavaScript, C# and Java."""
    return _columns(lambda before: len(before.encode("utf-16-le")) // 2)


@mutant("EU-DIA-012")
def tabs_of_8() -> Deviation:
    """A tab counts up to the next multiple of 8."""
    return _columns(lambda before: len(before.expandtabs(8)))


@mutant("EU-DIA-012")
def byte_order_mark_is_a_column() -> Deviation:
    """The byte order mark counts as a character of its line."""

    def position(original: Any, self: Source, index: int) -> tuple[int, int]:
        line, column = original(self, index)
        marked = Path(self.file).read_bytes().startswith(source.BOM)
        return line, column + (marked and line == 1)

    return around(Source, "position", position)


@mutant("EU-DIA-009")
def no_columns() -> Deviation:
    """Only the line is told."""
    return each_issue(lambda issue: {"column": None})


@mutant("EU-DIA-009")
def file_with_its_folder() -> Deviation:
    """The file is told with the folder that it is in."""
    return each_issue(lambda issue: {"file": f"case/{issue.file}"})


@mutant("EU-DIA-009")
def always_in_the_description() -> Deviation:
    """What is wrong with the URDF is told of the description."""
    return each_issue(lambda issue: {"file": "robot.yaml"})


@mutant("EU-DIA-009")
def end_in_place_of_beginning() -> Deviation:
    """The column is that at which something ends."""

    def place(original: Any, self: Source, start: int, *arguments: Any) -> Place:
        found: Place = original(self, start, *arguments)
        return Place(found.file, found.line, found.end_column or found.column, None, found.pointer)

    return around(Source, "place", place)


@mutant("EU-DIA-009")
def key_in_place_of_value() -> Deviation:
    """What is wrong with a value of the description is told of its key."""
    return around(YamlDocument, "place", lambda original, self, pointer=(), key=False: original(self, pointer, True))


@mutant("EU-DIA-009")
def anchor_in_place_of_alias() -> Deviation:
    """A value that an alias gives has the place of its anchor."""
    return around(yaml_node.Alias, "__init__", lambda original, self, span, target: original(self, target.span, target))


@mutant("EU-DIA-009")
def element_in_place_of_attribute() -> Deviation:
    """What is wrong with an attribute is told of its element."""
    return around(XmlDocument, "place", lambda original, self, element, attribute=None: original(self, element))


@mutant("EU-DIA-009")
def quote_before_the_attribute() -> Deviation:
    """The value of an attribute begins with its quote."""

    def place(original: Any, self: XmlDocument, element: Any, attribute: str | None = None) -> Place:
        found: Place = original(self, element, attribute)
        if attribute is None or element.get(attribute) is None or found.column is None:
            return found
        return Place(found.file, found.line, found.column - 1)

    return around(XmlDocument, "place", place)


@mutant("EU-DIA-009")
def lines_of_libxml2() -> Deviation:
    """What is wrong with the URDF is told of the line at which libxml2 says that a start tag ends."""

    def place(original: Any, self: XmlDocument, element: Any, attribute: str | None = None) -> Place:
        found: Place = original(self, element, attribute)
        return Place(found.file, element.sourceline, found.column)

    return around(XmlDocument, "place", place)


@mutant("EU-DIA-010")
def file_as_a_whole_at_its_beginning() -> Deviation:
    """What points at a file as a whole points at its first character."""

    def placed(issue: Issue) -> dict[str, Any]:
        return {"line": 1, "column": 1} if issue.line is None else {}

    return each_issue(placed)


def _elsewhere(where: Callable[[YamlDocument, str, int, Sequence[str | int], bool], int]) -> Deviation:
    """What is told of the description begins at another character; given are its text, where it begins, and of what."""

    def place(original: Any, self: YamlDocument, pointer: Sequence[str | int] = (), key: bool = False) -> Place:
        found: Place = original(self, pointer, key)
        if found.line is None or found.column is None:
            return found
        text = self.source.text
        lines = [0, *(end.end() for end in re.finditer("\r\n?|\n", text))]
        begins = lines[found.line - 1] + found.column - 1
        return self.source.place(where(self, text, begins, pointer, key))

    return around(YamlDocument, "place", place)


def _passed_over(pattern: str) -> Deviation:
    """What stands before a value, or begins it, is passed over."""
    before = re.compile(pattern)

    def where(document: YamlDocument, text: str, begins: int, pointer: Sequence[str | int], key: bool) -> int:
        found = before.match(text, begins)
        return found.end() if found else begins

    return _elsewhere(where)


@mutant("EU-DIA-009")
def anchors_and_tags_are_passed_over() -> Deviation:
    """A value begins after the anchor and the tag that stand before it on its line."""
    return _passed_over(r"(?:[&!]\S*[ \t]+)+(?=\S)")


@mutant("EU-DIA-009")
def anchors_before_blocks_are_passed_over() -> Deviation:
    """A mapping or list in block style begins at its first key or dash, whatever anchor or tag stands before that."""
    return _passed_over(r"(?:[&!]\S*[ \t]*)+(?:#[^\n]*)?\n\s*")


@mutant("EU-DIA-009")
def anchors_before_tags_are_passed_over() -> Deviation:
    """A value begins with its tag, after the anchor."""
    return _passed_over(r"&\S*[ \t]+")


@mutant("EU-DIA-009")
def keys_begin_after_their_quote() -> Deviation:
    """A key in quotes begins after the first of them."""
    return _elsewhere(lambda document, text, begins, pointer, key: begins + (key and text[begins] in "\"'"))


@mutant("EU-DIA-009")
def blocks_begin_with_their_text() -> Deviation:
    """A block scalar begins with its text."""
    return _passed_over(r"[|>][^\n]*\n\s*")


@mutant("EU-DIA-009")
def nothing_stands_where_its_line_ends() -> Deviation:
    """A value that is left empty stands where its line ends, after the comment."""

    def where(document: YamlDocument, text: str, begins: int, pointer: Sequence[str | int], key: bool) -> int:
        empty = text[begins - 1 : begins] in (":", "-") and not key
        return begins + len(re.split("[\r\n]", text[begins:])[0]) if empty else begins

    return _elsewhere(where)


def _of_the_urdf(deviation: Callable[[], Deviation]) -> Deviation:
    """Places are others in the URDF alone, whose parser is another library than that of the description."""

    def position(original: Any, self: Source, index: int) -> tuple[int, int]:
        if self.file.endswith(".urdf"):
            with instead(Source, "position", original), deviation():
                return Source(self.file, self.text, self.data).position(index)
        line, column = original(self, index)
        return line, column

    return around(Source, "position", position)


@mutant("EU-DIA-012")
def columns_in_bytes_of_the_urdf() -> Deviation:
    """In the URDF columns count bytes of UTF-8."""
    return _of_the_urdf(columns_in_bytes.deviation)


@mutant("EU-DIA-012")
def columns_in_utf_16_of_the_urdf() -> Deviation:
    """In the URDF columns count code units of UTF-16."""
    return _of_the_urdf(columns_in_utf_16.deviation)


@mutant("EU-DIA-012")
def tabs_of_8_in_the_urdf() -> Deviation:
    """In the URDF a tab counts up to the next multiple of 8."""
    return _of_the_urdf(tabs_of_8.deviation)


@mutant("EU-DIA-012")
def byte_order_mark_of_the_urdf_is_a_column() -> Deviation:
    """The byte order mark of the URDF counts as a character of its line."""
    return _of_the_urdf(byte_order_mark_is_a_column.deviation)


@mutant("EU-DIA-011")
def carriage_return_in_the_urdf_ends_no_line() -> Deviation:
    """In the URDF a carriage return alone ends no line."""
    return _of_the_urdf(carriage_return_ends_no_line.deviation)


@mutant("EU-DIA-011")
def two_characters_in_the_urdf_end_two_lines() -> Deviation:
    """In the URDF a carriage return and a line feed end a line each."""
    return _of_the_urdf(carriage_return_and_line_feed_end_two_lines.deviation)


@mutant("EU-DIA-011")
def lines_of_unicode_in_the_urdf() -> Deviation:
    """In the URDF a line ends also where Unicode has a separator."""
    return _of_the_urdf(lines_of_unicode.deviation)
