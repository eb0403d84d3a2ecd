"""Motions that play: a range of motion, a trajectory, and the fall under gravity. Knows no viewer."""

from __future__ import annotations

import time
import warnings
from collections.abc import Callable, Iterator

import numpy as np

from eurdf.kinematics.array import Vector
from eurdf.kinematics.exceptions import NotClosable
from eurdf.kinematics.forward_kinematics import forward_kinematics
from eurdf.kinematics.simulation import simulate
from eurdf.viewing.session import Session
from eurdf.viewing.trajectory import Trajectory, frames_between

#: Shows the session as it is, with a message below.
Show = Callable[[str], None]

# Time between frames, s.
_FRAME = 1.0 / 30.0
# Time step of a simulation, s.
_STEP = _FRAME / 30.0


def sweep_frames(session: Session, index: int, show: Show) -> Iterator[float]:
    """The range of motion of the actuator of a slider, again and again.

    Yields:
        How long to show each frame, s.

    Raises:
        NotClosable: The loops do not close.
        ValueError: It has no range of motion.
    """
    configurations, ends = session.sweep(index)
    name = session.sliders[index].joint
    while True:
        for q in configurations:
            session.show(q)
            show(f"sweep of '{name}': ends at {ends}")
            yield _FRAME


def trajectory_frames(session: Session, trajectory: Trajectory, show: Show) -> Iterator[float]:
    """A trajectory, once: the joints of its columns have its values, and the others follow.

    Yields:
        How long to show each frame, s.

    Raises:
        ValueError: A configuration cannot be reached; the text says at which time.
    """
    for at, (left, coordinates) in zip(trajectory.times, frames_between(trajectory), strict=True):
        begin = time.monotonic()
        try:
            session.show(forward_kinematics(session.robot, coordinates, session.q))
        except NotClosable as reason:
            raise ValueError(f"the trajectory stops at time {at:g} s: {reason}") from None
        show(f"trajectory: {at:.3f} s of {trajectory.times[-1]:g} s")
        yield max(0.0, left - (time.monotonic() - begin))


def gravity_frames(session: Session, show: Show, *, dissipation: bool) -> Iterator[float]:
    """The motion under gravity with motors that exert no torque, without end.

    It starts at rest, and again at rest where the user moves the robot meanwhile.

    Args:
        session: The robot.
        show: Shows it.
        dissipation: Whether damping and friction act.

    Yields:
        How long to show each frame, s.

    Raises:
        EurdfError: The motion cannot be computed, such as that of a joint without inertia.
    """
    q: Vector = np.full(session.robot.tree.nq, np.nan)
    v = np.zeros(session.robot.tree.nv)
    elapsed = 0.0
    while True:
        begin = time.monotonic()
        if not np.array_equal(q, session.q):
            v, elapsed = np.zeros(session.robot.tree.nv), 0.0
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # a time step that is too long for the energy
            motion = simulate(session.robot, session.q, v, duration=_FRAME, step=_STEP, dissipation=dissipation)
        v = motion.v[-1]
        session.show(motion.q[-1])
        q = session.q
        elapsed += _FRAME
        spent = time.monotonic() - begin
        speed = "" if spent <= _FRAME else f", {100.0 * _FRAME / spent:.0f} % of real time"
        show(f"gravity: {elapsed:.2f} s{speed}")
        yield max(0.0, _FRAME - (time.monotonic() - begin))
