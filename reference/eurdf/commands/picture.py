"""``eurdf picture``: draw a robot to a file, without a window."""

from __future__ import annotations

from typing import Any

from eurdf.commands.command import FORCE_FILE, JSON, ROBOT, WrittenInfo, cannot_run, command, flag, option
from eurdf.commands.output import write_result
from eurdf.commands.output_file import refuse_to_replace, writing
from eurdf.commands.selection import NEUTRAL, named_configuration
from eurdf.commands.terminal import progress_bar, write_notes
from eurdf.errors import CannotRun

_DESCRIPTION = """\
Draw the visual shapes of a robot to a PNG file: from the right, from the front right above, and from behind. A robot
without visual shapes is drawn as lines from link to link. The background is transparent. No window is opened.

With --open, the passive joints move so far that the closures are open: the picture shows where the loops are cut, with
the two frames of each closure and a line between them.

With --graph, draw the graph of its links, joints, closures and couplings to an SVG file instead.
"""


@command(
    summary="draw a robot, or its graph of links and loops, to a file",
    description=_DESCRIPTION,
    exit_codes="0 drawn, 1 the robot has errors, 2 the command cannot run.",
    examples=(
        "eurdf picture my_robot -o my_robot.png",
        "eurdf picture my_robot -o crouched.png --configuration crouched --loops",
        "eurdf picture my_robot -o cut.png --open",
        "eurdf picture my_robot -o graph.svg --graph",
    ),
    has_output=False,
)
def picture(
    options: dict[str, Any],
    path: str = ROBOT,
    output: str = option("the PNG or SVG file to write", "-o", "--output", required=True, metavar="OUT"),
    configuration: str | None = option(
        f"one of the description, or {NEUTRAL}; default: assembled, which is searched if there is none", metavar="NAME"
    ),
    loops: bool = flag("show the closures, and the shapes translucent"),
    open_: bool = flag("show the closures open", "--open"),
    graph: bool = flag("draw the graph of links and loops as SVG"),
    force: bool = FORCE_FILE,
    json: bool = JSON,
) -> int:
    """Draw."""
    if graph and (loops or open_ or configuration):
        raise CannotRun("--graph shows no configuration; leave out --loops, --open and --configuration")
    refuse_to_replace(output, force)

    import eurdf
    from eurdf.viewing import picture as drawing
    from eurdf.viewing.graph import save_graph
    from eurdf.writing.saved_configuration import NAME

    with cannot_run(ValueError, by=f"'{path}': "), progress_bar("drawing"):
        robot = eurdf.load(path, **options)
        if not graph:
            if configuration in (None, NAME) and NAME not in robot.configurations:
                q = eurdf.assemble(robot).q
            else:
                q = named_configuration(robot, configuration or NAME)
            image = drawing.picture(robot, q=q, loops=loops, apart=open_)
    with writing():
        if graph:
            save_graph(robot.mechanism, output)
        else:
            drawing.save_picture(image, output)
    if json:
        write_result(WrittenInfo((output,), None))
    write_notes([f"wrote '{output}'"])
    return 0
