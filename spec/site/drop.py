"""``drop.html``, the page that checks and moves a dropped robot: it is beside the pages that Sphinx makes."""

from __future__ import annotations

import json
import shutil
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from eurdf.viewing.page_files import page_file
from spec.site.clause import ROOT
from spec.site.pages import DROP_PAGE

_FOLDER = "drop"  # of what it loads
_EXAMPLES = ("digit_leg", "stewart_platform", "kangaroo_2legs", "robotiq_2f85")

#: Robots with what people get wrong: a title, a robot of the collection, and what is replaced in its description.
_MISTAKEN = (
    (
        "A four-bar with two mistakes",
        "four_bar",
        {"rocker_pin_b]": "roker_pin_b]", "[motor_crank]": "[motor_crnk]"},
    ),
    ("A delta robot with open loops", "delta", {"assembled: {}": "assembled: {motor_1: 0.4}"}),
)


def write_drop_page(site: Path) -> None:
    """Write the page, what it loads and its examples into a site.

    Raises:
        FileNotFoundError: The scripts of pages are not built.
        ValueError: A mistake of the example has no place in the robot any more.
    """
    folder = site / _FOLDER
    folder.mkdir()
    for name in ("page.css", "drop.css", "drop.js"):
        (folder / name).write_text(page_file(name), encoding="utf-8")
    examples = [_example(name, folder) for name in _EXAMPLES] + [_mistaken(*each, folder) for each in _MISTAKEN]
    data = json.dumps(examples, separators=(",", ":")).replace("<", "\\u003c")
    page = (ROOT / DROP_PAGE).read_text(encoding="utf-8")
    script = f'<script id="robots" type="application/json">{data}</script>'
    (site / Path(DROP_PAGE).name).write_text(page.replace("<!-- examples -->", script), encoding="utf-8")


def _example(name: str, folder: Path) -> dict[str, Any]:
    """A robot of the collection, as the script of the page reads it."""
    source = ROOT / "robots" / name
    shutil.copyfile(source / "picture.png", folder / f"{name}.png")
    title = (source / "README.md").read_text(encoding="utf-8").partition("\n")[0].removeprefix("# ")
    texts = {file: (source / file).read_text(encoding="utf-8") for file in ("robot.yaml", "robot.urdf")}
    return {
        "title": title,
        "picture": f"{_FOLDER}/{name}.png",
        "description": {"name": f"{name}/robot.yaml", "text": texts["robot.yaml"]},
        "urdf": {"name": f"{name}/robot.urdf", "text": texts["robot.urdf"]},
    }


def _mistaken(title: str, name: str, mistakes: Mapping[str, str], folder: Path) -> dict[str, Any]:
    """A robot whose description has mistakes."""
    example = _example(name, folder)
    text = example["description"]["text"]
    for right, wrong in mistakes.items():
        if right not in text:
            raise ValueError(
                f"the description of {name} does not contain '{right}', as an example of {DROP_PAGE} expects"
            )
        text = text.replace(right, wrong)
    return {**example, "title": title, "description": {**example["description"], "text": text}}
