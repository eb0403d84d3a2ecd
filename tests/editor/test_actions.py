"""Fixes and code lenses of documents that are open."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("pygls", reason="pygls is not installed: pip install -e '.[test]'")

from lsprotocol import types as lsp

import eurdf
from eurdf.editor.actions import assembled, code_actions, code_lenses
from eurdf.errors import CannotRun
from eurdf.linking.robot_files import read_robot
from eurdf.reading.source import Texts
from support.places import ROBOTS
from support.typed import checked, edited, opened, place_of

FOUR_BAR = ROBOTS / "four_bar"
WRONG = (FOUR_BAR / "robot.yaml").read_text(encoding="utf-8").replace("rocker_pin_a", "roker_pin_a")


def test_a_quick_fix_gives_the_robot_back() -> None:
    file = FOUR_BAR / "robot.yaml"
    robots = opened(file, robot_yaml=WRONG)
    at = place_of(WRONG, "roker_pin_a")
    assert not code_actions(robots, str(file), lsp.Range(at, at))  # nothing was tried so far
    checked(robots, str(file), thorough=True)
    quick, together = code_actions(robots, str(file), lsp.Range(at, at))
    assert quick.title == "Write 'rocker_pin_a'"
    for action in (quick, together):
        assert edited(robots, action.edit)[str(file)] == file.read_text(encoding="utf-8")
    assert code_actions(robots, str(file), lsp.Range(at, at), [lsp.CodeActionKind.SourceFixAll]) == [together]
    elsewhere = lsp.Range(lsp.Position(0, 0), lsp.Position(0, 0))
    assert code_actions(robots, str(file), elsewhere) == [together]


def test_a_fix_of_a_text_that_is_past_is_not_offered() -> None:
    file = FOUR_BAR / "robot.yaml"
    robots = opened(file, robot_yaml=WRONG)
    checked(robots, str(file), thorough=True)
    robots.documents.change(file.as_uri(), f"{WRONG}\n")
    at = place_of(WRONG, "roker_pin_a")
    assert not code_actions(robots, str(file), lsp.Range(at, at))


def test_a_lens_shows_how_the_robot_moves() -> None:
    file = ROBOTS / "digit_leg" / "robot.yaml"
    robots = opened(file)
    assert not code_lenses(robots, str(file))
    checked(robots, str(file), thorough=True)
    figures, *commands = code_lenses(robots, str(file))
    of = eurdf.analyze(eurdf.load(file, geometry=False))
    expected = f"nv {of.nv} · rows {of.nc} · rank {of.rank} · mobility {of.mobility} · residual "
    assert figures.command is not None
    assert figures.command.title.startswith(expected)
    assert figures.range.start == place_of(file.read_text(encoding="utf-8"), "closures:")
    assert [each.command.title for each in commands if each.command] == ["assemble", "view"]


def test_the_assembled_configuration_is_written(tmp_path: Path) -> None:
    text = (ROBOTS / "five_bar" / "robot.yaml").read_text(encoding="utf-8").partition("configurations:")[0]
    file, urdf = tmp_path / "robot.yaml", (ROBOTS / "five_bar" / "robot.urdf").read_text(encoding="utf-8")
    robots = opened(file, tmp_path / "robot.urdf", robot_yaml=text, robot_urdf=urdf)
    after = edited(robots, assembled(robots, str(file)))
    assert after[str(file)].startswith(text)
    robot = eurdf.load(after[str(file)], after[str(tmp_path / "robot.urdf")])
    assert np.abs(eurdf.residual(robot, robot.configurations["assembled"])).max() < 1e-12
    robots.documents.change(file.as_uri(), f"{text}root: sinking\n")
    with pytest.raises(CannotRun, match="sinking"):
        assembled(robots, str(file))


def test_a_fix_of_both_files_edits_both(tmp_path: Path) -> None:
    for name in ("robot.yaml", "robot.urdf"):
        (tmp_path / name).write_bytes((FOUR_BAR / name).read_bytes())
    file, urdf = tmp_path / "robot.yaml", tmp_path / "robot.urdf"
    wrong = urdf.read_text(encoding="utf-8").replace('type="continuous"', 'type="continous"', 1)
    robots = opened(file, urdf, robot_yaml=WRONG, robot_urdf=wrong)
    for _ in range(2):  # the error of the URDF hides the other
        checked(robots, str(file), thorough=True)
        wrong_file = next(path for path, found in robots.found().items() if found)
        together = code_actions(robots, wrong_file, lsp.Range(lsp.Position(0, 0), lsp.Position(0, 0)))[-1]
        for path, text in edited(robots, together.edit).items():
            robots.documents.change(Path(path).as_uri(), text)
    texts = Texts({path: each.text for path, each in robots.documents.opened.items()})
    assert not read_robot(file, texts=texts).diagnostics.error_count
    assert urdf.read_text(encoding="utf-8") == robots.documents.text(str(urdf))
