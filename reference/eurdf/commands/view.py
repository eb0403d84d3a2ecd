"""``eurdf view``: show a robot in the browser, and move it with its loops closed."""

from __future__ import annotations

import argparse
import sys
import threading
from typing import Any

from eurdf.commands.command import FORCE_FILE, ROBOT, ROOT, WrittenInfo, cannot_run, command, flag, option
from eurdf.commands.output import write_result
from eurdf.commands.output_file import refuse_to_replace, write_new
from eurdf.commands.terminal import progress_bar, write_lines, write_notes
from eurdf.errors import CannotRun

_DESCRIPTION = """\
Show a robot on a page in the browser, with a slider for each actuator. The loops stay closed: the passive joints
follow, and a slider stops at a position limit or a dead point and says why.

The page is updated when the files of the robot change. The command ends with Ctrl-C.

With --output, it writes a page that moves the robot without a server and without a network, to share or to publish.
"""
_LOOPBACK = "127.0.0.1"


def _port(text: str) -> int:
    try:
        port = int(text)
    except ValueError:
        port = -1
    if not 0 <= port < 1 << 16:
        raise argparse.ArgumentTypeError(f"'{text}' is not a port, 0 to 65535")
    return port


@command(
    summary="show a robot in the browser, and move it with its loops closed",
    description=_DESCRIPTION,
    exit_codes="0 ended or written, 1 the robot has errors, 2 the command cannot run.",
    examples=(
        "eurdf view my_robot",
        "eurdf view my_robot --trajectory walk.csv",
        "eurdf view my_robot --port 9000 --no-browser",
        "eurdf view my_robot -o my_robot.html",
    ),
    has_output=False,
)
def view(
    options: dict[str, Any],
    path: str = ROBOT,
    root: str | None = ROOT,
    port: int | None = option(
        "port to listen on, 0 for any; default: 8080 or the next free one", type=_port, metavar="PORT"
    ),
    host: str = option(
        f"address to listen on; default: {_LOOPBACK}, for this machine alone. With another one, other machines can "
        "move the robot, and save configurations to its file",
        default=_LOOPBACK,
        metavar="ADDRESS",
    ),
    trajectory: str | None = option(
        "a CSV file to replay: the first line names the columns, time and joints; the other joints follow",
        metavar="FILE",
    ),
    no_browser: bool = flag("do not open the page"),
    output: str | None = option("write a page that needs no server to this HTML file", "-o", "--output", metavar="OUT"),
    force: bool = FORCE_FILE,
    json: bool = flag("write one JSON object: the address, or the file"),
) -> int:
    """Show the page until the command is interrupted, or write it."""
    import eurdf

    options["root"] = root
    if output is not None:
        if trajectory is not None:
            raise CannotRun("a page that needs no server replays no trajectory; leave out --trajectory or --output")
        refuse_to_replace(output, force)

        from eurdf.viewing.live_robot import live_page, page_robot

        with progress_bar("writing the page"):
            robot = page_robot(path, **options)
            with cannot_run(FileNotFoundError):
                page = live_page(robot)
        write_new(output, page, force)
        if json:
            write_result(WrittenInfo((output,), None))
        write_notes([f"the page does not show the mesh '{name}': {why}" for name, why in robot.left_out.items()])
        write_notes([f"wrote '{output}'"])
        return 0
    with eurdf.view(path, host=host, port=port, browser=not no_browser, options=options) as viewer:
        try:
            if json:
                write_result(WrittenInfo((), viewer.url))
            else:
                write_lines([[(f"{viewer.robot.mechanism.name}: ", ""), (viewer.url, "bold")]], sys.stdout)
            sys.stdout.flush()
            with cannot_run(ValueError, by=f"'{trajectory}': "):
                if trajectory is not None:
                    viewer.replay(trajectory)
            threading.Event().wait()
        except KeyboardInterrupt:
            pass  # this is how it ends
    return 0
