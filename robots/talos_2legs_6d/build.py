"""Draws the whole of Talos, the rods of its ankles cut. Run as ``python -m robots.talos_2legs_6d.build [FOLDER]``."""

from __future__ import annotations

import sys
from pathlib import Path

from robots.builder import Drawing, write
from robots.talos_2legs.build import draw_talos


def draw() -> Drawing:
    """The robot with every joint at zero."""
    description = "PAL Robotics' humanoid Talos, the rods of its ankles cut and held by 6d closures"
    return draw_talos("talos_2legs_6d", description, ("universal", "ball"))


if __name__ == "__main__":
    write(draw(), Path(sys.argv[1]) if sys.argv[1:] else Path(__file__).parent)
