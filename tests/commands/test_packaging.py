"""The two distributions of the repository agree."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[2]


def project(folder: Path) -> dict[str, Any]:
    value: dict[str, Any] = tomllib.loads((folder / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    return value


READER, SUITE = project(ROOT), project(ROOT / "conformance")


def test_the_suite_has_the_version_of_the_reader_and_needs_it() -> None:
    assert SUITE["version"] == READER["version"]
    assert f"eurdf=={READER['version']}" in SUITE["dependencies"]


def test_an_editable_install_with_test_extra_has_what_the_suite_needs() -> None:
    packages = {package for package in SUITE["dependencies"] if not package.startswith("eurdf==")}
    assert packages <= set(READER["optional-dependencies"]["test"])
