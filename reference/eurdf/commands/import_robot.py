"""``eurdf import``: describe a robot that is in a file of another format, and show what is lost."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

from eurdf.commands.command import FORCE, JSON, OUTPUT_FOLDER, command, flag, option
from eurdf.commands.conversion_lines import loss_lines
from eurdf.commands.output import write_result
from eurdf.commands.output_file import writing
from eurdf.commands.terminal import progress_bar, write_lines, write_notes, write_reports
from eurdf.diagnostics import plural
from eurdf.reading.other_formats import IMPORTED

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


@command(
    summary="describe a robot that is in a file of a simulator, and show what is lost",
    description=_DESCRIPTION,
    exit_codes="0 imported, 1 the file or the robot has errors, or losses with --strict, 2 the command cannot run.",
    examples=(
        "eurdf import cassie.xml -o cassie",
        "eurdf import scene/arm.xml -o arm --within .",
        "eurdf import leg_mjcf -o leg",
    ),
)
def import_robot(
    file: str = option("the file to import, or a folder that `eurdf export` wrote", "file", metavar="FILE"),
    output: str = OUTPUT_FOLDER,
    format_: str | None = option(
        f"{', '.join(IMPORTED)}; default: recognized by the content", "--from", choices=IMPORTED, metavar="FORMAT"
    ),
    within: str | None = option(
        "a folder that the files may be in which FILE names, besides the robot's folder: the nearest one with a "
        "package.xml, or else that of FILE",
        metavar="FOLDER",
    ),
    allow_outside: bool = flag("read files that are outside these folders"),
    strict: bool = flag("write nothing if a loss is not exact, or the robot has errors"),
    force: bool = FORCE,
    json: bool = JSON,
) -> int:
    """Import, and show the losses."""
    import eurdf
    from eurdf.commands.conversion_info import ImportInfo, loss_infos
    from eurdf.diagnostics.report import Report
    from eurdf.errors import CannotImport

    try:
        with progress_bar("importing"):
            found = eurdf.import_robot(file, format=format_, within=within, strict=strict, allow_outside=allow_outside)
    except CannotImport as reason:
        place_of = _places((Path(reason.path),))
        if json:
            reported = tuple(Report(file, reason.diagnostics).to_json()["diagnostics"])
            losses = loss_infos(reason.losses, place_of)
            write_result(ImportInfo(file, format_, (), str(reason), None, (), None, losses, reported))
        else:
            write_lines(loss_lines(reason.losses, place_of), sys.stdout)
            if reason.diagnostics:
                write_reports([Report(output, reason.diagnostics)])
            write_notes([f"nothing was written: {reason}"], quiet=False)
        return 1
    place_of = _places(found.sources)
    with writing():
        paths = tuple(os.fspath(each) for each in found.write(output, force=force))
    report = eurdf.check(output)
    if json:
        reported = tuple(report.to_json()["diagnostics"])
        losses = loss_infos(found.losses, place_of)
        write_result(
            ImportInfo(file, found.format, paths, None, found.start, found.opened, found.closes, losses, reported)
        )
    else:
        write_lines(loss_lines(found.losses, place_of), sys.stdout)
        write_notes([*_loops(found), *(f"wrote '{each}'" for each in paths)])
        if not report.ok:
            write_reports([report])
    return 0 if report.ok else 1


def _loops(found: Import) -> list[str]:
    """How the loops were, and how they are."""
    is_open = [opening for opening in found.opened if opening.is_open]
    if not found.opened:
        return []
    count = plural(len(found.opened), "constraint")
    if not is_open:
        return [f"{count} closed at {found.start}"]
    widest = max(is_open, key=lambda opening: opening.width)
    after = "closed in the configuration 'assembled'" if found.closes else "no configuration was found that closes them"
    return [f"{count}, {len(is_open)} open at {found.start}, the most {widest}; {after}"]


def _places(sources: tuple[Path, ...]) -> Callable[[Loss], Place | None]:
    """What finds the element of a loss in files: the first one of its name."""

    @cache
    def by_name() -> dict[str, Place]:
        from eurdf.convert.xml_elements import places_of_names

        return places_of_names(sources)

    return lambda loss: by_name().get(loss.name)
