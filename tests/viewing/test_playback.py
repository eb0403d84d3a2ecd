"""What plays in the viewer: a trajectory, gravity."""

from __future__ import annotations

import time

import numpy as np
import pytest

import eurdf
from eurdf.viewing.playback import (
    FRAME,
    GravityPlayback,
    Trajectory,
    TrajectoryPlayback,
    read_trajectory,
    steps_with_room,
)


class Shown:
    """A robot that is shown nowhere."""

    def __init__(self, robot: eurdf.Robot) -> None:
        self.robot = robot
        self.q = self.first = eurdf.assemble(robot).q

    def go_to(self, q: np.ndarray) -> None:
        self.q = np.array(q)

    @property
    def residual(self) -> float:
        return float(np.abs(eurdf.residual(self.robot, self.q)).max(initial=0.0))


def test_trajectory_brings_joints_where_the_file_says() -> None:
    robot = eurdf.load("four_bar")
    trajectory = read_trajectory("time,motor_crank\n0,0.0\n0.5, 0.2\n\n0.75,0.3\n", robot)
    assert trajectory.times == (0.0, 0.5, 0.75)
    shown = Shown(robot)
    playback = TrajectoryPlayback(shown, trajectory)
    values = {0.0: 0.0}
    for seconds in playback.frames():
        assert 0.0 <= seconds <= FRAME
        if seconds:  # a frame, not a row that is computed
            values[playback.time] = robot.joint_positions(shown.q)["motor_crank"][0]
        assert shown.residual < 1e-9
    values[playback.time] = robot.joint_positions(shown.q)["motor_crank"][0]
    times = sorted(values)
    assert np.diff(times) == pytest.approx(FRAME, abs=FRAME / 2.0)
    for time_, value in values.items():  # each row from its time on
        assert value == pytest.approx(0.3 if time_ >= 0.75 else 0.2 if time_ >= 0.5 - 1e-9 else 0.0, abs=1e-12)
    playback.time = 0.6
    assert all(seconds == 0.0 for seconds in playback.at_time())
    assert robot.joint_positions(shown.q)["motor_crank"] == pytest.approx((0.2,))


def test_trajectory_out_of_reach_says_when() -> None:
    robot = eurdf.load("slider_crank")
    slider = next(joint.name for joint in robot.mechanism.joints if joint.type == "prismatic")
    playback = TrajectoryPlayback(Shown(robot), Trajectory((0.0, 1.5), ({}, {slider: (10.0,)})))
    with pytest.raises(ValueError, match=r"the trajectory stops at time 1\.5 s: "):
        list(playback.frames())
    assert playback.time == pytest.approx(1.5)


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


def fall(shown: Shown, frames: int, **options: bool) -> GravityPlayback:
    """Let a robot fall for a number of frames that are shown."""
    playback = GravityPlayback(shown, **{"dissipation": False, "held": False, **options})
    waits, count, before = playback.frames(), 0, 0.0
    while count < frames:
        assert 0.0 <= next(waits) <= FRAME
        count += playback.time != before
        before = playback.time
    waits.close()
    return playback


def test_gravity_moves_as_a_simulation_and_stops_where_the_user_moves() -> None:
    robot = eurdf.load("four_bar")
    shown = Shown(robot)
    playback = GravityPlayback(shown, dissipation=False, held=False)
    frames = playback.frames()
    while playback.time < 0.1:
        next(frames)
    expected = eurdf.simulate(robot, shown.first, duration=0.3, step=1.0 / 900.0)
    assert np.abs(expected.q[round(900.0 * playback.time)] - shown.q).max() < 1e-6
    assert np.abs(shown.q - shown.first).max() > 1e-3
    shown.q = shown.first  # the user's hand takes its velocity
    while playback.time == 0.0 or np.array_equal(shown.q, shown.first):
        next(frames)
    assert np.abs(expected.q[round(900.0 * playback.time)] - shown.q).max() < 1e-6


def test_fast_motion_under_gravity_keeps_loops_closed() -> None:
    shown = Shown(eurdf.load("kangaroo_leg", geometry=False))
    playback = GravityPlayback(shown, dissipation=True, held=False)
    for seconds in playback.frames():
        time.sleep(seconds)
        assert shown.residual < 1e-4
        if playback.time > 0.3:  # where steps of 1.1 ms diverge
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
    shown = Shown(floating)
    turned = np.array((0.5, -1.0, 2.0, 1.0, 0.0, 0.0, 0.0))  # half a turn about x
    shown.go_to(np.concatenate((turned, shown.q[7:])))
    begin = shown.q
    fall(shown, 5, held=True)
    assert (shown.q[:7] == turned).all()
    expected = eurdf.simulate(fixed, begin[7:], duration=0.1, step=1.0 / 900.0)
    assert np.abs(expected.q - shown.q[7:]).max(axis=1).min() < 1e-6
    assert np.abs(shown.q - begin).max() > 1e-5
    shown.go_to(begin)
    fall(shown, 5, held=False)
    assert shown.q[2] < begin[2]
