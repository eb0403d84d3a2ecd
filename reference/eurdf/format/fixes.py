"""Fixes of a description: a value in the place of another, an entry more or less; comments and the rest stay."""

from __future__ import annotations

from collections.abc import Container, Iterable, Sequence
from functools import partial
from itertools import chain, count
from typing import Any

from eurdf.diagnostics import Edit, Fix, misspelt, renamings
from eurdf.format.conventions import Version
from eurdf.format.mappings import Record
from eurdf.format.yaml_text import Value, flow, scalar
from eurdf.reading.yaml_node import Alias, Node, Pointer, YamlCollection, end_of, start_of
from eurdf.reading.yaml_reader import YamlDocument, YamlReporter


def report_name(
    reporter: YamlReporter,
    code: str,
    message: str,
    pointer: Pointer,
    wrong: str,
    known: Iterable[str],
    *,
    key: bool = False,
) -> None:
    """Report that a value, or a key, is a name that is none of those known."""
    write = partial(named, reporter.document, pointer, key)
    reporter.report(code, message, pointer, *misspelt(wrong, known, write), key=key)


def named(document: YamlDocument, pointer: Pointer, key: bool, name: str) -> tuple[Edit]:
    """The edit that writes a name in the place of another one, which is a value or a key."""
    return (document.edit(pointer, scalar(name), key),)


def renamed(document: YamlDocument, pointer: Pointer, name: str, *, key: bool = False) -> Sequence[Fix]:
    """A name that is known in the place of one that is not."""
    return renamings([name], partial(named, document, pointer, key))


def restated(document: YamlDocument, pointer: Pointer, value: Value, verb: str = "write") -> Fix:
    """A value in the place of another one."""
    return Fix(f"{verb} {flow(value)}", (document.edit(pointer, flow(value)),))


def free_name(name: str, taken: Container[str | None]) -> str:
    """The name, with a number if it is taken."""
    numbered = (f"{name}_{number}" for number in count(2))
    return next(each for each in chain([name], numbered) if each not in taken)


def renumbered(document: YamlDocument, pointer: Pointer, name: str, taken: Container[str | None]) -> Sequence[Fix]:
    """Another name in the place of one that is taken, and that nothing refers to."""
    return (restated(document, pointer, free_name(name, taken), "name it"),)


def unsigned(document: YamlDocument, pointer: Pointer, value: Any) -> tuple[Fix, ...]:
    """A number that must not be negative without its sign; -1 may mean no limit, and what is nearly 0 is rounded."""
    is_signed = isinstance(value, int | float) and value < -1e-12 and value != -1
    return (restated(document, pointer, -value),) if is_signed else ()


def swapped(document: YamlDocument, one: Pointer, other: Pointer) -> Sequence[Fix]:
    """Two numbers, the lower bound above 0 and the upper one below, exchanged; none where a sign may be wrong."""
    numbers = [value_at(document, pointer) for pointer in (one, other)]
    if any(isinstance(each, list) for each in numbers) or not numbers[0] > 0.0 > numbers[1]:
        return ()
    edits = [document.edit(one, flow(numbers[1])), document.edit(other, flow(numbers[0]))]
    return (Fix("swap the two", tuple(edits)),)


def added(document: YamlDocument, mapping: Pointer, key: str, value: Value) -> Sequence[Fix]:
    """A key before the others of a mapping; none where it has no others."""
    collection = _collection(document, mapping)
    if not collection.keys:
        return ()
    start, _ = next(iter(collection.keys.values()))
    entry = f"{key}: {flow(value)}"
    between = ", " if collection.is_flow else "\n" + " " * (document.source.position(start)[1] - 1)
    return (Fix(f"add {entry}", (document.source.edit(start, start, entry + between),)),)


def listed(document: YamlDocument, pointer: Pointer, name: str) -> Sequence[Fix]:
    """A list in the place of a mapping of names to mappings, each of which gets its name, or of its only item."""
    mapping, text, edits = value_at(document, pointer), document.source.text, []
    if not mapping:
        return ()
    collection = _collection(document, pointer)
    first, last = collection.span[0], end_of(collection)
    if name in mapping:
        if collection.is_flow:
            item = f"[{text[first:last]}]"
            return (Fix(f"write {item}", (document.source.edit(first, last, item),)),)
        item = "- " + text[first:last].replace("\n", "\n  ")
        return (Fix("begin the item with '- ', and indent the rest of it", (document.source.edit(first, last, item),)),)
    if not all(isinstance(item, dict) for item in mapping.values()):
        return ()
    if collection.is_flow:
        edits = [document.source.edit(first, first + 1, "["), document.source.edit(last - 1, last, "]")]
    for key in mapping:
        (start, end), (inner, _) = (document.span((*pointer, key), by_key) for by_key in (True, False))
        braces = text.startswith("{", inner)
        stop = inner + 1 if braces else text.find(":", end) + 1
        item = f"{'- ' * (not collection.is_flow)}{'{' * braces}{name}: {text[start:end]}{', ' * braces}"
        edits.append(document.source.edit(start, stop, item))
    return (Fix(f"write a list; its first item begins with '- {name}: {next(iter(mapping))}'", tuple(edits)),)


def removed(document: YamlDocument, pointer: Pointer, what: str) -> Sequence[Fix]:
    """An item of a list, or a key and its value, removed; none where it is the only one."""
    collection, text = _collection(document, pointer[:-1]), document.source.text
    steps = list(collection.nodes)
    if len(steps) < 2:
        return ()

    def start(step: str | int) -> int:
        return collection.keys[step][0] if step in collection.keys else start_of(collection.nodes[step])

    index = steps.index(pointer[-1])
    first, last = start(pointer[-1]), end_of(collection.nodes[pointer[-1]])
    if not collection.is_flow:  # its lines
        line = text.rfind("\n", 0, first) + 1
        if text[line:first].strip(" -" if not collection.is_mapping else " "):
            return ()
        first, last = line, (text.find("\n", last) + 1) or len(text)
    elif index:
        first = end_of(collection.nodes[steps[index - 1]])
    else:
        last = start(steps[1])
    return (Fix(f"remove {what}", (document.source.edit(first, last, ""),)),)


def without_key(
    document: YamlDocument, pointer: Pointer, version: Version, record: Record, others: Iterable[Record]
) -> Sequence[Fix]:
    """A key removed that belongs to another type than the one that a mapping states.

    None if the mapping lacks a key that its type needs, or if it has all that the other type has: then the type may be
    what is wrong.
    """
    stated, key = value_at(document, pointer[:-1]).keys(), pointer[-1]
    kinds = record.values_of_type()
    for form in others:
        keys, of_form = form.keys(version), form.values_of_type()
        if key in keys and (of_form in ((), kinds) or stated <= keys.keys()):
            return ()
    needed = {name for name, each in record.keys(version).items() if each.required}
    return removed(document, pointer, f"'{key}'") if needed <= stated else ()


def value_at(document: YamlDocument, pointer: Pointer) -> Any:
    """The value that a pointer leads to."""
    value: Any = document.data
    for step in pointer:
        value = value[step]
    return value


def _collection(document: YamlDocument, pointer: Pointer) -> YamlCollection:
    node: Node = document.root
    for step in (*pointer, None):
        node = node.target if isinstance(node, Alias) else node
        assert isinstance(node, YamlCollection)
        node = node if step is None else node.nodes[step]
    assert isinstance(node, YamlCollection)
    return node
