"""The session in Neovim: the tutorial's robot from an empty file to a valid one, and the moving picture of it."""

from __future__ import annotations

import re
import shutil
from pathlib import Path

import pytest

import eurdf
from robots import editor_picture
from support.places import ROOT

PICTURE = ROOT / "docs/pictures/editor.webp"


@pytest.mark.slow
@pytest.mark.skipif(shutil.which("nvim") is None, reason="Neovim is not installed: apt install neovim")
def test_neovim_writes_the_robot_of_the_tutorial(tmp_path: Path) -> None:
    pytest.importorskip("msgpack", reason="msgpack is not installed: pip install -e '.[test]'")
    pytest.importorskip("pygls", reason="pygls is not installed: pip install -e '.[test]'")
    expected = editor_picture.tutorial(tmp_path)
    with editor_picture.Neovim(tmp_path) as editor:
        editor_picture.write_robot(editor)
        editor.type("<CR>")
        assert editor.lua("vim.diagnostic.get(0)") == []
    written = (tmp_path / "robot.yaml").read_text(encoding="utf-8")
    angles = r"  assembled:.*\n(    .*\n)*"  # the fix writes other digits than the tutorial
    assert re.sub(angles, "", written) == re.sub(angles, "", expected)
    assert eurdf.check(tmp_path).ok
    assert eurdf.analyze(eurdf.load(tmp_path)).mobility == 1


def test_picture_of_the_editor_is_animated_and_small() -> None:
    image = pytest.importorskip("PIL.Image", reason="Pillow is not installed: pip install -e '.[pictures]'")
    assert PICTURE.stat().st_size < 300_000
    with image.open(PICTURE) as picture:
        assert picture.n_frames > 50
        assert picture.width <= 1000
        assert picture.info["loop"] == 0
