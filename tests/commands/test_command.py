"""The help of the commands: the same words for what they have in common, and examples that parse."""

from __future__ import annotations

import re
import shlex

import pytest

from eurdf.commands.main import COMMANDS, main

#: The commands that link a robot, and those that read a URDF alone.
OF_ROBOTS = (
    "check",
    "explain",
    "info",
    "view",
    "picture",
    "assemble",
    "export",
    "transmission",
    "serial",
    "migrate",
    "simplify",
)
OF_URDFS = ("generate", "schema")


def help_of(command: str, capsys: pytest.CaptureFixture[str]) -> str:
    with pytest.raises(SystemExit) as exit_:
        main([command, "--help"])
    assert exit_.value.code == 0
    return capsys.readouterr().out


def option(text: str, name: str) -> str:
    """What the help says of an option, in one line."""
    found = re.search(rf"^  {re.escape(name)}\b(.*?)(?=^  \S|^\S|\Z)", text, re.MULTILINE | re.DOTALL)
    assert found, f"{name} is missing"
    return " ".join(found[1].split())


@pytest.mark.parametrize("command", COMMANDS)
def test_help_shows_examples_and_exit_codes(
    command: str, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", "100")
    text = help_of(command, capsys)
    assert "\nExit codes: 0 " in text
    assert "2 the command cannot run" in text or "2 the check cannot run" in text
    examples = re.findall(r"^  (.*\beurdf .*)$", text.partition("\nexample")[2], re.MULTILINE)
    assert examples
    for example in examples:
        _, _, words = example.rpartition("eurdf ")
        name, *arguments = shlex.split(words)
        assert name == command
        # What the parser refuses, it refuses before it looks for any help.
        with pytest.raises(SystemExit) as exit_:
            main([name, *arguments, "--help"])
        assert exit_.value.code == 0
        capsys.readouterr()


def test_shared_options_have_the_same_help(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "100")
    of_robots = [help_of(command, capsys) for command in OF_ROBOTS]
    of_urdfs = [help_of(command, capsys) for command in OF_URDFS]
    for name, texts in (
        ("--urdf FILE", of_robots),
        ("--package-dir DIR", of_robots + of_urdfs),
        ("--xacro-arg NAME:=VALUE", of_robots + of_urdfs),
    ):
        assert len({option(text, name) for text in texts}) == 1
    paths = [option(text, "PATH") for text in of_robots]
    assert all(path.startswith(paths[1]) for path in paths)
    assert set(COMMANDS) == {*OF_ROBOTS, *OF_URDFS, "import", "robots", "certify", "completion", "server"}


@pytest.mark.parametrize("command", sorted({*COMMANDS} - {"certify", "completion", "server"}))
def test_results_are_also_written_as_json(command: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert option(help_of(command, capsys), "--json")
