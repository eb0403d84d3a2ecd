"""The pages that lead from a CAD program to a checked robot: done as they show, they give what they show."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from eurdf.commands.main import main
from eurdf.writing.naming_conventions import conventions
from support.page_reader import PageReader
from support.places import ROOT

SPEC = ROOT / "spec"
PAGES = ("solidworks", "onshape")


@pytest.mark.parametrize("name", PAGES)
def test_commands_give_what_page_shows(name: str, tmp_path: Path) -> None:
    page = SPEC / f"{name}.md"
    reader = PageReader(page, tmp_path)
    reader.follow()
    assert len(reader.told) >= 3
    for line, shown, given in reader.told:
        assert given == shown, f"spec/{page.name}:{line}"
    for file in ("robot.urdf", "robot.yaml"):
        ended_with = (tmp_path / file).read_text(encoding="utf-8")
        assert ended_with == (SPEC / "examples" / name / file).read_text(encoding="utf-8"), file


@pytest.mark.parametrize("name", PAGES)
def test_options_on_page_exist(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        main(["generate", "--help"])
    options = capsys.readouterr().out
    named = set(re.findall(r"`(--[a-z-]+)`", (SPEC / f"{name}.md").read_text(encoding="utf-8")))
    assert "--type" in named
    assert [option for option in sorted(named) if option not in options] == []


def test_proposed_names_are_recognised() -> None:
    text = (SPEC / "solidworks.md").read_text(encoding="utf-8")
    rows = dict(re.findall(r"^ +\| ([^|]+?) \| ([^|]+?) \|", text, re.M))
    proposed = {what: re.findall(r"`([^`]+)`", names) for what, names in rows.items()}
    known = conventions()
    for what, patterns in (
        ("the two links at a cut", known.closures),
        ("the same, with the type", known.closures),
        ("actuated joints", known.motors),
        ("ball joints", known.sphericals),
    ):
        assert proposed[what]
        for name in proposed[what]:
            assert any(pattern.search(name) for pattern in patterns), name


def test_site_shows_the_pages() -> None:
    index = (SPEC / "index.md").read_text(encoding="utf-8").split()
    assert set(PAGES) <= set(index)
