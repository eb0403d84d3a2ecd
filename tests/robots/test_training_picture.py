"""The picture of what a serial model of an ankle costs."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import eurdf
from robots import training_picture
from support.places import ROOT


def test_costs_are_those_of_the_transmission() -> None:
    found = training_picture.costs(9)
    robot = eurdf.load("unitree_g1_ankle", geometry=False)
    for pitch, corners in zip(training_picture.PITCHES, found.torques, strict=True):
        q = eurdf.transmissions.actuator_values(robot, {"free_pitch": np.radians(pitch), "free_roll": 0.0}).q
        G = eurdf.transmission(robot, training_picture.JOINTS, q).G
        expected = 25.0 * np.array([(a, b) for a in (1, -1) for b in (1, -1)]) @ G  # N·m
        np.testing.assert_allclose(sorted(corners.tolist()), sorted(expected.tolist()), atol=1e-9)
        near = np.abs(found.positions - (np.radians(pitch), 0.0)).sum(axis=1) < 1e-9
        np.testing.assert_allclose(
            found.inertia[near], np.atleast_2d((G**2).sum(axis=0) / 2.0)[: near.sum()], rtol=1e-6
        )
    lower, upper = found.box.T
    assert (found.reach >= lower - 1e-9).all()
    assert (found.reach <= upper + 1e-9).all()
    assert len(found.positions) < 81  # corners of the box are out of reach


def test_picture_is_light_and_small(tmp_path: Path) -> None:
    image = pytest.importorskip("PIL.Image", reason="Pillow is not installed: pip install -e '.[pictures]'")
    pytest.importorskip("matplotlib", reason="matplotlib is not installed: pip install -e '.[examples]'")
    committed, drawn = ROOT / "docs/pictures/g1_ankle_training.png", tmp_path / "drawn.png"
    training_picture.save(drawn, training_picture.costs(9))
    assert committed.stat().st_size < 150_000
    with image.open(committed) as picture, image.open(drawn) as now:
        assert picture.size == now.size
        assert picture.convert("RGB").getpixel((0, 0)) == (255, 255, 255)
