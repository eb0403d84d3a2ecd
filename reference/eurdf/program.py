"""Programs of this package that run in a process of their own."""

from __future__ import annotations

import sys
from pathlib import Path

# A module in the folder of the program or in the working directory is not one that it means. The package may be where
# only this process looks for it.
_RUN = """\
import sys
sys.path = [*filter(None, sys.path), sys.argv.pop()]
import runpy
runpy.run_path(sys.argv[1], run_name="__main__")
"""


def command_of(program: Path) -> list[str]:
    """The command that runs a file of Python, which can import this package."""
    return [sys.executable, "-c", _RUN, str(program), str(Path(__file__).parents[1])]
