"""Advice on limits: loops that close only where joints are beyond their limits."""

from __future__ import annotations

import numpy as np

from eurdf.array import Vector
from eurdf.diagnostics import Diagnostics
from eurdf.kinematics.assembly import assemble
from eurdf.kinematics.loop import joints_of_loops
from eurdf.kinematics.position_limit import position_limits
from eurdf.linking.configurations import BeyondLimit, beyond_limits
from eurdf.linking.robot_files import ReadRobot
from eurdf.pinocchio.robot import Robot

# Joints that a hint lists.
_JOINTS_LISTED = 4


def advise_on_limits(read: ReadRobot, robot: Robot, q: Vector, diagnostics: Diagnostics) -> None:
    """Report loops for which no closed configuration was found within the limits of their joints.

    It costs nothing where the closed configuration is within them. Where it is not, configurations within are searched
    for from the start of `assemble`, from q, and from the middle of each range.
    """
    beyond = _beyond(robot, q)
    if not beyond:
        return
    tried = []
    for q0 in (None, q, _middle(robot, q)):
        tried.append(assemble(robot, q0, limits=True))
        if tried[-1].closes or tried[-1].reason == "not decided":
            return
    within = min(tried, key=lambda found: found.residual)
    near = assemble(robot, within.q)
    if near.closes:
        beyond = min(beyond, _beyond(robot, near.q), key=lambda found: max(map(_excess, found), default=0.0))
    if not beyond:  # the search without limits ended within them
        return
    widest = max(within.open, key=lambda opening: opening.width)
    listed = ", ".join(map(_said, beyond[:_JOINTS_LISTED])) + (", ..." if len(beyond) > _JOINTS_LISTED else "")
    diagnostics.report(
        "x-closes-beyond-limits",
        f"no configuration was found that closes the loops within the limits of their joints; least open: {widest}",
        read.place_of_constraint(widest.name),
        f"they close with {listed}: correct these limits, or the frames of the closure",
    )


def _beyond(robot: Robot, q: Vector) -> list[BeyondLimit]:
    """The coordinates of joints of the loops that are beyond their limits."""
    names, first = robot.tree.velocity_names, robot.tree.own_velocities
    in_loops = {names[first[joint].start] for joint in joints_of_loops(robot)}
    beyond = beyond_limits(robot.mechanism.joints, robot.joint_positions(q))
    return [found for found in beyond if found.joint in in_loops]


def _middle(robot: Robot, q: Vector) -> Vector:
    """The configuration with each coordinate that has a range in the middle of it."""
    limits = position_limits(robot)
    ranged = np.isfinite(limits.lower) & np.isfinite(limits.upper)
    middle = np.array(q)
    middle[limits.coordinates[ranged]] = 0.5 * limits.lower[ranged] + 0.5 * limits.upper[ranged]
    return middle


def _excess(found: BeyondLimit) -> float:
    return max(found.lower - found.value, found.value - found.upper)


def _said(found: BeyondLimit) -> str:
    side = f"below its lower limit {found.lower:.4g}" if found.value < found.lower else ""
    side = side or f"above its upper limit {found.upper:.4g}"
    return f"'{found.joint}' {_excess(found):.3g} {found.unit} {side}"
