"""Programs of this package that run in a process of their own."""

from __future__ import annotations

import sys
from pathlib import Path

# A module in the working directory is not one that the program means. This package may be in a folder that only the
# process of the caller has added to those that it searches.
_RUN = """\
import sys
package = sys.argv.pop()
sys.path = [folder for folder in sys.path if folder]
if package not in sys.path:
    sys.path.insert(0, package)
import runpy
runpy.run_path(sys.argv[1], run_name="__main__")
"""


def command_of(program: Path) -> list[str]:
    """The command that runs a file of Python, which can import this package."""
    return [sys.executable, "-c", _RUN, str(program), str(Path(__file__).parents[1])]
