"""Programs of this package that run in a process of their own."""

from __future__ import annotations

import sys
from pathlib import Path


def command_of(program: Path) -> list[str]:
    """The command that runs a file of Python, which finds no modules in its folder and in the working directory."""
    if sys.version_info >= (3, 11):
        return [sys.executable, "-P", str(program)]
    run = "import sys; del sys.path[0]; import runpy; runpy.run_path(sys.argv[1], run_name='__main__')"
    return [sys.executable, "-c", run, str(program)]
