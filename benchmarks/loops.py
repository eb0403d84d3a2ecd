"""Time per loop of `eurdf.assemble` and `eurdf.analyze` on chains of 10, 100 and 1,000 independent four-bars.

Each four-bar stands on the rocker of the one before, or all stand side by side on the ground. Building the robot, whose
Pinocchio model takes memory quadratic in nv, is not measured. Times are of the processor.
"""

from __future__ import annotations

import numpy as np
import pinocchio as pin

import eurdf
from benchmarks.assembly import timed
from eurdf.mechanism.body import Body
from eurdf.mechanism.constraint import PointClosure
from eurdf.mechanism.frame import Anchor
from eurdf.mechanism.joint import Joint
from eurdf.mechanism.joint_type import JointType
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
    print(f"{'loops':>6} {'':12} {'assemble':>9} {'evaluations':>12} {'analyze':>9}   (ms a loop)")
    for in_series in (False, True):
        for count in SIZES:
            robot = four_bars(count, in_series)
            q = np.tile([0.9, -0.7, 1.9], count) + np.random.default_rng(0).uniform(-0.3, 0.3, robot.model.nv)
            assembling, assembly = timed(lambda r=robot, q=q: eurdf.assemble(r, q))  # type: ignore[misc]
            analyzing, analysis = timed(lambda r=robot, q=assembly.q: eurdf.analyze(r, q))  # type: ignore[misc]
            assert assembly.converged
            assert (analysis.mobility, analysis.redundant, analysis.uncontrolled) == (count, count, 0)
            assert pin.isNormalized(robot.model, assembly.q)
            kind = "in series" if in_series else "side by side"
            each = (assembling / count * 1e3, analyzing / count * 1e3)
            print(f"{count:6} {kind:12} {each[0]:9.2f} {assembly.iterations:12} {each[1]:9.2f}")
