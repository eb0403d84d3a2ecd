"""Errors of a file that have one cause, which one diagnostic names, with the fix (EU-DIA-001, EU-DIA-002)."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from eurdf.diagnostics import Diagnostic, Fix
from eurdf.diagnostics.wording import enumerated, quoted
from eurdf.format.conventions import VERSION2_0, VERSION2_1, VERSION_KEY, is_own_key
from eurdf.format.model import VERSION1
from eurdf.format.other_words import two_sides
from eurdf.format.value_types import Violation
from eurdf.format.yaml_text import flow, scalar
from eurdf.reading.yaml_node import Pointer
from eurdf.reading.yaml_reader import YamlDocument

_MERGE = "<<"


def with_one_cause(found: Sequence[Violation], document: YamlDocument) -> tuple[list[Diagnostic], list[Violation]]:
    """The diagnostics of errors that have one cause, and the other errors."""
    rest = list(found)
    diagnostics: list[Diagnostic] = []
    for cause in (_merge_keys, _two_sides, _later_version, _keys_of_version1):
        for diagnostic, consequences in cause(rest, document):
            diagnostics.append(diagnostic)
            rest = [each for each in rest if each not in consequences]
    return diagnostics, rest


def later_word(violation: Violation) -> str | None:
    """How a message names what only version 2.1 has, if that is the error in a file of version 2.0."""
    if violation.code == "later-value":
        return f"{violation.pointer[-1]} '{violation.value}'"
    if violation.code != "unknown-key":
        return None
    record, union = violation.about
    keys, name = record if union is None else union, violation.pointer[-1]
    return f"'{name}'" if name in keys.keys(VERSION2_1).keys() - keys.keys(VERSION2_0) else None


_Causes = Iterator[tuple[Diagnostic, list[Violation]]]


def _later_version(found: Sequence[Violation], document: YamlDocument) -> _Causes:
    """Several keys and types of version 2.1 in a file of version 2.0."""
    later = sorted((each for each in found if later_word(each)), key=lambda each: document.span(each.pointer, True)[0])
    if len(later) < 2 or document.data.get(VERSION_KEY) != VERSION2_0:
        return
    words = dict.fromkeys(filter(None, map(later_word, later)))
    code = "wrong-value" if later[0].code == "later-value" else "unknown-key"
    message = f"the file states version {VERSION2_0}, but uses {', '.join(words)} of version {VERSION2_1}"
    start, end = document.span((VERSION_KEY,))
    summary = f'write {VERSION_KEY}: "{VERSION2_1}" on line {document.place((VERSION_KEY,)).line}'
    fix = Fix(summary, (document.source.edit(start, end or start, f'"{VERSION2_1}"'),))
    place = document.place(later[0].pointer, code == "unknown-key")
    yield Diagnostic(code, message, place, summary, proposals=(fix,)), later


def _keys_of_version1(found: Sequence[Violation], document: YamlDocument) -> _Causes:
    """A file of version 1 that states version 2."""
    keys = [key for key in document.data if key != VERSION_KEY and not is_own_key(key)]
    unknown = [each for each in found if each.code == "unknown-key" and len(each.pointer) == 1]
    if len(unknown) < 2 or not all(key in VERSION1.all_keys for key in keys):
        return
    version = document.data[VERSION_KEY]
    message = f"the file states version {version}, but has the keys of version 1: {quoted(keys, len(keys))}"
    hint = f"a file of version 1 does not have '{VERSION_KEY}'; without it, `eurdf migrate` writes version 2.0"
    (start, _), (_, end), text = (
        document.span((VERSION_KEY,), True),
        document.span((VERSION_KEY,)),
        document.source.text,
    )
    end = text.find("\n", end) + 1 or len(text)
    fix = Fix(
        f"remove '{VERSION_KEY}', which a file of version 1 does not have", (document.source.edit(start, end, ""),)
    )
    yield Diagnostic("unknown-key", message, document.place(unknown[0].pointer, True), hint, proposals=(fix,)), unknown


def _merge_keys(found: Sequence[Violation], document: YamlDocument) -> _Causes:
    """The merge key of YAML 1.1, and what a mapping lacks because of it."""
    mappings = dict.fromkeys(each.pointer[: each.pointer.index(_MERGE)] for each in found if _MERGE in each.pointer)
    for pointer in mappings:
        consequences = [each for each in found if each.pointer[: len(pointer)] == pointer]
        at = (*pointer, _MERGE)
        here, merged = _value(document, pointer), _value(document, at)
        parts = [part for part in (merged if isinstance(merged, list) else [merged]) if isinstance(part, dict)]
        missing = {key: value for part in reversed(parts) for key, value in part.items() if key not in here}
        separator = (
            ", " if _value_is_flow(document, pointer) else "\n" + " " * ((document.place(at, True).column or 1) - 1)
        )
        (start, _), (_, end) = document.span(at, True), document.span(at)
        text = separator.join(f"{scalar(key)}: {flow(value)}" for key, value in missing.items())
        fixes = (
            [Fix(f"repeat the keys: {flow(missing)}", (document.source.edit(start, end, text),))]
            if end and text
            else []
        )
        hint = f"it must repeat the keys that it shares: {', '.join(map(scalar, missing))}" if missing else None
        message = "YAML 1.2 has no merge key '<<'"
        yield Diagnostic("unknown-key", message, document.place(at, True), hint, proposals=tuple(fixes)), consequences


def _two_sides(found: Sequence[Violation], document: YamlDocument) -> _Causes:
    """Closures that have a key for each of their frames, as those of other formats."""
    for lacking in found:
        if lacking.code != "missing" or lacking.pointer[::2] != ("closures", "frames"):
            continue
        closure = lacking.pointer[:-1]
        unknown = {
            each.pointer[-1]: each for each in found if each.pointer[:-1] == closure and each.code == "unknown-key"
        }
        data = _value(document, closure)
        if not (sides := two_sides({key: value for key, value in data.items() if key in unknown})):
            continue
        spans = [(document.span((*closure, key), True), document.span((*closure, key))) for key in sides]
        value = f"frames: {flow([data[key] for key in sides])}"
        fixes = []
        keys = list(data)
        if keys.index(sides[1]) == keys.index(sides[0]) + 1 and spans[1][1][1] is not None:
            fixes.append(Fix(f"write {value}", (document.source.edit(spans[0][0][0], spans[1][1][1], value),)))
        message = f"a closure has no keys {enumerated(sides)}: its two frames are the list 'frames'"
        place = document.place((*closure, sides[0]), True)
        consequences = [lacking, *(unknown[key] for key in sides)]
        yield Diagnostic("unknown-key", message, place, f"with these: {value}", proposals=tuple(fixes)), consequences


def _value(document: YamlDocument, pointer: Pointer) -> Any:
    value: Any = document.data
    for step in pointer:
        value = value[step]
    return value


def _value_is_flow(document: YamlDocument, pointer: Pointer) -> bool:
    return document.span(pointer)[1] is not None
