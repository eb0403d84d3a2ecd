"""``eurdf migrate``: convert a description from version 1 to version 2."""

from __future__ import annotations

import argparse
import contextlib
import io
import os
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from eurdf.commands.cannot_run import CannotRun
from eurdf.commands.editor_schema import NOT_BESIDE, EditorSchema, add_schema_option, schema_beside, write_described
from eurdf.commands.output import write_json, write_text
from eurdf.commands.output_file import add_output_option, refuse_to_replace
from eurdf.commands.robot_options import add_robot_options, add_robot_path, ending, robot_options
from eurdf.commands.selection import select_one

if TYPE_CHECKING:
    from eurdf.reading.source import Source

_DESCRIPTION = """\
Convert a description from version 1 to version 2, with the same model.

Version 2 states explicitly what version 1 implies: merged revolute joints, names of closures. If the URDF has mimic
joints, which version 1 lets move freely, the result has version 2.1, which can say so; else version 2.0. Comments and
your own data are kept; your own keys get the prefix x-. Before the result is written, it is read and checked: if its
model differs, nothing is written.
"""


def register(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the command to the parser."""
    parser = subparsers.add_parser(
        "migrate",
        help="convert a description from version 1 to version 2",
        description=_DESCRIPTION,
        epilog=ending(
            "0 written or nothing to do, 1 the robot has errors, 2 the command cannot run.",
            "eurdf migrate robot.v1.yaml -o robot.yaml",
        ),
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    add_robot_path(parser)
    add_robot_options(parser)
    add_output_option(parser)
    parser.add_argument("--force", action="store_true", help="replace OUT and its schema if they exist")
    add_schema_option(parser)
    parser.add_argument("--json", action="store_true", help="write one JSON object: the text, and what was done")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Migrate and write a description, print notes, and return the exit code."""
    from eurdf.linking.description import Described, Unlinked, describe
    from eurdf.writing.migrated_text import NotMigratable, schema_named, version_needed
    from eurdf.writing.migration import migrate

    path = select_one(args.path)
    options = robot_options(args)
    description = describe(path, **options)
    path = description.path
    if isinstance(description, Unlinked) or description.diagnostics.refused:
        show_report(path, tuple(description.diagnostics), args.json)
        return 1
    if not isinstance(description, Described):
        raise CannotRun(
            f"'{path}' is a plain URDF, which has nothing to migrate; `eurdf generate` writes a description"
        )
    document = description.extension.document
    source, urdf = document.source, description.urdf.document.source
    schema: EditorSchema | None = None
    written: str = description.extension.version
    if description.extension.version != "1":
        text, output = source.text, None
        notes: tuple[str, ...] = (
            f"'{source.file}' already has version {description.extension.version}: nothing to do",
        )
    else:
        output = args.output
        reference = schema_named(document, description.urdf) if args.schema == "format" else None
        if output is not None and not _leads_to_a_schema(reference, output):
            refuse_to_replace(output, args.force)
            schema = schema_beside(output, version_needed(description.urdf), args.schema, description.urdf, args.force)
            reference = None if schema is None else schema.reference
        try:
            urdf_path = urdf_named(output or source.file, urdf)
            migration = migrate(description, urdf_path, reference)
        except NotMigratable as reason:
            line = document.place(reason.pointer).line if reason.pointer else None
            where = f"{source.file}:{line}" if line else source.file
            raise CannotRun(f"cannot migrate: {where}: {reason}") from None
        text, notes, written = migration.text, migration.notes, migration.mechanism.version
        notes = (*notes, *urdf_notes(urdf, urdf_path, options["xacro_args"]))
        if output is not None:
            write_described(output, text, schema, args.force)
        elif reference is None and args.schema != "none":
            notes = (*notes, NOT_BESIDE)
    if args.json:
        write_json(_result(path, description.extension.version, written, output, schema, notes, text))
        return 0
    if args.output is None:
        write_yaml(text)
    print_notes(notes)
    print_notes([str(found) for found in description.diagnostics if found.code == "near-miss-key"])
    if output is not None:
        print_notes([f"wrote '{output}'"])
    if schema is not None:
        report_schema(schema)
    return 0


def report_schema(schema: EditorSchema) -> None:
    """Report the schema, if one was written."""
    if schema.is_new:
        print_notes([f"wrote '{schema.path}', the schema for editors"])


def _leads_to_a_schema(reference: str | None, output: str) -> bool:
    """Whether the schema that the first line of a description names exists."""
    if reference is None:
        return False
    return reference.startswith(("http://", "https://")) or os.path.isfile(os.path.join(Path(output).parent, reference))


def write_yaml(text: str) -> None:
    """Write to the standard output in UTF-8, whatever the locale."""
    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(encoding="utf-8")
    write_text(text)


def urdf_named(description: str | os.PathLike[str], urdf: Source) -> str:
    """The name of the URDF, or of its xacro, in a description; ``robot.urdf`` if it is not a file."""
    return urdf_from(description, urdf.files[0]) if urdf.files else "robot.urdf"


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


def urdf_from(description: str | os.PathLike[str], urdf: str | os.PathLike[str]) -> str:
    """Path of a URDF relative to the folder of a description."""
    home = os.path.realpath(Path(description).parent)
    # Resolve the folder, because '..' is relative to the target of a link; the file can stay a link.
    place = Path(os.path.realpath(Path(urdf).parent)) / Path(urdf).name
    try:
        return Path(os.path.relpath(place, home)).as_posix()
    except ValueError:  # on another drive
        return place.as_posix()


def show_report(path: str, diagnostics: tuple[Any, ...], as_json: bool) -> None:
    """Show the diagnostics of a robot: on the standard error, or as JSON in place of the output."""
    from eurdf.commands.check import write_reports
    from eurdf.diagnostics.report import Report, reports_to_json

    report = Report(path, diagnostics)
    if as_json:
        write_json(reports_to_json([report]))
        return
    with contextlib.redirect_stdout(sys.stderr):
        write_reports([report])


def print_notes(sentences: tuple[str, ...] | list[str]) -> None:
    """Write to the standard error, a line each."""
    from eurdf.diagnostics.visible import no_command, visible

    for sentence in sentences:
        sys.stderr.write(f"{no_command(visible(sentence))}\n")


def _result(
    path: str,
    version: str,
    written: str,
    output: str | None,
    schema: EditorSchema | None,
    notes: tuple[str, ...],
    text: str,
) -> dict[str, Any]:
    from eurdf.diagnostics.report import encodable

    return {
        "path": encodable(path),
        "from": version,
        "to": written,
        "output": None if output is None else encodable(output),
        "schema": None if schema is None else encodable(os.fspath(schema.path)),
        "notes": [encodable(note) for note in notes],
        "text": text,
    }
