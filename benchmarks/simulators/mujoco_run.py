"""MuJoCo on an exported robot."""

from __future__ import annotations

import time

import mujoco
import numpy as np

import eurdf
from benchmarks.simulators.run import Refused, Run, split


def run_mujoco(robot: eurdf.Robot, step: float, steps: int) -> Run | Refused:
    """Simulate the MJCF of a robot with MuJoCo, from its keyframe, with the solver that the file asks for."""
    try:
        model = mujoco.MjModel.from_xml_string(eurdf.export(robot, "mjcf").main.decode())
    except ValueError as error:
        return Refused(str(error))
    model.opt.timestep = step
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    mujoco.mj_forward(model, data)
    rows = data.ne
    found = np.empty((steps + 1, model.nbody - 1, 18))
    seconds = 0.0
    velocity = np.empty(6)
    for index in range(steps + 1):
        found[index, :, :9], found[index, :, 9:12] = data.xmat[1:], data.xpos[1:]
        for body in range(1, model.nbody):
            mujoco.mj_objectVelocity(model, data, mujoco.mjtObj.mjOBJ_BODY, body, velocity, 0)
            found[index, body - 1, 12:15], found[index, body - 1, 15:] = velocity[3:], velocity[:3]
        if index < steps:
            begin = time.process_time()
            mujoco.mj_step(model, data)
            seconds += time.process_time() - begin
            mujoco.mj_forward(model, data)  # mj_step leaves positions of bodies that are one step old
    names = tuple(model.body(index).name for index in range(1, model.nbody))
    return Run(model.nv, rows, names, *split(found), duration=step * steps, seconds=seconds / (step * steps))
