"""Time of the conformance suite on the reference, all levels, two processes; how much of it is spent in the reader."""

from __future__ import annotations

import subprocess
import sys
import time
from pathlib import Path

ROOT = Path(__file__).parents[1]


def main() -> None:
    """Print the last lines of the run, which say what passed and the share of the reader, and the time of the whole."""
    begin = time.perf_counter()
    command = [sys.executable, "-m", "pytest", "conformance", "-n", "2", "-q"]
    run = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    seconds = time.perf_counter() - begin
    print("\n".join(run.stdout.splitlines()[-16:]))
    print(f"{'whole run, start to end':24} {seconds:6.1f} s")
