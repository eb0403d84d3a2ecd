"""Robots that are open in an editor, without a server between: texts are typed, and edits are applied."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from lsprotocol import types as lsp

from eurdf.diagnostics.lines import Lines
from eurdf.editor.open_robots import OpenRobots


def opened(*files: Path, **texts: str) -> OpenRobots:
    """Robots with files open, as they are or with other texts by their stem and ending, ``robot_yaml``, and checked."""
    robots = OpenRobots()
    for file in files:
        text = texts.get(file.name.replace(".", "_"))
        data = file.read_bytes().decode(errors="replace").removeprefix("\ufeff") if text is None else text
        robots.documents.change(file.as_uri(), data)
    for file in files:
        for robot in robots.robots_of(str(file)):
            checked(robots, robot)
    return robots


def checked(robots: OpenRobots, robot: str, *, thorough: bool = False) -> None:
    tries = (lambda: True) if thorough else None
    robots.examined[robot] = robots.examine(robot, robots.snapshot(), tries)


def place(text: str, mark: str = "|") -> tuple[str, lsp.Position]:
    """A text without the mark in it, and where that is."""
    before, _, after = text.partition(mark)
    return before + after, lsp.Position(before.count("\n"), len(before) - before.rfind("\n") - 1)


def place_of(text: str, word: str) -> lsp.Position:
    """Where a word first is in a text."""
    return place(text.replace(word, f"\x1f{word}", 1), "\x1f")[1]


def edited(robots: OpenRobots, edit: lsp.WorkspaceEdit) -> Mapping[str, str]:
    """The texts of files after an edit, by path."""
    texts = {}
    for path in {*robots.documents.opened, *map(robots.documents.shown, map(_path, edit.changes or ()))}:
        text = robots.documents.text(path)
        lines = Lines(text)
        found = [
            (
                robots.documents.index(lines, each.range.start),
                robots.documents.index(lines, each.range.end),
                each.new_text,
            )
            for uri, edits in (edit.changes or {}).items()
            if robots.documents.shown(_path(uri)) == path
            for each in edits
        ]
        for start, end, new in sorted(found, reverse=True):
            text = text[:start] + new + text[end:]
        texts[path] = text
    return texts


def _path(uri: str) -> str:
    from eurdf.editor.documents import path_of

    return path_of(uri) or uri
