"""Time per loop of `assemble`, `analyze` and `forward_kinematics` on chains of 10, 100 and 1,000 four-bars.

Each four-bar stands on the rocker of the one before, or all stand side by side on the ground. Building the robot, whose
Pinocchio model takes memory quadratic in nv, is not measured. Forward kinematics moves each crank by 0.05 rad and is
called twice: the first call prepares the loops. A `pin.Data` of the whole model, which plain Newton would need, takes
64 nv³ bytes. Times are of the processor; memory is what the process grew by.
"""

from __future__ import annotations

from functools import partial

import numpy as np
import pinocchio as pin

import eurdf
from benchmarks.interleaved import peak_memory, timed
from eurdf.closures.point import PointClosure
from eurdf.mechanism.body import Anchor, Body
from eurdf.mechanism.joint import Joint
from eurdf.mechanism.joint_types import JointType
from eurdf.mechanism.mechanism import Mechanism
from eurdf.mechanism.pose import Pose
from eurdf.pinocchio.robot import build_robot

SIZES = (10, 100, 1000)


def four_bars(count: int, in_series: bool) -> eurdf.Robot:
    """Four-bars of bars 1.0, 1.5, 1.2 and 1.6 m, closed in 3d where the rocker meets the ground; cranks actuated."""
    bodies, joints, closures = [Body("ground")], [], []
    foot, place = "ground", (0.0, 0.0, 0.0)
    for index in range(count):
        parent, at = foot, place
        for name, offset in (("crank", at), ("coupler", (1.0, 0.0, 0.0)), ("rocker", (1.5, 0.0, 0.0))):
            child = f"{name}{index}"
            pose = Pose.from_xyz_rpy(offset, (0.0, 0.0, 0.0))
            joints.append(Joint(f"{child}_pin", JointType.REVOLUTE, parent, child, pose, axes=((0.0, 0.0, 1.0),)))
            bodies.append(Body(child))
            parent = child
        ground_pin = Pose.from_xyz_rpy((at[0] + 1.6, at[1], at[2]), (0.0, 0.0, 0.0))
        rocker_pin = Pose.from_xyz_rpy((1.2, 0.0, 0.0), (0.0, 0.0, 0.0))
        closures.append(PointClosure(f"loop{index}", Anchor(foot, ground_pin), Anchor(parent, rocker_pin)))
        if in_series:
            foot, place = parent, (0.0, 0.0, 0.1)
        else:
            place = (0.0, 0.0, 0.1 * (index + 1))
    actuators = tuple(f"crank{index}_pin" for index in range(count))
    mechanism = Mechanism(
        "four_bars",
        "",
        "fixed",
        tuple(bodies),
        tuple(joints),
        closures=tuple(closures),
        actuators=actuators,
    )
    return build_robot(mechanism, geometry=False)


def main() -> None:
    """Print a table, in ms a loop."""
    head = f"{'loops':>6} {'':12} {'assemble':>9} {'evaluations':>12} {'analyze':>9} {'FK first':>9} {'FK':>6}"
    print(f"{head} {'memory of FK':>14} {'pin.Data':>12}   (ms a loop)")
    for in_series in (False, True):
        for count in SIZES:
            robot = four_bars(count, in_series)
            q = np.tile([0.9, -0.7, 1.9], count) + np.random.default_rng(0).uniform(-0.3, 0.3, robot.model.nv)
            assembling, assembly = timed(partial(eurdf.assemble, robot, q))
            assert assembly.converged
            assert pin.isNormalized(robot.model, assembly.q)
            before = peak_memory()
            move = partial(eurdf.forward_kinematics, robot, assembly.q[robot.actuation.idx_q] + 0.05, assembly.q)
            (preparing, there), (moving, _) = timed(move), timed(move)
            grown = peak_memory() - before
            assert np.abs(eurdf.residual(robot, there)).max() <= 1e-10
            analyzing, analysis = timed(partial(eurdf.analyze, robot, assembly.q))
            assert (analysis.mobility, analysis.redundant, analysis.uncontrolled) == (count, count, 0)
            kind = "in series" if in_series else "side by side"
            each = [seconds / count * 1e3 for seconds in (assembling, analyzing, preparing, moving)]
            print(
                f"{count:6} {kind:12} {each[0]:9.2f} {assembly.iterations:12} {each[1]:9.2f} {each[2]:9.2f} "
                f"{each[3]:6.2f} {grown:11.0f} MB {64e-6 * robot.model.nv**3:9.0f} MB"
            )
