"""``eurdf export``: write a robot in the format of a simulator, and show what it loses."""

from __future__ import annotations

import os
import re
import sys
from functools import partial
from typing import TYPE_CHECKING, Any

from eurdf.commands.command import FORCE, FORMAT, ROBOT, command, flag, option
from eurdf.commands.conversion_lines import loss_lines, verification_lines
from eurdf.commands.output import write_result
from eurdf.commands.output_file import writing
from eurdf.commands.terminal import progress_bar, write_lines, write_notes, write_refusal
from eurdf.convert.formats import (
    ACTUATORS,
    CLOSURES,
    EXPORTS,
    JOINTS,
    MESH_FILES,
    Actuators,
    ClosureChoice,
    JointChoice,
    MeshFileChoice,
)
from eurdf.errors import CannotRun

if TYPE_CHECKING:
    from eurdf.convert.losses import Loss
    from eurdf.diagnostics import Place
    from eurdf.linking.robot_files import ReadRobot

_DESCRIPTION = """\
Write a robot in the format of a simulator, with the closed loops that the format can state, and show every loss: what
the format cannot say, or only approximately.

The files are written to a folder, all of them or none. With --verify, the program that they are for reads them back:
MuJoCo, Drake, the library of USD or Pinocchio; MuJoCo and Drake also let the robot fall for 2 s.
"""


_FORMATS: Any = (FORMAT, option("same as --format json", "--json", action="store_const", dest="form", const="json"))


@command(
    summary="write a robot in the format of a simulator, and show what it loses",
    description=_DESCRIPTION,
    exit_codes="0 exported, 1 the robot has errors, losses with --strict, or an error with --verify, 2 the command "
    "cannot run.",
    examples=(
        "eurdf export my_robot --to mjcf",
        "eurdf export my_robot --to mjcf --verify",
        "eurdf export my_robot --to mjcf -o simulation --actuators position",
    ),
)
def export(
    options: dict[str, Any],
    path: str = ROBOT,
    to: str = option(", ".join(EXPORTS), required=True, choices=EXPORTS, metavar="FORMAT"),
    output: str | None = option(
        "the folder to write to; default: the robot's name, _ and the format", "-o", "--output", metavar="OUT"
    ),
    configuration: str = option(
        "configuration to start simulations from; default: assembled, which is searched within the limits if there is "
        "none",
        metavar="NAME",
        default="assembled",
    ),
    actuators: Actuators = option(
        "what actuators become in MJCF and USD; default: motor", choices=ACTUATORS, default="motor"
    ),
    closures: ClosureChoice = option(
        "hinge: 3d closures become hinges where their bodies turn about one axis alone, for solvers that hold no ball "
        "joint in a loop; default: stated",
        choices=CLOSURES,
        default="stated",
    ),
    joints: JointChoice = option(
        "hinge: no ball joints in MJCF: those of rods become universal joints and 3d closures, others three hinges, "
        "about x, y and z; default: stated",
        choices=JOINTS,
        default="stated",
    ),
    mesh_files: MeshFileChoice = option(
        "copy mesh files to meshes/, or reference them where they are by absolute paths; default: copy",
        choices=MESH_FILES,
        default="copy",
    ),
    strict: bool = flag("write nothing if a loss is not exact"),
    force: bool = FORCE,
    verify: bool = flag(
        "read the result back: compare mass, mass matrix, loops and limits with the robot, simulate 2 s where the "
        "program can, and say which loops open by more than 5 mm, or what diverges, and why"
    ),
    form: str = _FORMATS,
) -> int:
    """Export, and show the losses."""
    from eurdf.linking.robot_files import read_valid

    read = read_valid(path, **options)
    if read.diagnostics:  # such as closures of another dialect, which the file will not have
        write_refusal(read.path, read.diagnostics, as_json=False)

    from eurdf.convert.export import Choices, export_linked
    from eurdf.convert.verification.verify import require_reader
    from eurdf.errors import CannotExport

    if verify:
        require_reader(to)
    losses: tuple[Loss, ...]
    refusal, paths, verification = "", [], None
    try:
        choices = Choices(to, configuration, actuators, closures, joints, mesh_files, strict)
        exported = export_linked(read, choices, options["package_dirs"], allow_outside=options["allow_outside"])
    except CannotExport as reason:
        losses = reason.losses
        refusal = "nothing was written: --strict refuses losses" if losses else f"nothing was written: {reason}"
    except ValueError as reason:
        raise CannotRun(str(reason)) from None
    else:
        losses = exported.losses
        with writing():
            name = re.sub(r"[^A-Za-z0-9._-]", "_", read.mechanism.name).strip(".") or "robot"
            folder = output or f"{name}_{to}"
            paths = [os.fspath(each) for each in exported.write(folder, force=force)]
        if verify:
            with progress_bar("simulating") as progress:
                verification = exported.verify(progress=progress)
    place_of = partial(_place, read)
    if form == "json":
        from eurdf.commands.conversion_info import ExportInfo, loss_infos, verification_info

        verified = None if verification is None else verification_info(verification)
        found = loss_infos(losses, place_of)
        write_result(ExportInfo(read.path, to, tuple(paths), refusal or None, found, verified))
    else:
        write_lines(loss_lines(losses, place_of), sys.stdout)
        write_notes([refusal] if refusal else [f"wrote '{each}'" for each in paths])
        if verification is not None:
            write_lines(verification_lines(verification), sys.stdout)
    return 1 if refusal or (verification is not None and verification.findings) else 0


def _place(read: ReadRobot, loss: Loss) -> Place | None:
    """Where the element of a loss is stated, if it is in a file."""
    name, urdf = loss.name, read.urdf
    if any(constraint.name == name for constraint in read.mechanism.constraints):
        if loss.concept.endswith(("closure", "coupling", "compliance")) and read.yaml is not None:
            return read.place_of_constraint(name)
        return None
    if loss.concept in ("inertia", "link without mass"):
        return urdf.document.place(urdf.links[name].element, None) if name in urdf.links else None
    if loss.concept in ("actuator", "control range", "gear ratio"):
        name = next((joint for joint, motor in read.mechanism.motors.items() if motor.name == name), name)
    if name in urdf.joints:
        return urdf.document.place(urdf.joints[name].element, None)
    return None
