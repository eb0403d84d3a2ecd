"""Figures of workspaces."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

import eurdf
from support.transmissions import slider_crank

ANKLE = ("free_pitch", "free_roll")


@pytest.fixture(scope="module")
def found() -> eurdf.transmissions.Workspace:
    return eurdf.transmissions.workspace(eurdf.load("unitree_g1_ankle", geometry=False), ANKLE, grid=5)


@pytest.mark.slow
def test_figure_names_quantities_and_stops(found: eurdf.transmissions.Workspace, tmp_path: Path) -> None:
    import matplotlib

    with matplotlib.rc_context({"svg.fonttype": "none"}):  # texts as texts
        drawn = eurdf.transmissions.plot_workspace(found, tmp_path / "ankle.svg", armature={"motor_a": 0.0036})
    text = drawn.read_text(encoding="utf-8")
    for words in ("free_pitch: torque [N·m]", "free_roll: velocity [rad/s]", "free_roll: inertia [10⁻³ kg·m²]"):
        assert words in text
    for stop in found.stops:
        assert str(stop) in text


def test_one_joint_gives_curves(tmp_path: Path) -> None:
    robot, q = slider_crank(0.3, 0.8, 1.1)
    found = eurdf.transmissions.workspace(robot, "slide", q, grid=5, ranges={"slide": (0.6, 1.0)})
    drawn = eurdf.transmissions.plot_workspace(found, tmp_path / "slide.png")
    assert drawn.read_bytes().startswith(b"\x89PNG")


def test_other_endings_are_errors(found: eurdf.transmissions.Workspace, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"ending '\.jpeg'; a figure ends in \.png, \.svg or \.pdf"):
        eurdf.transmissions.plot_workspace(found, tmp_path / "ankle.jpeg")


def test_missing_matplotlib_names_the_extra(
    found: eurdf.transmissions.Workspace, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    with pytest.raises(eurdf.errors.MissingExtra, match="plot") as caught:
        eurdf.transmissions.plot_workspace(found, tmp_path / "ankle.png")
    assert caught.value.extra == "plot"
