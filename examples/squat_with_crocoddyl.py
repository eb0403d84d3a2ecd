"""Finds a squat of Digit on both feet with Crocoddyl: the least motor torques that lower the torso and raise it again.

Run as ``python examples/squat_with_crocoddyl.py``. The springs of Digit are locked. Only three moments are stated: the
start, the torso down at half time, and standing at rest at the end; the solver finds the motion between them.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import crocoddyl
import numpy as np
import numpy.typing as npt
import pinocchio as pin

import eurdf
from eurdf.crocoddyl import DifferentialActionModelLoopFwdDynamics, ResidualModelFramePlacement

Array = npt.NDArray[np.float64]

STEP, NODES = 0.025, 40  # s; 1 s
DEPTH = 0.2  # m
FEET = ("left_foot", "right_foot")

#: Baumgarte gains kp, 1/s², and kd, 1/s: n steps reduce an opening of loops and contacts as n 0.2ⁿ.
GAINS = ((1.0 - 0.2) / STEP) ** 2, (1.0 - 0.2**2) / STEP

TORQUE, SPEED = 1e-4, 1e-4  # weights: 1/(N·m)²; 1/(rad/s)² and 1/(m/s)²
GOAL = 1e4  # the same of where the torso has to be, 1/m² and 1/rad²
REST = 10.0  # and of the speed at the end


class Squat(NamedTuple):
    """What the solver has found.

    Attributes:
        robot: The robot, with its feet held.
        iterations: How many there were until it converged.
        q: Configurations (NODES + 1, nq).
        u: Motor torques (NODES, nu), N·m.
        height: Height of the torso (NODES + 1,) above that of the start, m.
        ground: Upward force (NODES, 2) of the ground on each foot, N.
        opening: Largest opening of a loop or a contact, m or rad.
        load: Largest torque of a motor, in parts of its limit.
    """

    robot: eurdf.Robot
    iterations: int
    q: Array
    u: Array
    height: Array
    ground: Array
    opening: float
    load: float


def main() -> Squat:
    """Find the squat."""
    robot = eurdf.load("digit_2legs")
    robot = eurdf.lock(robot, [joint.name for joint in robot.mechanism.joints if any(joint.properties.stiffness)])
    robot = robot.with_contacts(dict.fromkeys(FEET, "6d"))
    q, still, torso = robot.configurations["assembled"], np.zeros(robot.model.nv), robot.model.getFrameId("torso")
    stand = pose(robot, q, torso)
    down = pin.SE3(stand.rotation, stand.translation - (0.0, 0.0, DEPTH))

    between, half, end = action(robot), action(robot, down), action(robot, stand, rest=True)
    actions = [between] * NODES
    actions[NODES // 2] = half
    start = np.concatenate((q, still))
    solver = crocoddyl.SolverFDDP(crocoddyl.ShootingProblem(start, actions, end))
    solver.th_stop = 1e-6
    holding = eurdf.inverse_dynamics(robot, q, still, still).u
    if not solver.solve([start] * (NODES + 1), [holding] * NODES, 20):
        raise ValueError(f"no squat found in {solver.iter} iterations")

    found, u = np.array(solver.xs)[:, : robot.model.nq], np.array(solver.us)
    forces = [each.differential.forces for each in solver.problem.runningDatas]
    return Squat(
        robot,
        solver.iter,
        found,
        u,
        np.array([pose(robot, each, torso).translation[2] for each in found]) - stand.translation[2],
        np.array([[of[foot][2] for foot in FEET] for of in forces]),
        float(np.abs(eurdf.batch.residual(robot, found)).max()),
        float((np.abs(u) / between.differential.u_ub).max()),
    )


def action(robot: eurdf.Robot, torso: pin.SE3 | None = None, rest: bool = False) -> Any:
    """A step of the motion; where the torso has to be at its start, if that is stated; or the end, at rest."""
    state = crocoddyl.StateMultibody(robot.model)
    nu = len(robot.actuation.idx_v)
    costs = crocoddyl.CostModelSum(state, nu)
    speeds = crocoddyl.ActivationModelWeightedQuad(np.repeat((0.0, 1.0), robot.model.nv))
    resting = crocoddyl.ResidualModelState(state, state.zero(), nu)
    costs.addCost("speed", crocoddyl.CostModelResidual(state, speeds, resting), REST if rest else SPEED)
    if not rest:
        torques = crocoddyl.ResidualModelControl(state, nu)
        costs.addCost("torque", crocoddyl.CostModelResidual(state, torques), TORQUE)
    if torso is not None:
        placement = ResidualModelFramePlacement(state, robot.model.getFrameId("torso"), torso, nu)
        weight = GOAL if rest else GOAL / STEP  # the costs of a step are multiplied by its length
        costs.addCost("torso", crocoddyl.CostModelResidual(state, placement), weight)
    dynamics = DifferentialActionModelLoopFwdDynamics(robot, costs, GAINS)
    return crocoddyl.IntegratedActionModelEuler(dynamics, 0.0 if rest else STEP)


def pose(robot: eurdf.Robot, q: Array, frame: int) -> pin.SE3:
    """The pose of a frame in the world."""
    pin.framesForwardKinematics(robot.model, robot.data, q)
    return robot.data.oMf[frame].copy()


if __name__ == "__main__":
    squat = main()
    print(f"{squat.iterations} iterations")
    for node in range(0, NODES, 5):
        left, right = squat.ground[node]
        print(f"{node * STEP:5.3f} s  torso {1e3 * squat.height[node]:4.0f} mm  ground {left:.0f} N and {right:.0f} N")
    print(f"{NODES * STEP:5.3f} s  torso {1e3 * squat.height[-1]:4.1f} mm")
    print(f"loops and contacts open by at most {squat.opening:.1e} m or rad")
    print(f"largest torque: {100.0 * squat.load:.0f} % of the limit of its motor")
