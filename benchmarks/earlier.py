"""Times of an earlier version, whose Python `EURDF_EARLIER_PYTHON` names; a program for that Python, too.

The program measures `eurdf.batch.forward_kinematics` with what it has on standard input, a NumPy archive: ``folder`` of
a robot, ``values`` and ``q0``. It prints a line of JSON: its commit, and the least time of the processor, s.
"""

from __future__ import annotations

import io
import json
import os
import subprocess
import sys
import time
from pathlib import Path

import numpy as np

import eurdf

VARIABLE = "EURDF_EARLIER_PYTHON"

_TURNS = 2


def earlier_forward_kinematics(name: str, values: np.ndarray, q0: np.ndarray) -> tuple[str, float] | None:
    """The commit of the earlier version, and its time for a robot of the collection; none without one."""
    program = os.environ.get(VARIABLE)
    if program is None:
        return None
    request = io.BytesIO()
    folder = str(Path(__file__).parents[1] / "robots" / name)  # it may not have this robot itself
    np.savez(request, folder=folder, values=values, q0=q0)
    # Started from its file, it finds no module of this project but those of its own environment.
    run = subprocess.run([program, __file__], input=request.getvalue(), capture_output=True, check=True)
    commit, seconds = json.loads(run.stdout.splitlines()[-1])
    return commit, seconds


def main() -> None:
    """Answer the request."""
    request = np.load(io.BytesIO(sys.stdin.buffer.read()))
    robot = eurdf.load(str(request["folder"]), geometry=False)
    times = []
    for _ in range(_TURNS):
        start = time.process_time()
        eurdf.batch.forward_kinematics(robot, request["values"], request["q0"])
        times.append(time.process_time() - start)
    folder = Path(eurdf.__file__).parent
    commit = subprocess.run(["git", "rev-parse", "--short=8", "HEAD"], cwd=folder, capture_output=True, text=True)
    print(json.dumps((commit.stdout.strip(), min(times))))


if __name__ == "__main__":
    main()
