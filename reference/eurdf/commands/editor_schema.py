"""The schema file beside a description, with which editors complete the description."""

from __future__ import annotations

import argparse
import json
import os
import re
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from eurdf.commands.cannot_run import CannotRun
from eurdf.commands.output_file import write_all_new

if TYPE_CHECKING:
    from eurdf.format.schema import SchemaVersion
    from eurdf.format.urdf.data import Urdf

#: The message if a description goes to the standard output.
NOT_BESIDE = "the output names no schema; use -o FILE to write the schema for editors beside it"

# Paths that the YAML language server reads without escapes.
_PLAIN_NAME = re.compile(r"[\w.-]+", re.ASCII)


@dataclass(frozen=True, slots=True)
class EditorSchema:
    """A schema to write beside a description.

    Attributes:
        path: Path of its file.
        text: Content of its file.
        is_new: Whether to write the file; False if it already exists.
    """

    path: Path
    text: str
    is_new: bool

    @property
    def reference(self) -> str:
        """Path relative to the description, for its first line."""
        return f"./{self.path.name}"


def add_schema_option(parser: argparse.ArgumentParser) -> None:
    """Add ``--schema`` to the parser of a command that writes a description."""
    parser.add_argument(
        "--schema",
        choices=("format", "robot", "none"),
        default="format",
        help="the schema to write beside OUT and name in its first line, for editors: format, that of "
        "the format (the default); robot, with the names of this robot; none, neither file nor line",
    )


def schema_beside(
    output: str | os.PathLike[str], version: SchemaVersion, choice: str, urdf: Urdf, force: bool = False
) -> EditorSchema | None:
    """The schema to write beside a description, or None; nothing is written yet.

    Args:
        output: Path of the description.
        version: Its version.
        choice: ``format``, ``robot`` or ``none``.
        urdf: The URDF whose names the schema of the robot contains.
        force: Whether to replace a different file of the same name.

    Raises:
        CannotRun: A different file of the same name exists and ``force`` is False, or it is the description.
    """
    from eurdf.format.schema import FILES, json_schema, names_of, schema_text

    if choice == "none":
        return None
    folder, file = os.path.split(output)
    name = FILES[version]
    if choice == "robot":
        stem = re.sub(r"(\.eurdf)?\.ya?ml$", "", file)
        name = f"{stem if _PLAIN_NAME.fullmatch(stem) else 'robot'}.schema.json"
    if name == file:
        raise CannotRun(f"'{output}' is also the name of the schema file; choose another name")
    schema = json_schema(version, names_of(urdf) if choice == "robot" else None)
    path, text = Path(folder, name), schema_text(schema)
    is_new = not _is_there(path, text)
    if is_new and not force and os.path.lexists(path):
        raise CannotRun(f"'{path}' already exists and differs; --force replaces it, --schema none keeps it")
    return EditorSchema(path, text, is_new)


def write_described(output: str, text: str, schema: EditorSchema | None, force: bool) -> None:
    """Write a description and its schema, unless the schema exists already: both, or none.

    Raises:
        CannotRun: A file exists and ``force`` is False, or one cannot be written.
    """
    # The schema first: a schema without a description does no harm.
    beside = {os.fspath(schema.path): schema.text} if schema is not None and schema.is_new else {}
    write_all_new({**beside, output: text}, force)


def _is_there(path: Path, text: str) -> bool:
    """Whether a file contains this schema, in any layout."""
    try:
        return bool(json.loads(path.read_text(encoding="utf-8")) == json.loads(text))
    except (OSError, ValueError):
        return False
