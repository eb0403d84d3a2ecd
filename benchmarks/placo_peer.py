"""placo in an environment of its own, whose Python `EURDF_PLACO_PYTHON` names: it needs another Pinocchio."""

from __future__ import annotations

import json
import os
import subprocess
from collections.abc import Sequence
from pathlib import Path

import pinocchio as pin

import eurdf
from benchmarks.inverse_kinematics_peers import IDLE, MOST_STEPS
from benchmarks.plain_newton import AT_TARGET, CLOSED, Vector
from eurdf.mechanism.joint_types import JointType

VARIABLE = "EURDF_PLACO_PYTHON"

_TYPES = (JointType.REVOLUTE, JointType.CONTINUOUS, JointType.PRISMATIC, JointType.FIXED)


def placo_time_and_errors(
    robot: eurdf.Robot, frame: str, targets: Sequence[pin.SE3], q0: Vector
) -> tuple[float | None, list[tuple[float, float]]]:
    """Median time, s, and the errors of loops and frame at the end; none where placo cannot do the robot."""
    mechanism, program = robot.mechanism, os.environ.get(VARIABLE)
    folder = Path(__file__).parents[1] / "robots" / mechanism.name
    frames = [(each.type, each.a.frame, each.b.frame) for each in mechanism.closures]
    if (
        program is None
        or not (folder / "robot.urdf").is_file()
        or mechanism.root == "floating"
        or mechanism.couplings
        or any(joint.type not in _TYPES for joint in mechanism.joints)
        or any(kind not in ("3d", "6d") or not (a and b) for kind, a, b in frames)
    ):
        return None, []
    request = {
        "urdf": str(folder),
        "closures": frames,
        "frame": frame,
        "targets": [target.homogeneous.tolist() for target in targets],
        "start": {name: value for name, (value,) in robot.joint_positions(q0).items()},
        "steps": MOST_STEPS,
        "idle": IDLE,
        "ends": (CLOSED, AT_TARGET),
    }
    command = [program, str(Path(__file__).with_name("placo_run.py"))]
    run = subprocess.run(command, input=json.dumps(request), capture_output=True, text=True, check=False)
    if run.returncode:  # its quadratic program has no solution, or the URDF has other frames
        return None, []
    answer = json.loads(run.stdout.splitlines()[-1])
    return answer["seconds"], answer["errors"]
