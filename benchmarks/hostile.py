"""Time and memory to check, report and load files that are made to take much of both, each in its own process."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

_TESTS = Path(__file__).parents[1] / "tests"


def main() -> None:
    """Print a table: processor time in s, and memory beyond that of the packages in MiB."""
    print(f"{'s':>7} {'MiB':>6}  file")
    command = [sys.executable, str(_TESTS / "support" / "hostile.py")]
    environment = {**os.environ, "PYTHONPATH": str(_TESTS), "OPENBLAS_NUM_THREADS": "1"}
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=environment) as process:
        assert process.stdout is not None
        for line in process.stdout:
            found = json.loads(line)
            print(f"{found['seconds']:7.2f} {found['memory']:6}  {found['name']}", flush=True)
