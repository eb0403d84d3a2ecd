"""``eurdf picture``: draw a robot to a file, without a window."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

from eurdf.commands.cannot_run import CannotRun
from eurdf.commands.migrate import print_notes
from eurdf.commands.output_file import refuse_to_replace, writing
from eurdf.commands.robot_options import add_robot_options, add_robot_path, ending, robot_options
from eurdf.commands.selection import select_one

if TYPE_CHECKING:
    from eurdf.kinematics.array import Vector
    from eurdf.pinocchio.robot import Robot

_DESCRIPTION = """\
Draw the visual shapes of a robot to a PNG file: from the right, from the front right above, and from behind. A robot
without visual shapes is drawn as lines from link to link. The background is transparent. No window is opened.

With --graph, draw the graph of its links, joints, closures and couplings to an SVG file instead.
"""
_EPILOG = ending(
    "0 drawn, 1 the robot has errors, 2 the command cannot run.",
    "eurdf picture my_robot -o my_robot.png",
    "eurdf picture my_robot -o crouched.png --configuration crouched --loops",
    "eurdf picture my_robot -o graph.svg --graph",
)

_NEUTRAL = "neutral"


def register(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the command to the parser."""
    parser = subparsers.add_parser(
        "picture",
        help="draw a robot, or its graph of links and loops, to a file",
        description=_DESCRIPTION,
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    add_robot_path(parser)
    add_robot_options(parser)
    parser.add_argument("-o", "--output", required=True, metavar="OUT", help="the PNG or SVG file to write")
    parser.add_argument(
        "--configuration",
        metavar="NAME",
        help=f"one of the description, or {_NEUTRAL}; default: assembled, which is searched if there is none",
    )
    parser.add_argument("--loops", action="store_true", help="show the closures, and the shapes translucent")
    parser.add_argument("--graph", action="store_true", help="draw the graph of links and loops as SVG")
    parser.add_argument("--force", action="store_true", help="replace an existing file")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Draw, and return the exit code."""
    path = select_one(args.path)
    options = robot_options(args)
    if args.graph and (args.loops or args.configuration):
        raise CannotRun("--graph shows no configuration; leave out --loops and --configuration")
    refuse_to_replace(args.output, args.force)

    import eurdf
    from eurdf.viewing.graph import save_graph
    from eurdf.viewing.picture import picture, save_picture

    try:
        robot = eurdf.load(path, **options)
        if args.graph:
            with writing():
                save_graph(robot.mechanism, args.output)
            print_notes([f"wrote '{args.output}'"])
            return 0
        image = picture(robot, q=_configuration(robot, args.configuration), loops=args.loops)
    except eurdf.InvalidRobot as refusal:
        from eurdf.commands.check import write_reports
        from eurdf.diagnostics.report import Report

        write_reports([Report(refusal.path, tuple(refusal.diagnostics))])
        return 1
    except ValueError as reason:
        raise CannotRun(f"'{path}': {reason}") from None
    with writing():
        save_picture(image, args.output)
    print_notes([f"wrote '{args.output}'"])
    return 0


def _configuration(robot: Robot, name: str | None) -> Vector:
    """The configuration to show."""
    import pinocchio as pin

    from eurdf.diagnostics import did_you_mean
    from eurdf.kinematics.assembly import assemble
    from eurdf.writing.saved_configuration import NAME

    if name is not None and name in robot.configurations:
        return robot.configurations[name]
    if name == _NEUTRAL:
        return pin.neutral(robot.model)  # type: ignore[no-any-return]
    if name is None or name == NAME:
        return robot.configurations[NAME] if NAME in robot.configurations else assemble(robot).q
    known = [*robot.configurations, _NEUTRAL]
    hint = did_you_mean(name, known) or f"the configurations are: {', '.join(known)}"
    raise CannotRun(f"there is no configuration '{name}'; {hint}")
