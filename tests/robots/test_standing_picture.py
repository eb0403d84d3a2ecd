"""The picture of robots that stand: forces are drawn where they act."""

from __future__ import annotations

import numpy as np
import pytest

from examples import stand
from robots import standing_picture
from support.places import ROOT

PICTURE = ROOT / "docs/pictures/stand.png"


@pytest.mark.slow
def test_arrows_are_forces_at_centres_of_pressure():
    robot, moments, _ = stand.main("digit_2legs")
    shaft, head, cone = (surface for surface, _ in list(standing_picture.forces(robot, moments[0]))[:3])
    along = head.vertices[-1] - shaft.vertices.mean(axis=0)
    assert along[2] > 0.9 * np.linalg.norm(along)
    tip = cone.vertices[:36].mean(axis=0)
    np.testing.assert_allclose(shaft.vertices[:36].mean(axis=0), tip, atol=1e-9)
    # The feet carry the same, so the robot is above the middle of both centres of pressure.
    shifts = [surface.vertices[:36].mean(axis=0)[1] for surface, _ in standing_picture.forces(robot, moments[0])]
    assert sum(shifts) == pytest.approx(0.0, abs=1e-3)


def test_picture_is_transparent_and_small():
    image = pytest.importorskip("PIL.Image", reason="Pillow is not installed: pip install -e '.[pictures]'")
    assert PICTURE.stat().st_size < 100_000
    with image.open(PICTURE) as picture:
        assert picture.convert("RGBA").getpixel((0, 0))[3] == 0
