"""Linkages as robots that have motors, and the robots that the toolbox is tried on."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

import eurdf
from eurdf.kinematics.assembly import assemble
from eurdf.kinematics.position_limit import position_limits
from eurdf.mechanism.constraint import Closure
from eurdf.mechanism.mechanism import Mechanism
from eurdf.pinocchio.robot import Robot
from support.linkage import Linkage
from support.wild import FACTS, WILD

#: Names of the robots of the collection, and of the published ones that close and that nobody here wrote.
ROBOTS = ["digit_leg", "four_bar", *(f"wild/{name}" for name, facts in FACTS.items() if facts["closes"])]

_LOADED: dict[str, Robot] = {}


def robot_called(name: str) -> Robot:
    if name.startswith("wild/") and not FACTS:
        pytest.skip("no published robots: put their folder at ../shared/wild, beside the checkout")
    if name not in _LOADED:
        place = WILD / name.removeprefix("wild/") if name.startswith("wild/") else name
        _LOADED[name] = eurdf.load(place, geometry=False)
    return _LOADED[name]


def actuated(linkage: Linkage, joints: Sequence[str] | None = None) -> Robot:
    """The linkage as a robot, the joints given actuated in that order."""
    names = tuple(linkage.actuated if joints is None else joints)
    actuation = Linkage(linkage.model, actuated=names).actuation
    closures = tuple(found for found in linkage.constraints if isinstance(found, Closure))
    mechanism = Mechanism("linkage", "", "fixed", (), (), closures=closures)  # without bodies and joints
    robot = Robot(mechanism, linkage.model)
    # In place of what it would make of its mechanism.
    vars(robot).update(tree=linkage.tree, actuation=actuation, configurations=linkage.configurations)
    return robot


def closed_near(robot: Any, random: np.random.Generator, spread: float = 0.3, limits: bool = False) -> Any:
    """A random closed configuration, within the limits if that is asked."""
    q0 = assemble(robot, limits=limits).q
    for _ in range(100):
        away = pin.integrate(robot.model, q0, random.uniform(-spread, spread, robot.model.nv))
        if limits:  # also of joints that are in no loop
            away = position_limits(robot).clip(away)
        assembly = assemble(robot, away, restarts=0, limits=limits)
        if assembly.closes:
            return assembly.q
    raise AssertionError("the robot does not close anywhere near")
