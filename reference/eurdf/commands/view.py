"""``eurdf view``: show a robot in the browser, and move it with its loops closed."""

from __future__ import annotations

import argparse
import sys
import threading

from eurdf.commands.cannot_run import CannotRun
from eurdf.commands.migrate import print_notes
from eurdf.commands.output import write_lines
from eurdf.commands.output_file import refuse_to_replace, write_new
from eurdf.commands.robot_options import add_robot_options, add_robot_path, ending, robot_options
from eurdf.commands.selection import select_one

_DESCRIPTION = """\
Show a robot on a page in the browser, with a slider for each actuator. The loops stay closed: the passive joints
follow, and a slider stops at a position limit or a dead point and says why.

The page is updated when the files of the robot change. The command ends with Ctrl-C.

With --output, it writes a page that moves the robot without a server and without a network, to share or to publish.
"""
_EPILOG = ending(
    "0 ended or written, 1 the robot has errors, 2 the command cannot run.",
    "eurdf view my_robot",
    "eurdf view my_robot --trajectory walk.csv",
    "eurdf view my_robot --port 9000 --no-browser",
    "eurdf view my_robot -o my_robot.html",
)

_LOOPBACK = "127.0.0.1"


def register(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the command to the parser."""
    parser = subparsers.add_parser(
        "view",
        help="show a robot in the browser, and move it with its loops closed",
        description=_DESCRIPTION,
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    add_robot_path(parser)
    add_robot_options(parser)
    parser.add_argument("--root", choices=("fixed", "floating"), help="default: as the description says")
    parser.add_argument(
        "--port", type=_port, metavar="PORT", help="port to listen on, 0 for any; default: 8080 or the next free one"
    )
    parser.add_argument(
        "--host",
        default=_LOOPBACK,
        metavar="ADDRESS",
        help=f"address to listen on; default: {_LOOPBACK}, for this machine alone. With another one, other machines "
        "can move the robot, and save configurations to its file",
    )
    parser.add_argument(
        "--trajectory",
        metavar="FILE",
        help="a CSV file to replay: the first line names the columns, time and joints; the other joints follow",
    )
    parser.add_argument("--no-browser", action="store_true", help="do not open the page")
    parser.add_argument("-o", "--output", metavar="OUT", help="write a page that needs no server to this HTML file")
    parser.add_argument("--force", action="store_true", help="replace an existing file")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Show the page until the command is interrupted, or write it, and return the exit code."""
    path = select_one(args.path)
    options = {"root": args.root, **robot_options(args)}

    import eurdf

    try:
        if args.output is not None:
            if args.trajectory is not None:
                raise CannotRun("a page that needs no server replays no trajectory; leave out --trajectory or --output")
            refuse_to_replace(args.output, args.force)

            from eurdf.viewing.live_robot import live_page

            write_new(args.output, live_page(eurdf.load(path, **options)), args.force)
            print_notes([f"wrote '{args.output}'"])
            return 0
        viewer = eurdf.view(path, host=args.host, port=args.port, browser=not args.no_browser, options=options)
    except eurdf.InvalidRobot as refusal:
        from eurdf.commands.check import write_reports
        from eurdf.diagnostics.report import Report

        write_reports([Report(refusal.path, tuple(refusal.diagnostics))])
        return 1
    with viewer:
        try:
            write_lines([[(f"{viewer.robot.mechanism.name}: ", ""), (viewer.url, "bold")]], sys.stdout)
            sys.stdout.flush()
            if args.trajectory is not None:
                viewer.replay(args.trajectory)
            threading.Event().wait()
        except ValueError as reason:
            raise CannotRun(f"'{args.trajectory}': {reason}") from None
        except KeyboardInterrupt:
            pass  # this is how it ends
    return 0


def _port(text: str) -> int:
    try:
        port = int(text)
    except ValueError:
        port = -1
    if not 0 <= port < 1 << 16:
        raise argparse.ArgumentTypeError(f"'{text}' is not a port, 0 to 65535")
    return port
