"""The tutorial of the specification: done from its first block to its last, it gives what it shows."""

from __future__ import annotations

import re

import pytest

from spec.figures import draw
from support.page_reader import PageReader
from support.places import ROOT

SPEC = ROOT / "spec"
TUTORIAL = SPEC / "tutorial.md"
ROBOT = SPEC / "examples" / "tutorial"


@pytest.fixture(scope="module")
def reader(tmp_path_factory: pytest.TempPathFactory) -> PageReader:
    """Who has done the tutorial."""
    reader = PageReader(TUTORIAL, tmp_path_factory.mktemp("tutorial"))
    reader.follow()
    return reader


def test_commands_and_code_give_what_tutorial_shows(reader: PageReader) -> None:
    assert len(reader.told) > 10
    for line, shown, given in reader.told:
        assert given == shown, f"spec/tutorial.md:{line}"


def test_final_tutorial_robot_is_the_example(reader: PageReader) -> None:
    for name in ("robot.urdf", "robot.yaml"):
        assert (reader.folder / name).read_text(encoding="utf-8") == (ROBOT / name).read_text(encoding="utf-8"), name


@pytest.mark.parametrize("name", sorted(draw.FIGURE))
def test_figures_are_current(name: str) -> None:
    assert (SPEC / "figures" / f"{name}.svg").read_text(encoding="utf-8") == draw.FIGURE[name]().text()


def test_figures_are_readable_on_any_background() -> None:
    for path in sorted((SPEC / "figures").glob("*.svg")):
        for colour in set(re.findall(r'(?:fill|stroke)="([^"]+)"', path.read_text(encoding="utf-8"))):
            if colour not in ("none", draw.INK):
                assert _contrast(colour, 1.0) >= 3.0, f"{path.name}: {colour} on white"
                assert _contrast(colour, 0.0) >= 3.0, f"{path.name}: {colour} on black"


def _contrast(colour: str, ground: float) -> float:
    """Contrast ratio of a colour with a ground of a relative luminance, as WCAG 2 defines it."""
    parts = [int(colour[start : start + 2], 16) / 255 for start in (1, 3, 5)]
    linear = [part / 12.92 if part <= 0.04045 else ((part + 0.055) / 1.055) ** 2.4 for part in parts]
    luminance = sum(weight * part for weight, part in zip((0.2126, 0.7152, 0.0722), linear, strict=True))
    brighter, darker = max(luminance, ground), min(luminance, ground)
    return (brighter + 0.05) / (darker + 0.05)
