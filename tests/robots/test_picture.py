"""Pictures of robots: three views side by side, in colour, on white."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parents[2]))

import eurdf
from robots import picture, sheet

ROOT = Path(__file__).parents[2]


def test_missing_renderer_says_what_to_install(monkeypatch, capsys, tmp_path):
    monkeypatch.setitem(sys.modules, "pyvista", None)
    assert picture.main(["four_bar", "-o", str(tmp_path / "picture.png")]) == 2
    assert 'pip install -e ".[pictures]"' in capsys.readouterr().err


def test_undrawable_robot_is_reported(monkeypatch, capsys, tmp_path):
    pytest.importorskip("pyvista", reason="pyvista is not installed: pip install -e '.[pictures]'")
    assert picture.main(["no_such_robot"]) == 1
    (tmp_path / "robot.urdf").write_text('<robot name="bare"><link name="base"/></robot>')
    assert picture.main([str(tmp_path)]) == 1
    no_such, bare = capsys.readouterr().err.splitlines()
    assert no_such.startswith("no_such_robot: there is no")
    assert bare == f"{tmp_path}: it has no visual shapes"


def test_views_fill_picture_within_margin():
    pytest.importorskip("pyvista", reason="pyvista is not installed: pip install -e '.[pictures]'")
    image = picture.picture(eurdf.load("four_bar"))
    height, width, _ = image.shape
    assert abs(width - 780) <= 3
    assert height <= 860
    seen = (image < 250).any(axis=2)
    rows, columns = np.flatnonzero(seen.any(axis=1)), np.flatnonzero(seen.any(axis=0))
    assert (columns[0], width - 1 - columns[-1]) == pytest.approx((12, 12), abs=2)
    assert (rows[0], height - 1 - rows[-1]) == pytest.approx((12, 12), abs=2)


def test_picture_is_drawn_beside_robot_and_is_small():
    for file in ROOT.glob("robots/*/picture.png"):
        assert file.stat().st_size <= 150_000, file


def test_sheet_shows_each_robot_with_name():
    pytest.importorskip("pyvista", reason="pyvista is not installed: pip install -e '.[pictures]'")
    one, two = sheet.sheet(["four_bar"]), sheet.sheet(["four_bar", "bennett"])
    width, height = 170, 190
    assert one.shape == two.shape
    assert (one[:, width:] == 255).all()
    assert (two[:, :width] == one[:, :width]).all()
    for part in (two[: height - 22, width : 2 * width], two[height - 22 :, width : 2 * width]):
        assert (part < 128).any()


def test_sheet_without_renderer_says_what_to_install(monkeypatch, capsys, tmp_path):
    monkeypatch.setitem(sys.modules, "pyvista", None)
    assert sheet.main(["-o", str(tmp_path / "sheet.png")]) == 2
    assert 'pip install -e ".[pictures]"' in capsys.readouterr().err
