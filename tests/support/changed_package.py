"""A copy of the package with lines added to it: what somebody writes who extends the format."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

import eurdf

#: A file of the package, a text that it has once, and what to add before that; the file is new where there is no text.
Addition = tuple[str, str, str]


def run_with(folder: Path, added: Sequence[Addition], *arguments: str | Path) -> str:
    """Run Python with a copy of the package that has at most 40 lines more, and return what it prints."""
    assert sum(text.count("\n") for _, _, text in added) <= 40
    copy = folder / "eurdf"
    shutil.copytree(Path(eurdf.__file__).parent, copy, ignore=shutil.ignore_patterns("__pycache__"))
    for path, before, text in added:
        (copy / path).parent.mkdir(exist_ok=True)
        content = (copy / path).read_text(encoding="utf-8") if before else ""
        assert not before or content.count(before) == 1, f"{path} has {before!r} {content.count(before)} times"
        (copy / path).write_text(content.replace(before, text + before) if before else text, encoding="utf-8")
    tests = Path(__file__).parents[1]
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(map(str, (folder, tests, tests / "recipes")))}
    ran = subprocess.run(
        [sys.executable, *arguments], env=environment, capture_output=True, text=True, check=False, timeout=300
    )
    assert ran.returncode == 0, ran.stdout + ran.stderr
    return ran.stdout
