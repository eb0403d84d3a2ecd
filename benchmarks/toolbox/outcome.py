"""What is expected of a call of the published code, and what was seen."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pinocchio as pin

import eurdf


@dataclass(frozen=True, slots=True)
class Agrees:
    """Both sides differ by at most so much, in the units of what is compared: m, rad, s, N, N·m."""

    tolerance: float

    @property
    def text(self) -> str:
        """For the page."""
        return f"≤ {self.tolerance:.0e}".replace("e-0", "e-") if self.tolerance else "equal"


@dataclass(frozen=True, slots=True)
class Off:
    """They differ by more than so much, and no error says so; the page may say in words what is wrong."""

    least: float
    words: str = ""

    @property
    def text(self) -> str:
        """For the page."""
        return f"**{self.words or f'off by more than {self.least:g}'}**"


@dataclass(frozen=True, slots=True)
class Fails:
    """Their side raises an error with these words; the page may say why."""

    words: str
    why: str = ""

    @property
    def text(self) -> str:
        """For the page."""
        return f"fails: {self.why or f'`{self.words}`'}"


Outcome = Agrees | Off | Fails


@dataclass(frozen=True, slots=True)
class Found:
    """What a call did: it returned a value, raised an error, or ended the process with a signal."""

    value: Any = None
    error: str = ""
    signal: int = 0


@dataclass(frozen=True)
class Case:
    """A robot of the collection at a closed configuration, and what their functions are called with.

    Attributes:
        name: Of the robot.
        frame: A frame that its motors move.
        robot: As it is loaded.
        arrays: By name: ``q`` (nq,) closed, ``near`` (nq,) open by some centimetres, ``v`` and ``a`` (nv,) any velocity
            and acceleration, ``vc`` and ``ac`` such that the loops stay closed, ``motors`` (nu,) positions near those
            of q in the order of q, ``moved`` (nq,) the configuration there, ``target`` (4, 4) the pose of the frame at
            it, ``twist`` (6,) of the frame, ``S`` (nv, nu), ``more`` (nv, nu + 1) with one motor more, ``u0`` (nu + 1,)
            any torques.
    """

    name: str
    frame: str
    robot: eurdf.Robot
    arrays: dict[str, Any] = field(repr=False)

    def __getattr__(self, name: str) -> Any:
        try:
            return self.arrays[name]
        except KeyError:
            raise AttributeError(name) from None


def more_motor(robot: eurdf.Robot) -> str:
    """The first joint of one velocity without a motor."""
    model, motors = robot.model, robot.actuation.joints
    return next(
        str(model.names[i]) for i in range(1, model.njoints) if model.joints[i].nv == 1 and model.names[i] not in motors
    )


def case(name: str, frame: str) -> Case:
    """The case of a robot; all of it is the same in each run."""
    robot = eurdf.load(name, geometry=False)
    model, random = robot.model, np.random.default_rng(1)
    motors = robot.actuation.idx_q
    values = random.uniform(-0.2, 0.2, len(motors))
    q = eurdf.forward_kinematics(robot, values)
    near = pin.integrate(model, q, random.normal(scale=0.02, size=model.nv))
    v, a = random.normal(size=(2, model.nv))
    vc = eurdf.project_velocity(robot, q, v)
    ac = eurdf.kinematics.achievable_acceleration(robot, q, vc, eurdf.project_acceleration(robot, q, vc, a))
    moved = eurdf.forward_kinematics(robot, values + 0.05, q)
    data = model.createData()
    pin.framesForwardKinematics(model, data, moved)
    arrays = {"q": q, "near": near, "v": v, "a": a, "vc": vc, "ac": ac, "moved": moved}
    arrays |= {"motors": moved[np.sort(motors)], "target": data.oMf[model.getFrameId(frame)].homogeneous.copy()}
    arrays |= {"twist": np.array([0.1, 0.2, -0.1, 0.3, -0.2, 0.1]), "S": robot.actuation.selection}
    column = model.joints[model.getJointId(more_motor(robot))].idx_v
    arrays |= {"more": np.hstack([robot.actuation.selection, np.eye(model.nv)[:, [column]]])}
    arrays |= {"u0": random.normal(size=len(motors) + 1)}
    return Case(name, frame, robot, arrays)


#: How far what their side returned is from what it should be.
Compare = Callable[[Any, Any], float]


def same(ours: Callable[[Case], Any]) -> Compare:
    """The largest difference to a value of ours; infinite where the shapes differ."""

    def compare(of: Case, theirs: Any) -> float:
        a, b = np.asarray(theirs, float), np.asarray(ours(of), float)
        return float(np.abs(a - b).max(initial=0.0)) if a.shape == b.shape else float("inf")

    return compare


def opening(of: Case, theirs: Any) -> float:
    """The largest row of the residual at a configuration, m or rad."""
    return float(np.abs(eurdf.residual(of.robot, np.array(theirs))).max())


def frame_error(of: Case, theirs: Any) -> float:
    """How far the frame is from its target at a configuration, m or rad."""
    model, data = of.robot.model, of.robot.model.createData()
    pin.framesForwardKinematics(model, data, np.array(theirs))
    reached = data.oMf[model.getFrameId(of.frame)]
    return float(np.abs(pin.log6(reached.actInv(pin.SE3(of.target))).vector).max())


def stretch(of: Case, theirs: Any) -> float:
    """How far the lengths of the quaternions of a configuration are from 1."""
    q = np.array(theirs)
    return float(np.abs(q - pin.normalize(of.robot.model, q)).max())


def judged(expected: Outcome, compare: Compare, of: Case | None, found: Found) -> str | None:
    """What was seen otherwise than expected; None if nothing."""
    seen = f"signal {found.signal}" if found.signal else found.error
    match expected:
        case Fails():
            return None if expected.words in found.error else seen or "no error"
        case Agrees() | Off():
            if seen:
                return seen
            difference = compare(of, found.value)
            if isinstance(expected, Agrees):
                return None if difference <= expected.tolerance else f"differs by {difference:.1e}"
            return None if difference > expected.least else f"differs only by {difference:.1e}"
