"""The blocks of a chapter: headings, prose, code and directives.

This is the part of MyST that the specification is written in, and no more: it is read without Sphinx, so that tests and
other programs need nothing but Python.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

#: Directives whose body is not Markdown.
VERBATIM = frozenset({"api", "code", "code-block", "example", "math", "raw", "sourcecode", "toctree", "transcript"})

_FENCE = re.compile(r"^(?P<indent> *)(?P<marks>`{3,}|~{3,}|:{3,}) *(?P<info>.*?) *$")
_DIRECTIVE = re.compile(r"^\{(?P<name>[A-Za-z0-9_:-]+)\} *(?P<argument>.*)$")
_OPTION = re.compile(r"^ *:(?!::)(?P<name>[^:\s]+):(?: +(?P<value>.*?))? *$")
_HEADING = re.compile(r"^(?P<marks>#{1,6}) +(?P<text>.*?) *#* *$")


@dataclass(frozen=True, slots=True)
class Heading:
    """A heading, with its rank from 1."""

    line: int
    rank: int
    text: str


@dataclass(frozen=True, slots=True)
class Prose:
    """A paragraph, list or table: lines without a blank line between them."""

    line: int
    text: str


@dataclass(frozen=True, slots=True)
class Code:
    """A fenced block of code, with the language that its fence names."""

    line: int
    language: str
    text: str


@dataclass(frozen=True, slots=True)
class Directive:
    """A directive.

    Attributes:
        line: Line of its fence, from 1.
        name: Its name, as ``clause``.
        argument: What follows the name.
        options: Its options, by name; the value of a flag is empty.
        body: Its body, without the options.
        body_line: Line at which the body begins.
    """

    line: int
    name: str
    argument: str
    options: Mapping[str, str]
    body: str
    body_line: int

    @property
    def is_code(self) -> bool:
        """Whether its body is not Markdown."""
        return self.name in VERBATIM


Block = Heading | Prose | Code | Directive


def read_blocks(text: str, first_line: int = 1) -> Iterator[Block]:
    """The blocks of a chapter or of a directive's body, in order, without those inside directives.

    Args:
        text: Markdown.
        first_line: Number of its first line.
    """
    lines = text.splitlines()
    index = 0
    while index < len(lines):
        line = lines[index]
        if not line.strip():
            index += 1
        elif fence := _FENCE.match(line):
            end = _end_of(lines, index, fence["marks"])
            content = [_without_indent(inner, len(fence["indent"])) for inner in lines[index + 1 : end]]
            yield _fenced(fence, content, first_line + index)
            index = end + 1
        elif heading := _HEADING.match(line):
            yield Heading(first_line + index, len(heading["marks"]), heading["text"])
            index += 1
        else:
            start = index
            while index < len(lines) and lines[index].strip() and not _begins_other(lines[index]):
                index += 1
            yield Prose(first_line + start, "\n".join(lines[start:index]))


def walk(text: str, first_line: int = 1) -> Iterator[Block]:
    """The blocks of a chapter; the blocks inside a directive follow it."""
    for block in read_blocks(text, first_line):
        yield block
        if isinstance(block, Directive) and not block.is_code:
            yield from walk(block.body, block.body_line)


def _begins_other(line: str) -> bool:
    return bool(_FENCE.match(line) or _HEADING.match(line))


def _end_of(lines: list[str], start: int, marks: str) -> int:
    """Index of the line that closes a fence; after the last line if none does."""
    closing = re.compile(rf"^ *{re.escape(marks[0])}{{{len(marks)},}} *$")
    return next((index for index in range(start + 1, len(lines)) if closing.match(lines[index])), len(lines))


def _without_indent(line: str, indent: int) -> str:
    return line[min(indent, len(line) - len(line.lstrip(" "))) :]


def _fenced(fence: re.Match[str], content: list[str], line: int) -> Code | Directive:
    directive = _DIRECTIVE.match(fence["info"])
    if directive is None:
        return Code(line, fence["info"], "\n".join(content))
    options = {}
    while content and (option := _OPTION.match(content[0])):
        options[option["name"]] = _unquoted(option["value"] or "")
        del content[0]
        line += 1
    start = line - len(options)
    body_line = line + 1
    while content and not content[0].strip():
        del content[0]
        body_line += 1
    body = "\n".join(content).rstrip()
    return Directive(start, directive["name"], directive["argument"], options, body, body_line)


def _unquoted(value: str) -> str:
    """The value of an option, without the quotes that MyST needs around a value with a colon."""
    return value[1:-1] if len(value) > 1 and value[0] == value[-1] == '"' else value
