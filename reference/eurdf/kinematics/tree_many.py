"""The spanning tree at many configurations at once, in NumPy: all joints of one level of the tree together.

The joints become elementary nodes: screws, with the pose exp6(S q), and poses that coordinates state. S, the columns of
the motion subspace at zero, is what Pinocchio's joints tell; it is constant in the node's moving frame.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from eurdf.array import Indices, Matrix, Vector
from eurdf.closures import se3
from eurdf.closures.kind import RelativeMotions, RelativePoses
from eurdf.closures.se3 import cross, skew, transposed, turned
from eurdf.kinematics.tree_kinematics import MovingJoint, TreeKinematics
from eurdf.pinocchio.ancestry import between

_IDENTITY = np.eye(4)


class _Node(NamedTuple):
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

    def __init__(self, tree: TreeKinematics) -> None:
        """Take a tree of joints whose motion subspace does not depend on the configuration, or of screws in series.

        Raises:
            NotImplementedError: A joint moves in another way.
        """
        self.nq, self.nv, self.parents = tree.nq, tree.nv, list(tree.parents)
        self.nodes: list[_Node] = []
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


def _nodes(joint: MovingJoint, form: str, parent: int, first: int) -> Iterable[_Node]:
    """The nodes of a joint, numbered from ``first``, on a parent node."""
    S, idx_v = joint.subspace, joint.idx_v
    if form in ("ball", "pose"):
        yield _Node(parent, joint.placement, S, joint.idx_q, idx_v, form, np.zeros(6), 1.0)
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
        yield _Node(parent, placement, twists, joint.idx_q + column, own, kind, about / (rate or 1.0), rate)
        parent, placement = first + column, _IDENTITY


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
        """See `_Curved`."""
        return _complex_product(q, np.concatenate((np.cos(v), np.sin(v)), axis=-1))

    def difference(self, q: Matrix, other: Matrix) -> Matrix:
        """See `_Curved`."""
        turn = _complex_product(_conjugate(q), other)
        return np.asarray(np.arctan2(turn[..., 1:], turn[..., :1]))

    def integrate_derivative(self, v: Matrix) -> Matrix:
        """See `_Curved`."""
        return np.ones((*v.shape, 1))

    difference_derivative = integrate_derivative


class _Balls(_Curved):
    """Unit quaternions, x, y, z, w."""

    def integrate(self, q: Matrix, v: Matrix) -> Matrix:
        """See `_Curved`."""
        return se3.quaternion_product(q, se3.quaternion_exp(v))

    def difference(self, q: Matrix, other: Matrix) -> Matrix:
        """See `_Curved`."""
        return se3.quaternion_log(se3.quaternion_product(q * [-1.0, -1.0, -1.0, 1.0], other))

    def integrate_derivative(self, v: Matrix) -> Matrix:
        """See `_Curved`."""
        return se3.exp6_derivative(np.concatenate((np.zeros_like(v), v), axis=-1))[..., 3:, 3:]

    def difference_derivative(self, v: Matrix) -> Matrix:
        """See `_Curved`."""
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
        """See `_Curved`."""
        R, p = self.pose(q)
        v = self._twist(v)
        return self.coordinates(q, v, p + turned(R, se3.exp6(v)[1]))

    def difference(self, q: Matrix, other: Matrix) -> Matrix:
        """See `_Curved`."""
        (R, p), (R_other, p_other) = self.pose(q), self.pose(other)
        back = transposed(R)
        return se3.log6(back @ R_other, turned(back, p_other - p))[..., self.moving]

    def integrate_derivative(self, v: Matrix) -> Matrix:
        """See `_Curved`."""
        return self._block(se3.exp6_derivative(self._twist(v)))

    def difference_derivative(self, v: Matrix) -> Matrix:
        """See `_Curved`."""
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
        """See `_Poses`."""
        R = np.zeros((*q.shape[:-1], 3, 3))
        R[..., 0, 0] = R[..., 1, 1] = q[..., 2]
        R[..., 1, 0], R[..., 0, 1], R[..., 2, 2] = q[..., 3], -q[..., 3], 1.0
        return R, np.concatenate((q[..., :2], np.zeros_like(q[..., :1])), axis=-1)

    def coordinates(self, q: Matrix, v: Matrix, position: Matrix) -> Matrix:
        """See `_Poses`."""
        turn = np.concatenate((np.cos(v[..., 5:]), np.sin(v[..., 5:])), axis=-1)
        return np.concatenate((position[..., :2], _complex_product(q[..., 2:], turn)), axis=-1)


_CURVED: dict[str, type[_Curved]] = {"pair": _Pairs, "ball": _Balls, "pose": _Poses, "planar": _Planes}


def _complex_product(a: Matrix, b: Matrix) -> Matrix:
    """Products of numbers a + b i, (…, 2)."""
    real = a[..., 0] * b[..., 0] - a[..., 1] * b[..., 1]
    return np.stack((real, a[..., 0] * b[..., 1] + a[..., 1] * b[..., 0]), axis=-1)


def _conjugate(a: Matrix) -> Matrix:
    return np.asarray(a * [1.0, -1.0])


class _Chain:
    """Some nodes of a tree, level by level; a parent that is not among them is at rest at the origin.

    Row 0 of what it computes is of the origin.

    Attributes:
        row: Of each node, by number, its row.
        column_nodes: Of each column, one for each velocity of each node, the number of the node.
        velocities: Of each column the index in v.
    """

    def __init__(self, tree: TreeMany, numbers: Iterable[int]) -> None:
        level: dict[int, int] = {}
        for number in sorted(numbers):
            level[number] = level.get(tree.nodes[number - 1].parent, -1) + 1
        order = sorted(level, key=lambda number: (level[number], number))
        self.row = {0: 0, **{number: row for row, number in enumerate(order, 1)}}
        nodes = [tree.nodes[number - 1] for number in order]
        self.count = len(nodes) + 1
        parents = np.array([self.row.get(node.parent, 0) for node in nodes], dtype=np.intp)
        self._levels: list[tuple[slice, slice | Indices]] = []
        depth = [level[number] for number in order]
        for each in range(max(depth, default=-1) + 1):
            first, last = depth.index(each), len(depth) - depth[::-1].index(each)
            above = parents[first:last]
            one = slice(int(above[0]), int(above[0]) + 1)
            self._levels.append((slice(first + 1, last + 1), one if (above == above[0]).all() else above))
        self._screws = _Screws([(row, node) for row, node in enumerate(nodes) if node.form not in ("ball", "pose")])
        self._balls = [(row, node) for row, node in enumerate(nodes) if node.form in ("ball", "pose")]
        columns = [(row, number, S, v) for row, number in enumerate(order, 1) for S, v in _columns(tree, number)]
        self.column_nodes = [number for _, number, _, _ in columns]
        self.velocities = np.array([v for _, _, _, v in columns], dtype=np.intp)
        self._column_rows = np.array([row for row, _, _, _ in columns], dtype=np.intp)
        self._subspace = np.array([S for _, _, S, _ in columns]).reshape(-1, 6)
        self._slides = bool(self._subspace[:, :3].any())
        self._of_node = np.equal(np.arange(self.count)[:, None], self._column_rows).astype(np.float64)

    def place(self, q: Matrix) -> Matrix:
        """Poses (B, count, 4, 4) of the nodes' moving frames at q (B, nq)."""
        own = self._screws.poses(q, self.count - 1)
        for row, node in self._balls:
            moved = np.zeros((len(q), 4, 4))
            moved[:, 3, 3] = 1.0
            first = node.idx_q
            if node.form == "pose":
                moved[:, :3, 3] = q[:, first : first + 3]
                first += 3
            moved[:, :3, :3] = se3.rotation_of(q[:, first : first + 4])
            own[:, row] = node.placement @ moved
        poses = np.empty((len(q), self.count, 4, 4))
        poses[:, 0] = _IDENTITY
        for rows, above in self._levels:
            np.matmul(poses[:, above], own[:, rows.start - 1 : rows.stop - 1], out=poses[:, rows])
        return poses

    def twists(self, poses: Matrix) -> Matrix:
        """Of each column the twist (B, c, 6) for a unit velocity, of the point at the origin and in its axes."""
        at = poses[:, self._column_rows]
        R, S = at[..., :3, :3], self._subspace
        found = np.empty((*at.shape[:2], 6))
        angular = np.einsum("bcij,cj->bci", R, S[:, 3:], out=found[..., 3:])
        found[..., :3] = cross(at[..., :3, 3], angular)
        if self._slides:
            found[..., :3] += np.einsum("bcij,cj->bci", R, S[:, :3])
        return found

    def motions(self, poses: Matrix, v: Matrix) -> tuple[Matrix, Matrix]:
        """The twists and their derivatives (B, count, 6) of the nodes, of the point at the origin and in its axes."""
        own = self._of_node @ (self.twists(poses) * v[:, self.velocities, None])
        twists, changes = np.zeros((2, *own.shape))
        for rows, above in self._levels:
            twists[:, rows] = twists[:, above] + own[:, rows]
            changes[:, rows] = changes[:, above] + _cross6(twists[:, rows], own[:, rows])
        return twists, changes


