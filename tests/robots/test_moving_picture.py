"""The moving picture: a foot that is dragged while the loops stay closed."""

from __future__ import annotations

import numpy as np
import pytest

import eurdf
from robots import moving_picture
from support.places import ROOT

PICTURE = ROOT / "docs/pictures/digit_leg.webp"


def test_dragged_foot_keeps_loops_closed_and_returns_to_its_start():
    robot = eurdf.load("digit_leg")
    path = list(moving_picture.dragged(robot, 24))
    assert max(np.abs(eurdf.residual(robot, q)).max() for q, _ in path) < 1e-9
    held = np.array([point for _, point in path])
    assert np.ptp(held, axis=0)[[0, 2]].min() > 0.2
    assert np.abs(held[0] - held[-1]).max() < 0.1


def test_picture_is_transparent_animated_without_end_and_small():
    image = pytest.importorskip("PIL.Image", reason="Pillow is not installed: pip install -e '.[pictures]'")
    assert PICTURE.stat().st_size < 2_000_000
    with image.open(PICTURE) as picture:
        assert picture.n_frames > 24
        assert picture.info["loop"] == 0
        assert all(picture.convert("RGBA").getpixel((0, y))[3] == 0 for y in (0, picture.height - 1))


@pytest.mark.slow
def test_frames_show_the_motion():
    pytest.importorskip("pyvista", reason="pyvista is not installed: pip install -e '.[pictures]'")
    one, other = moving_picture.moving_picture(eurdf.load("digit_leg"), 2)
    assert one.shape == other.shape
    assert (np.abs(one.astype(int) - other).max(axis=2) > 100).sum() > 2000
