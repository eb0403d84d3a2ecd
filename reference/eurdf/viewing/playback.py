"""Motions that play: a trajectory, and the fall under gravity."""

from __future__ import annotations

import bisect
import csv
import io
import math
import time
import warnings
from collections.abc import Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
import pinocchio as pin

from eurdf.array import Vector
from eurdf.diagnostics import did_you_mean
from eurdf.errors import NotClosable, SimulationDiverged
from eurdf.kinematics.forward import forward_kinematics
from eurdf.kinematics.residual import residual
from eurdf.kinematics.simulation import Simulation, simulate
from eurdf.kinematics.tolerances import CLOSED
from eurdf.pinocchio.robot import build_robot

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot
    from eurdf.viewing.shown import ShownRobot

#: Time between frames, s.
FRAME = 1.0 / 30.0
# Most steps of a simulation in a frame, and the time step, s.
_STEPS = 30
_STEP = FRAME / _STEPS
# The shortest time step, s.
_SHORTEST_STEP = _STEP / 32.0
# Time for the steps of a frame, s.
_BUDGET = 0.025
# A row of a trajectory whose time is later by no more is shown, s.
_LATER = 1e-9
# Time between looks at whether a frame is computed, s.
_POLL = 0.002
# The column of times in the file of a trajectory.
_TIME = "time"
# A floating root has the first coordinates of q: position and quaternion.
_ROOT_COORDINATES = 7


@dataclass(frozen=True, slots=True)
class Trajectory:
    """Coordinates of joints at times; the other joints follow.

    Attributes:
        times: In ascending order, s.
        coordinates: At each time, the coordinates of the joints as in files.
    """

    times: tuple[float, ...]
    coordinates: tuple[Mapping[str, tuple[float, ...]], ...]


def read_trajectory(text: str, robot: Robot) -> Trajectory:
    """Read a CSV file; `Viewer.replay` has what it contains.

    Args:
        text: The file.
        robot: Whose joints they are.

    Raises:
        ValueError: The file has an error; the text says in which line.
    """
    rows = csv.reader(io.StringIO(text.removeprefix("\ufeff")))
    header = [name.strip() for name in next(rows, [])]
    columns = _columns(header, robot)
    times: list[float] = []
    coordinates: list[Mapping[str, tuple[float, ...]]] = []
    for row in rows:
        line = rows.line_num
        if not any(cell.strip() for cell in row):
            continue
        if len(row) != len(header):
            raise ValueError(f"line {line}: {len(row)} values, but the first line names {len(header)} columns")
        numbers = [_number(cell, line, name) for cell, name in zip(row, header, strict=True)]
        time = numbers[header.index(_TIME)]
        if times and time <= times[-1]:
            raise ValueError(f"line {line}: time {time:g} does not follow {times[-1]:g}; times must ascend")
        times.append(time)
        coordinates.append({joint: tuple(numbers[at] for at in places) for joint, places in columns.items()})
    if not times:
        raise ValueError("the trajectory has no line of values")
    return Trajectory(tuple(times), tuple(coordinates))


def _columns(header: list[str], robot: Robot) -> dict[str, list[int]]:
    """For each joint the indices of its columns."""
    if _TIME not in header:
        raise ValueError(f"line 1: there is no column '{_TIME}'; the first line names the columns, such as: time,motor")
    for name in header:
        if header.count(name) > 1:
            raise ValueError(f"line 1: column '{name}' occurs {header.count(name)} times")
    sizes = {joint.name: len(joint.type.coordinates) for joint in robot.mechanism.joints if joint.name in robot.slots}
    expected = {
        joint: [joint] if size == 1 else [f"{joint}:{number + 1}" for number in range(size)]
        for joint, size in sizes.items()
    }
    joint_of = {column: joint for joint, names in expected.items() for column in names}
    columns: dict[str, list[int]] = {}
    for name in header:
        if name == _TIME:
            continue
        joint = joint_of.get(name)
        if joint is None:
            hint = did_you_mean(name, joint_of) or "columns are 'time' and names of moving joints"
            raise ValueError(f"line 1: there is no joint '{name}'; {hint}")
        missing = [other for other in expected[joint] if other not in header]
        if missing:
            raise ValueError(f"line 1: joint '{joint}' has {sizes[joint]} coordinates; add column '{missing[0]}'")
        columns[joint] = [header.index(other) for other in expected[joint]]
    return columns


def _number(cell: str, line: int, column: str) -> float:
    try:
        number = float(cell)
    except ValueError:
        number = math.nan
    if not math.isfinite(number):
        raise ValueError(f"line {line}: '{cell.strip()}' in column '{column}' is not a finite number")
    return number


class TrajectoryPlayback:
    """A trajectory that plays: the joints of its columns have its values, and the others follow.

    Attributes:
        time: Where it is, s, from its begin.
        duration: How long it is, s.
        speed: Time of the trajectory in a second.
    """

    what = "trajectory"
    pace = 1.0

    def __init__(self, shown: ShownRobot, trajectory: Trajectory) -> None:
        self._shown, self._trajectory = shown, trajectory
        self._found: list[Vector] = []
        self.time, self.speed = 0.0, 1.0
        self.duration = trajectory.times[-1] - trajectory.times[0]

    def frames(self) -> Iterator[float]:
        """Play on, to its end.

        Yields:
            How long to show each frame, s, or 0 for one that is computed.

        Raises:
            ValueError: A configuration cannot be reached; the text says at which time.
        """
        while True:
            begin = time.monotonic()
            yield from self.at_time()
            if self.time >= self.duration:
                return
            yield max(0.0, FRAME - (time.monotonic() - begin))
            # A frame that takes long to compute makes the motion slow, and leaves none out.
            self.time = min(self.time + self.speed * FRAME, self.duration)

    def at_time(self) -> Iterator[float]:
        """Show where it is; configurations are computed one after the other, to stay on one branch."""
        robot, times = self._shown.robot, self._trajectory.times
        wanted = bisect.bisect_right(times, times[0] + self.time + _LATER) - 1
        while len(self._found) <= wanted:
            number = len(self._found)
            before = self._found[-1] if self._found else self._shown.q
            try:
                found = forward_kinematics(robot, self._trajectory.coordinates[number], before)
            except NotClosable as reason:
                raise ValueError(f"the trajectory stops at time {times[number]:g} s: {reason}") from None
            self._found.append(found)
            yield 0.0
        self._shown.go_to(self._found[wanted])


