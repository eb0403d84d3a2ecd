"""``eurdf simplify``: write a robot with fewer velocities and constraint rows that moves in the same way."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any, Literal

from eurdf.commands.command import FORCE, JSON, ROBOT, cannot_run, command, flag, option
from eurdf.commands.output import write_result
from eurdf.commands.output_file import writing
from eurdf.commands.terminal import Table, progress_bar, write_notes, write_shown

if TYPE_CHECKING:
    from eurdf.convert.simplify import Simplification

_DESCRIPTION = """\
Rewrite a robot with fewer velocities and constraint rows, where its motion stays the same, and show what that saves.

Three revolute or continuous joints whose axes meet in one point become a ball joint; a ball joint whose link a 6d
closure holds becomes a 3d closure, and its link is fixed to what held it. The result is compared with the robot along a
random motion: if a link or an acceleration differs, nothing is written. Without -o, nothing is written either.
"""


@command(
    summary="write a robot with fewer velocities and rows that moves in the same way, or go back",
    description=_DESCRIPTION,
    exit_codes="0 written or nothing to do, 1 the robot has errors, 2 the command cannot run.",
    examples=("eurdf simplify digit_leg -o digit_leg_3d", "eurdf simplify delta --expand --only closures"),
)
def simplify(
    options: dict[str, Any],
    path: str = ROBOT,
    output: str | None = option("the folder to write to; default: none", "-o", "--output", metavar="FOLDER"),
    expand: bool = flag(
        "go back: each 3d closure becomes a ball joint and a 6d closure, each ball joint three continuous joints"
    ),
    only: Literal["joints", "closures"] | None = option(
        "rewrite only the joints (three revolute, a ball), or only the closures (6d, 3d)",
        choices=("joints", "closures"),
    ),
    force: bool = FORCE,
    json: bool = JSON,
) -> int:
    """Rewrite, and show what was saved."""
    import eurdf
    from eurdf.commands.conversion_info import SimplifyInfo
    from eurdf.errors import CannotSimplify

    with cannot_run(CannotSimplify), progress_bar("comparing motions"):
        found = eurdf.simplify(path, expand=expand, only=only, **options)
    paths: tuple[str, ...] = ()
    notes: list[str] = []
    if output is not None:
        with writing():
            paths = tuple(os.fspath(each) for each in found.write(output, force=force))
    if json:
        write_result(SimplifyInfo.of(path, paths, found))
        return 0
    if found.motion is None:
        write_shown([f"{path}: nothing to {'expand' if expand else 'simplify'}"])
    else:
        write_shown(_table(found))
        notes = [*found.changes, str(found.motion)]
    write_notes(
        [*notes, *found.kept, *(f"lost: {each}" for each in found.lost), *(f"wrote '{each}'" for each in paths)]
    )
    return 0


def _table(found: Simplification) -> Table:
    """What was saved."""
    before, after = found.before, found.after
    rows = [
        ("velocities", f"{before.nv}", f"{after.nv}"),
        ("constraint rows", f"{before.nc}", f"{after.nc}"),
    ]
    if found.motion and found.motion.times:
        one, other = (f"{1e6 * each:.0f} µs" for each in found.motion.times)
        rows.append(("forward dynamics", one, other))
    return Table("", "before", "after", rows=rows, right=(1, 2))
