"""``eurdf check``: report the errors of robots, with their places."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, TextIO

from eurdf.commands.cannot_run import CannotRun
from eurdf.commands.output import columns, has_boxes, is_terminal, write_json, write_lines
from eurdf.commands.robot_options import add_robot_options, add_robot_path, ending, robot_options
from eurdf.commands.selection import select, without_robot
from eurdf.reading.given import is_stream

if TYPE_CHECKING:
    from eurdf.diagnostics.report import Report

_DESCRIPTION = """\
Check robots: the description, the URDF it extends, and whether the loops close.

A folder without a robot.yaml is searched: each folder in it with a robot.yaml is a robot. In the others, a YAML file is
a robot if its name is *.eurdf.yaml, or if it has the top-level key extended_urdf or closed_loop. Standard input or a
pipe contains one text: a URDF, which begins with <, or a description, whose paths are relative to the working
directory.

Of several paths, a folder without a robot is skipped, and named on the standard error: eurdf check robots/*/. It is an
error if no other path is left, and if a folder has several URDFs and no description.

A warning whose code begins with x- is advice: the file conforms, but is probably not what you intended.
"""
_EPILOG = ending(
    "0 all robots pass, 1 errors found, 2 the check cannot run.",
    "eurdf check robots/",
    "eurdf check robots/*/",
    "eurdf check leg.yaml --urdf leg.urdf.xacro --xacro-arg side:=left --package-dir ~/ws/src",
    "xacro leg.urdf.xacro side:=left | eurdf check -",
)

# Show progress from this number of robots on.
_MANY = 4


def register(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the command to the parser."""
    parser = subparsers.add_parser(
        "check",
        help="check robots and report errors with file, line and hint",
        description=_DESCRIPTION,
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    add_robot_path(parser, several=True)
    add_robot_options(parser)
    parser.add_argument("--format", choices=("text", "json", "sarif"), default="text", help="default: text")
    parser.add_argument("--strict", action="store_true", help="treat warnings as errors")
    parser.add_argument(
        "--allow-none",
        action="store_true",
        help="succeed if a folder contains no robot (for hooks)",
    )
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Check, write the diagnostics, and return the exit code."""
    from eurdf.diagnostics import quoted
    from eurdf.diagnostics.visible import visible

    skipped = without_robot(args.paths)
    robots = select([path for path in args.paths if path not in skipped], args.allow_none)
    options = robot_options(args)
    if len(robots) > 1 and args.urdf is not None and is_stream(args.urdf):
        raise CannotRun(
            f"--urdf {args.urdf} can be read only once, but there are {len(robots)} robots; check them one by one"
        )
    reports = [_check(robot, options) for robot in _with_progress(robots)]
    if args.format == "json":
        from eurdf.diagnostics.report import reports_to_json

        write_json(reports_to_json(reports, args.strict, skipped))
    elif args.format == "sarif":
        from eurdf import __version__
        from eurdf.diagnostics.sarif import sarif_log

        write_json(sarif_log(reports, __version__))
    elif reports:
        write_reports(reports, args.strict)
    else:
        write_lines([[(f"{visible(path)}: no robot", "")] for path in args.paths], sys.stdout)
    if skipped:
        count = "1 folder" if len(skipped) == 1 else f"{len(skipped)} folders"
        names = visible(quoted(skipped, len(skipped)))
        write_lines([[(f"skipped {count} without a robot: {names}", "")]], sys.stderr)
    return 0 if all(report.passes(args.strict) for report in reports) else 1


def write_reports(reports: Sequence[Report], strict: bool = False, stream: TextIO | None = None) -> None:
    """Write diagnostics and verdicts as text, to the standard output by default."""
    from eurdf.diagnostics.text import SOURCE_WIDTH, report_lines, summary_line, total_line

    stream = stream or sys.stdout
    width = min(columns() - len("12345 | "), 2 * SOURCE_WIDTH) if is_terminal(stream) else SOURCE_WIDTH
    bar = "│" if has_boxes(stream) else "|"
    for report in reports:
        write_lines([*report_lines(report, width, bar), summary_line(report, strict)], stream)
        if report.diagnostics and len(reports) > 1:
            write_lines([[]], stream)
    if len(reports) > 1:
        write_lines([total_line(reports, strict)], stream)


def _check(robot: str, options: Mapping[str, Any]) -> Report:
    import eurdf

    return eurdf.check(robot, **options)


def _with_progress(robots: Sequence[str]) -> Iterable[str]:
    if len(robots) < _MANY or not (sys.stderr.isatty() and is_terminal(sys.stderr)):
        return robots
    from rich.console import Console
    from rich.progress import track

    return track(robots, description="checking", console=Console(stderr=True), transient=True)
