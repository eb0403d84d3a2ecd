"""What plays in the viewer: a range of motion, a trajectory, gravity."""

from __future__ import annotations

from itertools import islice

import numpy as np
import pytest

import eurdf
from eurdf.viewing.playback import gravity_frames, sweep_frames, trajectory_frames
from eurdf.viewing.session import Session
from eurdf.viewing.trajectory import Trajectory, read_trajectory


def silent(message: str) -> None:
    """Shows nothing."""


def test_sweep_moves_the_actuator_with_loops_closed_and_repeats() -> None:
    session = Session(eurdf.load("unitree_g1_ankle"))
    said: list[str] = []
    frames = sweep_frames(session, 0, said.append)
    values = []
    for seconds in islice(frames, 300):
        assert 0.0 < seconds < 0.1
        values.append(session.value(0))
        assert session.residual < 1e-9
    assert min(values) < -0.3 < 0.1 < max(values)
    assert "passive limit of 'free_roll'" in said[0]


def test_trajectory_brings_joints_where_the_file_says() -> None:
    robot = eurdf.load("four_bar")
    trajectory = read_trajectory("time,motor_crank\n0,0.0\n0.5, 0.2\n\n0.75,0.3\n", robot)
    assert trajectory.times == (0.0, 0.5, 0.75)
    session = Session(robot)
    frames = trajectory_frames(session, trajectory, silent)
    for value, seconds in zip((0.0, 0.2, 0.3), (0.5, 0.25, 0.0), strict=True):
        assert 0.0 <= next(frames) <= seconds
        assert session.value(0) == pytest.approx(value, abs=1e-12)
        assert session.residual < 1e-9
    with pytest.raises(StopIteration):
        next(frames)


def test_trajectory_out_of_reach_says_when() -> None:
    robot = eurdf.load("slider_crank")
    slider = next(joint.name for joint in robot.mechanism.joints if joint.type == "prismatic")
    frames = trajectory_frames(Session(robot), Trajectory((0.0, 1.5), ({}, {slider: (10.0,)})), silent)
    next(frames)
    with pytest.raises(ValueError, match=r"the trajectory stops at time 1\.5 s: "):
        next(frames)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "line 1: there is no column 'time'"),
        ("motor_crank\n1\n", "line 1: there is no column 'time'"),
        ("time,motor_crnak\n0,1\n", "line 1: there is no joint 'motor_crnak'; did you mean 'motor_crank'?"),
        ("time,time\n0,1\n", "line 1: column 'time' occurs 2 times"),
        ("time,motor_crank\n", "the trajectory has no line of values"),
        ("time,motor_crank\n0,1\n1\n", "line 3: 1 values, but the first line names 2 columns"),
        ("time,motor_crank\n0,fast\n", "line 2: 'fast' in column 'motor_crank' is not a finite number"),
        ("time,motor_crank\n0,nan\n", "line 2: 'nan' in column 'motor_crank' is not a finite number"),
        ("time,motor_crank\n0,1\n0,1\n", "line 3: time 0 does not follow 0; times must ascend"),
    ],
)
def test_wrong_trajectory_is_refused_with_its_line(text: str, message: str) -> None:
    with pytest.raises(ValueError) as refused:
        read_trajectory(text, eurdf.load("four_bar"))
    assert str(refused.value).startswith(message)


def test_joint_with_several_coordinates_has_a_column_for_each() -> None:
    robot = eurdf.load("digit_leg")
    ball = next(joint.name for joint in robot.mechanism.joints if joint.type == "spherical")
    columns = ",".join(f"{ball}:{number}" for number in range(1, 5))
    trajectory = read_trajectory(f"time,{columns}\n0,0,0,0,1\n", robot)
    assert trajectory.coordinates == ({ball: (0.0, 0.0, 0.0, 1.0)},)
    with pytest.raises(ValueError, match=f"add column '{ball}:4'"):
        read_trajectory(f"time,{columns.rpartition(',')[0]}\n0,0,0,0\n", robot)


def test_gravity_moves_as_a_simulation_and_stops_where_the_user_moves() -> None:
    robot = eurdf.load("four_bar")
    session = Session(robot)
    frames = gravity_frames(session, silent, dissipation=False)
    for _ in range(6):
        next(frames)
    expected = eurdf.simulate(robot, session.first, duration=0.2, step=1.0 / 900.0)
    assert session.q == pytest.approx(expected.q[-1], abs=1e-6)
    assert np.abs(session.q - session.first).max() > 1e-3
    session.reset()  # the user's hand takes its velocity
    next(frames)
    assert session.q == pytest.approx(eurdf.simulate(robot, session.first, duration=1 / 30, step=1 / 900).q[-1])
