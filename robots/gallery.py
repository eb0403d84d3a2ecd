"""Writes what shows the whole collection, ``robots/README.md`` and ``collection.json``: ``python -m robots.gallery``.

Everything in the gallery comes from the folders of the robots: pictures, metadata, and the dimensions in their READMEs,
which `robots.quality` compares with the computed ones. The other file is the output of ``eurdf robots --json``.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path

import yaml

import eurdf
from eurdf.collection import collection_names
from eurdf.commands import robots as command
from eurdf.json_schema import to_json
from robots.features import features_of
from robots.quality.readme import stated_dimensions

HERE = Path(__file__).parent
FILE = HERE / "README.md"
DIMENSIONS = HERE / command.FILE

_HEAD = """\
# Robots of the collection

Load one by its name: `eurdf.load("digit_leg")`, `eurdf view digit_leg`. Each folder has the robot's files, a README
with the source of each number, three pictures (views; closures and the frames where loops are cut; graph of links and
loops) and, for most, the program that draws it. Dimensions are those with the base fixed: velocities of the spanning
tree (nv), constraint rows (nc), mobility, and actuated velocities.

| robot | what it is | features of the format | nv | nc | mobility | actuated | source |
| --- | --- | --- | --- | --- | --- | --- | --- |
"""

_TAIL = """
This page is written by `python -m robots.gallery`. CONTRIBUTING.md explains how to add a robot.
"""


def gallery() -> str:
    """The text of the gallery."""
    return _HEAD + "".join(_row(name) for name in collection_names()) + _TAIL


def _row(name: str) -> str:
    folder = HERE / name
    metadata: Mapping[str, str] = yaml.safe_load((folder / "robot.yaml").read_text(encoding="utf-8"))["metadata"]
    head, *rows = stated_dimensions((folder / "README.md").read_text(encoding="utf-8").splitlines())
    row = dict(zip(head, next((row for row in rows if row[0] == "fixed"), rows[0]), strict=True))
    cells = (
        f'<img src="{name}/picture.png" width="240" alt=""><br>**[{name}]({name}/README.md)**<br>'
        f"[loops]({name}/loops.png), [graph]({name}/graph.svg)",
        metadata["description"],
        ", ".join(features_of(folder)),
        *(row[column] for column in ("nv", "nc", "mobility", "actuated")),
        metadata.get("source", "stated in its README"),
    )
    return f"| {' | '.join(cell.replace('|', '/') for cell in cells)} |\n"


def dimensions() -> str:
    """The text of the file with the computed dimensions."""
    found = command.Collection(tuple(map(_collected, collection_names())))
    return json.dumps(to_json(found), indent=2) + "\n"


def _collected(name: str) -> command.CollectedRobot:
    robot = eurdf.load(name, geometry=False)
    analysis, mechanism = eurdf.analyze(robot), robot.mechanism
    counts = {column: getattr(analysis, column) for column in command.COUNTS if column != "closures"}
    description = str(mechanism.metadata["description"])
    return command.CollectedRobot(name, description, mechanism.root, closures=len(mechanism.closures), **counts)


if __name__ == "__main__":
    DIMENSIONS.write_text(dimensions(), encoding="utf-8")
    FILE.write_text(gallery(), encoding="utf-8")
