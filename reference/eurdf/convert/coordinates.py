"""From the configurations and velocities of a robot to those of an exported model, and back."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import reduce
from operator import mul

import numpy as np

from eurdf.array import Matrix, Vector
from eurdf.convert.parts import OwnVectors, Part
from eurdf.mechanism.pose import IDENTITY_QUATERNION, Pose, Quaternion
from eurdf.writing.xml_text import rpy_of


@dataclass(frozen=True, repr=False)
class Coordinates:
    """The map between the vectors of a robot, q (nq,) and v (nv,), and those of an exported model.

    In the model, angles (rad) and lengths (m) are zero where those of the robot are, unless `Part` states another zero.
    Forces go the other way: τ = Tᵀ τ_model with T of `rates`.

    Attributes:
        parts: In the order of the model.
        own: The vectors of the robot.
        quaternion: Order of the components of a quaternion in the model.
        at_rest: Whether the linear velocity of planar and floating joints, and of a floating root, is along the axes of
            the joint's frame at rest (of the world for a root) in the model; if not, along those of the child, as in
            the robot.
    """

    parts: tuple[Part, ...]
    own: OwnVectors
    quaternion: str = "wxyz"
    at_rest: bool = True
    _idx_q: tuple[int, ...] = field(init=False, repr=False)
    _idx_v: tuple[int, ...] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        idx_q, idx_v = [0], [0]
        for part in self.parts:
            idx_q.append(idx_q[-1] + part.nq)
            idx_v.append(idx_v[-1] + part.nv)
        object.__setattr__(self, "_idx_q", tuple(idx_q))
        object.__setattr__(self, "_idx_v", tuple(idx_v))

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the joints of the model, in order."""
        return tuple(name for part in self.parts for name in part.names)

    @property
    def nq(self) -> int:
        """Number of coordinates of the model."""
        return self._idx_q[-1]

    @property
    def nv(self) -> int:
        """Number of velocities of the model."""
        return self._idx_v[-1]

    def from_files(self, coordinates: Mapping[str, Sequence[float]]) -> Vector:
        """The configuration of the model, of shape (`nq`,), from coordinates as files have them.

        Args:
            coordinates: By name of the joint; a joint that is left out is at its neutral.
        """
        found = np.empty(self.nq)
        for part, start in zip(self.parts, self._idx_q, strict=False):
            given = tuple(coordinates.get(part.joint, part.type.neutral if not part.mimics else (0.0,)))
            found[start : start + part.nq] = _on_circles(self._in_model(part, given), part.circular)
        return found

    def to_q(self, q: Vector) -> Vector:
        """The configuration of the model, of shape (`nq`,), at q (nq,) of the robot."""
        q = _checked("q", q, self.own.nq)
        return self.from_files({part.joint: self._own_coordinates(part, q) for part in self.parts})

    def from_q(self, configuration: Vector) -> Vector:
        """The q (nq,) of the robot at a configuration (`nq`,) of the model; coordinates of mimic joints are ignored."""
        given = _checked("configuration", configuration, self.nq)
        q = np.empty(self.own.nq)
        for part, start in zip(self.parts, self._idx_q, strict=False):
            if part.mimics:
                continue
            own = self._from_model(part, _off_circles(given[start : start + part.nq].tolist(), part.circular))
            place, _ = self.own.places[part.joint]
            if place.stop - place.start > len(own):
                own[-1:] = math.cos(own[-1]), math.sin(own[-1])
            q[place] = own
        return q

    def rates(self, q: Vector) -> Matrix:
        """T (`nv`, nv) at q (nq,): the velocity of the model is T v."""
        q = _checked("q", q, self.own.nq)
        T = np.zeros((self.nv, self.own.nv))
        for part, row in zip(self.parts, self._idx_v, strict=False):
            block = self._block(part, q)
            _, column = self.own.places[part.joint]
            T[row : row + block.shape[0], column : column + block.shape[1]] = block
        return T

    def to_v(self, q: Vector, v: Vector) -> Vector:
        """The velocity of the model, of shape (`nv`,), at q (nq,) and v (nv,) of the robot."""
        return np.asarray(self.rates(q) @ _checked("v", v, self.own.nv))

    def from_v(self, configuration: Vector, velocity: Vector) -> Vector:
        """The v (nv,) of the robot at a configuration (`nq`,) and a velocity (`nv`,) of the model."""
        q = self.from_q(configuration)
        given = _checked("velocity", velocity, self.nv)
        v = np.empty(self.own.nv)
        for part, row in zip(self.parts, self._idx_v, strict=False):
            if part.mimics:
                continue
            mine = given[row : row + part.nv]
            _, at = self.own.places[part.joint]
            if part.ratios:
                for value, (index, multiplier, _) in zip(mine, part.ratios, strict=True):
                    if multiplier:  # of a helical joint, the angle is last
                        v[at + index] = value / multiplier
            else:
                v[at : at + part.nv] = np.linalg.solve(self._block(part, q), mine)
        return v

    def to_a(self, q: Vector, v: Vector, a: Vector) -> Vector:
        """The acceleration of the model, T a + Ṫ v of shape (`nv`,), at q (nq,), v and a (nv,) of the robot."""
        found = self.rates(q) @ _checked("a", a, self.own.nv)
        v = _checked("v", v, self.own.nv)
        for part, row in zip(self.parts, self._idx_v, strict=False):
            _, at = self.own.places[part.joint]
            if part.rotation == "xyz":
                # ω = E ȧ, so ä = E⁻¹ (ω̇ - Ė ȧ); found has E⁻¹ ω̇.
                first = part.nv - 3
                inverse = self._block(part, q)[first:, first:]
                angles = _angles(self._own_coordinates(part, q)[-4:])
                rates = np.asarray(inverse @ v[at + first : at + part.nv])
                turning = _rate_of_angle_axes(angles, rates.tolist()) @ rates
                found[row + first : row + part.nv] -= inverse @ turning
            if not (part.type.moving_frame and part.type.slides and self.at_rest):
                continue  # an angular velocity has the same rate along the axes at rest: ω × ω = 0
            n = 2 if part.type.quaternion is None else 3
            linear = np.zeros(3)
            linear[:n] = v[at : at + n]
            angular = np.array((0.0, 0.0, v[at + 2])) if n == 2 else v[at + 3 : at + 6]
            turning = np.zeros(part.nv)
            turning[:n] = np.cross(angular, linear)[:n]
            found[row : row + part.nv] += self._block(part, q) @ turning
        return np.asarray(found)

    def _own_coordinates(self, part: Part, q: Vector) -> tuple[float, ...]:
        place, _ = self.own.places[part.joint]
        own = q[place].tolist()
        if len(own) > (1 if part.mimics else len(part.type.coordinates)):
            own[-2:] = [math.atan2(own[-1], own[-2])]
        return tuple(own)

    def _in_model(self, part: Part, own: Sequence[float]) -> Sequence[float]:
        if part.ratios:
            return [multiplier * own[index] + offset for index, multiplier, offset in part.ratios]
        at = part.type.quaternion
        if at is None:
            return [value - zero for value, zero in zip(own, part.zero or (0.0,) * len(own), strict=True)]
        position = [value - zero for value, zero in zip(own[:at], part.zero[:at] or (0.0,) * at, strict=True)]
        norm = math.hypot(*own[at:])
        x, y, z, w = (value / norm for value in own[at:])
        turned = (x, y, z, w)
        if part.zero:
            turned = (_pose(part.zero[at:]).inverse() * Pose(quaternion=turned)).quaternion
        if part.turn != IDENTITY_QUATERNION:
            turn = Pose(quaternion=part.turn)
            turned = (turn.inverse() * Pose(quaternion=turned) * turn).quaternion
        if part.rotation == "quaternion":
            orientation: Sequence[float] = self._ordered(turned)
        else:
            orientation = _angles(turned) if part.rotation == "xyz" else rpy_of(Pose(quaternion=turned))
        return [*orientation, *position] if part.orientation_first else [*position, *orientation]

    def _from_model(self, part: Part, given: list[float]) -> list[float]:
        if part.ratios:
            own = [0.0] * len(part.type.coordinates)
            for value, (index, multiplier, offset) in zip(given, part.ratios, strict=True):
                if multiplier:
                    own[index] = (value - offset) / multiplier
            return own
        at = part.type.quaternion
        if at is None:
            return [value + zero for value, zero in zip(given, part.zero or (0.0,) * len(given), strict=True)]
        position, orientation = given[:at], given[at:]
        if part.orientation_first:
            orientation, position = given[: len(given) - at], given[len(given) - at :]
        if part.rotation == "quaternion":
            if self.quaternion == "wxyz":
                orientation = [*orientation[1:], orientation[0]]
            turned = _pose(orientation)
        else:
            turns = [Pose(quaternion=_about(axis, angle)) for axis, angle in enumerate(orientation)]
            turned = reduce(mul, turns if part.rotation == "xyz" else reversed(turns))
        if part.turn != IDENTITY_QUATERNION:
            turn = Pose(quaternion=part.turn)
            turned = turn * turned * turn.inverse()
        if part.zero:
            turned = _pose(part.zero[at:]) * turned
            position = [value + zero for value, zero in zip(position, part.zero, strict=False)]
        return [*position, *turned.quaternion]

    def _ordered(self, quaternion: Quaternion) -> Quaternion:
        x, y, z, w = quaternion
        return (w, x, y, z) if self.quaternion == "wxyz" else quaternion

    def _block(self, part: Part, q: Vector) -> Matrix:
        """T of one part: from the velocities of ``part.joint`` to those of the part."""
        if part.ratios:
            n = 1 if part.mimics else part.type.nv
            block = np.zeros((len(part.ratios), n))
            for row, (index, multiplier, _) in enumerate(part.ratios):
                block[row, index] = multiplier
            return block
        own = self._own_coordinates(part, q)
        of_angles = np.linalg.inv(_angle_axes(_angles(own[-4:]))) if part.rotation == "xyz" else None
        if of_angles is not None and not part.type.slides:
            return np.asarray(of_angles)
        if not self.at_rest:
            return np.eye(part.nv)
        if part.type.quaternion is None:
            c, s = math.cos(own[2]), math.sin(own[2])
            return np.array(((c, -s, 0.0), (s, c, 0.0), (0.0, 0.0, 1.0)))
        turn = rotation_matrix(Pose(quaternion=part.turn).inverse().quaternion)
        if not part.type.slides:
            return turn if part.rotation == "quaternion" else rotation_matrix(own)
        block = np.zeros((6, 6))
        block[:3, :3] = rotation_matrix(own[3:])
        along_child = part.rotation == "quaternion" and not part.orientation_first
        block[3:, 3:] = turn if along_child else block[:3, :3]
        if of_angles is not None:
            block[3:, 3:] = of_angles
        return np.roll(block, 3, axis=0) if part.orientation_first else block

    def __repr__(self) -> str:
        return f"<Coordinates: nq {self.nq}, nv {self.nv}, {len(self.names)} joints>"


