"""Newton's steps to targets that are near, for one configuration and for many."""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin
import pytest

import eurdf
from benchmarks.robots import robot_called
from eurdf.kinematics.frame_targets import Target
from eurdf.kinematics.inverse_newton import InverseNewton
from eurdf.kinematics.problem import Problem, for_many
from eurdf.pinocchio.robot import Robot

TOLERANCE = 1e-8


def frame_of(robot: Robot) -> str:
    return robot.mechanism.bodies[-1].name


def poses(robot: Robot, frame: str, configurations: Any) -> Target:
    """Where a frame is at closed configurations."""
    data, index = robot.model.createData(), robot.model.getFrameId(frame, pin.FrameType.BODY)
    found = []
    for q in configurations:
        pin.framesForwardKinematics(robot.model, data, q)
        found.append(pin.SE3(data.oMf[index]))
    return Target(np.array([each.translation for each in found]), np.array([each.rotation for each in found]))


def closed_around(robot: Robot, q: Any, spread: float, count: int) -> Any:
    random = np.random.default_rng(0)
    moves = spread * random.uniform(-1.0, 1.0, (count, robot.model.nv))
    return np.array([eurdf.assemble(robot, pin.integrate(robot.model, q, v)).q for v in moves])


@pytest.mark.parametrize("is_pose", [True, False])
@pytest.mark.parametrize(
    "name", ["digit_2legs", "doggo_leg", "five_bar", "kangaroo_leg", "stewart_platform", "tello", "30 four-bars"]
)
def test_one_and_many_reach_near_targets_alike(name: str, is_pose: bool) -> None:
    robot = robot_called(name)
    q, frame = eurdf.assemble(robot).q, frame_of(robot)
    goal = poses(robot, frame, closed_around(robot, q, 1.0 / max(50, 20 * robot.model.nv), 3))
    goal = goal if is_pose else Target(goal.position)
    newton, problem = InverseNewton(robot, (is_pose,), frame, few=False), for_many(robot)
    many = newton.near(problem, [goal], np.tile(q, (3, 1)), None, TOLERANCE)
    assert many.reached.all()
    for element, found in enumerate(many.q):
        assert np.abs(eurdf.residual(robot, found)).max() < 1e-10
        at = poses(robot, frame, [found])
        assert np.linalg.norm(at.position[0] - goal.position[element]) < TOLERANCE
        if goal.rotation is not None and at.rotation is not None:
            assert np.linalg.norm(pin.log3(goal.rotation[element].T @ at.rotation[0])) < TOLERANCE
        own = goal.among(np.array([element]))
        one = InverseNewton(robot, (is_pose,), frame).near(Problem(robot), [own], q[None], None, TOLERANCE)
        assert one.reached[0]
        np.testing.assert_allclose(one.q[0], found, atol=1e-9)
        assert (one.position[0, 0], one.angle[0, 0]) == pytest.approx(
            (many.position[element, 0], many.angle[element, 0])
        )


def test_only_loops_that_carry_the_frame_move() -> None:
    robot = eurdf.load("digit_2legs", geometry=False)
    q, frame = eurdf.assemble(robot).q, "left_rod2_end"
    goal = poses(robot, frame, closed_around(robot, q, 0.02, 1))
    found = InverseNewton(robot, (True,), frame).near(Problem(robot), [goal], q[None], None, TOLERANCE)
    assert found.reached[0]
    moved = np.flatnonzero(robot.tree.difference(q, found.q[0]))
    assert not any("right" in robot.tree.velocity_names[index] for index in moved)


@pytest.mark.parametrize("few", [True, False])
def test_doubtful_targets_are_left_to_the_search(few: bool) -> None:
    robot = eurdf.load("four_bar", geometry=False)
    q, frame = eurdf.assemble(robot).q, "coupler"
    newton = InverseNewton(robot, (True,), frame, few=few)
    problem = Problem(robot) if few else for_many(robot)

    def reached(start: Any, target: Any, limits: Any = None) -> bool:
        return bool(newton.near(problem, [poses(robot, frame, [target])], start[None], limits, TOLERANCE).reached[0])

    near, far = (eurdf.forward_kinematics(robot, [np.cos(angle), np.sin(angle)], q) for angle in (0.05, 1.5))
    assert reached(q, near)
    assert not reached(q, far)
    assert not reached(q, q)  # a solution is left as it is
    assert not reached(pin.integrate(robot.model, q, np.full(robot.model.nv, 1e-3)), near)  # open at the start


def test_doubtful_way_is_gone_in_two_halves() -> None:
    robot, frame = eurdf.load("cassie_leg", geometry=False), "plantar_end"
    q = eurdf.assemble(robot).q
    motors = q[robot.actuation.idx_q]
    ends = [eurdf.forward_kinematics(robot, motors + move, q) for move in np.linspace(0.0, 0.06, 9)[1:]]
    newton, problem = InverseNewton(robot, (True,), frame), Problem(robot)

    def near(start: Any, end: Any) -> Any:
        return newton.near(problem, [poses(robot, frame, [end])], start[None], None, TOLERANCE)

    whole, small = near(q, ends[-1]), q
    assert whole.reached[0]
    for end in ends:  # small ways are gone at once
        found = near(small, end)
        assert found.reached[0]
        assert found.iterations[0] < 5 <= whole.iterations[0]
        small = found.q[0]
    np.testing.assert_allclose(whole.q[0], small, atol=1e-2)
    assert np.abs(eurdf.residual(robot, whole.q[0])).max() < 1e-10
    assert np.abs(whole.q[0] - q).max() > 0.05  # the ways differ by much less than they are long