def _columns(tree: TreeMany, number: int) -> Iterable[tuple[Vector, int]]:
    node = tree.nodes[number - 1]
    return zip(node.twists.T, node.idx_v, strict=True)


class _Screws:
    """Screws: poses placement · exp6(S q), each linear in 1, cos θ, sin θ and θ."""

    def __init__(self, nodes: Sequence[tuple[int, _Node]]) -> None:
        self.rows = np.array([row for row, _ in nodes], dtype=np.intp)
        self._q = np.array([node.idx_q for _, node in nodes], dtype=np.intp)
        self._rate = np.array([node.rate for _, node in nodes])
        self._pairs, self._angles = (
            np.array([index for index, (_, node) in enumerate(nodes) if node.form == form], dtype=np.intp)
            for form in ("pair", "angle of a pair")
        )
        parts = np.zeros((4, len(nodes), 4, 4))
        for index, (_, node) in enumerate(nodes):
            parts[:, index] = node.placement @ _screw_parts(node.about)
        self._fixed, self._cosine, self._sine, self._slide = parts
        self._slides = bool(self._slide.any())

    def poses(self, q: Matrix, count: int) -> Matrix:
        """The poses (B, count, 4, 4), with those of other nodes left empty."""
        x = q[:, self._q]
        if len(self._angles):
            x[:, self._angles] = np.arctan2(q[:, self._q[self._angles] + 1], x[:, self._angles])
        theta = x * self._rate
        cosine, sine = np.cos(theta), np.sin(theta)
        if len(self._pairs):
            cosine[:, self._pairs], sine[:, self._pairs] = x[:, self._pairs], q[:, self._q[self._pairs] + 1]
        found: Matrix = self._cosine * cosine[..., None, None]
        found += self._sine * sine[..., None, None]
        found += self._fixed
        if self._slides:
            found += self._slide * theta[..., None, None]
        if len(self.rows) == count:
            return found
        poses = np.empty((len(q), count, 4, 4))
        poses[:, self.rows] = found
        return poses


