"""``eurdf check``: report the errors of robots, with their places."""

from __future__ import annotations

import argparse
import sys
from typing import TYPE_CHECKING, Any

from eurdf.commands.command import ROBOTS, command, flag, option
from eurdf.commands.selection import select, without_robot
from eurdf.commands.terminal import PATIENCE, progress_bar, write_json, write_lines, write_reports
from eurdf.errors import CannotRun
from eurdf.reading.robot_source import is_stream

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
--ignore leaves it out.

A hint is a question, or a fix, which was tried: with it the diagnostic is gone, there is no new one, and the actuators
still move independently. --fix applies these, to files in the folder of the robot only, all or none; --diff shows them.
"""

# Show progress at once from this number of robots on.
_MANY = 4


def _advice(code: str) -> str:
    """A code of advice: errors, and warnings that a clause demands, are not ignored."""
    from eurdf.diagnostics.registry import OWN_PREFIX, REGISTRY
    from eurdf.diagnostics.wording import meant

    advice = [known for known in REGISTRY if known.startswith(OWN_PREFIX)]
    if code not in advice:
        raise argparse.ArgumentTypeError(f"'{code}' is no code of advice{meant(code, advice)}")
    return code


@command(
    summary="check robots and report errors with file, line and hint",
    description=_DESCRIPTION,
    exit_codes="0 all robots pass, with --fix after the fixes, with --diff with them; 1 errors found; "
    "2 the check cannot run.",
    examples=(
        "eurdf check robots/",
        "eurdf check robots/*/",
        "eurdf check my_robot --diff && eurdf check my_robot --fix",
        "eurdf check leg.yaml --urdf leg.urdf.xacro --xacro-arg side:=left --package-dir ~/ws/src",
        "xacro leg.urdf.xacro side:=left | eurdf check -",
    ),
)
def check(
    options: dict[str, Any],
    paths: list[str] = ROBOTS,
    form: Any = (
        option("default: text", "--format", choices=("text", "json", "sarif"), default="text"),
        option("the same as --format json", "--json", action="store_const", dest="form", const="json"),
    ),
    strict: bool = flag("treat warnings as errors"),
    fix: bool = flag("apply the fixes that are certain to the files, and check them again", group="fixes"),
    diff: bool = flag("show what --fix changes, and change nothing", group="fixes"),
    allow_none: bool = flag("succeed if a folder contains no robot (for hooks)"),
    ignore: list[str] = option(
        "leave out this advice, a code that begins with x- (repeatable)",
        metavar="CODE",
        type=_advice,
        action="append",
        default=[],
    ),
) -> int:
    """Check, and write the diagnostics."""
    import eurdf
    from eurdf.diagnostics import plural, quoted
    from eurdf.diagnostics.wording import visible

    skipped = without_robot(paths)
    robots = select([path for path in paths if path not in skipped], allow_none)
    urdf = options["urdf"]
    if len(robots) > 1 and urdf is not None and is_stream(urdf):
        raise CannotRun(
            f"--urdf {urdf} can be read only once, but there are {len(robots)} robots; check them one by one"
        )
    if diff and form != "text":
        raise CannotRun(f"--diff writes a diff, not {form}; --fix with --format {form} reports what is left")
    reports: list[Report] = []
    with progress_bar("checking", 0.0 if len(robots) >= _MANY else PATIENCE) as progress:
        for robot in robots:
            reports.append(_fixed(robot, options, diff, form) if fix or diff else eurdf.check(robot, **options))
            if progress is not None:
                progress(len(reports), len(robots))
    if diff:
        return 0 if all(report.passes(strict) for report in reports) else 1
    reports = [report.without(ignore) for report in reports]
    if form == "json":
        from eurdf.diagnostics.report import reports_to_json

        write_json(reports_to_json(reports, strict, skipped))
    elif form == "sarif":
        from eurdf.diagnostics.sarif import sarif_log

        write_json(sarif_log(reports, eurdf.__version__))
    elif reports:
        write_reports(reports, strict)
    else:
        write_lines([[(f"{visible(path)}: no robot", "")] for path in paths], sys.stdout)
    if skipped:
        names = visible(quoted(skipped, len(skipped)))
        write_lines([[(f"skipped {plural(len(skipped), 'folder')} without a robot: {names}", "")]], sys.stderr)
    return 0 if all(report.passes(strict) for report in reports) else 1


def _fixed(robot: str, options: dict[str, Any], diff: bool, form: str) -> Report:
    """Fix a robot, or show how, and say what is done; the result of the check after the fixes."""
    from eurdf.commands.fixing import fixing

    done = fixing(robot, **options)
    if diff:
        write_lines(done.diff(), sys.stdout)
        return done.report
    done.write()
    fixed = [f"fixed {found.place}: {found.hint} [{found.code}]" for found in done.applied]
    write_lines([[(line, "green")] for line in fixed], sys.stdout if form == "text" else sys.stderr)
    return done.report