def _on_circles(values: Sequence[float], circular: Sequence[int]) -> list[float]:
    """The values, with cosine and sine in the place of the angles at these indices."""
    return [
        each
        for index, value in enumerate(values)
        for each in ((math.cos(value), math.sin(value)) if index in circular else (value,))
    ]


def _off_circles(values: list[float], circular: Sequence[int]) -> list[float]:
    """The angles of `_on_circles`, from -π to π."""
    found = list(values)
    for index in circular:
        found[index : index + 2] = [math.atan2(found[index + 1], found[index])]
    return found


def _pose(quaternion: Sequence[float]) -> Pose:
    x, y, z, w = quaternion
    return Pose(quaternion=(x, y, z, w))


def _about(axis: int, angle: float) -> Quaternion:
    s, c = math.sin(angle / 2.0), math.cos(angle / 2.0)
    return s * (axis == 0), s * (axis == 1), s * (axis == 2), c


def _angles(quaternion: Sequence[float]) -> tuple[float, float, float]:
    """a, b, c with R(x, a) R(y, b) R(z, c) the rotation of a quaternion; b is from -π/2 to π/2."""
    R = rotation_matrix(quaternion)
    a = math.atan2(-R[1, 2], R[2, 2])
    s, c = math.sin(a), math.cos(a)
    return (
        a,
        math.atan2(R[0, 2], c * R[2, 2] - s * R[1, 2]),
        math.atan2(c * R[1, 0] + s * R[2, 0], c * R[1, 1] + s * R[2, 1]),
    )


