"""The two distributions of the repository agree."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

ROOT = Path(__file__).parents[2]


def project(folder: Path) -> dict[str, Any]:
    value: dict[str, Any] = tomllib.loads((folder / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    return value


READER, SUITE = project(ROOT), project(ROOT / "conformance")


def test_suite_requires_same_version_of_reference() -> None:
    assert SUITE["version"] == READER["version"]
    assert f"eurdf=={READER['version']}" in SUITE["dependencies"]


def test_editable_install_has_test_dependencies() -> None:
    packages = {package for package in SUITE["dependencies"] if not package.startswith("eurdf==")}
    assert packages <= set(READER["optional-dependencies"]["test"])
