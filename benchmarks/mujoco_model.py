"""A robot in MuJoCo, from the MJCF that `eurdf.export` writes, to compare times and motions."""

from __future__ import annotations

import mujoco
import numpy as np
import numpy.typing as npt

import eurdf

Vector = npt.NDArray[np.float64]

# Only gravity and springs act, as in `eurdf.simulate`.
_LEFT_OUT = ("CONTACT", "LIMIT", "ACTUATION", "DAMPER", "FRICTIONLOSS")


class MuJoCoRobot:
    """A robot in MuJoCo: its closures are soft constraints, as stiff as the step allows.

    Attributes:
        model: It integrates with RK4, and has neither contacts nor limits, motors, damping or friction.
        data: Its state.
    """

    def __init__(self, robot: eurdf.Robot, step: float = 1e-3) -> None:
        export = eurdf.export(robot, "mjcf")
        self._coordinates = export.coordinates
        self.model = mujoco.MjModel.from_xml_string(export.main.decode())
        self.model.opt.integrator, self.model.opt.timestep = mujoco.mjtIntegrator.mjINT_RK4, step
        for part in _LEFT_OUT:
            self.model.opt.disableflags |= getattr(mujoco.mjtDisableBit, f"mjDSBL_{part}")
        self.data = mujoco.MjData(self.model)

    def move(self, q: Vector, v: Vector) -> None:
        """Bring it to a configuration (nq,) and velocity (nv,) of the robot."""
        mujoco.mj_resetData(self.model, self.data)
        self.data.qpos[:], self.data.qvel[:] = self.qpos(q), self._coordinates.rates(q) @ v
        mujoco.mj_forward(self.model, self.data)

    def qpos(self, q: Vector) -> Vector:
        """MuJoCo's coordinates of a configuration (nq,)."""
        return np.asarray(self._coordinates.to_q(q))

    @property
    def opening(self) -> float:
        """The largest residual of a closure or coupling, m or rad."""
        mujoco.mj_forward(self.model, self.data)
        return float(np.abs(self.data.efc_pos[: self.data.ne]).max(initial=0.0))

    def step(self, count: int) -> None:
        """Simulate steps."""
        mujoco.mj_step(self.model, self.data, count)
