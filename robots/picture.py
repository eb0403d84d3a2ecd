"""Draws the pictures of the collection: ``python -m robots.picture NAME…|--all``.

For each robot: ``picture.png``, three views; ``loops.png``, its closures with the frames where loops are cut; and
``graph.svg``, the graph of links and loops. They are written to its folder. `eurdf picture` draws any robot.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence

import eurdf
from eurdf.collection import collection_folder, collection_names
from eurdf.errors import RobotNotFound
from eurdf.viewing.graph import save_graph
from eurdf.viewing.picture import VIEWS, picture, save_picture


def main(arguments: Sequence[str] | None = None) -> int:
    """Draws the pictures; 0 if all are drawn, 1 if a robot cannot be, 2 if nothing can."""
    parser = argparse.ArgumentParser("python -m robots.picture", description="Draw pictures of robots.")
    parser.add_argument("robots", nargs="*", metavar="ROBOT", help="name of one of the collection")
    parser.add_argument("--all", action="store_true", help="every robot of the collection")
    options = parser.parse_args(arguments)
    robots = collection_names() if options.all else options.robots
    if not robots:
        parser.error("name a robot, or say --all")
    folder, failed = collection_folder(), False
    assert folder is not None  # in a checkout
    for robot in robots:
        try:
            if robot not in collection_names():
                raise RobotNotFound(robot, "it is not in the collection; `eurdf picture` draws other robots")
            loaded = eurdf.load(robot)
            save_graph(loaded.mechanism, folder / robot / "graph.svg")
            save_picture(picture(loaded), folder / robot / "picture.png")
            save_picture(picture(loaded, VIEWS[1:2], loops=True), folder / robot / "loops.png")
        except eurdf.errors.MissingExtra as missing:
            print(missing, file=sys.stderr)
            return 2
        except (eurdf.EurdfError, ValueError, OSError) as error:
            failed = True
            print(f"{robot}: {error}", file=sys.stderr)
    return int(failed)


if __name__ == "__main__":
    sys.exit(main())
