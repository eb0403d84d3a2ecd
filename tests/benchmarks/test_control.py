"""The page that compares what control and training get, and the rows that it is made of."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from benchmarks import control
from support.places import ROOT

TEXT = (ROOT / "docs" / "control.md").read_text(encoding="utf-8")


def test_page_has_every_row() -> None:
    assert re.findall(r" \| `(\w+)` \|$", TEXT, re.M) == list(control.ROWS)


@pytest.mark.parametrize("name", ["serial_model", "four_bar", "calibration"])
def test_row_on_page_is_measured_again(name: str) -> None:
    assert f"| {' | '.join(control.ROWS[name]())} |" in TEXT


def test_table_is_written_in_its_place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    page = tmp_path / "page.md"
    page.write_text(TEXT, encoding="utf-8")
    monkeypatch.setattr(control, "ROWS", {"four_bar": lambda: ("a claim", "ours", "another way")})
    assert control.main(["--page", str(page)]) == 0
    before, after = (
        re.split(r"(?<=-->\n)\n|\n\n(?=<!-- end)", text) for text in (TEXT, page.read_text(encoding="utf-8"))
    )
    assert (before[0], before[2]) == (after[0], after[2])
    assert after[1].splitlines()[2:] == ["| a claim | ours | another way | `four_bar` |"]
