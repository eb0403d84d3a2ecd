"""The same robot in MuJoCo and in Pinocchio: one configuration and velocity, seen by both.

Run as ``python examples/mujoco_and_pinocchio.py``; needs MuJoCo.
"""

from __future__ import annotations

from typing import NamedTuple

import mujoco
import numpy as np
import pinocchio as pin

import eurdf


class Compared(NamedTuple):
    """Largest differences of the two.

    Attributes:
        position: Of the origins of links, m.
        mass_matrix: Of the entries of M, kg, kg·m or kg·m².
        bias: Of the forces of gravity and velocity, N or N·m.
    """

    position: float
    mass_matrix: float
    bias: float


def main(name: str = "digit_leg") -> Compared:
    """Compare poses, mass matrix and bias forces near the configuration ``assembled``."""
    robot = eurdf.load(name, geometry=False)
    export = eurdf.export(robot, "mjcf")
    model = mujoco.MjModel.from_xml_string(export.main.decode())
    data = mujoco.MjData(model)

    random = np.random.default_rng(0)
    v = random.uniform(-1.0, 1.0, robot.model.nv)
    q = pin.integrate(robot.model, robot.configurations["assembled"], 0.1 * v)
    data.qpos[:] = export.coordinates.to_q(q)
    data.qvel[:] = export.coordinates.to_v(q, v)
    mujoco.mj_forward(model, data)

    pin.framesForwardKinematics(robot.model, robot.data, q)
    links = [model.body(i).name for i in range(1, model.nbody)]
    position = max(
        float(np.abs(data.body(link).xpos - robot.data.oMf[robot.model.getFrameId(link)].translation).max())
        for link in links
    )
    T = export.coordinates.rates(q)  # velocity of MuJoCo = T v; forces go back by its transpose
    columns = np.zeros((robot.model.nv, model.nv))
    for row, column in zip(columns, T.T, strict=True):
        mujoco.mj_mulM(model, data, row, column)
    mass_matrix = float(np.abs(T.T @ columns.T - eurdf.mass_matrix(robot, q)).max())
    drift = np.zeros(model.nv)
    mujoco.mj_mulM(model, data, drift, export.coordinates.to_a(q, v, np.zeros(robot.model.nv)))
    bias = T.T @ (drift + data.qfrc_bias) - pin.nonLinearEffects(robot.model, robot.data, q, v)
    return Compared(position, mass_matrix, float(np.abs(bias).max()))


if __name__ == "__main__":
    result = main()
    print(f"positions differ by    {result.position:.1e} m at most")
    print(f"mass matrices by       {result.mass_matrix:.1e}")
    print(f"bias forces by         {result.bias:.1e} N or N·m")
