"""The page for engineers of humanoids: its commands and code give what it shows."""

from __future__ import annotations

from pathlib import Path

import pytest

from support.page_reader import PageReader
from support.places import ROOT


@pytest.mark.slow
def test_commands_and_code_give_what_page_shows(tmp_path: Path) -> None:
    reader = PageReader(ROOT / "docs" / "humanoids.md", tmp_path)
    reader.follow()
    assert len(reader.told) > 6
    for line, shown, given in reader.told:
        assert given == shown, f"docs/humanoids.md:{line}"
