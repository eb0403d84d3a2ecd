"""Definitions, references, symbols, and renaming in all files of a robot."""

from __future__ import annotations

from pathlib import Path

from lsprotocol import types as lsp

from eurdf.diagnostics import Edit, Fix, Phase
from eurdf.diagnostics.lines import Lines
from eurdf.editor.names import Occurrence, RobotNames
from eurdf.editor.open_robots import OpenRobots
from eurdf.editor.shown import location
from eurdf.errors import EurdfError
from eurdf.format.yaml_text import scalar
from eurdf.linking.robot_files import read_robot
from eurdf.reading.source import Texts
from eurdf.reading.xacro import is_xacro
from eurdf.reading.xml_reader import escaped

_SYMBOLS = {
    "link": lsp.SymbolKind.Struct,
    "joint": lsp.SymbolKind.Field,
    "frame": lsp.SymbolKind.Constant,
    "closure": lsp.SymbolKind.Interface,
    "coupling": lsp.SymbolKind.Interface,
    "actuator": lsp.SymbolKind.Event,
    "configuration": lsp.SymbolKind.Object,
}

# Phases whose errors can hide where something is named.
_HIDING = (Phase.YAML, Phase.SCHEMA, Phase.URDF)


class CannotRename(EurdfError, ValueError):  # noqa: N818 - shown to the user as it is
    """Something cannot be renamed; the text says why."""


def here(robots: OpenRobots, path: str, at: lsp.Position) -> Occurrence | None:
    """What is named at a place of a document."""
    lines = Lines(robots.documents.text(path))
    return robots.names(path).at(path, robots.documents.index(lines, at))


def definition(robots: OpenRobots, path: str, at: lsp.Position) -> lsp.Location | None:
    """Where what is named at a place is defined."""
    found = here(robots, path, at)
    defined = found and robots.names(path).of(found.kind).get(found.name)
    return location(robots, defined) if defined is not None else None


def references(robots: OpenRobots, path: str, at: lsp.Position, *, declared: bool) -> list[lsp.Location]:
    """Where else that is named, and where it is defined if asked for."""
    found = here(robots, path, at)
    same = [] if found is None else robots.names(path).same(found)
    return [location(robots, each) for each in same if declared or not each.defines]


def symbols(robots: OpenRobots, path: str) -> list[lsp.DocumentSymbol]:
    """What a document defines, in its order."""
    found = []
    for each in sorted(robots.names(path).all, key=lambda each: each.start):
        if each.file == path and each.defines:
            where = robots.documents.range(each.lines, each.start, each.end)
            found.append(lsp.DocumentSymbol(each.name, _SYMBOLS[each.kind], where, where, each.kind))
    return found


# -- renaming ---------------------------------------------------------------------------------------------------------


def to_rename(robots: OpenRobots, path: str, at: lsp.Position) -> lsp.Range:
    """The name at a place.

    Raises:
        CannotRename: Nothing that a file of the robot defines is named there.
    """
    found = here(robots, path, at)
    if found is None:
        raise CannotRename("there is no name of a part of the robot here")
    defined = robots.names(path).of(found.kind).get(found.name)
    if defined is None:
        raise CannotRename(f"'{found.name}' is not defined in the files of the robot")
    if is_xacro(defined.file):
        raise CannotRename(f"'{found.name}' is defined in a xacro, which can make other names of it; rename it there")
    return robots.documents.range(found.lines, found.start, found.end)


def rename(robots: OpenRobots, path: str, at: lsp.Position, name: str) -> lsp.WorkspaceEdit:
    """The edits of all files of a robot, and of other descriptions of its URDF, that give something another name.

    Raises:
        CannotRename: See `to_rename`; or the robot has an error, which can hide where something is named; or it would
            have one with the new name.
    """
    to_rename(robots, path, at)
    found = here(robots, path, at)
    assert found is not None
    involved = robots.robots_of(path)
    places = {(each.file, each.start): each for each in robots.names(path).same(found)}
    if found.kind in ("link", "joint"):
        urdf = robots.names(path).of(found.kind)[found.name].file
        involved = robots.descriptions_of(urdf) or [urdf]
        for other in involved:
            names = RobotNames(robots.documents.yaml(other), robots.documents.xml(urdf))
            places |= {(each.file, each.start): each for each in names.same(found)}
    edits = [_renamed(each, name) for each in places.values()]
    texts = robots.snapshot()
    changed = Texts({**texts, **Fix("", tuple(edits)).texts()})
    for robot in involved:
        before, after = (read_robot(Path(robot), texts=Texts(each)).diagnostics for each in (texts, changed))
        if hides := next((each for each in before.errors if each.phase in _HIDING), None):
            raise CannotRename(f"correct this first: {hides}")
        counts = before.counts()
        if new := next((each for each in after.errors if after.counts()[each.code] > counts[each.code]), None):
            raise CannotRename(f"with the name '{name}' there would be an error: {new.message}")
    return robots.documents.workspace_edit(edits)


def _renamed(place: Occurrence, name: str) -> Edit:
    text = scalar(name) if place.element is None else escaped(name)
    return Edit(place.file, place.start, place.end, text, place.lines)
