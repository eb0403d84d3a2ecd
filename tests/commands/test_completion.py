"""``eurdf completion``, in the shells that are installed."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import eurdf

CASES = [
    ("che", ["check"]),
    ("help expo", ["export"]),
    ("-q info --roo", ["--root"]),
    ("info --root ", ["fixed", "floating"]),
    ("export four_bar --to mj", ["mjcf"]),
    ("check four_", ["four_bar", "four_files"]),
    ("schema --for four_", ["four_files"]),
    ("serial four_bar --joints ", []),
]

# Each gets the words before the cursor, and prints what may follow, a line each.
SHELLS = {
    "bash": """\
eval "$(eurdf completion bash)"
COMP_WORDS=(eurdf "$@")
COMP_CWORD=$#
_eurdf eurdf
printf '%s\\n' "${COMPREPLY[@]}"
""",
    "fish": """\
eurdf completion fish | source
complete -C "eurdf "(string join ' ' -- $argv) | string trim --right --chars /
""",
}


@pytest.fixture
def bin_folder(tmp_path: Path) -> Path:
    """A folder with this `eurdf`."""
    script = tmp_path / "bin" / "eurdf"
    script.parent.mkdir()
    script.write_text(f'#!/bin/sh\nexec "{sys.executable}" -m eurdf "$@"\n', encoding="utf-8")
    script.chmod(0o755)
    return script.parent


@pytest.mark.parametrize("shell", SHELLS)
def test_words_are_completed_in_the_shell(shell: str, tmp_path: Path, bin_folder: Path) -> None:
    if shutil.which(shell) is None:
        pytest.skip(f"{shell} is not installed")
    (tmp_path / "four_files").mkdir()
    (tmp_path / "script").write_text(SHELLS[shell], encoding="utf-8")
    path = os.pathsep.join([str(bin_folder), os.environ["PATH"]])
    environment = {
        **os.environ,
        "PATH": path,
        "PYTHONPATH": str(Path(eurdf.__file__).parents[1]),
        "HOME": str(tmp_path),
    }
    for line, expected in CASES:
        run = [shell, "script", *line.split(" ")]
        found = subprocess.run(run, capture_output=True, text=True, timeout=60, env=environment, cwd=tmp_path)
        assert (sorted(filter(None, found.stdout.splitlines())), found.stderr) == (expected, "")
