"""What a program reads of an exported file: the seam between a simulator and the comparison, and what is found."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from eurdf.array import Matrix, Vector
from eurdf.convert.conventions import opening_of
from eurdf.convert.coordinates import Coordinates, homogeneous
from eurdf.kinematics.opening import Opening
from eurdf.mechanism.body import Anchor
from eurdf.mechanism.constraint import Closure
from eurdf.pinocchio.robot import Robot, build_robot


@dataclass(frozen=True, slots=True)
class Finding:
    """Something that is wrong with a file that was read back.

    Attributes:
        message: What is wrong, with its values.
        causes: What was seen of the cause, and what to do, each a sentence.
    """

    message: str
    causes: tuple[str, ...] = ()

    def __str__(self) -> str:
        return "; ".join((self.message, *self.causes))


class CannotRead(Exception):  # noqa: N818 - it never leaves the comparison
    """A program refuses a file; the text is its reason.

    Attributes:
        reader: The program.
    """

    def __init__(self, reader: str, reason: object) -> None:
        self.reader = reader
        super().__init__(str(reason))


@dataclass(frozen=True, eq=False)
class Exported:
    """A file to read back, and the robot that it was written from.

    Attributes:
        path: The main file.
        robot: The robot, with the closures that were exported.
        coordinates: From the vectors of the robot to those of the model.
        start: The configuration (nq,) that simulations start from.
    """

    path: Path
    robot: Robot
    coordinates: Coordinates
    start: Vector

    def off_mimics(self, positions: Vector) -> Iterator[Opening]:
        """How far each mimic joint is off its leader at positions (`coordinates.nq`,) of the model; m or rad."""
        expected, at = self.coordinates.to_q(self.coordinates.from_q(positions)), 0
        for part in self.coordinates.parts:
            if part.mimics:
                off = positions[at] - expected[at]
                slides = part.type == "prismatic"
                yield Opening(part.names[0], abs(off) if slides else 0.0, 0.0 if slides else abs(off))
            at += part.nq


class Range(NamedTuple):
    """A coordinate of the model with limits: its joint, value, and lower and upper limit, rad or m."""

    joint: str
    value: float
    lower: float
    upper: float


@dataclass(frozen=True, slots=True, eq=False)
class Instant:
    """The model at one time of a simulation.

    Attributes:
        time: s.
        positions: In the coordinates of the model.
        velocities: In those of the model, rad/s or m/s.
        openings: Of each constraint of the file, in the order of `ReadModel.openings`.
        contact: Where bodies collide: two of them that overlap most, and by how much, m.
    """

    time: float
    positions: Vector
    velocities: Vector
    openings: tuple[Opening, ...]
    contact: tuple[str, str, float] | None = None


class Diverged(Exception):  # noqa: N818 - it never leaves the comparison
    """A simulation has numbers that are not finite; the text says what the simulator reports."""


class ReadModel(ABC):
    """A file as a program reads it.

    Attributes:
        reader: Name and version of the program.
        unverified: What this program cannot compare, each a sentence.
        tolerance: Opening, m or rad, up to which a loop counts as closed at the start.
        mass_tolerance: Relative difference up to which masses and mass matrices count as equal.
        step: Time step of its simulations, s; 0 if it simulates nothing.
        shorter: What to do for a shorter time step.
        velocities: Joint and unit (rad or m) of each velocity of the model.
    """

    reader: str
    unverified: tuple[str, ...] = ()
    tolerance = mass_tolerance = 1e-6
    step = 0.0
    shorter = ""
    velocities: Sequence[tuple[str, str]] = ()

    @abstractmethod
    def __init__(self, exported: Exported) -> None:
        """Read a file.

        Raises:
            CannotRead: The program refuses it.
        """

    @property
    @abstractmethod
    def mass(self) -> float:
        """Mass of all bodies, kg."""

    @abstractmethod
    def mass_matrix(self, q: Vector) -> Matrix:
        """M (nv, nv) at q (nq,), for velocities of the robot."""

    @abstractmethod
    def openings(self, q: Vector) -> tuple[Opening, ...]:
        """How far each closure, coupling and mimic of the file is open at q (nq,)."""

    @abstractmethod
    def ranges(self, q: Vector) -> tuple[Range, ...]:
        """Each coordinate with limits, at q (nq,)."""

    def fall(self, q: Vector, seconds: float, *, slower: int = 1, contacts: bool = True) -> Iterator[Instant]:
        """Simulate without actuation, from rest at q (nq,).

        Args:
            q: Where to start.
            seconds: How long, s.
            slower: How many steps to make in the time of one.
            contacts: Whether bodies collide.

        Yields:
            The model after each step.

        Raises:
            Diverged: Numbers are not finite.
        """
        raise NotImplementedError


def without_armature(robot: Robot, names: Sequence[str] | None = None) -> Robot:
    """The robot without the armatures and rotors of some joints, or of all, which some formats do not have."""
    joints = tuple(
        replace(joint, properties=replace(joint.properties, armature=(), rotor_inertia=(), gear_ratio=()))
        if names is None or joint.name in names
        else joint
        for joint in robot.mechanism.joints
    )
    return build_robot(replace(robot.mechanism, joints=joints), geometry=False)


def opening_between(closure: Closure, a: Matrix, b: Matrix) -> Opening:
    """How far a closure is open, with its frames at poses (4, 4) in the world."""
    return Opening(closure.name, *opening_of(closure, a, b))


def anchored(anchor: Anchor, pose: Callable[[str], Any]) -> Matrix:
    """Pose (4, 4) of an anchor in the world, where `pose` gives that of its body."""
    return np.asarray(pose(anchor.body) @ homogeneous(anchor.pose))
