"""``eurdf export``: write a robot in the format of a simulator, and show what it loses."""

from __future__ import annotations

import argparse
import os
import re
import sys
from typing import TYPE_CHECKING

from eurdf.commands.cannot_run import CannotRun
from eurdf.commands.loss_lines import loss_lines
from eurdf.commands.migrate import print_notes, show_report
from eurdf.commands.output import write_json, write_lines
from eurdf.commands.output_file import writing
from eurdf.commands.progress import progress_bar
from eurdf.commands.robot_options import add_robot_options, add_robot_path, ending, robot_options
from eurdf.commands.selection import select_one
from eurdf.commands.verification_lines import verification_lines
from eurdf.convert.formats import ACTUATORS, CLOSURES, EXPORTS, MESH_FILES

if TYPE_CHECKING:
    from eurdf.convert.losses import Loss
    from eurdf.diagnostics import Place
    from eurdf.linking.description import Linked

_DESCRIPTION = """\
Write a robot in the format of a simulator, with the closed loops that the format can state, and show every loss: what
the format cannot say, or only approximately.

The files are written to a folder, all of them or none. With --verify, the program that they are for reads them back:
MuJoCo, Drake, the library of USD or Pinocchio; MuJoCo and Drake also let the robot fall for 2 s.
"""
_EPILOG = ending(
    "0 exported, 1 the robot has errors, losses with --strict, or an error with --verify, 2 the command cannot run.",
    "eurdf export my_robot --to mjcf",
    "eurdf export my_robot --to mjcf --verify",
    "eurdf export my_robot --to mjcf -o simulation --actuators position",
)


def register(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the command to the parser."""
    parser = subparsers.add_parser(
        "export",
        help="write a robot in the format of a simulator, and show what it loses",
        description=_DESCRIPTION,
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    add_robot_path(parser)
    add_robot_options(parser)
    parser.add_argument("--to", required=True, choices=EXPORTS, metavar="FORMAT", help=", ".join(EXPORTS))
    parser.add_argument(
        "-o", "--output", metavar="OUT", help="the folder to write to; default: the robot's name, _ and the format"
    )
    parser.add_argument(
        "--configuration",
        metavar="NAME",
        default="assembled",
        help="configuration to start simulations from; default: assembled, which is searched within the limits if "
        "there is none",
    )
    parser.add_argument(
        "--actuators", choices=ACTUATORS, default="motor", help="what actuators become in MJCF and USD; default: motor"
    )
    parser.add_argument(
        "--closures",
        choices=CLOSURES,
        default="stated",
        help="hinge: 3d closures become hinges where their bodies turn about one axis alone, for solvers that hold no "
        "ball joint in a loop; default: stated",
    )
    parser.add_argument(
        "--mesh-files",
        choices=MESH_FILES,
        default="copy",
        help="copy mesh files to meshes/, or reference them where they are by absolute paths; default: copy",
    )
    parser.add_argument("--strict", action="store_true", help="write nothing if a loss is not exact")
    parser.add_argument("--force", action="store_true", help="replace existing files")
    parser.add_argument(
        "--verify",
        action="store_true",
        help="read the result back: compare mass, mass matrix, loops and limits with the robot, simulate 2 s where the "
        "program can, and say which loops open by more than 5 mm, or what diverges, and why",
    )
    parser.add_argument("--format", choices=("text", "json"), default="text", help="format of the output")
    parser.add_argument("--json", action="store_const", dest="format", const="json", help="same as --format json")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Export, show the losses, and return the exit code."""
    from eurdf.linking.description import Unlinked, describe

    path = select_one(args.path)
    options = robot_options(args)
    description = describe(path, **options)
    as_json = args.format == "json"
    if isinstance(description, Unlinked) or description.diagnostics.refused:
        show_report(description.path, tuple(description.diagnostics), as_json)
        return 1
    if description.diagnostics:  # such as closures of another dialect, which the file will not have
        show_report(description.path, tuple(description.diagnostics), False)

    from eurdf.convert.exceptions import CannotExport
    from eurdf.convert.export import Choices, export_linked
    from eurdf.convert.verification.verify import require_reader

    if args.verify:
        require_reader(args.to)
    losses: tuple[Loss, ...]
    refusal, paths, verification = "", [], None
    folder = args.output or f"{_file_name(description.mechanism.name)}_{args.to}"
    try:
        choices = Choices(args.to, args.configuration, args.actuators, args.closures, args.mesh_files, args.strict)
        exported = export_linked(description, choices, options["package_dirs"], allow_outside=options["allow_outside"])
    except CannotExport as reason:
        losses = reason.losses
        refusal = "nothing was written: --strict refuses losses" if losses else f"nothing was written: {reason}"
    except ValueError as reason:
        raise CannotRun(str(reason)) from None
    else:
        losses = exported.losses
        with writing():
            paths = [os.fspath(each) for each in exported.write(folder, force=args.force)]
        if args.verify:
            with progress_bar("simulating") as progress:
                verification = exported.verify(progress=progress)
    if as_json:
        from eurdf.commands.export_info import export_info

        info = export_info(
            description.path, args.to, paths, losses, refusal, lambda loss: _place(loss, description), verification
        )
        write_json(info.model_dump(mode="json"))
    else:
        write_lines(loss_lines(losses, lambda loss: _place(loss, description)), sys.stdout)
        print_notes([refusal] if refusal else [f"wrote '{each}'" for each in paths])
        if verification is not None:
            write_lines(verification_lines(verification), sys.stdout)
    return 1 if refusal or (verification is not None and verification.findings) else 0


def _file_name(robot: str) -> str:
    return re.sub(r"[^A-Za-z0-9._-]", "_", robot).strip(".") or "robot"


def _place(loss: Loss, description: Linked) -> Place | None:
    """Where the element of a loss is stated, if it is in a file."""
    from eurdf.linking.description import Described

    name, urdf = loss.name, description.urdf
    if any(constraint.name == name for constraint in description.mechanism.constraints):
        if loss.concept.endswith(("closure", "coupling", "compliance")) and isinstance(description, Described):
            return description.place_of_constraint(name)
        return None
    if loss.concept in ("inertia", "link without mass"):
        return urdf.document.place(urdf.links[name].element, None) if name in urdf.links else None
    if loss.concept in ("actuator", "control range", "gear ratio"):
        name = next((joint for joint, motor in description.mechanism.motors.items() if motor.name == name), name)
    if name in urdf.joints:
        return urdf.document.place(urdf.joints[name].element, None)
    return None
