"""Draws the collection on one sheet, each robot once: ``python -m robots.sheet [-o FILE]``."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np

import eurdf
from eurdf.viewing.picture import VIEWS, Image, picture, save_picture
from robots.drawing import draw

_COLUMNS = 7
_CELL = 170, 190  # width and height of a robot and its name, pixels
_NAME = 22  # height of a name, pixels
_GRAY = "#777"  # of the names: the sheet is seen on white and on black


def sheet(robots: Sequence[str]) -> Image:
    """Robots, seen from the front right above, each with its name below: pixels (height, width, 4)."""
    from PIL import Image as Pillow
    from PIL import ImageDraw

    width, height = _CELL
    whole = Pillow.new("RGBA", (_COLUMNS * width, -(-len(robots) // _COLUMNS) * height), _GRAY + "0")
    pen = ImageDraw.Draw(whole)
    for index, name in enumerate(robots):
        left, top = index % _COLUMNS * width, index // _COLUMNS * height
        seen = Pillow.fromarray(picture(eurdf.load(name), VIEWS[1:2]))
        seen.thumbnail((width - 10, height - _NAME), Pillow.Resampling.LANCZOS)
        whole.paste(seen, (left + (width - seen.width) // 2, top + (height - _NAME - seen.height) // 2))
        pen.text((left + width / 2, top + height - _NAME / 2), name, fill=_GRAY, anchor="mm", font_size=12)
    return np.asarray(whole)


def main(arguments: Sequence[str] | None = None) -> int:
    """Draws the sheet; 0 if it is drawn, 2 if it cannot be."""
    default = Path(__file__).parent / "collection.png"
    return draw(
        "sheet",
        "Draw the collection on one sheet.",
        default,
        lambda file: save_picture(sheet(eurdf.collection_names()), file),
        arguments,
    )


if __name__ == "__main__":
    sys.exit(main())
