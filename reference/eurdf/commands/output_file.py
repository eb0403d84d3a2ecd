"""The files that a command writes, such as a description and the schema beside it, with which editors complete it."""

from __future__ import annotations

import contextlib
import json
import os
import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from eurdf.commands.command import option
from eurdf.commands.terminal import write_notes, write_text
from eurdf.errors import CannotRun

if TYPE_CHECKING:
    from eurdf.format.schema import SchemaVersion
    from eurdf.format.urdf.data import Urdf
    from eurdf.reading.source import Source

#: The message if a description goes to the standard output.
NOT_BESIDE = "the output names no schema; use -o FILE to write the schema for editors beside it"

# Paths that the YAML language server reads without escapes.
_PLAIN_NAME = re.compile(r"[\w.-]+", re.ASCII)


def refuse_to_replace(path: str | os.PathLike[str], force: bool) -> None:
    """Raise `CannotRun` if a file, or a link wherever it leads, exists and ``force`` is False."""
    if not force and os.path.lexists(path):
        raise CannotRun(f"'{os.fspath(path)}' already exists; --force replaces it")


def write_new(path: str | os.PathLike[str], content: str | bytes, force: bool = False) -> None:
    """Write a file, completely or not at all; a symbolic link is followed, and a text is written in UTF-8.

    Raises:
        CannotRun: The file exists and ``force`` is False, or it cannot be written.
    """
    write_all_new({os.fspath(path): content}, force)


def write_all_new(files: Mapping[str, str | bytes], force: bool = False) -> None:
    """Write files as `write_new` does: all of them, or none."""
    from eurdf.writing.atomic_file import write_together  # only now: often nothing is written

    for path in files:
        refuse_to_replace(path, force)
    with writing():
        write_together(files, replace=force)


@contextlib.contextmanager
def writing() -> Iterator[None]:
    """Raise `CannotRun` if a file cannot be written, with its path."""
    try:
        yield
    except OSError as error:
        if error.filename is None:
            raise CannotRun(str(error).replace("; force replaces it", "; --force replaces it")) from error
        raise CannotRun(f"cannot write '{os.fsdecode(error.filename)}': {error.strerror}") from error


@dataclass(frozen=True, slots=True)
class EditorSchema:
    """A schema to write beside a description; it is new unless the file already has it."""

    path: Path
    text: str
    is_new: bool

    @property
    def reference(self) -> str:
        """Path relative to the description, for its first line."""
        return f"./{self.path.name}"


#: ``--schema`` of a command that writes a description.
SCHEMA: Any = option(
    "the schema to write beside OUT and name in its first line, for editors: format, that of the format (the default); "
    "robot, with the names of this robot; none, neither file nor line",
    choices=("format", "robot", "none"),
    default="format",
)


def schema_beside(
    output: str | os.PathLike[str], version: SchemaVersion, choice: str, urdf: Urdf, force: bool = False
) -> EditorSchema | None:
    """The schema to write beside a description, by a choice of `SCHEMA`, or None; nothing is written yet.

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


@dataclass(frozen=True, slots=True)
class DescriptionFile:
    """A description to write, with its schema, if any; without a path, it goes to the standard output, or nowhere."""

    path: str | None
    text: str
    schema: EditorSchema | None

    def write(self, force: bool) -> None:
        """Write the file, and the schema unless it exists already: both, or none.

        Raises:
            CannotRun: A file exists and ``force`` is False, or one cannot be written.
        """
        if self.path is not None:
            # The schema first: a schema without a description does no harm.
            beside = {os.fspath(self.schema.path): self.schema.text} if self.schema and self.schema.is_new else {}
            write_all_new({**beside, self.path: self.text}, force)

    @property
    def paths(self) -> dict[str, str | None]:
        """The paths of both files, for JSON."""
        return {"output": self.path, "schema": None if self.schema is None else os.fspath(self.schema.path)}

    def show(self, notes: Iterable[str], as_text: bool) -> None:
        """Show what was written: the text on the standard output, if it goes there, and notes."""
        if as_text:
            write_text(self.text)
        write_notes(notes)
        if self.path is not None:
            write_notes([f"wrote '{self.path}'"])
        if self.schema is not None and self.schema.is_new:
            write_notes([f"wrote '{self.schema.path}', the schema for editors"])


def urdf_notes(urdf: Source, name: str, xacro_args: Mapping[str, str]) -> tuple[str, ...]:
    """The notes if the URDF of a description is more than a file that the description names."""
    if not urdf.files:
        return (
            f"the URDF came from {urdf.file}; write it to '{name}', which the description names, or use --urdf each "
            "time",
        )
    if xacro_args:
        return (f"the description names '{name}' without arguments; use --xacro-arg each time",)
    return ()


def _is_there(path: Path, text: str) -> bool:
    """Whether a file contains this schema, in any layout."""
    try:
        return bool(json.loads(path.read_text(encoding="utf-8")) == json.loads(text))
    except (OSError, ValueError):
        return False
