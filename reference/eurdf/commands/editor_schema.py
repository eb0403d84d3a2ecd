"""The schema that an editor completes a written description with: a file beside the description."""

from __future__ import annotations

import argparse
import json
import os
import re
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from eurdf.commands.cannot_run import CannotRun
from eurdf.commands.output_file import write_new

if TYPE_CHECKING:
    from eurdf.format.urdf import Urdf

#: The message where a description goes to the standard output.
NOT_BESIDE = "the text names no schema; with -o FILE, the schema that editors complete it with is written beside it"

# What the YAML language server reads in its comment as it is written.
_PLAIN_NAME = re.compile(r"[\w.-]+", re.ASCII)


@dataclass(frozen=True, slots=True)
class EditorSchema:
    """A schema to write beside a description.

    Attributes:
        path: Of its file.
        text: Of its file.
        is_new: Whether the file is to be written; else it is there already.
    """

    path: Path
    text: str
    is_new: bool

    @property
    def reference(self) -> str:
        """Path from the description, for its first line."""
        return f"./{self.path.name}"


def add_schema_option(parser: argparse.ArgumentParser) -> None:
    """Add ``--schema`` to the parser of a command that writes a description."""
    parser.add_argument(
        "--schema",
        choices=("format", "robot", "none"),
        default="format",
        help="the schema written beside OUT and named in its first line, for completion in an editor: format, that of "
        "the format (the default); robot, with the names of this robot; none, neither file nor line",
    )


def schema_beside(
    output: str | os.PathLike[str], version: Literal["1", "2"], choice: str, urdf: Urdf, force: bool = False
) -> EditorSchema | None:
    """The schema to write beside a description, or None where none is wanted; nothing is written yet.

    Args:
        output: Path of the description.
        version: Its version.
        choice: ``format``, ``robot`` or ``none``.
        urdf: The URDF whose names the schema of the robot has.
        force: Whether another file of its name is replaced.

    Raises:
        CannotRun: Another file has its name and is not to be replaced, or the description itself would have it.
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
        raise CannotRun(f"'{output}' is the name of the schema that is written beside it; choose another")
    schema = json_schema(version, names_of(urdf) if choice == "robot" else None)
    path, text = Path(folder, name), schema_text(schema)
    is_new = not _is_there(path, text)
    if is_new and not force and os.path.lexists(path):
        raise CannotRun(f"'{path}' exists already and is another; --force replaces it, --schema none leaves it")
    return EditorSchema(path, text, is_new)


def write_schema(schema: EditorSchema) -> None:
    """Write the schema where it is not there yet."""
    if schema.is_new:
        write_new(schema.path, schema.text, force=True)


def _is_there(path: Path, text: str) -> bool:
    """Whether a file has this schema, however it is laid out."""
    try:
        return bool(json.loads(path.read_text(encoding="utf-8")) == json.loads(text))
    except (OSError, ValueError):
        return False
