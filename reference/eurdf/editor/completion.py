"""What can be typed at the cursor: keys, values, and names of links, joints and frames that are not used yet."""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

from lsprotocol import types as lsp

from eurdf.diagnostics.lines import Lines
from eurdf.editor.cursor import Cursor, cursor_at, word_at
from eurdf.editor.documents import is_xml_file
from eurdf.editor.names import KINDS, Occurrence, RobotNames
from eurdf.editor.open_robots import OpenRobots
from eurdf.format.conventions import VERSION2_0, VERSION2_1, VERSION_KEY
from eurdf.format.mappings import Key, Record
from eurdf.format.urdf.elements import KNOWN, URDF_JOINT_TYPES
from eurdf.format.value_types import ByName, Choice, ListOf, Never, Text
from eurdf.format.yaml_text import flow, scalar

# The start tag that the cursor is in: its name, the rest, and the attribute whose value is typed.
_IN_TAG = re.compile(r"<([\w:]+)(\s[^<>]*)?$")
_IN_VALUE = re.compile(r"""\s([\w:]+)\s*=\s*(["'])([^"'<>]*)$""")
_TAG = re.compile(r"<(?:!--.*?-->|/([\w:]+)\s*>|([\w:]+)(?:\"[^\"]*\"|'[^']*'|[^<>\"'])*?(/?)>)", re.DOTALL)

# Attributes of elements of a URDF beside those of `KNOWN`.
_ATTRIBUTES = {
    "robot": ("name", "version"),
    "link": ("name",),
    "joint": ("name", "type"),
    "parent": ("link",),
    "child": ("link",),
    "axis": ("xyz",),
    "mass": ("value",),
    "inertia": ("ixx", "iyy", "izz", "ixy", "ixz", "iyz"),
}

#: A value that can be completed: what is inserted, its kind, and what it is.
_Offer = tuple[str, lsp.CompletionItemKind, str]


def completions(robots: OpenRobots, path: str, at: lsp.Position) -> list[lsp.CompletionItem]:
    """What can be typed at a place of a document."""
    documents = robots.documents
    lines = Lines(documents.text(path))
    index = documents.index(lines, at)
    if is_xml_file(path):
        start, _ = word_at(lines.text, index, "_./-:")
        end, offers = index, list(_in_urdf(robots, path, lines.text[:index]))
    else:
        cursor = cursor_at(lines.text, index)
        if cursor is None:
            return []
        start, end, offers = cursor.start, cursor.end, list(_in_description(robots, path, cursor))
    where = documents.range(lines, start, end)
    return [
        lsp.CompletionItem(
            label=text.rstrip(":= "),
            kind=kind,
            detail=detail,
            sort_text=f"{number:04}",
            text_edit=lsp.TextEdit(where, text),
        )
        for number, (text, kind, detail) in enumerate(offers)
    ]


# -- descriptions -----------------------------------------------------------------------------------------------------


def _in_description(robots: OpenRobots, path: str, cursor: Cursor) -> Iterator[_Offer]:
    names = robots.names(path)
    if cursor.is_key:
        yield from _keys(cursor.keys(), cursor.taken)
        for kind in cursor.types():
            if isinstance(kind, ByName) and kind.keys is not None:
                yield from _named(names, kind.keys, cursor.taken, robots, after=": ")
        return
    if cursor.pointer == (VERSION_KEY,):
        yield from ((f'"{each}"', lsp.CompletionItemKind.EnumMember, "") for each in (VERSION2_0, VERSION2_1))
    elif cursor.pointer == ("urdf",):
        yield from _files(path)
    else:
        yield from _values(cursor, names, robots)


def _values(cursor: Cursor, names: RobotNames, robots: OpenRobots) -> Iterator[_Offer]:
    for kind in cursor.types():
        if isinstance(kind, Text) and kind.name in KINDS:
            yield from _named(names, kind, cursor.taken, robots)
        elif isinstance(kind, Choice):
            choices = (each for each in kind.allowed(cursor.version) if each not in cursor.taken)
            yield from ((each, lsp.CompletionItemKind.EnumMember, "") for each in choices)
        elif isinstance(kind, Never):
            yield "false", lsp.CompletionItemKind.Keyword, ""
        elif isinstance(kind, Record) and cursor.begins:
            yield from _keys(kind.keys(cursor.version), set())
        elif isinstance(kind, ByName) and kind.keys is not None and cursor.begins:
            yield from _named(names, kind.keys, set(), robots, after=": ")