def _angle_axes(angles: Sequence[float]) -> Matrix:
    """E (3, 3): the angular velocity, along the axes of the child, of rates of `_angles` is E times these."""
    _, b, c = angles
    (sb, cb), (sc, cc) = ((math.sin(each), math.cos(each)) for each in (b, c))
    return np.array(((cc * cb, sc, 0.0), (-sc * cb, cc, 0.0), (sb, 0.0, 1.0)))


def _rate_of_angle_axes(angles: Sequence[float], rates: Sequence[float]) -> Matrix:
    """Ė of `_angle_axes`."""
    _, b, c = angles
    _, db, dc = rates
    (sb, cb), (sc, cc) = ((math.sin(each), math.cos(each)) for each in (b, c))
    return np.array(
        (
            (-sc * cb * dc - cc * sb * db, cc * dc, 0.0),
            (-cc * cb * dc + sc * sb * db, -sc * dc, 0.0),
            (cb * db, 0.0, 0.0),
        )
    )


def rotation_matrix(quaternion: Sequence[float]) -> Matrix:
    """The rotation (3, 3) of a quaternion x, y, z, w of any length but 0."""
    u, w = np.array(quaternion[:3]), quaternion[3]
    x, y, z = u
    square = float(u @ u) + w * w
    cross = np.array(((0.0, -z, y), (z, 0.0, -x), (-y, x, 0.0)))
    return np.asarray(((w * w - u @ u) * np.eye(3) + 2.0 * np.outer(u, u) + 2.0 * w * cross) / square)


def homogeneous(pose: Pose) -> Matrix:
    """The pose as a matrix (4, 4)."""
    found = np.eye(4)
    found[:3, :3], found[:3, 3] = rotation_matrix(pose.quaternion), pose.xyz
    return found


def _checked(name: str, given: Vector, size: int) -> Vector:
    values = np.asarray(given, dtype=np.float64)
    if values.shape != (size,):
        raise ValueError(f"{name} has the shape {values.shape}; expected ({size},)")
    return values
