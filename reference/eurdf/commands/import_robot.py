"""``eurdf import``: describe a robot that is in a file of another format, and show what is lost."""

from __future__ import annotations

import argparse
import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from eurdf.commands.check import write_reports
from eurdf.commands.loss_lines import loss_lines
from eurdf.commands.migrate import print_notes
from eurdf.commands.output import write_json, write_lines
from eurdf.commands.output_file import writing
from eurdf.commands.robot_options import ending
from eurdf.convert.formats import IMPORTS

if TYPE_CHECKING:
    from eurdf.convert.import_robot import Import
    from eurdf.convert.losses import Loss
    from eurdf.diagnostics import Place

_DESCRIPTION = """\
Describe a robot that is in a file of a simulator, with its closed loops, and show every loss: what a description cannot
say, or only approximately.

The files are written to a folder, all of them or none: robot.urdf, robot.yaml, its schema, meshes, a README.
If the loops are open at the keyframe or reference pose of the file, a configuration is searched that closes them.
What was written is checked, as by `eurdf check`.
"""
_EPILOG = ending(
    "0 imported, 1 the file or the robot has errors, or losses with --strict, 2 the command cannot run.",
    "eurdf import cassie.xml -o cassie",
    "eurdf import scene/arm.xml -o arm --within .",
)


def register(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the command to the parser."""
    parser = subparsers.add_parser(
        "import",
        help="describe a robot that is in a file of a simulator, and show what is lost",
        description=_DESCRIPTION,
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("file", metavar="FILE", help="the file to import")
    parser.add_argument("-o", "--output", metavar="FOLDER", required=True, help="the folder to write to")
    parser.add_argument(
        "--from",
        dest="format_",
        choices=IMPORTS,
        metavar="FORMAT",
        help=f"{', '.join(IMPORTS)}; default: recognized by the content",
    )
    parser.add_argument(
        "--within",
        metavar="FOLDER",
        help="a folder that the files may be in which FILE names, besides the robot's folder: the nearest one with a "
        "package.xml, or else that of FILE",
    )
    parser.add_argument("--allow-outside", action="store_true", help="read files that are outside these folders")
    parser.add_argument(
        "--strict", action="store_true", help="write nothing if a loss is not exact, or the robot has errors"
    )
    parser.add_argument("--force", action="store_true", help="replace existing files")
    parser.add_argument("--format", choices=("text", "json"), default="text", help="format of the output")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Import, show the losses, and return the exit code."""
    from eurdf.checking.check import check
    from eurdf.convert.exceptions import CannotImport
    from eurdf.convert.import_robot import import_robot
    from eurdf.diagnostics.report import Report

    try:
        found = import_robot(
            args.file, format=args.format_, within=args.within, strict=args.strict, allow_outside=args.allow_outside
        )
    except CannotImport as reason:
        places = _Places((Path(args.file),))
        if args.format == "json":
            from eurdf.commands.import_info import refused_import

            info = refused_import(args.file, args.format_, reason, places.of)
            write_json(info.model_dump(mode="json"))
        else:
            write_lines(loss_lines(reason.losses, places.of), sys.stdout)
            if reason.diagnostics:
                write_reports([Report(args.output, reason.diagnostics)])
            print_notes([f"nothing was written: {reason}"])
        return 1
    places = _Places(found.sources)
    with writing():
        paths = [os.fspath(each) for each in found.write(args.output, force=args.force)]
    report = check(args.output)
    if args.format == "json":
        from eurdf.commands.import_info import import_info

        write_json(import_info(args.file, found, paths, report, places.of).model_dump(mode="json"))
    else:
        write_lines(loss_lines(found.losses, places.of), sys.stdout)
        print_notes([*_loops(found), *(f"wrote '{each}'" for each in paths)])
        if not report.ok:
            write_reports([report])
    return 0 if report.ok else 1


def _loops(found: Import) -> list[str]:
    """How the loops were, and how they are."""
    is_open = [opening for opening in found.opened if opening.is_open]
    if not found.opened:
        return []
    count = f"{len(found.opened)} constraint{'' if len(found.opened) == 1 else 's'}"
    if not is_open:
        return [f"{count} closed at {found.start}"]
    widest = max(is_open, key=lambda opening: max(opening.position, opening.angle))
    after = "closed in the configuration 'assembled'" if found.closes else "no configuration was found that closes them"
    return [f"{count}, {len(is_open)} open at {found.start}, the most {widest}; {after}"]


class _Places:
    """Where the elements of files are: the first one of a name."""

    def __init__(self, sources: tuple[Path, ...]) -> None:
        self._sources = sources
        self._of: dict[str, Place] | None = None

    def of(self, loss: Loss) -> Place | None:
        """Where the element of a loss is, if it has a name there."""
        if self._of is None:
            from eurdf.convert.xml_elements import places_of_names

            self._of = places_of_names(self._sources)
        return self._of.get(loss.name)
