"""Folders of the repository that tests read."""

from __future__ import annotations

from pathlib import Path

ROOT = Path(__file__).parents[2]
DATA = ROOT / "tests" / "data"
ROBOTS = ROOT / "robots"
#: Published robots, beside the checkout.
WILD = ROOT.parent / "shared" / "wild"
