"""CPU time of the command `eurdf check` on one robot, start to end, against `python -c "import pinocchio"`."""

from __future__ import annotations

import os
import subprocess
import sys

from benchmarks.load import robots


def cpu(command: list[str]) -> float:
    """CPU time of a command, user and system, in s: the least of five."""
    # As an installed package has it: compiled once, by the first run.
    environment = {key: value for key, value in os.environ.items() if key != "PYTHONDONTWRITEBYTECODE"}
    times = []
    for _ in range(5):
        before = os.times()
        subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, env=environment, check=False)
        after = os.times()
        times.append(after.children_user + after.children_system - before.children_user - before.children_system)
    return min(times)


def main() -> None:
    """Print a table."""
    peer = cpu([sys.executable, "-c", "import pinocchio"])
    print(f"{'import pinocchio':24} {peer:6.2f} s")
    for folder in robots():
        ours = cpu([sys.executable, "-m", "eurdf", "check", str(folder)])
        print(f"{'check ' + folder.name:24} {ours:6.2f} s {ours / peer:6.2f}x")
