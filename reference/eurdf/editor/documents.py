"""The documents that are open in an editor: their texts, and places in them as the protocol counts these."""

from __future__ import annotations

import os
from collections.abc import Iterable
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from lsprotocol import types as lsp
from pygls import uris

from eurdf.collection import is_description
from eurdf.collection.near_paths import YAML_ENDINGS
from eurdf.diagnostics import Edit, FileError
from eurdf.diagnostics.lines import Lines
from eurdf.reading.source import BOM, FILE_LIMIT, Source, Texts, read_bytes
from eurdf.reading.xml_reader import XmlDocument, read_xml
from eurdf.reading.yaml_reader import YamlDocument, read_yaml

#: Bytes of a code unit, and how Python calls an encoding in which all code units have these.
_ENCODINGS = {"utf-8": (1, "utf-8"), "utf-16": (2, "utf-16-le"), "utf-32": (4, "utf-32-le")}

_BEGIN_LIMIT = 1 << 16


@dataclass
class OpenDocument:
    """A document that is open.

    Attributes:
        uri: As the editor names it.
        text: As the editor shows it.
        is_saved: Whether the file has this text, so that it is read.
    """

    uri: str
    text: str
    is_saved: bool


class Documents:
    """The files of robots: those that are open, with their texts, and those on the disk.

    Attributes:
        opened: Those that are open, by path.
        encoding: How the editor counts the characters of a line.
    """

    def __init__(self) -> None:
        self.opened: dict[str, OpenDocument] = {}
        self.encoding = "utf-16"
        self._parsed: dict[str, tuple[str, YamlDocument | XmlDocument | None]] = {}

    # -- files --------------------------------------------------------------------------------------------------------

    def change(self, uri: str, text: str) -> str | None:
        """Take the text of a document that was opened, changed or saved.

        Returns:
            Its path; None if it is no file of a robot.
        """
        path = path_of(uri)
        text = text.encode("utf-16-le", "surrogatepass").decode("utf-16-le", "replace")
        if path is None or not (is_xml_file(path) or is_description(os.path.basename(path), lambda: text.encode())):
            return None
        self.opened[path] = OpenDocument(uri, text, self._on_disk(path) == text)
        return path

    def close(self, uri: str) -> str | None:
        """Forget a document; its path if it was known."""
        path = path_of(uri)
        return path if path is not None and self.opened.pop(path, None) is not None else None

    def texts(self) -> Texts:
        """The texts that are not those of files."""
        return Texts({path: each.text for path, each in self.opened.items() if not each.is_saved})

    def text(self, path: str) -> str:
        """The text of a file, open or not; empty if it cannot be read."""
        known = self.opened.get(path) or self.opened.get(self.shown(path))
        return known.text if known is not None else self._on_disk(path) or ""

    def shown(self, path: str) -> str:
        """The path of a file by which it is open, whichever way a robot names it."""
        path = os.path.abspath(path)
        if path in self.opened:
            return path
        return next((each for each in self.opened if _same(each, path)), path)

    def uri(self, path: str) -> str:
        """How the editor names a file."""
        known = self.opened.get(self.shown(path))
        return known.uri if known is not None else Path(self.shown(path)).as_uri()

    def parsed(self, path: str) -> YamlDocument | XmlDocument | None:
        """A file as it was when it last had no error of syntax; None if it never was."""
        text = self.text(path)
        before, document = self._parsed.get(path, (None, None))
        if text != before:
            try:
                source = Source(path, text, text.encode())
                document = read_xml(source) if is_xml_file(path) else read_yaml(source)
            except FileError:
                pass  # which is reported, and leaves the one before
            self._parsed[path] = text, document
        return document

    def is_current(self, path: str) -> bool:
        """Whether `parsed` has the text of a file as it is."""
        document = self.parsed(path)
        return document is not None and document.source.text == self.text(path)

    def yaml(self, path: str) -> YamlDocument | None:
        """The description at a path, as `parsed` has it."""
        document = None if is_xml_file(path) else self.parsed(path)
        return document if isinstance(document, YamlDocument) else None

    def xml(self, path: str) -> XmlDocument | None:
        """The URDF or xacro at a path, as `parsed` has it."""
        document = self.parsed(path) if is_xml_file(path) else None
        return document if isinstance(document, XmlDocument) else None

    def _on_disk(self, path: str) -> str | None:
        try:
            return read_bytes(path, FILE_LIMIT).removeprefix(BOM).decode(errors="replace")
        except FileError:
            return None

    # -- places -------------------------------------------------------------------------------------------------------

    def position(self, lines: Lines, index: int) -> lsp.Position:
        """The place of a character, by its index in a text."""
        line, column = lines.position(index)
        return lsp.Position(line - 1, self._units(lines.text[index - column + 1 : index]))

    def range(self, lines: Lines, start: int, end: int) -> lsp.Range:
        """The place of characters from one to before another."""
        return lsp.Range(self.position(lines, start), self.position(lines, end))

    def index(self, lines: Lines, position: lsp.Position) -> int:
        """Index of the character at a place; behind the end of a line, of its end."""
        span = lines.span(position.line + 1)
        if span is None:
            return len(lines.text)
        width, codec = _ENCODINGS[self.encoding]
        before = lines.text[slice(*span)].encode(codec)[: position.character * width]
        return span[0] + len(before.decode(codec, "ignore"))

    def workspace_edit(self, edits: Iterable[Edit]) -> lsp.WorkspaceEdit:
        """Edits of files as the protocol has them."""
        changes: dict[str, list[lsp.TextEdit]] = {}
        for each in edits:
            where = self.range(each.lines, each.start, each.end)
            changes.setdefault(self.uri(each.file), []).append(lsp.TextEdit(where, each.text))
        return lsp.WorkspaceEdit(changes=changes)

    def _units(self, text: str) -> int:
        width, codec = _ENCODINGS[self.encoding]
        return len(text.encode(codec)) // width


def path_of(uri: str) -> str | None:
    """The path of a file; None for what is in no file, or is of no kind that a robot has."""
    path = uris.to_fs_path(uri) if uri.startswith("file:") else None
    if path is None or "\0" in path:
        return None
    return os.path.abspath(path) if is_xml_file(path) or path.endswith(YAML_ENDINGS) else None


def is_xml_file(path: str) -> bool:
    """Whether a path is that of a URDF or a xacro."""
    return path.lower().endswith((".urdf", ".xacro"))


def descriptions_beside(path: str) -> list[str]:
    """The descriptions in the folder of a file."""
    folder = os.path.dirname(path)
    try:
        names = sorted(os.listdir(folder))
    except OSError:
        return []
    paths = (os.path.join(folder, name) for name in names)
    return [path for path in paths if is_description(os.path.basename(path), partial(_begin, path))]


def _begin(path: str) -> bytes:
    try:
        return read_bytes(path, _BEGIN_LIMIT)
    except FileError:
        return b""


def _same(one: str, other: str) -> bool:
    return os.path.realpath(one) == os.path.realpath(other)
