"""What the page for those who write an adapter shows is what happens."""

from __future__ import annotations

import re
import shlex
from pathlib import Path

import pytest

from eurdf.commands.main import main
from eurdf_conformance.corpus import archive
from eurdf_conformance.corpus.read import all_cases
from eurdf_conformance.judging.known_failures import read_known_failures
from eurdf_conformance.suite.item import planned_items
from support.places import ROOT
from support.warm import run_module

PAGE = ROOT / "docs" / "write_an_adapter.md"
TEXT = PAGE.read_text(encoding="utf-8")


def blocks(language: str) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```$", TEXT, re.DOTALL | re.MULTILINE)


@pytest.mark.parametrize(
    "shown",
    [
        pytest.param(blocks("console")[0], id="smoke"),
        pytest.param(blocks("console")[1], id="whole", marks=pytest.mark.slow),
    ],
)
def test_first_runs_give_shown_results(shown: str) -> None:
    command, *lines = shown.splitlines()
    program, *arguments = shlex.split(command.removeprefix("$ "))
    assert program == "pytest"
    # The shown lines are of version 1, the only one that the parser claims.
    less = ["--seed=0", "--format-version=1"]
    done = run_module(program, [*arguments, *less, "-n0", "-p", "no:cacheprovider", "--tb=no", "-q"], cwd=ROOT)
    assert lines
    for line in lines:
        # Each case that is added changes the numbers, but not what they show.
        pattern = re.sub(r"\d+(?=\\ (?:of|excused))|(?<=of\\ )\d+", r"\\d+", ".*".join(map(re.escape, line.split("…"))))
        assert re.search(f"^{pattern}$", done.stdout, re.MULTILINE), f"{line}\n{done.stdout}"
    assert done.returncode == int("--smoke" not in arguments)


def test_shown_known_failures_are_usable(tmp_path: Path) -> None:
    (shown,) = blocks("yaml")
    (tmp_path / "known.yaml").write_text(shown, encoding="utf-8")
    known = read_known_failures(tmp_path / "known.yaml")
    assert known.failures
    assert known.unexpected([], planned_items(all_cases())) == []


def test_linked_targets_exist() -> None:
    links = re.findall(r"\]\(([^)]+\.\w+)\)", TEXT)
    assert len(links) >= 2
    assert [link for link in links if not (PAGE.parent / link).is_file()] == []
    assert f"python -m {archive.__name__} OUT" in TEXT


def test_options_on_page_exist(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        main(["certify", "--help"])
    options = capsys.readouterr().out
    named = set(
        re.findall(r"`?(--[a-z]+(?:-[a-z]+)*)", "".join(blocks("sh")) + " ".join(re.findall("`--[^`]+`", TEXT)))
    )
    assert {"--verify", "--compare", "--certificate", "--explore", "--known-failures", "--smoke"} <= named
    assert [option for option in sorted(named) if option not in options] == []
