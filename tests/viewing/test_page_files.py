"""The scripts of pages, and what is said where they are not built."""

from __future__ import annotations

from pathlib import Path

import pytest

from eurdf.viewing import page_files


def test_missing_page_says_what_to_run(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(page_files, "_FOLDER", tmp_path)
    with pytest.raises(FileNotFoundError, match=r"'page\.js' is missing; run: npm install --prefix"):
        page_files.page_file("page.js")
    (tmp_path / "page.js").write_text("1", encoding="utf-8")
    assert page_files.page_file("page.js") == "1"
