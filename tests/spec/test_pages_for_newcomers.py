"""The pages for those who come from another format: what their commands print and write is what they show."""

from __future__ import annotations

import importlib.util
from pathlib import Path

import pytest

from support.page_reader import PageReader
from support.places import ROOT

DOCS = ROOT / "docs"


@pytest.mark.parametrize("name", ["from_mjcf", "from_sdf", "from_toolbox", "from_urdf_plus"])
def test_files_and_output_are_as_shown(name: str, tmp_path: Path) -> None:
    if name == "from_mjcf" and importlib.util.find_spec("mujoco") is None:
        pytest.skip("mujoco is not installed: pip install -e '.[mujoco]'")
    reader = PageReader(DOCS / f"{name}.md", tmp_path)
    reader.follow()
    assert len(reader.told) >= 2
    for line, shown, given in reader.told:
        assert given == shown, f"docs/{name}.md:{line}"
