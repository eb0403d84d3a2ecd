"""Places that are counted in another way, or are those of something else."""

from __future__ import annotations

import re
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
    return instead(source, "_BREAK", re.compile("\r?\n"))


@mutant("EU-DIA-011")
def carriage_return_and_line_feed_end_two_lines() -> Deviation:
    """A carriage return and a line feed end a line each."""
    return instead(source, "_BREAK", re.compile("[\r\n]"))


@mutant("EU-DIA-011")
def lines_of_unicode() -> Deviation:
    """A line ends also where Unicode has a separator, as for str.splitlines and libyaml."""
    return instead(source, "_BREAK", re.compile("\r\n|[\n\r\v\f\x1c-\x1e\x85\u2028\u2029]"))


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
