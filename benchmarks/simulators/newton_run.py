"""The solvers of Newton on an exported robot, in the Python of an environment that has it."""

from __future__ import annotations

import json
import os
import subprocess
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

import eurdf
from benchmarks.simulators.run import Refused, Run, rotations

#: Environment variable with the path of that Python. It has packages of its own: those of Newton exclude ours.
VARIABLE = "EURDF_NEWTON_PYTHON"

#: How to have one.
HOW = f"make an environment, `pip install 'newton[sim,importers]'` there, and set {VARIABLE} to its Python"

#: The solvers for rigid bodies, of all in `newton.solvers`.
SOLVERS = ("MuJoCo", "Steel", "Kamino", "XPBD", "VBD", "SemiImplicit", "Featherstone")

#: Rows of the constraints that Newton's joints are when they close a loop.
_ROWS = {"BALL": 3, "FIXED": 6, "REVOLUTE": 5, "DISTANCE": 1}

_PROGRAM = Path(__file__).with_name("newton_process.py")


def ask_newton(python: str, path: Path | None, **request: Any) -> dict[str, Any]:
    """What the program `newton_process` answers for a file, or without one.

    Raises:
        RuntimeError: It ends without an answer.
    """
    done = subprocess.run(
        [python, str(_PROGRAM)],
        input=json.dumps({"model": path and str(path), "solver": None, **request}),
        capture_output=True,
        text=True,
        check=False,
        env={name: value for name, value in os.environ.items() if name not in ("PYTHONPATH", "PYTHONHOME")},
    )
    if done.returncode:
        raise RuntimeError((done.stderr.strip().splitlines() or [f"it ends with {done.returncode}"])[-1])
    answer: dict[str, Any] = json.loads(done.stdout.splitlines()[-1])
    return answer


def rows_of(answer: Mapping[str, Any]) -> int:
    """The number of rows of the loops."""
    return sum(_ROWS[kind] for kind in answer["loops"])


def run_newton(python: str, robot: eurdf.Robot, solver: str, step: float, steps: int, seconds: float) -> Run | Refused:
    """Simulate the USD of a robot with a solver of Newton and its default settings, for at most some processor time."""
    with tempfile.TemporaryDirectory() as folder:
        path = eurdf.export(robot, "usd").write(folder)[0]
        output = os.path.join(folder, "motion.npz")
        options = {"step": step, "steps": steps, "seconds": seconds, "output": output}
        try:
            answer = ask_newton(python, path, solver=f"Solver{solver}", **options)
        except RuntimeError as error:
            return Refused(str(error))
        if "refused" in answer:
            return Refused(answer["refused"])
        with np.load(output) as motion:
            poses, velocities = motion["poses"].astype(float), motion["velocities"].astype(float)
    return Run(
        answer["freedoms"],
        rows_of(answer),
        tuple(answer["bodies"]),
        rotations(poses[..., 3:]),
        poses[..., :3],
        velocities[..., :3],
        velocities[..., 3:],
        duration=step * (len(poses) - 1),
        seconds=answer["seconds"],
    )
