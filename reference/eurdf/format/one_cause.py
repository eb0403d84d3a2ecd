"""Errors of a file that have one cause, which one diagnostic names, with the fix (EU-DIA-001, EU-DIA-002)."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence

from eurdf.diagnostics import Diagnostic, Fix
from eurdf.diagnostics.wording import enumerated, quoted
from eurdf.format.conventions import VERSION2_0, VERSION2_1, VERSION_KEY, is_own_key
from eurdf.format.fixes import value_at
from eurdf.format.model import VERSION1
from eurdf.format.value_types import Violation
from eurdf.format.yaml_text import flow, scalar
from eurdf.reading.yaml_node import Pointer
from eurdf.reading.yaml_reader import YamlDocument

_MERGE = "<<"

# Keys that name one of two sides: 'body1' and 'body2', 'link_a' and 'link_b'.
_SIDE = re.compile(r"(\D*?[^\W\d_])[_-]?[12ab]", re.IGNORECASE)


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


_Causes = Iterator[tuple[Diagnostic, Sequence[Violation]]]


def _later_version(found: Sequence[Violation], document: YamlDocument) -> _Causes:
    """Several keys and types of version 2.1 in a file of version 2.0."""
    later = sorted((each for each in found if later_word(each)), key=lambda each: document.span(each.pointer, True)[0])
    if len(later) < 2 or document.data.get(VERSION_KEY) != VERSION2_0:
        return
    words = ", ".join(dict.fromkeys(filter(None, map(later_word, later))))
    code = "wrong-value" if later[0].code == "later-value" else "unknown-key"
    message = f"the file states version {VERSION2_0}, but uses {words} of version {VERSION2_1}"
    text = f'{VERSION_KEY}: "{VERSION2_1}"'
    hint = f"write {text} on line {document.place((VERSION_KEY,)).line}"
    fixes = _instead(document, (VERSION_KEY,), (VERSION_KEY,), text, hint)
    place = document.place(later[0].pointer, code == "unknown-key")
    yield Diagnostic(code, message, place, hint, proposals=fixes), later


def _keys_of_version1(found: Sequence[Violation], document: YamlDocument) -> _Causes:
    """A file of version 1 that states version 2."""
    keys = [key for key in document.data if key != VERSION_KEY and not is_own_key(key)]
    unknown = [each for each in found if each.code == "unknown-key" and len(each.pointer) == 1]
    if len(unknown) < 2 or not all(key in VERSION1.all_keys for key in keys):
        return
    version, where = document.data[VERSION_KEY], (VERSION_KEY,)
    message = f"the file states version {version}, but has the keys of version 1: {quoted(keys, len(keys))}"
    hint = f"a file of version 1 does not have '{VERSION_KEY}'; without it, `eurdf migrate` writes version 2.0"
    fixes = _instead(document, where, where, "", f"remove '{VERSION_KEY}', which a file of version 1 does not have")
    yield Diagnostic("unknown-key", message, document.place(unknown[0].pointer, True), hint, proposals=fixes), unknown


def _merge_keys(found: Sequence[Violation], document: YamlDocument) -> _Causes:
    """The merge key of YAML 1.1, and what a mapping lacks because of it."""
    for pointer in dict.fromkeys(
        each.pointer[: each.pointer.index(_MERGE)] for each in found if _MERGE in each.pointer
    ):
        at = (*pointer, _MERGE)
        merged, place = value_at(document, at), document.place(at, True)
        parts = [part for part in (merged if isinstance(merged, list) else [merged]) if isinstance(part, dict)]
        missing = {key: value for part in reversed(parts) for key, value in part.items()}
        missing = {key: value for key, value in missing.items() if key not in value_at(document, pointer)}
        between = ", " if document.span(pointer)[1] is not None else "\n" + " " * ((place.column or 1) - 1)
        text = between.join(f"{scalar(key)}: {flow(value)}" for key, value in missing.items())
        hint = f"the keys that it shares must be repeated: {quoted([*missing], len(missing))}"
        fixes = _instead(document, at, at, text, f"repeat the keys: {flow(missing)}")
        consequences = [each for each in found if each.pointer[: len(pointer)] == pointer]
        yield Diagnostic("unknown-key", "YAML 1.2 has no merge key '<<'", place, hint, proposals=fixes), consequences


def _two_sides(found: Sequence[Violation], document: YamlDocument) -> _Causes:
    """Closures that have a key for each of their frames, as those of other formats."""
    for lacking in found:
        if lacking.code != "missing" or lacking.pointer[::2] != ("closures", "frames"):
            continue
        closure = lacking.pointer[:-1]
        unknown = {each.pointer[-1]: each for each in found if each.pointer[:-1] == closure}
        data = {key: value for key, value in value_at(document, closure).items() if isinstance(value, str | dict)}
        stems = {key: match[1] for key in data if key in unknown and (match := _SIDE.fullmatch(key))}
        one, other = next(((a, b) for a in stems for b in stems if a != b and stems[a] == stems[b]), ("", ""))
        if not one:
            continue
        text = f"frames: {flow([data[one], data[other]])}"
        keys = [*value_at(document, closure)]
        follows = keys.index(other) == keys.index(one) + 1
        fixes = _instead(document, (*closure, one), (*closure, other), text, f"write {text}") if follows else ()
        message = f"a closure has no keys {enumerated([one, other])}: its two frames are the list 'frames'"
        diagnostic = Diagnostic(
            "unknown-key", message, document.place((*closure, one), True), f"with these: {text}", proposals=fixes
        )
        yield diagnostic, [lacking, unknown[one], unknown[other]]


def _instead(document: YamlDocument, first: Pointer, last: Pointer, text: str, summary: str) -> tuple[Fix, ...]:
    """A fix that writes a text in place of the entries from one key to another, unless the last is a block."""
    (start, _), (_, end) = document.span(first, True), document.span(last)
    return () if end is None else (Fix(summary, (document.source.edit(start, end, text),)),)