def _keys(keys: dict[str, Key] | Any, taken: set[str]) -> Iterator[_Offer]:
    """The keys of a mapping: those that must be there, then the others."""
    for name, key in sorted(keys.items(), key=lambda item: not item[1].required):
        if name not in taken:
            needed = "required" if key.required else "" if key.default is None else f"default: {_short(key.default)}"
            ending = ":" if isinstance(key.type, ListOf | ByName | Record) else ": "
            yield name + ending, lsp.CompletionItemKind.Property, "; ".join(filter(None, (key.title, needed)))


def _short(default: Any) -> str:
    return flow(default) if isinstance(default, str | int | float) else "none" if not default else flow(default)


def _named(names: RobotNames, kind: Text, taken: set[str], robots: OpenRobots, after: str = "") -> Iterator[_Offer]:
    """RobotNames of a kind that are not used beside the cursor."""
    found = names.of(KINDS[kind.name])
    for name, each in found.items():
        if name in taken or (kind.name == "MovingJointName" and not robots.can_move(names, each)):
            continue
        what = lsp.CompletionItemKind.Struct if each.kind == "link" else lsp.CompletionItemKind.Field
        yield scalar(name) + after, what, about(each)


def about(each: Occurrence) -> str:
    """What something is, in a few words."""
    if each.element is None or each.kind != "joint":
        return each.kind
    links = [found.get("link", "") for tag in ("parent", "child") for found in each.element.iterfind(tag)]
    return f"{each.element.get('type', '')} joint, {' → '.join(links)}"


def _files(path: str) -> Iterable[_Offer]:
    """The URDFs in the folder of a description, and below it."""
    folder = Path(path).parent
    try:
        found = [each for each in (*folder.iterdir(), *folder.glob("*/*.urdf")) if is_xml_file(each.name)]
    except OSError:
        return []
    return [(scalar(os.path.relpath(each, folder)), lsp.CompletionItemKind.File, "URDF") for each in sorted(found)]


# -- URDFs ------------------------------------------------------------------------------------------------------------


def _in_urdf(robots: OpenRobots, path: str, before: str) -> Iterator[_Offer]:
    """Tags, attributes and values of a URDF, by the text before the cursor."""
    inside = _IN_TAG.search(before)
    if inside is None:
        if before.endswith("<"):
            yield from ((tag, lsp.CompletionItemKind.Class, "") for tag in _children(_open_tag(before[:-1])))
        return
    tag, rest = inside[1], inside[2]
    if rest is None:  # the tag is typed
        above = _open_tag(before[: inside.start()])
        yield from ((each, lsp.CompletionItemKind.Class, "") for each in _children(above))
        return
    value = _IN_VALUE.search(rest)
    if value is None:
        if rest.count('"') % 2 == 0:
            stated = set(re.findall(r"([\w:]+)\s*=", rest))
            offered = (each for each in _attributes(tag) if each not in stated)
            yield from ((f"{each}=", lsp.CompletionItemKind.Property, "") for each in offered)
        return
    names, where = robots.names(path), (tag, value[1])
    if where == ("joint", "type"):
        yield from ((each, lsp.CompletionItemKind.EnumMember, "") for each in URDF_JOINT_TYPES)
    elif where in (("parent", "link"), ("child", "link")):
        taken = {each.name for each in names.all if each.element is not None and each.element.tag == tag == "child"}
        free = {name: each for name, each in names.of("link").items() if name not in taken}
        yield from ((name, lsp.CompletionItemKind.Struct, "link") for name in free)
    elif where == ("mimic", "joint"):
        yield from ((name, lsp.CompletionItemKind.Field, about(each)) for name, each in names.of("joint").items())


def _children(tag: str) -> tuple[str, ...]:
    """The elements that an element can have, the required ones first."""
    return (*KNOWN[tag].needed, *KNOWN[tag].children) if tag in KNOWN else ()


def _attributes(tag: str) -> tuple[str, ...]:
    """The attributes that an element can have, the required ones first."""
    known = (*KNOWN[tag].others, *KNOWN[tag].attributes) if tag in KNOWN else ()
    return (*_ATTRIBUTES.get(tag, ()), *known)


def _open_tag(text: str) -> str:
    """The innermost element that is open at the end of a text; empty if none is."""
    opened: list[str] = []
    for found in _TAG.finditer(text):
        if found[2] and not found[3]:
            opened.append(found[2])
        elif found[1] in opened:
            del opened[len(opened) - 1 - opened[::-1].index(found[1]) :]
    return opened[-1] if opened else ""