def _screw_parts(about: Vector) -> Matrix:
    """The matrices (4, 4, 4) of which exp6(S θ) is the sum, times 1, cos θ, sin θ and θ, of a unit twist S."""
    v, w = about[:3], about[3:]
    parts = np.zeros((4, 4, 4))
    fixed, cosine, sine, slide = parts
    fixed[3, 3] = 1.0
    if not w.any():
        fixed[:3, :3], slide[:3, 3] = np.eye(3), v
        return parts
    along, W, arm = np.outer(w, w), skew(w), cross(w, v)  # the axis passes through the arm
    fixed[:3, :3], cosine[:3, :3], sine[:3, :3] = along, np.eye(3) - along, W
    fixed[:3, 3], cosine[:3, 3], sine[:3, 3], slide[:3, 3] = arm, -arm, -W @ arm, w * (w @ v)
    return parts


def _cross6(a: Matrix, b: Matrix) -> Matrix:
    """The derivative (…, 6) of a twist b that moves with a."""
    linear = cross(a[..., 3:], b[..., :3]) + cross(a[..., :3], b[..., 3:])
    return np.concatenate((linear, cross(a[..., 3:], b[..., 3:])), axis=-1)


def _to_frame(poses: Matrix) -> Matrix:
    """The matrices (…, 6, 6) that see twists of the point at the origin, in its axes, from frames with these poses."""
    back, arm = transposed(poses[..., :3, :3]), skew(poses[..., :3, 3])
    found = np.zeros((*back.shape[:-2], 6, 6))
    found[..., :3, :3] = found[..., 3:, 3:] = back
    found[..., :3, 3:] = -back @ arm
    return found


@dataclass(eq=False)
class ManyPoses(RelativePoses):
    """Poses of pairs, and of what they were computed from.

    Attributes:
        q: The configurations (B, nq).
        nodes: Poses of the nodes.
        a: Poses (B, k, 4, 4) of frames A.
        b: Poses of frames B.
    """

    q: Matrix
    nodes: Matrix
    a: Matrix
    b: Matrix
    twists: tuple[Matrix, Matrix] | None = None

    def __post_init__(self) -> None:
        back = transposed(self.a[..., :3, :3])
        found = back @ self.b[..., :3, :]
        self.rotation = found[..., :3]
        self.position = found[..., 3] - turned(back, self.a[..., :3, 3])


