"""Imports go in one direction, with no circle: the contracts are in pyproject.toml, under tool.importlinter."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from support.places import ROOT


def lint(folder: Path) -> str:
    """What import-linter says of the packages that are imported from a folder."""
    run = "from importlinter.cli import lint_imports_command as run; run()"
    command = [sys.executable, "-c", run, "--no-cache", "--config", str(ROOT / "pyproject.toml")]
    return " ".join(subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False).stdout.split())


def test_imports_follow_the_layers() -> None:
    said = lint(ROOT)
    assert " 0 broken." in said, said


@pytest.mark.slow
@pytest.mark.parametrize(
    ("file", "wrong", "complaint"),
    [
        ("eurdf/format/wording.py", "import eurdf.linking.link", "eurdf.format is not allowed to import eurdf.linking"),
        ("eurdf/linking/merging.py", "import pinocchio", "eurdf.linking is not allowed to import pinocchio"),
        ("eurdf/mechanism/pose.py", "import yaml", "eurdf.mechanism is not allowed to import yaml"),
        ("eurdf/kinematics/assembly.py", "import pinocchio", "eurdf.kinematics is not allowed to import pinocchio"),
        ("eurdf/commands/certify.py", "import eurdf_conformance", "eurdf is not allowed to import eurdf_conformance"),
        ("eurdf/linking/frame_names.py", "import eurdf.linking.closures", "No cycles are allowed in eurdf.linking"),
    ],
)
def test_wrong_import_breaks_a_contract(tmp_path: Path, file: str, wrong: str, complaint: str) -> None:
    sources = shutil.ignore_patterns("corpus", "__pycache__")
    shutil.copytree(ROOT / "reference/eurdf", tmp_path / "eurdf", ignore=sources)
    shutil.copytree(ROOT / "conformance/eurdf_conformance", tmp_path / "eurdf_conformance", ignore=sources)
    with (tmp_path / file).open("a", encoding="utf-8") as module:
        module.write(f"\n{wrong}\n")
    assert complaint in lint(tmp_path)
