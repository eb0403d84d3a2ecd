"""Configurations of a drawing in which some joints have other coordinates than drawn."""

from __future__ import annotations

from collections.abc import Mapping

import eurdf
from eurdf.pinocchio.robot import build_robot
from robots.builder.drawing import Drawing
from robots.builder.mechanism import mechanism_of

#: Steps from the drawn pose: small, so that all loops stay on the branch of the drawing.
_STEPS = 20


def assembled_at(drawing: Drawing, held: Mapping[str, float]) -> dict[str, float | tuple[float, ...]]:
    """Coordinates of all joints (rad, m, seen from the drawn pose) where some are held and every loop is closed."""
    robot = build_robot(mechanism_of(drawing), geometry=False)
    q = robot.configuration({})
    for step in range(1, _STEPS + 1):
        part: dict[str, tuple[float, ...]] = {name: (value * step / _STEPS,) for name, value in held.items()}
        q = eurdf.assemble(robot, robot.configuration(robot.joint_positions(q) | part), hold=tuple(held)).q
    return {name: found if len(found) > 1 else found[0] for name, found in robot.joint_positions(q).items()}
