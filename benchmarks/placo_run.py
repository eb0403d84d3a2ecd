"""A program for the Python of an environment with placo: its inverse kinematics of a frame, with loops.

It imports nothing of this project. The request comes on standard input, in JSON: ``urdf`` (a folder with robot.urdf),
``closures`` (kind and two frames of each), ``frame``, ``targets`` (its poses), ``start`` (joint positions by name),
``steps`` and ``idle`` (the most steps, and those without progress), ``ends`` (errors at which to stop). The answer is a
line of JSON on standard output: median processor time, s, and for each target how far the loops are open at the end,
and the frame from its target, m and rad.
"""

from __future__ import annotations

import json
import statistics
import sys
import time
from typing import Any

import numpy as np
import placo

_TURNS = 10


def main() -> None:
    """Answer the request."""
    request = json.load(sys.stdin)
    robot = placo.RobotWrapper(request["urdf"], placo.Flags.ignore_collisions)
    solver = placo.KinematicsSolver(robot)
    solver.mask_fbase(True)
    solver.enable_joint_limits(False)
    closures = []
    for number, (kind, a, b) in enumerate(request["closures"]):
        if kind == "3d":
            closure = solver.add_relative_position_task(a, b, np.zeros(3))
            closure.configure(f"loop{number}", "hard", 1.0)
        else:
            closure = solver.add_relative_frame_task(a, b, np.eye(4))
            closure.configure(f"loop{number}", "hard", 1.0, 1.0)
        closures.append((kind, a, b))
    task = solver.add_frame_task(request["frame"], np.eye(4))
    task.configure("frame", "soft", 1.0, 1.0)
    times, errors = [], []
    for target in map(np.array, request["targets"]):
        taken, end = min(_solve(request, robot, solver, task, target) for _ in range(_TURNS))
        times.append(taken)
        errors.append(end)
    print(json.dumps({"seconds": statistics.median(times), "errors": errors}))


def _solve(
    request: dict[str, Any], robot: Any, solver: Any, task: Any, target: Any
) -> tuple[float, tuple[float, float]]:
    for name, value in request["start"].items():
        robot.set_joint(name, value)
    robot.update_kinematics()
    task.T_world_frame = target
    begin, least, idle = time.process_time(), np.inf, 0
    for _ in range(request["steps"]):
        end = _errors(request, robot, target)
        idle = 0 if sum(end) < 0.5 * least else idle + 1
        least = min(least, sum(end))
        if (end[0] <= request["ends"][0] and end[1] <= request["ends"][1]) or idle > request["idle"]:
            break
        solver.solve(True)
        robot.update_kinematics()
    return time.process_time() - begin, end


def _errors(request: dict[str, Any], robot: Any, target: Any) -> tuple[float, float]:
    loops = 0.0
    for kind, a, b in request["closures"]:
        T = np.linalg.inv(robot.get_T_world_frame(a)) @ robot.get_T_world_frame(b)
        loops = max(loops, float(np.abs(T[:3, 3]).max()), _angle(T) if kind == "6d" else 0.0)
    T = np.linalg.inv(target) @ robot.get_T_world_frame(request["frame"])
    return loops, max(float(np.linalg.norm(T[:3, 3])), _angle(T))


def _angle(T: Any) -> float:
    R = T[:3, :3]
    return float(np.linalg.norm([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]]) / 2.0)


if __name__ == "__main__":
    main()
