"""A program for the Python of an environment with Newton: what it reads of a file, and how a solver of it moves that.

It imports nothing of this project. The request comes on standard input, in JSON: ``model`` (path of a file of MJCF or
USD, or null for versions alone), ``solver`` (name of a class of ``newton.solvers``, or null), ``step`` (s), ``steps``,
``seconds`` (processor time after which to stop), ``output`` (path of an npz file to write). The answer is a line of
JSON on standard output.
"""

from __future__ import annotations

import contextlib
import json
import sys
import time
from typing import Any

import newton
import numpy as np
import warp as wp

#: Steps before the time is measured: the first ones compile.
WARM_UP = 3


def main() -> None:
    """Answer the request."""
    request = json.load(sys.stdin)
    with contextlib.redirect_stdout(sys.stderr):
        answer = _answer(request)
    print(json.dumps(answer))


def _answer(request: dict[str, Any]) -> dict[str, Any]:
    wp.config.quiet = True
    versions = {"newton": newton.__version__, "mujoco": _version("mujoco")}
    if request["model"] is None:
        return versions
    builder = newton.ModelBuilder()
    path = request["model"]
    (builder.add_mjcf if path.endswith(".xml") else builder.add_usd)(path)
    if request["solver"] == "SolverVBD":
        builder.color()  # it asks for this
    model = builder.finalize(device="cpu")
    state, other = model.state(), model.state()
    stated = state.body_q.numpy().copy()
    newton.eval_ik(model, state, state.joint_q, state.joint_qd)
    newton.eval_fk(model, state.joint_q, state.joint_qd, state)
    types, articulations = model.joint_type.numpy(), model.joint_articulation.numpy()
    starts = model.joint_qd_start.numpy()
    labels = [label.rpartition("/")[2] for label in model.body_label]
    answer = {
        **versions,
        "freedoms": sum(int(starts[i + 1] - starts[i]) for i in range(model.joint_count) if articulations[i] >= 0),
        "loops": sorted(newton.JointType(int(kind)).name for kind in types[articulations < 0]),
        "mimics": model.joint_mimic_coeffs.numpy()[model.joint_mimic_joint.numpy() >= 0].tolist(),
        "bodies": labels,
        "mass": model.body_mass.numpy().tolist(),
        "poses": stated.tolist(),
        "poses_of_coordinates": state.body_q.numpy().tolist(),
    }
    if request["solver"] is None:
        return answer
    poses, velocities = [state.body_q.numpy().copy()], [state.body_qd.numpy().copy()]
    seconds = 0.0
    try:
        solver = getattr(newton.solvers, request["solver"])(model)
        control = model.control()
        for index in range(request["steps"]):
            begin = time.process_time()
            state.clear_forces()
            solver.step(state, other, control, None, request["step"])
            state, other = other, state
            poses.append(state.body_q.numpy().copy())
            velocities.append(state.body_qd.numpy().copy())
            seconds += time.process_time() - begin if index >= WARM_UP else 0.0
            if seconds > request["seconds"]:
                break
    except Exception as error:
        return answer | {"refused": f"{type(error).__name__}: {error}"}
    np.savez(request["output"], poses=np.stack(poses), velocities=np.stack(velocities))
    return answer | {"seconds": seconds / (request["step"] * (len(poses) - 1 - WARM_UP))}


def _version(module: str) -> str:
    try:
        return str(__import__(module).__version__)
    except ImportError:
        return ""


if __name__ == "__main__":
    main()
