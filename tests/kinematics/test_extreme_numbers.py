"""Robots with numbers at the ends of the range of doubles: every result is finite, or an error of eurdf."""

from __future__ import annotations

import random
import re
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from lxml import etree

import eurdf

ROBOTS = Path(__file__).parents[2] / "robots"
NUMBER = re.compile(r'(?<=["\s])-?\d+\.?\d*(e-?\d+)?(?=["\s])')
EXTREME = ("0", "5e-324", "1e-300", "1e-20", "1e10", "1e100", "1e155", "1e200", "1e300", "1e308", "-1")

#: Functions of a robot, q, v and an acceleration.
FUNCTIONS: dict[str, Callable[[Any, Any, Any], Any]] = {
    "forward": lambda robot, q, v: eurdf.forward_dynamics(robot, q, v),
    "damped": lambda robot, q, v: eurdf.forward_dynamics(robot, q, 0.0 * v, dissipation=True, gains=(100.0, 20.0)),
    "inverse": lambda robot, q, v: eurdf.inverse_dynamics(robot, q, 0.0 * v, 0.0 * v),
    "achievable": lambda robot, q, v: eurdf.achievable_acceleration(robot, q, 0.0 * v, 0.0 * v),
    "mass matrix": lambda robot, q, v: eurdf.mass_matrix(robot, q),
    "velocity": lambda robot, q, v: eurdf.project_velocity(robot, q, v),
    "acceleration": lambda robot, q, v: eurdf.project_acceleration(robot, q, v, v),
    "derivative": lambda robot, q, v: eurdf.dq_dq_actuated(robot, q),
    "step": lambda robot, q, v: eurdf.simulate(robot, q, v, duration=0.002),
}


def extreme_robots(name: str, seed: int, count: int) -> Iterator[eurdf.Robot]:
    """A robot of the collection with up to three numbers of its URDF replaced."""
    chosen = random.Random(seed)
    yaml = (ROBOTS / name / "robot.yaml").read_text(encoding="utf-8")
    yaml = re.sub(r"^configurations:.*?(?=^\S|\Z)", "", yaml, flags=re.DOTALL | re.MULTILINE)
    for _ in range(count):
        urdf = (ROBOTS / name / "robot.urdf").read_text(encoding="utf-8")
        for _ in range(chosen.randint(1, 3)):
            found = chosen.choice(list(NUMBER.finditer(urdf)))
            urdf = urdf[: found.start()] + chosen.choice(EXTREME) + urdf[found.end() :]
        try:
            yield eurdf.load(yaml, urdf=urdf, geometry=False)
        except eurdf.InvalidRobot:
            continue


def numbers(result: Any) -> Iterator[Any]:
    for part in result if isinstance(result, tuple) else (result,):
        yield from numbers(part) if isinstance(part, tuple) else (part,)


@pytest.mark.parametrize("name", ["four_bar", "five_bar", "slider_crank", "delta"])
def test_result_of_extreme_robot_is_finite_or_an_error(name: str) -> None:
    loaded = 0
    for robot in extreme_robots(name, seed=3, count=12):
        loaded += 1
        q = eurdf.assemble(robot, restarts=0).q
        v = np.random.default_rng(loaded).standard_normal(robot.model.nv)
        for what, function in FUNCTIONS.items():
            try:
                result = function(robot, q, v)
            except eurdf.EurdfError:
                continue
            assert all(np.isfinite(part).all() for part in numbers(result)), (name, loaded, what)
    assert loaded > 3


@pytest.mark.parametrize("size", [1e155, 1e200, 1e308])
def test_overflow_of_given_velocity_is_named(size: float) -> None:
    robot = eurdf.load("four_bar", geometry=False)
    q = robot.configurations["assembled"]
    with pytest.raises(eurdf.NumericalOverflow, match="would not be finite"):
        eurdf.forward_dynamics(robot, q, np.full(robot.model.nv, size))


def test_mobility_of_a_joint_that_follows_1e200_times_prints_nothing(tmp_path: Path) -> None:
    """Warnings are errors in these tests: paths along which numbers overflow gave one."""
    urdf = etree.parse(ROBOTS / "digit_leg" / "robot.urdf")
    (joint,) = urdf.xpath("//joint[@name='free_foot2']")
    joint.set("type", "prismatic")
    etree.SubElement(joint, "mimic", joint="motor_hip_z", multiplier="1e200")
    urdf.write(tmp_path / "robot.urdf")
    (tmp_path / "robot.yaml").write_bytes((ROBOTS / "digit_leg" / "robot.yaml").read_bytes())
    assert eurdf.analyze(eurdf.load(tmp_path)).closes


@pytest.mark.parametrize("function", [eurdf.residual, eurdf.residual_and_jacobian, eurdf.closure_openings])
@pytest.mark.parametrize("size", [1e155, -1e155, 1e308])
def test_residual_at_coordinates_that_overflow_is_an_error(function: Callable[..., Any], size: float) -> None:
    robot = eurdf.load("digit_leg", geometry=False)
    q = np.array(robot.configurations["assembled"])
    q[robot.model.joints[robot.model.getJointId("ball_rod1_start")].idx_q + 2] = size
    with pytest.raises(eurdf.NumericalOverflow):
        function(robot, q)


@pytest.mark.parametrize("function", [eurdf.batch.residual, eurdf.batch.residual_and_jacobian])
@pytest.mark.parametrize("size", [1e155, -1e155, 1e308])
def test_overflow_in_a_batch_names_the_configuration(function: Callable[..., Any], size: float) -> None:
    robot = eurdf.load("digit_leg", geometry=False)
    q = np.tile(robot.configurations["assembled"], (3, 1))
    q[1, robot.model.joints[robot.model.getJointId("ball_rod1_start")].idx_q + 2] = size
    with pytest.raises(eurdf.NumericalOverflow, match=r"q\[1\]"):
        function(robot, q)