class GravityPlayback:
    """The motion under gravity with motors that exert no torque, without end.

    It starts at rest, and again at rest where the robot is moved meanwhile.

    Attributes:
        dissipation: Whether damping and friction act.
        held: Whether a floating root stays where it is.
        time: Simulated time since it began, s.
        pace: Simulated time over real time of the last frame, at most 1.
    """

    what = "gravity"
    duration, speed = None, 1.0

    def __init__(self, shown: ShownRobot, *, dissipation: bool, held: bool) -> None:
        self._shown, self.dissipation, self.held = shown, dissipation, held
        self.time, self.pace = 0.0, 1.0

    def frames(self) -> Iterator[float]:
        """Play on. Another thread computes it, so that the caller never waits for a step.

        Yields:
            How long to show each frame, s; or how long to wait for the next one.

        Raises:
            EurdfError: The motion cannot be computed, such as that of a joint without inertia.
            ValueError: The motion is too fast for the time step.
        """
        shown, spent = self._shown, 0.0
        q: Vector = np.full(shown.robot.tree.nq, np.nan)
        fall = _GravityMotion(shown.robot, self.held)
        thread, count = ThreadPoolExecutor(1, "eurdf viewer gravity"), 1  # the time of a step is not known yet
        try:
            while True:
                if not np.array_equal(q, shown.q):
                    q = shown.q
                    fall.begin(q)
                    self.time = spent = 0.0
                running = thread.submit(fall.advance, count, self.dissipation)
                while not running.done():
                    yield _POLL
                if not np.array_equal(q, shown.q):
                    continue  # the user moved it meanwhile
                try:
                    reached, seconds = running.result()
                except SimulationDiverged:
                    raise ValueError(
                        f"gravity ends after {self.time:.2f} s: the motion is too fast, as near a singularity, even "
                        f"for steps of {1e3 * _SHORTEST_STEP:.2g} ms; 'reset' returns to the start"
                    ) from None
                begin = time.monotonic()
                simulated = count * _STEP
                self.time += simulated
                self.pace = min(1.0, simulated / (spent + seconds))
                shown.go_to(reached)
                q = shown.q
                spent = time.monotonic() - begin
                count = steps_with_room(count, seconds)
                yield max(0.0, simulated - seconds - spent)
        finally:
            thread.shutdown(wait=False, cancel_futures=True)


def steps_with_room(steps: int, seconds: float) -> int:
    """How many steps of a simulation the next frame gets, after one whose steps took so long, s.

    They are as many as its time has room for, at least one and at most twice as many as before.
    """
    room = _BUDGET * steps / max(seconds, 1e-9)
    return int(min(max(room, 1.0), 2.0 * steps, _STEPS))


class _GravityMotion:
    """A motion under gravity, computed part by part.

    Where the motion is fast, as near a singularity, the time step gets shorter, so that the loops stay closed.

    A robot with its root held is simulated with a root fixed to the world, in which gravity has another direction.
    """

    def __init__(self, robot: Robot, held: bool) -> None:
        self._robot = robot
        self._held = held and robot.mechanism.root == "floating"
        if self._held:
            self._robot = build_robot(replace(robot.mechanism, root="fixed", configurations={}), geometry=False)
        self._gravity: Vector = np.array(robot.model.gravity.linear)
        self._root: Vector = np.empty(0)

    def begin(self, q: Vector) -> None:
        """Start at rest at a configuration (nq,) of the robot."""
        size = _ROOT_COORDINATES if self._held else 0
        self._root, self._q, self._step = q[:size], q[size:], _STEP
        self._v: Vector = np.zeros(self._robot.tree.nv)
        if self._held:
            self._robot.model.gravity.linear = pin.XYZQUATToSE3(self._root).rotation.T @ self._gravity

    def advance(self, steps: int, dissipation: bool) -> tuple[Vector, float]:
        """The configuration (nq,) of the robot after some steps, and how long they took, s.

        Each step is simulated alone, so that the motion does not depend on how many a frame has time for.
        """
        begin = time.monotonic()
        for _ in range(steps):
            motion = self._simulated(dissipation)
            while motion is None:
                self._step /= 2.0
                motion = self._simulated(dissipation)
            self._q, self._v = motion.q[-1], motion.v[-1]
        return np.concatenate((self._root, self._q)), time.monotonic() - begin

    def _simulated(self, dissipation: bool) -> Simulation | None:
        """One step of the motion; None if the time step is too long for it, and can be shorter."""
        may_be_shorter = self._step > _SHORTEST_STEP
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")  # a time step that is too long for the energy
                motion = simulate(
                    self._robot, self._q, self._v, duration=_STEP, step=self._step, dissipation=dissipation
                )
        except SimulationDiverged:
            if may_be_shorter:
                return None
            raise
        opened = np.abs(residual(self._robot, motion.q[-1])).max(initial=0.0) > CLOSED
        return None if opened and may_be_shorter else motion
