"""The spanning tree at many configurations at once, in NumPy: its elementary motions, and steps of its coordinates.

The joints become elementary nodes: screws, with the pose exp6(S q), and poses that coordinates state. S, the columns of
the motion subspace at zero, is what Pinocchio's joints tell; it is constant in the node's moving frame.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np

from eurdf.array import Matrix, Vector
from eurdf.closures import se3
from eurdf.closures.se3 import transposed, turned
from eurdf.pinocchio.tree import MovingJoint, Tree

IDENTITY = np.eye(4)


class Node(NamedTuple):
    """An elementary motion: its parent node, 0 for the world, the pose (4, 4) at rest there, and how it moves.

    Attributes:
        parent: The parent's number; nodes are numbered from 1.
        placement: Pose (4, 4) of the node's frame at rest in the parent's moving frame.
        twists: S (6, n) in its moving frame: one column of a screw, three or six of a ball, with or without position.
        idx_q: Index of its coordinate, or of the first.
        idx_v: Index (n,) in v of each column of its twists.
        form: What its coordinate is: a ``number``, cos and sin (``pair``), the ``angle of a pair`` of another joint, a
            quaternion (``ball``), or a position and a quaternion (``pose``).
        about: The unit twist (6,) of a screw per rad, or per m where it only slides.
        rate: rad or m per unit of the coordinate.
    """

    parent: int
    placement: Matrix
    twists: Matrix
    idx_q: int
    idx_v: tuple[int, ...]
    form: str
    about: Vector
    rate: float


class TreeMany:
    """A spanning tree; plain data, which can be pickled and shared.

    Attributes:
        nq: Number of coordinates.
        nv: Number of velocities.
        parents: Of each joint its parent.
        nodes: The elementary motions, from number 1; a parent comes before its children.
        own: Of each joint its nodes.
    """

    def __init__(self, tree: Tree) -> None:
        """Take a tree of joints whose motion subspace does not depend on the configuration, or of screws in series.

        Raises:
            NotImplementedError: A joint moves in another way.
        """
        self.nq, self.nv, self.parents = tree.nq, tree.nv, list(tree.parents)
        self.nodes: list[Node] = []
        self.own: list[range] = [range(0)]
        self._curved: list[_Curved] = []
        curved: dict[str, list[MovingJoint]] = {}
        pairs: set[int] = set()
        last = [0]  # of each joint its last node
        for joint in tree.moving_joints:
            form = _form(joint)
            if form == "number" and joint.idx_q in pairs:
                form = "angle of a pair"
            if joint.nq != len(joint.idx_v) and joint.nq:
                curved.setdefault(form, []).append(joint)
            if form == "pair":
                pairs.add(joint.idx_q)
            first = len(self.nodes) + 1
            self.nodes.extend(_nodes(joint, form, last[joint.parent], first))
            self.own.append(range(first, len(self.nodes) + 1))
            last.append(len(self.nodes) if len(self.own[-1]) else last[joint.parent])
        self._last = last
        self._curved = [_CURVED[form](joints) for form, joints in curved.items()]
        flat = [
            (joint.idx_q + k, velocity)
            for joint in tree.moving_joints
            if joint.nq == len(joint.idx_v)
            for k, velocity in enumerate(joint.idx_v)
        ]
        self._flat_q, self._flat_v = (np.array([each[k] for each in flat], dtype=np.intp) for k in range(2))

    def node_of(self, joint: int) -> int:
        """The node whose frame is the moving frame of a joint."""
        return self._last[joint]

    def integrate(self, q: Matrix, v: Matrix) -> Matrix:
        """The configurations (B, nq) that v (B, nv) leads to from q in unit time, normalized."""
        moved = np.array(q)
        moved[:, self._flat_q] += v[:, self._flat_v]
        for joints in self._curved:
            moved[:, joints.q] = joints.normalized(joints.integrate(q[:, joints.q], v[:, joints.v]))
        return moved

    def difference(self, q: Matrix, other: Matrix) -> Matrix:
        """The velocities (B, nv) that lead from q to the other configurations in unit time."""
        v = np.empty((len(q), self.nv))
        v[:, self._flat_v] = other[:, self._flat_q] - q[:, self._flat_q]
        for joints in self._curved:
            v[:, joints.v] = joints.difference(q[:, joints.q], other[:, joints.q])
        return v

    def integrate_derivative(self, q: Matrix, v: Matrix) -> Matrix:
        """Derivative (B, nv, nv) of q ⊕ v by v."""
        J = np.tile(np.eye(self.nv), (len(v), 1, 1))
        for joints in self._curved:
            J[:, joints.v[:, :, None], joints.v[:, None, :]] = joints.integrate_derivative(v[:, joints.v])
        return J

    def difference_derivative(self, q: Matrix, other: Matrix) -> Matrix:
        """Derivative (B, nv, nv) of `difference` by the motion of the other configurations."""
        J = np.tile(np.eye(self.nv), (len(q), 1, 1))
        for joints in self._curved:
            v = joints.difference(q[:, joints.q], other[:, joints.q])
            J[:, joints.v[:, :, None], joints.v[:, None, :]] = joints.difference_derivative(v)
        return J

    def difference_derivative_times(self, q: Matrix, other: Matrix, forces: Matrix) -> Matrix:
        """Jᵀ f (B, nv) of this derivative J and forces (B, nv)."""
        times = np.array(forces)
        for joints in self._curved:
            v = joints.difference(q[:, joints.q], other[:, joints.q])
            times[:, joints.v] = (forces[:, joints.v][..., None, :] @ joints.difference_derivative(v))[..., 0, :]
        return times

    def normalized(self, q: Matrix) -> Matrix:
        """The configurations with quaternions, and cosines and sines, of unit length."""
        result = np.array(q)
        for joints in self._curved:
            result[:, joints.q] = joints.normalized(q[:, joints.q])
        return result


def _form(joint: MovingJoint) -> str:
    n = len(joint.idx_v)
    match joint.nq, n:
        case (2, 1):
            return "pair"
        case (4, 3):
            return "planar" if joint.subspace[:3].any() else "ball"
        case (7, 6):
            return "pose"
        case (nq, _) if nq == n or (nq == 0 and n == 1):
            return "number"
    raise NotImplementedError(f"joint {joint.name} has {joint.nq} coordinates and {n} velocities")


def _nodes(joint: MovingJoint, form: str, parent: int, first: int) -> Iterable[Node]:
    """The nodes of a joint, numbered from ``first``, on a parent node."""
    S, idx_v = joint.subspace, joint.idx_v
    if form in ("ball", "pose"):
        yield Node(parent, joint.placement, S, joint.idx_q, idx_v, form, np.zeros(6), 1.0)
        return
    placement = joint.placement
    for column in range(len(idx_v)):
        about, own = S[:, column], idx_v[column : column + 1]
        twists = S[:, column : column + 1]
        rate = float(np.linalg.norm(about[3:])) or float(np.linalg.norm(about[:3]))
        kind = form
        if form == "planar":  # its velocity is that of its moving frame, which is the frame of the last node
            kind = "pair" if column == 2 else "number"
            twists, own = (S, idx_v) if column == 2 else (S[:, :0], ())
        yield Node(parent, placement, twists, joint.idx_q + column, own, kind, about / (rate or 1.0), rate)
        parent, placement = first + column, IDENTITY


class _Curved:
    """Joints of one form whose coordinates are not numbers to add to.

    Attributes:
        q: Indices (j, …) in q of their coordinates.
        v: Indices (j, …) in v of their velocities.
    """

    def __init__(self, joints: Sequence[MovingJoint]) -> None:
        self.q = np.array([range(joint.idx_q, joint.idx_q + joint.nq) for joint in joints], dtype=np.intp)
        self.v = np.array([joint.idx_v for joint in joints], dtype=np.intp)

    def integrate(self, q: Matrix, v: Matrix) -> Matrix:
        """The coordinates (B, j, …) that velocities lead to in unit time."""
        raise NotImplementedError

    def difference(self, q: Matrix, other: Matrix) -> Matrix:
        """The velocities that lead from q to the other coordinates in unit time."""
        raise NotImplementedError

    def integrate_derivative(self, v: Matrix) -> Matrix:
        """The derivative (B, j, n, n) of `integrate` by the velocities."""
        raise NotImplementedError

    def difference_derivative(self, v: Matrix) -> Matrix:
        """The derivative of `difference`, which is v, by the motion of the other coordinates."""
        raise NotImplementedError

    def normalized(self, q: Matrix) -> Matrix:
        """The coordinates with the numbers that state a rotation of unit length."""
        n = self.turns
        return np.concatenate((q[..., :-n], q[..., -n:] / se3.norm(q[..., -n:])[..., None]), axis=-1)

    turns = 4  # the number of coordinates, the last, that state a rotation


class _Pairs(_Curved):
    """Turns about an axis, as cos and sin."""

    turns = 2

    def integrate(self, q: Matrix, v: Matrix) -> Matrix:
        return _complex_product(q, np.concatenate((np.cos(v), np.sin(v)), axis=-1))

    def difference(self, q: Matrix, other: Matrix) -> Matrix:
        turn = _complex_product(_conjugate(q), other)
        return np.asarray(np.arctan2(turn[..., 1:], turn[..., :1]))

    def integrate_derivative(self, v: Matrix) -> Matrix:
        return np.ones((*v.shape, 1))

    difference_derivative = integrate_derivative


class _Balls(_Curved):
    """Unit quaternions, x, y, z, w."""

    def integrate(self, q: Matrix, v: Matrix) -> Matrix:
        return se3.quaternion_product(q, se3.quaternion_exp(v))

    def difference(self, q: Matrix, other: Matrix) -> Matrix:
        return se3.quaternion_log(se3.quaternion_product(q * [-1.0, -1.0, -1.0, 1.0], other))

    def integrate_derivative(self, v: Matrix) -> Matrix:
        return se3.exp6_derivative(np.concatenate((np.zeros_like(v), v), axis=-1))[..., 3:, 3:]

    def difference_derivative(self, v: Matrix) -> Matrix:
        return se3.log3_derivative(v)


class _Poses(_Curved):
    """Positions x, y, z, m, and unit quaternions x, y, z, w."""

    moving = np.arange(6)  # of the components of a twist those that they have

    def pose(self, q: Matrix) -> tuple[Matrix, Matrix]:
        """Rotations (B, j, 3, 3) and positions (B, j, 3)."""
        return se3.rotation_of(q[..., 3:]), q[..., :3]

    def coordinates(self, q: Matrix, v: Matrix, position: Matrix) -> Matrix:
        """The coordinates at these positions, turned by v."""
        return np.concatenate((position, se3.quaternion_product(q[..., 3:], se3.quaternion_exp(v[..., 3:]))), axis=-1)

    def integrate(self, q: Matrix, v: Matrix) -> Matrix:
        R, p = self.pose(q)
        v = self._twist(v)
        return self.coordinates(q, v, p + turned(R, se3.exp6(v)[1]))

    def difference(self, q: Matrix, other: Matrix) -> Matrix:
        (R, p), (R_other, p_other) = self.pose(q), self.pose(other)
        back = transposed(R)
        return se3.log6(back @ R_other, turned(back, p_other - p))[..., self.moving]

    def integrate_derivative(self, v: Matrix) -> Matrix:
        return self._block(se3.exp6_derivative(self._twist(v)))

    def difference_derivative(self, v: Matrix) -> Matrix:
        return self._block(se3.log6_derivative(self._twist(v)))

    def _twist(self, v: Matrix) -> Matrix:
        twist = np.zeros((*v.shape[:-1], 6))
        twist[..., self.moving] = v
        return twist

    def _block(self, J: Matrix) -> Matrix:
        return J[..., self.moving[:, None], self.moving]


class _Planes(_Poses):
    """x and y, m, and a turn about z as cos and sin."""

    turns, moving = 2, np.array([0, 1, 5])

    def pose(self, q: Matrix) -> tuple[Matrix, Matrix]:
        R = np.zeros((*q.shape[:-1], 3, 3))
        R[..., 0, 0] = R[..., 1, 1] = q[..., 2]
        R[..., 1, 0], R[..., 0, 1], R[..., 2, 2] = q[..., 3], -q[..., 3], 1.0
        return R, np.concatenate((q[..., :2], np.zeros_like(q[..., :1])), axis=-1)

    def coordinates(self, q: Matrix, v: Matrix, position: Matrix) -> Matrix:
        turn = np.concatenate((np.cos(v[..., 5:]), np.sin(v[..., 5:])), axis=-1)
        return np.concatenate((position[..., :2], _complex_product(q[..., 2:], turn)), axis=-1)


_CURVED: dict[str, type[_Curved]] = {"pair": _Pairs, "ball": _Balls, "pose": _Poses, "planar": _Planes}


def _complex_product(a: Matrix, b: Matrix) -> Matrix:
    """Products of numbers a + b i, (…, 2)."""
    real = a[..., 0] * b[..., 0] - a[..., 1] * b[..., 1]
    return np.stack((real, a[..., 0] * b[..., 1] + a[..., 1] * b[..., 0]), axis=-1)


def _conjugate(a: Matrix) -> Matrix:
    return np.asarray(a * [1.0, -1.0])
