"""The joints and constraints of a transmission as numbers, for what is generated of it: C and tables of arrays."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, NamedTuple

from eurdf.array import Vector
from eurdf.closures import MODULES
from eurdf.kinematics.tangent_space import TangentSpaces
from eurdf.mechanism.body import WORLD
from eurdf.mechanism.constraint import Closure, Constraint, Coupling
from eurdf.mechanism.joint import Joint, Mimic
from eurdf.mechanism.pose import IDENTITY, ORIGIN, Pose, Vector3, X, Y, Z, cross, direction
from eurdf.pinocchio.mimic import following
from eurdf.transmissions.drive import Drive

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot

#: What generated programs call each kind of constraint.
KINDS = {**MODULES, Coupling.type: "coupling"}


class Screw(NamedTuple):
    """A joint with one coordinate, or a ball.

    Attributes:
        parent: Number of the joint that carries it; 0 is at rest.
        ball: Whether it is a ball.
        turns: Whether it turns about its axis.
        coordinate: Its coordinate, the first one of a ball.
        velocity: Its velocity, the first one of a ball.
        multiplier: Its motion for that of its coordinate, which is another joint's if it is a mimic joint.
        offset: Its position if the coordinate is zero.
        pose: Its frame at rest, in its parent.
        axis: Unit vector.
        advance: Translation for a unit of its motion.
    """

    parent: int
    ball: bool
    turns: bool
    coordinate: int
    velocity: int
    multiplier: float
    offset: float
    pose: Pose
    axis: Vector3
    advance: Vector3


class ConstraintNumbers(NamedTuple):
    """What a constraint is made of.

    Attributes:
        kind: Its name in `KINDS`.
        ends: For both frames the joint that carries it, and its pose there.
        axes: Those of a hinge, in both frames.
        across: Two unit vectors across the first axis and each other.
        length: The length, or the offset of a coupling.
        path: The joints that move it, with +1 for those that move B and -1 for A, or with coefficients.
    """

    kind: str
    ends: tuple[tuple[int, Pose], tuple[int, Pose]]
    axes: tuple[Vector3, Vector3]
    across: tuple[Vector3, Vector3]
    length: float
    path: list[tuple[int, float]]


class Tables:
    """The joints and constraints of some drives as numbers.

    Attributes:
        joints: Each joint but number 0, which is at rest, parents first.
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
                    f"generated code cannot have the contact '{constraint.name}' of a floating robot; prepare the "
                    "transmission for the robot without contacts"
                )
            if constraint.type not in KINDS:
                raise ValueError(
                    f"constraint '{constraint.name}' is {constraint.type}, which generated code does not support"
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
        self.joints: list[Screw] = []
        self.places: dict[str, tuple[int, Pose]] = {}
        self.of_body: dict[str, range] = {}
        self.of_joint: dict[str, int] = {}
        for joint in mechanism.joints:
            if joint.child in relevant:
                self._add(joint, mimics.get(joint.name), first)
            elif joint.name in alone:
                self.of_joint[joint.name] = len(self.joints) + 1
                self.joints += _screws(joint, 0, IDENTITY, *first[joint.name], None, len(self.joints) + 1)

    def pose(self, q: Vector) -> list[float]:
        """The coordinates at a configuration (nq,)."""
        values = self.robot.joint_positions(q)
        return [value for name in self._first for value in values[name]]

    def numbers(self, constraint: Constraint) -> ConstraintNumbers:
        """What a constraint is made of."""
        places = [self.places.get(anchor.body, (0, IDENTITY)) for anchor in constraint.anchors] or 2 * [(0, IDENTITY)]
        poses = [anchor.pose for anchor in constraint.anchors] or 2 * [IDENTITY]
        one, other = ((joint, pose * at) for (joint, pose), at in zip(places, poses, strict=True))
        own = constraint.own if isinstance(constraint, Closure) else {}
        a, b = (direction(axis) for axis in own.get("axes", (Z, Z)))
        length = constraint.offset if isinstance(constraint, Coupling) else own.get("length", 0.0)
        across, kind = _across(a), KINDS[constraint.type]
        return ConstraintNumbers(kind, (one, other), (a, b), across, length, self._path(constraint))

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

    def _path(self, constraint: Constraint) -> list[tuple[int, float]]:
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
) -> list[Screw]:
    """A joint as joints of one coordinate and balls in a row; ``number`` is that of the first."""
    factor, offset = (1.0, 0.0) if mimic is None else (mimic.multiplier, mimic.offset)
    found = []
    for k, (axis, turns, advance) in enumerate(joint.motions):
        x, y, z = axis if axis and advance else ORIGIN
        along = advance * x, advance * y, advance * z
        kind = axis is None, bool(turns)
        found.append(Screw(parent, *kind, coordinate + k, velocity + k, factor, offset, pose, axis or Z, along))
        parent, pose = number + k, IDENTITY
    return found


def _across(a: Vector3) -> tuple[Vector3, Vector3]:
    """Two unit vectors across a unit vector and each other."""
    least = min(range(3), key=lambda k: abs(a[k]))
    first = direction(cross(a, (X, Y, Z)[least]))
    return first, cross(a, first)
