"""``eurdf robots``: list the robots of the package."""

from __future__ import annotations

import argparse
import sys
from typing import TYPE_CHECKING

from eurdf.commands.output import cell, columns, is_terminal, new_table, write_json, write_lines, write_rendered
from eurdf.commands.robot_options import ending

if TYPE_CHECKING:
    from eurdf.commands.collection_info import Collection

# A narrower terminal has no space for descriptions.
_WIDE = 120


def register(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the command to the parser."""
    parser = subparsers.add_parser(
        "robots",
        help="list the robots of the collection",
        description="List the robots of this package. All commands and eurdf.load accept their names.",
        epilog=ending("0 listed, 1 a robot cannot be built, 2 the command cannot run.", "eurdf robots --json"),
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--json", action="store_true", help="write one JSON object")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """List them, and return the exit code."""
    from eurdf.commands.collection_info import collection_info

    collection = collection_info()
    if args.json:
        write_json(collection.model_dump(mode="json"))
    else:
        _show(collection)
    return 1 if any(robot.error for robot in collection.robots) else 0


def _show(collection: Collection) -> None:
    from eurdf.diagnostics.visible import visible

    counts = ("nv", "closures", "nc", "mobility", "actuated", "uncontrolled")
    described = not is_terminal(sys.stdout) or columns() >= _WIDE
    table = new_table("robot", *counts, "root", *(["description"] if described else []))
    for column in table.columns[: len(counts) + 2]:
        column.no_wrap = described
    for column in table.columns[1 : len(counts) + 1]:
        column.justify = "right"
    for robot in collection.robots:
        numbers = (getattr(robot, count) for count in counts)
        said = cell("cannot be built", "red") if robot.error else cell(robot.description or "")
        table.add_row(
            cell(robot.name, "bold"),
            *("-" if number is None else str(number) for number in numbers),
            robot.root or "-",
            *([said] if described else []),
        )
    write_rendered(table)
    errors = (f"{robot.name}: {robot.error}" for robot in collection.robots if robot.error)
    write_lines([[(visible(error), "")] for error in errors], sys.stderr)
