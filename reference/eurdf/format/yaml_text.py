"""Plain values as readable YAML text, which has the same values in YAML 1.2 and 1.1."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any, NamedTuple

from eurdf.reading.core_schema import resolve

Value = str | int | float | bool | Sequence["Value"] | Mapping[str, "Value"] | None

#: Maximum width of a list or mapping on one line.
WIDTH = 100

#: Maximum length of a key before a colon without a question mark; YAML sets 1024.
_LONGEST_KEY = 1000

# Text without a character that is special in YAML, in a block or between brackets.
_SAFE = re.compile(r"[\w./](?:[\w./+ -]*[\w./+-])?")

# Plain text by the core schema that YAML 1.1 parsers read as a truth value or a number.
_YAML_1_1_BOOL = frozenset({"y", "n", "yes", "no", "on", "off"})
_YAML_1_1_NUMBER = re.compile(r"[-+.\d][\d_.eE+-]*|0[xob][\da-fA-F_]*|[-+]?\.(?:inf|nan)", re.IGNORECASE)

_ESCAPES = {'"': '\\"', "\\": "\\\\", "\n": "\\n", "\r": "\\r", "\t": "\\t"}


class YamlEntry(NamedTuple):
    """An entry of a mapping or a list, with the comments that go with it.

    Attributes:
        lines: Its text, without indentation.
        above: Comments on their own lines before it, each from its ``#`` on.
        beside: Comment at the end of its first line, or empty.
    """

    lines: tuple[str, ...]
    above: tuple[str, ...] = ()
    beside: str = ""

    def text(self, indent: str = "") -> Iterator[str]:
        """Its lines."""
        first, *rest = self.lines
        yield from (indent + comment for comment in self.above)
        yield indent + first + (f"  {self.beside}" if self.beside else "")
        yield from (indent + line for line in rest)


def scalar(value: str | float | bool | None) -> str:
    """A text, number, truth value or null, quoted where it must be."""
    if isinstance(value, str):
        return value if _is_plain(value) else _quoted(value)
    if value is None:
        return "null"
    if isinstance(value, bool):
        return "true" if value else "false"
    text = repr(value)
    # "1e-05" is a number by the core schema, but a text in YAML 1.1.
    return text.replace("e", ".0e") if "e" in text and "." not in text else text


def flow(value: Value) -> str:
    """Any value on one line."""
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{_flow_key(key)}: {flow(inner)}" for key, inner in value.items()) + "}"
    if isinstance(value, str | int | float) or value is None:
        return scalar(value)
    return "[" + ", ".join(map(flow, value)) + "]"


def lines_of(key: str, value: Value) -> tuple[str, ...]:
    """The lines of an entry of a mapping: one where the value fits on it, else a block."""
    name = scalar(key)
    head = f"{name}:" if len(name) <= _LONGEST_KEY else f"? {name}\n:"
    return _lines(head, value)


def lines_of_item(value: Value) -> tuple[str, ...]:
    """The lines of an item of a list."""
    return _lines("-", value)


def item_of_mapping(mapping: Mapping[str, Value]) -> tuple[str, ...]:
    """The lines of an item of a list, each of its keys on a line of its own."""
    first, *rest = (line for key, value in mapping.items() for line in lines_of(key, value))
    return (f"- {first}", *(f"  {line}" for line in rest))


def section(key: str, items: Iterable[YamlEntry], above: Iterable[str] = (), beside: str = "") -> YamlEntry:
    """A key and, indented below it, the entries of its mapping or list."""
    lines = (line for item in items for line in item.text("  "))
    return YamlEntry((f"{scalar(key)}:", *lines), tuple(above), beside)


def entries_of(content: Mapping[str, Any]) -> Iterator[YamlEntry]:
    """The entries of a description of version 2: a line for each key of a closure, and for each element of others."""
    for key, value in content.items():
        if key == "closures":
            yield section(key, [YamlEntry(item_of_mapping(item)) for item in value])
        elif key in ("couplings", "frames"):
            yield section(key, [YamlEntry(lines_of_item(item)) for item in value])
        elif key in ("joints", "configurations", "metadata"):
            yield section(key, [YamlEntry(lines_of(name, item)) for name, item in value.items()])
        else:
            yield YamlEntry(lines_of(key, value))


def modeline(schema: str) -> str:
    """The comment by which an editor finds the schema."""
    return f"# yaml-language-server: $schema={schema}"


def text_of(entries: Iterable[YamlEntry]) -> str:
    """The text of a file."""
    return "".join(f"{line}\n" for entry in entries for line in entry.text())


def _lines(head: str, value: Value) -> tuple[str, ...]:
    one = f"{head} {flow(value)}"
    block: tuple[str, ...] | None = None
    if len(one) > WIDTH and value and not isinstance(value, str | int | float):
        if isinstance(value, Mapping):
            block = tuple(line for key, inner in value.items() for line in lines_of(key, inner))
        else:
            block = tuple(line for inner in value for line in lines_of_item(inner))
    if block is None:
        return tuple(one.split("\n"))
    if head == "-":
        first, *rest = block
        return (f"- {first}", *(f"  {line}" for line in rest))
    return (*head.split("\n"), *(f"  {line}" for line in block))


def _flow_key(key: str) -> str:
    name = scalar(key)
    return name if len(name) <= _LONGEST_KEY else f"? {name} "


def _is_plain(text: str) -> bool:
    return (
        _SAFE.fullmatch(text) is not None
        and isinstance(resolve(text), str)
        and text.lower() not in _YAML_1_1_BOOL
        and _YAML_1_1_NUMBER.fullmatch(text) is None
    )


def _quoted(text: str) -> str:
    return '"' + "".join(map(_escaped, text)) + '"'


def _escaped(character: str) -> str:
    if character in _ESCAPES:
        return _ESCAPES[character]
    # YAML counts a byte order mark as printable, but it is invisible.
    if character.isprintable():
        return character
    code = ord(character)
    return f"\\x{code:02x}" if code < 0x100 else f"\\u{code:04x}" if code < 0x10000 else f"\\U{code:08x}"
