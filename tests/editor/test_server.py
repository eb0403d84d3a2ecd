"""The server as an editor sees it, over standard input and output."""

from __future__ import annotations

import asyncio
import json
import os
import shutil
import subprocess
import sys
from collections.abc import Awaitable, Callable
from pathlib import Path

import pytest

pytest.importorskip("pygls", reason="pygls is not installed: pip install -e '.[test]'")

from lsprotocol import types as lsp

import eurdf
from eurdf.editor.server import EditorServer
from eurdf_conformance.corpus.case import InvalidCase
from eurdf_conformance.corpus.read import all_cases
from support.language_server import Editor, in_editor
from support.places import ROBOTS
from support.typed import place_of

SERVER = (sys.executable, "-m", "eurdf", "server")
FILES = {name: (ROBOTS / "four_bar" / name).read_text(encoding="utf-8") for name in ("robot.yaml", "robot.urdf")}
WRONG = FILES["robot.yaml"].replace("rocker_pin_a", "roker_pin_a")


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for name in FILES:
        shutil.copy(ROBOTS / "four_bar" / name, tmp_path)
    return tmp_path


def served(session: Callable[[Editor], Awaitable[None]]) -> None:
    in_editor(session, SERVER)


def test_an_editor_finds_fixes_and_renames(folder: Path) -> None:
    file = folder / "robot.yaml"

    async def session(editor: Editor) -> None:
        assert await editor.open(file) == []
        found = await editor.type(file, WRONG)
        assert [(each.code, each.range.start) for each in found] == [("unknown-frame", place_of(WRONG, "roker_pin_a"))]
        (quick, _) = await editor.code_actions(file, found[0].range)
        assert [each.new_text for each in quick.edit.changes[file.as_uri()]] == ["rocker_pin_a"]
        assert await editor.type(file, FILES["robot.yaml"]) == []
        edit = await editor.rename(file, place_of(FILES["robot.yaml"], "motor_crank"), "motor")
        assert {Path(uri).name for uri in edit.changes} == {"robot.yaml", "robot.urdf"}
        with pytest.raises(Exception, match="two joints are named 'free_rocker'"):
            await editor.rename(file, place_of(FILES["robot.yaml"], "motor_crank"), "free_rocker")
        at = place_of(FILES["robot.yaml"], "motor_crank")
        line, column = at.line + 1, at.character + 1
        assert "continuous" in await editor.hover(file, line, column)
        assert "free_rocker" in await editor.completions(file, line, column)
        assert [each.command.title for each in await editor.code_lenses(file)][1:] == ["assemble", "view"]

    served(session)


def test_a_file_that_is_closed_counts_as_it_is_on_the_disk(folder: Path) -> None:
    async def session(editor: Editor) -> None:
        await editor.open(folder / "robot.yaml")
        await editor.open(folder / "robot.urdf")
        wrong = FILES["robot.urdf"].replace('name="motor_crank"', 'name="crank_motor"')
        await editor.type(folder / "robot.urdf", wrong, of=folder / "robot.yaml")
        assert editor.found[(folder / "robot.yaml").as_uri()]
        editor.close(folder / "robot.urdf")
        while editor.found[(folder / "robot.yaml").as_uri()]:  # or else the session takes too long
            await asyncio.sleep(0.01)

    served(session)


def test_invalid_cases_are_found_by_the_running_server() -> None:
    cases = [case for case in all_cases() if isinstance(case.case, InvalidCase) and case.description.is_file()]

    async def session(editor: Editor) -> None:
        for case in cases[::80]:
            await editor.open(case.description)
            for found in eurdf.check(case.description).errors:
                at = lsp.Position((found.line or 1) - 1, (found.column or 1) - 1)
                uri = Path(found.file).as_uri()
                while uri not in editor.found:
                    await asyncio.sleep(0.01)
                assert (found.code, at) in [(each.code, each.range.start) for each in editor.found[uri]], case.name

    served(session)


def test_a_request_that_fails_does_not_end_the_server(folder: Path) -> None:
    async def session(editor: Editor) -> None:
        file = folder / "robot.yaml"
        await editor.open(file)
        with pytest.raises(Exception, match="no name of a part"):
            await editor.rename(file, lsp.Position(10**9, 10**9), "x")
        with pytest.raises(Exception, match=r"eurdf\.nothing"):
            await editor.command("eurdf.nothing")
        for text in ("\ud800", "{" * 10_000, "a: &a [*a, *a]", '!!python/object/apply:os.system ["touch made"]', "\0"):
            assert await editor.type(file, text)
        assert await editor.type(file, FILES["robot.yaml"]) == []
        assert not Path("made").exists()

    served(session)


def test_a_check_that_fails_does_not_end_the_server(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    async def session() -> None:
        server, published = EditorServer(), []
        monkeypatch.setattr(server, "text_document_publish_diagnostics", published.append)
        monkeypatch.setattr(server, "window_log_message", published.append)
        examine = server.robots.examine
        monkeypatch.setattr(server.robots, "examine", lambda *_: 1 / 0)
        server.changed((folder / "robot.yaml").as_uri(), WRONG)
        await server.settled()
        assert any("cannot check" in getattr(each, "message", "") for each in published)
        monkeypatch.setattr(server.robots, "examine", examine)
        server.changed((folder / "robot.yaml").as_uri(), WRONG)
        await server.settled()
        assert [each.code for each in published[-1].diagnostics] == ["unknown-frame"]
        server.end()

    asyncio.run(session())


@pytest.mark.slow
@pytest.mark.skipif(shutil.which("nvim") is None, reason="Neovim is not installed: apt install neovim")
def test_neovim_shows_fixes_and_renames(folder: Path) -> None:
    command = ["nvim", "--clean", "--headless", "-S", str(Path(__file__).with_name("neovim.lua"))]
    environment = {**os.environ, "EURDF_PYTHON": sys.executable, "XDG_STATE_HOME": str(folder / "state")}
    done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, timeout=120)
    said = done.stdout + done.stderr
    seen = json.loads(said[said.index("{") : said.rindex("}") + 1])
    at = place_of(WRONG, "roker_pin_a")
    assert (
        seen["diagnostic"].items() >= {"code": "unknown-frame", "line": at.line + 1, "column": at.character + 1}.items()
    )
    assert seen["title"] == "Write 'rocker_pin_a'"
    assert "\n".join([*seen["fixed"], ""]) == FILES["robot.yaml"]
    before, after = eurdf.load(ROBOTS / "four_bar"), eurdf.load(folder)
    assert [name.replace("motor_crank", "motor") for name in before.model.names] == list(after.model.names)
    assert after.actuation.joints == ("motor",)
    assert eurdf.check(folder).ok


def test_without_pygls_the_command_says_how_to_install_it() -> None:
    program = (
        "import sys; sys.modules['pygls'] = None; from eurdf.commands.main import main; sys.exit(main(['server']))"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=60)
    assert done.returncode == 2
    assert "[editor]" in done.stderr
