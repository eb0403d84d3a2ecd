"""What plays in the viewer: a range of motion, a trajectory, gravity."""

from __future__ import annotations

import time
from itertools import islice

import numpy as np
import pytest

import eurdf
from eurdf.viewing.playback import (
    Trajectory,
    gravity_frames,
    read_trajectory,
    steps_with_room,
    sweep_frames,
    trajectory_frames,
)
from eurdf.viewing.session import Session


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


def fall(session: Session, shown: int, **options: bool) -> None:
    """Let a robot fall for a number of frames that are shown."""
    said: list[str] = []
    frames = gravity_frames(session, said.append, **{"dissipation": False, **options})
    while len(said) < shown:
        assert 0.0 <= next(frames) <= 1.0 / 30.0
    frames.close()


def test_gravity_moves_as_a_simulation_and_stops_where_the_user_moves() -> None:
    robot = eurdf.load("four_bar")
    session = Session(robot)
    said: list[str] = []
    frames = gravity_frames(session, said.append, dissipation=False)
    while len(said) < 8:
        next(frames)
    expected = eurdf.simulate(robot, session.first, duration=0.3, step=1.0 / 900.0)
    assert np.abs(expected.q - session.q).max(axis=1).min() < 1e-6
    assert np.abs(session.q - session.first).max() > 1e-3
    session.reset()  # the user's hand takes its velocity
    while len(said) < 9:
        next(frames)
    assert np.abs(expected.q[1:31] - session.q).max(axis=1).min() < 1e-6


def test_fast_motion_under_gravity_keeps_loops_closed() -> None:
    session = Session(eurdf.load("kangaroo_leg", geometry=False))
    said: list[str] = []
    for seconds in gravity_frames(session, said.append, dissipation=True):
        time.sleep(seconds)
        assert session.residual < 1e-4
        if said and float(said[-1].split()[1]) > 0.3:  # where steps of 1.1 ms diverge
            break


def test_frame_gets_as_many_steps_as_its_time_has_room_for() -> None:
    """With a clock of which each step takes a given time."""
    for seconds, steps in ((1e-5, 30), (2e-3, 12), (0.011, 2), (3.0, 1)):
        count = 1
        for _ in range(20):
            assert count * seconds <= 0.025 or count == 1
            count = steps_with_room(count, count * seconds)
        assert count == steps
        assert steps_with_room(count, 3.0) == 1  # another program took the processor


def test_floating_robot_keeps_its_base_until_it_is_released() -> None:
    """Upside down, what hangs from the base falls as with a fixed base and gravity upwards."""
    floating, fixed = eurdf.load("digit_leg", root="floating"), eurdf.load("digit_leg", root="fixed")
    fixed.model.gravity.linear = -fixed.model.gravity.linear
    session = Session(floating)
    turned = np.array((0.5, -1.0, 2.0, 1.0, 0.0, 0.0, 0.0))  # half a turn about x
    session.show(np.concatenate((turned, session.q[7:])))
    begin = session.q
    fall(session, 5, held=True)
    assert (session.q[:7] == turned).all()
    expected = eurdf.simulate(fixed, begin[7:], duration=0.1, step=1.0 / 900.0)
    assert np.abs(expected.q - session.q[7:]).max(axis=1).min() < 1e-6
    assert np.abs(session.q - begin).max() > 1e-5
    session.show(begin)
    fall(session, 5, held=False)
    assert session.q[2] < begin[2]
