"""``eurdf schema``: write the JSON Schema of the format, for editors."""

from __future__ import annotations

import argparse
import sys

from eurdf.commands.cannot_run import CannotRun
from eurdf.commands.check import write_reports
from eurdf.commands.migrate import print_notes
from eurdf.commands.output import write_text
from eurdf.commands.output_file import add_output_option, write_new
from eurdf.commands.robot_options import add_urdf_options, ending, require_urdf, urdf_options
from eurdf.reading.given import shown


def register(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the command to the parser."""
    parser = subparsers.add_parser(
        "schema",
        help="write the JSON Schema of a description, for editors",
        description="Write the JSON Schema (2020-12) of Extended URDF. The first line of a description names it:\n\n"
        "  # yaml-language-server: $schema=./robot.schema.json",
        epilog=ending(
            "0 written, 1 the URDF has errors, 2 the command cannot run.",
            "eurdf schema --for robot.urdf -o robot.schema.json",
        ),
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument(
        "--version", choices=("1", "2", "2.1"), default="2", help="version of the format; default: 2, which is 2.0"
    )
    parser.add_argument(
        "--for",
        dest="urdf",
        metavar="URDF",
        help="include the names of the links and joints of this robot, so that editors complete them",
    )
    add_urdf_options(parser)
    add_output_option(parser)
    parser.add_argument("--force", action="store_true", help="replace OUT if it exists")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Write the schema and return the exit code."""
    from eurdf.format.schema import json_schema, names_of, schema_text

    names = None
    if args.urdf is None and (args.package_dirs or args.xacro_args):
        raise CannotRun("--package-dir and --xacro-arg need --for")
    if args.urdf is not None:
        from eurdf.diagnostics import Diagnostics
        from eurdf.diagnostics.report import Report
        from eurdf.linking.description import read_urdf_alone

        require_urdf(args.urdf)
        diagnostics = Diagnostics()
        urdf = read_urdf_alone(args.urdf, diagnostics, **urdf_options(args))
        if urdf is None:
            # The standard output is reserved for the schema.
            write_reports([Report(shown(args.urdf), tuple(diagnostics))], stream=sys.stderr)
            return 1
        names = names_of(urdf)
    text = schema_text(json_schema(args.version, names))
    if args.output is None:
        write_text(text)
    else:
        write_new(args.output, text, args.force)
        print_notes([f"wrote '{args.output}'"])
    return 0