class ManyPairs:
    """Pairs of frames A, B; plain data, which can be pickled and shared."""

    def __init__(self, tree: TreeMany, pairs: Sequence[tuple[Any, Any]], velocities: Indices) -> None:
        """Take pairs of a tree.

        Args:
            tree: The tree.
            pairs: Of each the frames A and B: the joint that moves it, and its pose (4, 4) in that.
            velocities: Indices (n,) in v of the columns of the Jacobian.
        """
        self.count, self.n = len(pairs), len(velocities)
        signs = [between(tree.parents, a.joint, b.joint) for a, b in pairs]
        joints = sorted(set().union(*signs))
        joint_of = {number: joint for joint in joints for number in tree.own[joint]}
        self._chain = chain = _Chain(tree, joint_of)
        self._rows = np.array(
            [chain.row.get(tree.node_of(end.joint), 0) for pair in zip(*pairs, strict=True) for end in pair],
            dtype=np.intp,
        )
        placements = [end.placement.homogeneous for pair in zip(*pairs, strict=True) for end in pair]
        self._placements = np.array(placements).reshape(-1, 4, 4)
        self.moving = np.unique(chain.velocities)
        # Of each pair its columns among those of the chain, their signs, and where they are among the velocities.
        wanted = {velocity: index for index, velocity in enumerate(velocities.tolist())}
        by_joint: dict[int, list[tuple[int, int]]] = {}
        for column, (number, velocity) in enumerate(zip(chain.column_nodes, chain.velocities.tolist(), strict=True)):
            if velocity in wanted:
                by_joint.setdefault(joint_of[number], []).append((column, wanted[velocity]))
        entries = [
            [(column, sign, place) for joint, sign in sorted(own.items()) for column, place in by_joint.get(joint, ())]
            for own in signs
        ]
        width = max(map(len, entries), default=0)
        self._columns = np.zeros((self.count, width), dtype=np.intp)
        self._signs = np.zeros((self.count, width, 1))
        self._places = np.full((self.count, width), -1)
        for pair, own in enumerate(entries):
            for index, (column, sign, place) in enumerate(own):
                self._columns[pair, index], self._signs[pair, index], self._places[pair, index] = column, sign, place
        self._scatters: dict[tuple[int, int, int], list[tuple[Indices, Indices]]] = {}

    @property
    def numbers(self) -> int:
        """Numbers that one element takes, roughly."""
        return (
            40 * self._chain.count + 12 * len(self._chain.velocities) + self.count * (90 + 6 * self._columns.shape[1])
        )

    def at(self, q: Matrix) -> ManyPoses:
        """The poses at q (B, nq)."""
        nodes = self._chain.place(q)
        frames = nodes[:, self._rows] @ self._placements
        return ManyPoses(q, nodes, frames[:, : self.count], frames[:, self.count :])

    def jacobian(self, at: ManyPoses, which: slice, rows: Matrix) -> Matrix:
        """The derivative (B, k r, n) by the velocities of rows (B, k, r, 6) over the twists of some pairs."""
        if at.twists is None:
            signed = self._chain.twists(at.nodes)[:, self._columns]
            signed *= self._signs
            at.twists = _to_frame(at.a), np.swapaxes(signed, -1, -2)
        to_a, twists = at.twists
        B, k, r = rows.shape[:3]
        block = (rows @ to_a[:, which]) @ twists[:, which]
        scatter = self._scatter(which, r)
        if not scatter:
            return block.reshape(B, k * r, self.n)
        K = np.zeros((B, k * r * self.n))
        block = block.reshape(B, math.prod(block.shape[1:]))
        for of_block, of_K in scatter:
            K[:, of_K] += block[:, of_block]
        return K.reshape(B, k * r, self.n)

    def _scatter(self, which: slice, r: int) -> list[tuple[Indices, Indices]]:
        """Entries of the block (k, r, width) of some pairs, and where in K (k r, n) they belong; none if all are there.

        Where a joint mimics another one of its path, several entries belong to one of K: each but the first comes in
        a later round.
        """
        key = which.start, which.stop, r
        if key not in self._scatters:
            places = self._places[which]
            k, width = places.shape
            rounds: list[tuple[list[int], list[int]]] = []
            seen: dict[int, int] = {}
            for pair in range(k):
                for row in range(r):
                    for index, place in enumerate(places[pair].tolist()):
                        if place < 0:
                            continue
                        target = (pair * r + row) * self.n + place
                        turn = seen[target] = seen.get(target, -1) + 1
                        if turn == len(rounds):
                            rounds.append(([], []))
                        rounds[turn][0].append((pair * r + row) * width + index)
                        rounds[turn][1].append(target)
            whole = width == self.n and len(rounds) == 1 and rounds[0][0] == rounds[0][1] == list(range(k * r * width))
            self._scatters[key] = (
                []
                if whole
                else [(np.array(of_block, np.intp), np.array(of_K, np.intp)) for of_block, of_K in rounds or [([], [])]]
            )
        return self._scatters[key]

    def motions(self, q: Matrix, v: Matrix) -> RelativeMotions:
        """How the pairs move at q (B, nq) while every joint keeps its velocity v (B, nv)."""
        at = self.at(q)
        twists, changes = self._chain.motions(at.nodes, v)
        a, b = self._rows[: self.count], self._rows[self.count :]
        to_b = _to_frame(at.b)
        change = changes[:, b] - changes[:, a] + _cross6(twists[:, b], twists[:, a])
        return RelativeMotions(at, turned(to_b, twists[:, b] - twists[:, a]), turned(to_b, change))
