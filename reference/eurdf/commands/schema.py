"""``eurdf schema``: the JSON Schema of the format, for an editor."""

from __future__ import annotations

import argparse
import os
import sys
from typing import TYPE_CHECKING

from eurdf.commands.cannot_run import CannotRun
from eurdf.commands.check import write_reports
from eurdf.commands.migrate import tell
from eurdf.commands.output import write_text
from eurdf.commands.output_file import write_new

if TYPE_CHECKING:
    from eurdf.diagnostics import Diagnostics
    from eurdf.format.urdf import Urdf


def register(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the command to the parser."""
    parser = subparsers.add_parser(
        "schema",
        help="write the JSON Schema that an editor completes and checks a description with",
        description="Write the JSON Schema (2020-12) of Extended URDF. The first line of a description names it: "
        "# yaml-language-server: $schema=./robot.schema.json",
        epilog="Exit codes: 0 written, 1 the URDF has errors, 2 the command cannot run.",
    )
    parser.add_argument("--version", choices=("1", "2"), default="2", help="version of the format; default: 2")
    parser.add_argument(
        "--for",
        dest="urdf",
        metavar="URDF",
        help="name the links and joints of this robot, so that an editor completes them",
    )
    parser.add_argument("-o", "--output", metavar="OUT", help="the file to write; default: the standard output")
    parser.add_argument("--force", action="store_true", help="replace OUT if it is there already")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Write the schema and return the exit code."""
    from eurdf.diagnostics import Diagnostics
    from eurdf.diagnostics.report import Report
    from eurdf.format.schema import json_schema, names_of, schema_text

    names = None
    if args.urdf is not None:
        if not os.path.exists(args.urdf):
            raise CannotRun(f"'{args.urdf}' does not exist")
        diagnostics = Diagnostics()
        urdf = _read(args.urdf, diagnostics)
        if urdf is None:
            # The standard output is for a schema.
            write_reports([Report(args.urdf, tuple(diagnostics))], stream=sys.stderr)
            return 1
        names = names_of(urdf)
    text = schema_text(json_schema(args.version, names))
    if args.output is None:
        write_text(text)
    else:
        write_new(args.output, text, args.force)
        tell([f"wrote '{args.output}'"])
    return 0


def _read(path: str, diagnostics: Diagnostics) -> Urdf | None:
    from eurdf.diagnostics import Fault
    from eurdf.format.urdf import read_urdf
    from eurdf.reading.source import read_source
    from eurdf.reading.xml_reader import read_xml

    try:
        return read_urdf(read_xml(read_source(path)), diagnostics)
    except Fault as fault:
        diagnostics.add(fault.diagnostic)
        return None
