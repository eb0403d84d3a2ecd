"""Robots with numbers at the bounds of EU-FIL-005: every result is finite, or an error of eurdf."""

from __future__ import annotations

import math
import random
import re
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
import pytest
from lxml import etree

import eurdf
from support.places import DATA, ROBOTS

NUMBER = re.compile(r'(?<=["\s])-?\d+\.?\d*(e-?\d+)?(?=["\s])')
EXTREME = ("0", "5e-324", "1e-300", "1e-20", "1e10", "1e12", "-1e13", "1e14", "-1e15", "1e15", "-1")

#: Functions of a robot, q, v and an acceleration.
FUNCTIONS: dict[str, Callable[[Any, Any, Any], Any]] = {
    "forward": lambda robot, q, v: eurdf.forward_dynamics(robot, q, v),
    "damped": lambda robot, q, v: eurdf.forward_dynamics(robot, q, 0.0 * v, dissipation=True, gains=(100.0, 20.0)),
    "inverse": lambda robot, q, v: eurdf.inverse_dynamics(robot, q, 0.0 * v, 0.0 * v),
    "achievable": lambda robot, q, v: eurdf.kinematics.achievable_acceleration(robot, q, 0.0 * v, 0.0 * v),
    "mass matrix": lambda robot, q, v: eurdf.mass_matrix(robot, q),
    "velocity": lambda robot, q, v: eurdf.project_velocity(robot, q, v),
    "acceleration": lambda robot, q, v: eurdf.project_acceleration(robot, q, v, v),
    "derivative": lambda robot, q, v: eurdf.kinematics.dq_dq_actuated(robot, q),
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


BOUNDS = (1e15, 1e14, 1.0, 3e-15, 1e-15)


def at_bounds(chance: random.Random, text: str) -> str:
    """Each number with the size of a bound or of one of the usual, and its sign."""
    return " ".join(f"{math.copysign(chance.choice(BOUNDS), float(word))!r}" for word in text.split())


def bounded_robots(stem: str, seed: int, count: int) -> Iterator[eurdf.Robot]:
    """A robot with every joint type, and half of the numbers of both files at the bounds of EU-FIL-005."""
    chance = random.Random(seed)
    description = (DATA / f"{stem}.yaml").read_text(encoding="utf-8").partition("configurations:")[0]
    description = description.replace("stage: {limits: {velocity: 1.5}", "stage: {type: helical, pitch: 0.005")
    for _ in range(count):
        urdf = etree.parse(DATA / "workbench.urdf")
        numbers = [(moment, name) for moment in urdf.iter("inertia") for name in moment.keys()]  # noqa: SIM118
        numbers += [(mass, "value") for mass in urdf.iter("mass") if float(mass.get("value")) > 1e-5]
        for joint in urdf.iter("joint"):
            if "wrist" not in joint.get("name"):  # those to merge, whose axes meet
                for child in joint.iter("origin", "dynamics", "mimic"):
                    numbers += [(child, name) for name in child.keys() if name not in ("joint", "rpy")]  # noqa: SIM118
        for element, name in numbers:
            if chance.random() < 0.5:
                element.set(name, at_bounds(chance, element.get(name)))
        yaml = re.sub(
            r"(?<=: )(?<!length: )-?[0-9][-0-9.e]*(?=[,}])",
            lambda found: at_bounds(chance, found[0]) if chance.random() < 0.5 else found[0],
            description,
        )
        yield eurdf.load(yaml, urdf=etree.tostring(urdf, encoding="unicode"), geometry=False)


@pytest.mark.parametrize("stem", ["workbench", "workbench.2.1"])
def test_robot_with_numbers_at_the_bounds_has_finite_quantities(stem: str) -> None:
    for robot in bounded_robots(stem, seed=5, count=20):
        end = np.ones(robot.model.nq)
        for q in (pin.neutral(robot.model), pin.randomConfiguration(robot.model, -end, end)):
            pin.framesForwardKinematics(robot.model, robot.data, q)
            assert all(np.isfinite(pose.homogeneous).all() for pose in robot.data.oMf)
            assert np.isfinite(eurdf.mass_matrix(robot, q)).all()
            assert all(np.isfinite(part).all() for part in eurdf.residual_and_jacobian(robot, q))


@pytest.mark.parametrize("size", [1e155, 1e200, 1e308])
def test_overflow_of_given_velocity_is_named(size: float) -> None:
    robot = eurdf.load("four_bar", geometry=False)
    q = robot.configurations["assembled"]
    with pytest.raises(eurdf.errors.NumericalOverflow, match="would not be finite"):
        eurdf.forward_dynamics(robot, q, np.full(robot.model.nv, size))


def test_mobility_of_a_joint_that_follows_1e15_times_prints_nothing(tmp_path: Path) -> None:
    """Warnings are errors in these tests: paths along which numbers overflow gave one."""
    urdf = etree.parse(ROBOTS / "digit_leg" / "robot.urdf")
    (joint,) = urdf.xpath("//joint[@name='free_foot2']")
    joint.set("type", "prismatic")
    etree.SubElement(joint, "mimic", joint="motor_hip_z", multiplier="1e15")
    urdf.write(tmp_path / "robot.urdf")
    (tmp_path / "robot.yaml").write_bytes((ROBOTS / "digit_leg" / "robot.yaml").read_bytes())
    assert eurdf.analyze(eurdf.load(tmp_path)).closes


@pytest.mark.parametrize("size", [1e155, -1e155, 1e308])
def test_coordinates_that_overflow_are_an_error(size: float) -> None:
    robot = eurdf.load("digit_leg", geometry=False)
    q = np.tile(robot.configurations["assembled"], (3, 1))
    q[1, robot.model.joints[robot.model.getJointId("ball_rod1_start")].idx_q + 2] = size
    for function in (eurdf.residual, eurdf.residual_and_jacobian, eurdf.kinematics.closure_openings):
        with pytest.raises(eurdf.errors.NumericalOverflow):
            function(robot, q[1])
    for of_many in (eurdf.batch.residual, eurdf.batch.residual_and_jacobian):
        with pytest.raises(eurdf.errors.NumericalOverflow, match=r"q\[1\]"):
            of_many(robot, q)
