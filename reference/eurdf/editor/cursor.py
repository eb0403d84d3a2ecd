"""What a description has at the cursor, also while it is being typed and cannot be read."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from eurdf.diagnostics import FileError
from eurdf.editor.names import version_in
from eurdf.format.closure_model import AnyClosure
from eurdf.format.conventions import Version, is_own_key
from eurdf.format.mappings import Alone, Key, OneOf, Record
from eurdf.format.model import MODELS
from eurdf.format.value_types import ByName, ListOf, ValueType
from eurdf.reading.source import Source
from eurdf.reading.yaml_node import Pointer
from eurdf.reading.yaml_reader import read_yaml

# Stands for the word at the cursor.
_MARK = "eurdf-cursor"

# What a line has that matters to brackets: a quoted text, a comment, a bracket.
_TOKEN = re.compile(r"""'(?:[^']|'')*'|"(?:[^"\\]|\\.)*"|(?:^|(?<=\s))#.*|[][{}]""")
_CLOSING = {"[": "]", "{": "}"}


@dataclass(frozen=True)
class Cursor:
    """The place in a description at which a key or a value is typed.

    Attributes:
        data: The description as far as it can be read, with `_MARK` at the cursor.
        pointer: What leads to the value, or to the mapping that gets the key.
        is_key: Whether a key is typed.
        start: Index of the first character of the word at the cursor.
        end: Index of the one after its last.
        begins: Whether what is typed is the first of its line or item, so that a mapping can begin.
        version: The version of the description.
    """

    data: dict[str, Any]
    pointer: Pointer
    is_key: bool
    start: int
    end: int
    begins: bool
    version: Version

    @property
    def around(self) -> Any:
        """The mapping that gets the key; or the mapping or list that contains the value."""
        value: Any = self.data
        for step in self.pointer if self.is_key else self.pointer[:-1]:
            value = value[step]
        return value

    @property
    def taken(self) -> set[str]:
        """The keys, or the texts, that are beside what is typed."""
        beside = self.around if self.is_key or isinstance(self.around, list) else ()
        return {each for each in beside if isinstance(each, str) and each != _MARK}

    def types(self) -> list[ValueType]:
        """The types that the value can have, or the mapping that gets the key."""
        return list(types_at(self.data, self.pointer, self.version))

    def keys(self) -> dict[str, Key]:
        """The keys that the mapping can get."""
        records = [each for each in self.types() if isinstance(each, Record)]
        return {name: key for each in reversed(records) for name, key in each.keys(self.version).items()}


def cursor_at(text: str, index: int) -> Cursor | None:
    """The cursor at a character of a description; None in a comment, and where nothing is known."""
    start, end = word_at(text, index)
    line = text.rfind("\n", 0, index) + 1
    if any(found[0].startswith("#") for found in _TOKEN.finditer(text[line:index])):
        return None
    before = text[:start]
    skeleton = _skeleton(before)
    after = text[end:]
    for head, tail in ((before, after), (before, _closed(before)), (skeleton, _closed(skeleton))):
        for mark in (_MARK, f"{_MARK}:"):
            try:
                data = read_yaml(Source("", content := head + mark + tail, content.encode())).data
            except FileError:
                continue
            found = _find(data, ())
            if found is not None:
                return Cursor(data, *found, start, end, not text[line:start].strip(" -"), version_in(data))
    return None


def word_at(text: str, index: int, others: str = "_./-") -> tuple[int, int]:
    """Where a word begins and ends that is at a character, of letters, digits and the others."""
    start, end = index, index
    while start and (text[start - 1].isalnum() or text[start - 1] in others):
        start -= 1
    while end < len(text) and (text[end].isalnum() or text[end] in others):
        end += 1
    return start, end


def types_at(data: Any, pointer: Pointer, version: Version) -> Iterator[ValueType]:
    """The types that the value at a pointer can have: more than one where it is not decided."""
    kinds: list[ValueType] = [MODELS[version]]
    value = data
    for step in pointer:
        kinds = [
            inner for kind in kinds for form in _forms(kind, value, version) for inner in _inner(form, step, version)
        ]
        value = value[step]
    for kind in kinds:
        yield from _forms(kind, value, version)


def _forms(kind: ValueType, value: Any, version: Version) -> list[ValueType]:
    """The forms of a type, or those that a mapping can become."""
    if isinstance(kind, AnyClosure):
        kind = kind.forms
    if isinstance(kind, OneOf):
        forms = kind.forms(version)
        if isinstance(value, dict):
            forms = [form for form in forms if isinstance(form, Record)]
            named = [form for form in forms if value.get("type") in form.values_of_type()]  # type: ignore[attr-defined]
            known = {key for key in value if isinstance(key, str) and key in kind.keys(version)}
            forms = [form for form in named or forms if known <= form.keys(version).keys()]  # type: ignore[attr-defined]
        return [inner for form in forms for inner in _forms(form, value, version)]
    return _forms(kind.text, value, version) if isinstance(kind, Alone) else [kind]


def _inner(kind: ValueType, step: str | int, version: Version) -> list[ValueType]:
    if isinstance(kind, Record):
        keys = kind.keys(version)
        return [keys[str(step)].type] if step in keys else []
    is_inside = isinstance(kind, ListOf) or (isinstance(kind, ByName) and not is_own_key(str(step)))
    return [kind.item] if is_inside else []  # type: ignore[attr-defined]


def _find(value: Any, at: Pointer) -> tuple[Pointer, bool] | None:
    """The pointer of the mark, or of the mapping that has it as a key, and whether that is so."""
    if value == _MARK:
        return at, False
    if isinstance(value, dict) and _MARK in value:
        return at, True
    items = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    return next((found for step, inner in items if (found := _find(inner, (*at, step))) is not None), None)


def _closed(text: str) -> str:
    """The brackets that are open at the end of a text."""
    opened: list[str] = []
    for line in text.split("\n"):
        for found in _TOKEN.finditer(line):
            if found[0] in _CLOSING:
                opened.append(_CLOSING[found[0]])
            elif opened and found[0] == opened[-1]:
                opened.pop()
    return "".join(reversed(opened))


def _skeleton(text: str) -> str:
    """The last line of a text, and each line above that it is below of, by their indentation."""
    *above, last = text.split("\n")
    kept, depth = [last], _depth(last)
    for line in reversed(above):
        if line.strip() and not line.lstrip().startswith("#") and _depth(line) < depth:
            kept.append(line)
            depth = _depth(line)
    return "\n".join(reversed(kept))


def _depth(line: str) -> float:
    """The indentation of a line; an item can be as far to the left as the key of its list."""
    content = line.lstrip(" ")
    return len(line) - len(content) + (0.5 if content.startswith("- ") or content == "-" else 0.0)
