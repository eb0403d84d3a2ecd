"""The joints, constraints and polynomials of a transmission as tables of C."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from eurdf.array import Vector
from eurdf.closures import MODULES
from eurdf.kinematics.tangent_space import TangentSpaces
from eurdf.mechanism.body import WORLD
from eurdf.mechanism.constraint import Closure, Constraint, Coupling
from eurdf.mechanism.joint import Joint, Mimic
from eurdf.mechanism.pose import IDENTITY, ORIGIN, Pose, Vector3, X, Y, Z, cross, direction
from eurdf.pinocchio.mimic import following
from eurdf.transmissions.drive import Drive
from eurdf.transmissions.first_guess import Prediction

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot

#: What the kernel calls each kind of constraint.
KINDS = {type_: module.upper() for type_, module in MODULES.items()} | {Coupling.type: "COUPLING"}

# Digits of a coefficient after the point, which are more than a first guess needs.
_DIGITS = 9


class Tables:
    """The joints and constraints of some drives as numbers.

    Attributes:
        joints: Entry of each joint but number 0, which is at rest, parents first.
        size: Number of coordinates.
        units: Unit of each velocity.
        coordinates: For each velocity its coordinate; -1 for the first of a ball, -2 for the others.
        balls: For each velocity the first coordinate of its ball; -1 if it has none.
        velocity: Index here of a velocity of the robot's model.
        constraints: Indices of the constraints.
    """

    def __init__(self, robot: Robot, drives: Sequence[Drive]) -> None:
        mechanism = robot.mechanism
        self.robot = robot
        self.constraints = sorted({index for drive in drives for index in drive.closures})
        chosen = [robot.constraints[index] for index in self.constraints]
        for constraint in chosen:
            if any(anchor.body == WORLD for anchor in constraint.anchors):
                raise ValueError(
                    f"the C of a transmission cannot have the contact '{constraint.name}' of a floating robot; prepare "
                    "it for the robot without contacts"
                )
        self._above = {joint.child: joint for joint in mechanism.joints}
        relevant = {body for constraint in chosen for body in self._between(constraint)}
        alone = {name for constraint in chosen for name in constraint.joints}
        alone |= {name for drive in drives for name in (*drive.given.joints, *drive.asked.joints)}
        mimics = following(mechanism).mimics
        self.size = 0
        self.velocity: dict[int, int] = {}
        self.units: list[float] = []
        self.coordinates: list[int] = []
        self.balls: list[int] = []
        own = {joint.name: mimics.get(joint.name) for joint in mechanism.joints if joint.child in relevant}
        needed = {name if mimic is None else mimic.joint for name, mimic in own.items()} | alone
        first: dict[str, tuple[int, int]] = {}
        self._first = first
        scale = robot.cached(TangentSpaces).scale
        for name, slot in robot.slots.items():
            if name not in needed:
                continue
            first[name] = self.size, len(self.units)
            quaternion = slot.joint.type.quaternion
            for k in range(slot.nv):
                self.velocity[slot.idx_v + k] = len(self.units)
                self.units.append(float(scale[slot.idx_v + k]))
                of_ball = quaternion is not None and k >= quaternion
                self.coordinates.append((-1 if k == quaternion else -2) if of_ball else self.size + k)
                self.balls.append(self.size + (quaternion or 0) if of_ball else -1)
            self.size += len(slot.joint.type.coordinates)
        self.joints: list[str] = []
        self.places: dict[str, tuple[int, Pose]] = {}
        self.of_body: dict[str, range] = {}
        self.of_joint: dict[str, int] = {}
        for joint in mechanism.joints:
            if joint.child in relevant:
                self._add(joint, mimics.get(joint.name), first)
            elif joint.name in alone:
                self.of_joint[joint.name] = len(self.joints) + 1
                self.joints += _screws(joint, 0, IDENTITY, *first[joint.name], None, len(self.joints) + 1)

    def pose(self, q: Vector) -> str:
        """The coordinates at a configuration (nq,), as an initializer."""
        values = self.robot.joint_positions(q)
        return vector(value for name in self._first for value in values[name])

    def _add(self, joint: Joint, mimic: Mimic | None, first: Mapping[str, tuple[int, int]]) -> None:
        parent, pose = self.places.get(joint.parent, (0, IDENTITY))
        pose = pose * joint.placement
        if joint.type.is_fixed:
            self.places[joint.child] = parent, pose * joint.offset
            self.of_body[joint.child] = range(0)
            return
        start = len(self.joints) + 1
        leader = joint.name if mimic is None else mimic.joint
        self.joints += _screws(joint, parent, pose, *first[leader], mimic, start)
        self.of_joint[joint.name] = start
        self.of_body[joint.child] = range(start, len(self.joints) + 1)
        self.places[joint.child] = len(self.joints), joint.offset

    def _way_up(self, body: str) -> list[str]:
        """The body and what is above it."""
        way = [body]
        while way[-1] in self._above:
            way.append(self._above[way[-1]].parent)
        return way

    def _between(self, constraint: Constraint) -> set[str]:
        """The bodies on the way from one anchor to the other, without the one where they meet."""
        ends = [set(self._way_up(anchor.body)) for anchor in constraint.anchors]
        return ends[0] ^ ends[1] if ends else set()

    def anchors(self, constraint: Constraint) -> list[tuple[int, Pose]]:
        """The joints that carry the anchors of a constraint, and their poses there."""
        places = [self.places.get(anchor.body, (0, IDENTITY)) for anchor in constraint.anchors]
        return [(joint, pose * at.pose) for (joint, pose), at in zip(places, constraint.anchors, strict=True)]

    def path(self, constraint: Constraint) -> list[tuple[int, float]]:
        """The joints that move a constraint, with +1 for those that move B and -1 for A, or with coefficients."""
        if isinstance(constraint, Coupling):
            return [(self.of_joint[name], coefficient) for name, coefficient in constraint.coefficients]
        between, found = self._between(constraint), []
        for anchor, sign in zip(constraint.anchors, (-1.0, 1.0), strict=True):
            for body in self._way_up(anchor.body):
                if body in between:
                    found += [(joint, sign) for joint in self.of_body[body]]
        return found


def _screws(
    joint: Joint, parent: int, pose: Pose, coordinate: int, velocity: int, mimic: Mimic | None, number: int
) -> list[str]:
    """The entries of a joint as joints of one coordinate and balls in a row; ``number`` is that of the first."""
    factor, offset = (1.0, 0.0) if mimic is None else (mimic.multiplier, mimic.offset)
    found = []
    for k, (axis, turns, advance) in enumerate(joint.motions):
        numbers = parent, int(axis is None), int(turns), coordinate + k, velocity + k
        along = [advance * each for each in axis] if axis and advance else ORIGIN
        frame = f"{_rotation(pose)}, {vector(pose.xyz)}, {vector(axis or Z)}, {vector(along)}"
        found.append(f"{{{', '.join(map(str, numbers))}, {literal(factor)}, {literal(offset)}, {frame}}}")
        parent, pose = number + k, IDENTITY
    return found


def constraint_entry(constraint: Constraint, tables: Tables, first: int, last: int, scale: Vector) -> str:
    """The entry of a constraint, whose path is that from first to last, with the scales of its rows."""
    ends = tables.anchors(constraint) or [(0, IDENTITY), (0, IDENTITY)]
    own = constraint.own if isinstance(constraint, Closure) else {}
    a, b = (direction(axis) for axis in own.get("axes", (Z, Z)))
    length = constraint.offset if isinstance(constraint, Coupling) else own.get("length", 0.0)
    frames = ", ".join(f"{_rotation(pose)}, {vector(pose.xyz)}" for _, pose in ends)
    return (
        f"{{{KINDS[constraint.type]}, {constraint.rows}, {first}, {last}, "
        f"{ends[0][0]}, {ends[1][0]}, {frames}, "
        f"{literal(length)}, {vector(a)}, {vector(b)}, {{{', '.join(map(vector, _across(a)))}}}, {vector(scale)}}}"
    )


def _across(a: Vector3) -> tuple[Vector3, Vector3]:
    """Two unit vectors across a unit vector and each other."""
    least = min(range(3), key=lambda k: abs(a[k]))
    first = direction(cross(a, (X, Y, Z)[least]))
    return first, cross(a, first)


def drive_entry(
    number: int,
    drive: Drive,
    tables: Tables,
    place: Mapping[int, int],
    rows: Sequence[slice],
    guess: Prediction | None,
    reach: float,
) -> str:
    """The arrays of a drive and its entry; ``place`` is that of each constraint, ``rows`` those of all."""
    own = [tables.velocity[v] for v in drive.own.tolist()]
    asked = [tables.velocity[v] for v in drive.asked.velocities.tolist()]
    position = {velocity: index for index, velocity in enumerate(own)}
    lists = {
        "given_velocity": [tables.velocity[v] for v in drive.given.velocities.tolist()],
        "given_circular": [int(circular) for circular in drive.given.circular],
        "asked_velocity": asked,
        "asked_circular": [int(circular) for circular in drive.asked.circular],
        "asked_own": [position.get(velocity, -1) for velocity in asked],
        "own_velocity": own or [0],
        "constraint": [place[index] for index in drive.closures] or [0],
    }
    degrees, error, sign = (0, 0.0, 0.0) if guess is None else (guess.degree + 1, guess.error, guess.sign)
    coefficients = (
        np.zeros(1) if guess is None or not own else guess.coefficients.reshape(len(own), -1) / drive.unit[:, None]
    )
    boxes = {
        "lower": np.zeros(1) if guess is None else guess.lower,
        "upper": np.zeros(1) if guess is None else guess.upper,
        "coefficients": coefficients.round(_DIGITS).ravel() + 0.0,
    }
    arrays = [array("int", f"{key}_{number}", map(str, values)) for key, values in lists.items()]
    arrays += [array("double", f"{key}_{number}", map(literal, values)) for key, values in boxes.items()]
    counts = len(drive.given), len(drive.asked), len(own), rows_of(rows, drive), drive.rank, len(drive.closures)
    parts = [*map(str, (*counts, degrees)), *(f"{key}_{number}" for key in lists), *map(literal, (error, sign, reach))]
    parts += [f"{key}_{number}" for key in boxes]
    return "\n".join([*arrays, f"static const drive drive_{number} = {{{', '.join(parts)}}};"])


def rows_of(rows: Sequence[slice], drive: Drive) -> int:
    """The number of rows of the constraints of a drive."""
    return sum(rows[index].stop - rows[index].start for index in drive.closures)


def array(type_: str, name: str, values: Iterable[str]) -> str:
    """An array of numbers."""
    return f"static const {type_} {name}[] = {{{', '.join(values)}}};"


def table(type_: str, name: str, entries: Iterable[str], size: str = "[]") -> str:
    """An array of structures or rows, one a line."""
    lines = ",\n".join(f"    {entry}" for entry in entries)
    return f"static const {type_} {name}{size} = {{\n{lines},\n}};"


def literal(value: float) -> str:
    """A number, with all its digits."""
    return repr(float(value))


def vector(values: Iterable[float]) -> str:
    """The initializer of an array of numbers."""
    return "{" + ", ".join(map(literal, values)) + "}"


def _rotation(pose: Pose) -> str:
    columns = [pose.rotate(axis) for axis in (X, Y, Z)]
    return vector(columns[column][row] for row in range(3) for column in range(3))
