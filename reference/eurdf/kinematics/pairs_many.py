"""Relative poses of pairs of frames and their Jacobians at many configurations at once: a level of the tree at a time.

Arrays have the elements first, except for those of the nodes: they have them last, so that products with what is
constant are products of large matrices.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Sequence
from functools import cached_property
from typing import Any

import numpy as np

from eurdf.array import Indices, Matrix, Vector
from eurdf.closures.kind import RelativeMotions, RelativePoses
from eurdf.closures.se3 import cross, rotation_of, skew, turned
from eurdf.kinematics.tree_many import IDENTITY, Node, TreeMany
from eurdf.pinocchio.ancestry import between, nodes_between
from eurdf.pinocchio.tree_few import as_slice


class _Subtree:
    """Some nodes of a tree, level by level; a parent that is not among them is at rest at the origin.

    Row 0 of what it computes is of the origin.

    Attributes:
        row: Of each node, by number, its row.
        count: Number of rows.
        column_nodes: Of each column, one for each velocity of each node, the number of the node.
        velocities: Of each column the index in v.
    """

    def __init__(self, tree: TreeMany, numbers: Iterable[int]) -> None:
        level: dict[int, int] = {}
        for number in sorted(numbers):
            level[number] = level.get(tree.nodes[number - 1].parent, -1) + 1
        order = sorted(level, key=lambda number: (level[number], tree.nodes[number - 1].form in _BALL_FORMS, number))
        self.row = {0: 0, **{number: row for row, number in enumerate(order, 1)}}
        self.count = len(order) + 1
        # Of the screws, and of the balls, of each level: rows, rows of the parents, which kind, and which of these.
        self._levels: list[tuple[slice, slice | Indices, bool, slice]] = []
        nodes: tuple[list[Node], list[Node]] = [], []
        for (_, of_balls), own in itertools.groupby(order, lambda n: (level[n], tree.nodes[n - 1].form in _BALL_FORMS)):
            members = [tree.nodes[number - 1] for number in own]
            alike, first = nodes[of_balls], 1 + sum(map(len, nodes))
            above = np.array([self.row.get(node.parent, 0) for node in members], dtype=np.intp)
            one = slice(int(above[0]), int(above[0]) + 1)
            self._levels.append(
                (
                    slice(first, first + len(members)),
                    one if (above == above[0]).all() else above,
                    of_balls,
                    slice(len(alike), len(alike) + len(members)),
                )
            )
            alike.extend(members)
        self._screws, self._balls = _ScrewNodes(nodes[0]), _BallNodes(nodes[1])
        columns = [
            (row, number, S, velocity)
            for row, number in enumerate(order, 1)
            for S, velocity in zip(tree.nodes[number - 1].twists.T, tree.nodes[number - 1].idx_v, strict=True)
        ]
        self.column_nodes = [number for _, number, _, _ in columns]
        self.velocities = np.array([velocity for _, _, _, velocity in columns], dtype=np.intp)
        rows = np.array([row for row, _, _, _ in columns], dtype=np.intp)
        self._column_rows = as_slice(rows)
        subspace = np.array([S for _, _, S, _ in columns]).reshape(-1, 1, 2, 3)
        self._slides = bool(subspace[:, :, 0].any())
        self._subspace = subspace if self._slides else subspace[:, :, 1:]
        self._of_node = np.equal(np.arange(self.count)[:, None], rows).astype(np.float64)

    def place(self, q: Matrix) -> Matrix:
        """Poses (count, 3, 4, B) of the nodes' moving frames at q (B, nq)."""
        poses = np.empty((self.count, 3, 4, len(q)))
        poses[0] = IDENTITY[:3, :, None]
        screws, balls = self._screws.moves(q), self._balls.moves(q)
        for rows, above, of_balls, own in self._levels:
            if of_balls:
                self._balls.place(own, balls, poses[above], poses[rows])
            else:
                self._screws.place(own, screws, poses[above], poses[rows])
        return poses

    def twists(self, poses: Matrix) -> Matrix:
        """Of each column the twist for a unit velocity, of the origin and in its axes; then zero (c + 1, 6, B)."""
        at = poses[self._column_rows]
        seen = self._subspace @ at[:, :, :3]
        twists = np.empty((len(at) + 1, 6, at.shape[-1]))
        twists[-1] = 0.0
        found, angular, p = twists[:-1], seen[:, :, -1], at[:, :, 3]
        found[:, 3:] = angular
        for x, y, z in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
            found[:, x] = p[:, y] * angular[:, z] - p[:, z] * angular[:, y]
        if self._slides:
            found[:, :3] += seen[:, :, 0]
        return twists

    def motions(self, poses: Matrix, v: Matrix) -> tuple[Matrix, Matrix]:
        """The twists and their derivatives (B, count, 6) of the nodes, of the point at the origin and in its axes."""
        own = self._of_node @ (_elements_first(self.twists(poses)[:-1]) * v[:, self.velocities, None])
        twists, changes = np.zeros((2, *own.shape))
        for rows, above, _, _ in self._levels:
            twists[:, rows] = twists[:, above] + own[:, rows]
            changes[:, rows] = changes[:, above] + _cross6(twists[:, rows], own[:, rows])
        return twists, changes


class _ScrewNodes:
    """Screws: poses placement · exp6(S θ), each linear in 1, cos θ, sin θ and θ."""

    def __init__(self, nodes: Sequence[Node]) -> None:
        self._q = np.array([node.idx_q for node in nodes], dtype=np.intp)
        self._rate = np.array([node.rate for node in nodes])[:, None]
        self._pairs, self._angles = (
            np.array([index for index, node in enumerate(nodes) if node.form == form], dtype=np.intp)
            for form in ("pair", "angle of a pair")
        )
        parts = np.array([node.placement @ _screw_parts(node.about) for node in nodes]).reshape(-1, 4, 4, 4)
        slide = parts[:, 3, :, 3]
        self._slides = bool(slide.any())
        by_column = np.swapaxes(parts[:, :3], -1, -2).reshape(-1, 12, 4)  # of 1, cos and sin
        self._parts = np.concatenate((by_column, slide[:, None]) if self._slides else (by_column,), axis=1)[:, None]

    def moves(self, q: Matrix) -> tuple[Matrix, Matrix, Matrix]:
        """cos θ, sin θ and θ (n, 1, 1, B) at q (B, nq)."""
        x = np.ascontiguousarray(q[:, self._q].T)
        if len(self._angles):
            x[self._angles] = np.arctan2(q[:, self._q[self._angles] + 1].T, x[self._angles])
        theta = x * self._rate
        cosine, sine = np.cos(theta), np.sin(theta)
        if len(self._pairs):
            cosine[self._pairs], sine[self._pairs] = x[self._pairs], q[:, self._q[self._pairs] + 1].T
        return cosine[:, None, None], sine[:, None, None], theta[:, None]

    def place(self, own: slice, moves: tuple[Matrix, Matrix, Matrix], above: Matrix, poses: Matrix) -> None:
        """Set the poses (n, 3, 4, B) of some of the screws, where their parents' are ``above``."""
        cosine, sine, theta = moves
        parts = self._parts[own] @ above
        np.multiply(parts[:, :, 4:8], cosine[own], out=poses)
        poses += parts[:, :, :4]
        part = parts[:, :, 8:12]
        part *= sine[own]
        poses += part
        if self._slides:
            poses[:, :, 3] += parts[:, :, 12] * theta[own]


class _BallNodes:
    """Balls, with or without a position of their own."""

    def __init__(self, nodes: Sequence[Node]) -> None:
        self._placements = np.array([node.placement.T for node in nodes]).reshape(-1, 1, 4, 4)
        turns = [node.idx_q + (3 if node.form == "pose" else 0) for node in nodes]
        self._quaternions = np.array([range(first, first + 4) for first in turns], dtype=np.intp).reshape(-1, 4)
        self._moving = np.array([node.form == "pose" for node in nodes], dtype=bool)

    def moves(self, q: Matrix) -> tuple[Matrix, Matrix]:
        """Rotations (n, 3, 3, B) and positions (n, 3, B) at q (B, nq)."""
        if not len(self._quaternions):
            return q, q
        R = np.ascontiguousarray(np.moveaxis(rotation_of(q[:, self._quaternions]), 0, -1))
        p = np.moveaxis(q[:, self._quaternions[:, :3] - 3], 0, -1) * self._moving[:, None, None]
        return R, p

    def place(self, own: slice, moves: tuple[Matrix, Matrix], above: Matrix, poses: Matrix) -> None:
        R, p = moves[0][own], moves[1][own]
        rest = self._placements[own] @ above
        np.einsum("nijb,njkb->nikb", rest[:, :, :3], R, out=poses[:, :, :3])
        poses[:, :, 3] = rest[:, :, 3]
        if self._moving[own].any():
            poses[:, :, 3] += np.einsum("nijb,njb->nib", rest[:, :, :3], p)


_BALL_FORMS = ("ball", "pose")


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


def _elements_first(array: Matrix) -> Matrix:
    return np.ascontiguousarray(np.moveaxis(array, -1, 0))


def _cross6(a: Matrix, b: Matrix) -> Matrix:
    """The derivative (…, 6) of a twist b that moves with a."""
    linear = cross(a[..., 3:], b[..., :3]) + cross(a[..., :3], b[..., 3:])
    return np.concatenate((linear, cross(a[..., 3:], b[..., 3:])), axis=-1)


class ManyPoses(RelativePoses):
    """Poses of pairs, and of what they were computed from.

    Attributes:
        nodes: Poses (count, 3, 4, B) of the nodes.
        frames: Poses (2 k, 3, 4, B) of frames A, then of frames B.
        twists: The twists (B, k, 6, …) of their columns, once they are computed.
    """

    def __init__(self, nodes: Matrix, frames: Matrix) -> None:
        self.nodes, self.frames = nodes, frames
        k = len(frames) // 2
        a, between_ = frames[:k], frames[k:].copy()
        between_[:, :, 3] -= a[:, :, 3]
        found = _elements_first(np.einsum("kijb,kilb->kjlb", a[:, :, :3], between_))
        self.rotation, self.position = found[..., :3], found[..., 3]
        self.twists: Matrix | None = None

    @cached_property
    def a(self) -> tuple[Matrix, Matrix]:
        """The inverse rotations (B, k, 3, 3) and the origins (B, k, 3) of frames A."""
        return _inverse_rotations(self.frames[: len(self.frames) // 2])

    @cached_property
    def b(self) -> tuple[Matrix, Matrix]:
        """Those of frames B."""
        return _inverse_rotations(self.frames[len(self.frames) // 2 :])


def _inverse_rotations(frames: Matrix) -> tuple[Matrix, Matrix]:
    found = np.ascontiguousarray(frames.transpose(3, 0, 2, 1))
    return found[:, :, :3], found[:, :, 3]


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
        self._parents, self._ends = tree.parents, [(a.joint, b.joint) for a, b in pairs]
        joint_of = {number: joint for joint in nodes_between(tree.parents, self._ends) for number in tree.own[joint]}
        self._chain = chain = _Subtree(tree, joint_of)
        self._rows = np.array(
            [chain.row.get(tree.node_of(end.joint), 0) for pair in zip(*pairs, strict=True) for end in pair],
            dtype=np.intp,
        )
        placements = [end.placement.homogeneous.T for pair in zip(*pairs, strict=True) for end in pair]
        self._placements = np.array(placements).reshape(-1, 1, 4, 4)
        # Of each joint its columns among those of the chain, and where they are among the velocities.
        wanted = {velocity: index for index, velocity in enumerate(velocities.tolist())}
        self._by_joint: dict[int, list[tuple[int, int]]] = {}
        for column, (number, velocity) in enumerate(zip(chain.column_nodes, chain.velocities.tolist(), strict=True)):
            if velocity in wanted:
                self._by_joint.setdefault(joint_of[number], []).append((column, wanted[velocity]))

    @cached_property
    def _entries(self) -> tuple[Indices, Matrix, Indices | None, list[tuple[int, int, int]]]:
        """Of each pair its columns among those of the chain, the last one zero, and their signs.

        Then of each column (k, n) of K which of these it is, None if all are in their order, and what is added to it
        where a joint mimics another one of its path: the pair, and the columns of the pair and of K.

        They take much memory where many pairs have long paths, and the poses do without them.
        """
        entries = [
            [
                (column, sign, place)
                for joint, sign in sorted(between(self._parents, a, b).items())
                for column, place in self._by_joint.get(joint, ())
            ]
            for a, b in self._ends
        ]
        whole = all([place for _, _, place in own] == list(range(self.n)) for own in entries)
        width = max(map(len, entries), default=0) + (not whole)
        columns, chosen = np.full((self.count, width), -1), np.full((self.count, self.n), width - 1)
        signs, added = np.ones((self.count, width, 1, 1)), []
        for pair, own in enumerate(entries):
            for index, (column, sign, place) in enumerate(own):
                columns[pair, index], signs[pair, index] = column, sign
                if whole:
                    continue
                if chosen[pair, place] == width - 1:
                    chosen[pair, place] = index
                else:
                    added.append((pair, index, place))
        return columns, signs, None if whole else chosen, added

    @property
    def numbers(self) -> int:
        """Numbers that one element takes, roughly."""
        width = int(self._entries[0].shape[1])
        return 40 * self._chain.count + 12 * len(self._chain.velocities) + self.count * (90 + 6 * width)

    def at(self, q: Matrix) -> ManyPoses:
        """The poses at q (B, nq)."""
        nodes = self._chain.place(q)
        return ManyPoses(nodes, self._placements @ nodes[self._rows])

    def jacobian(self, at: ManyPoses, which: slice, rows: Matrix) -> Matrix:
        """The derivative (B, k r, n) by the velocities of rows (B, k, r, 6) over the twists of some pairs."""
        columns, signs, chosen, added = self._entries
        if at.twists is None:
            twists = self._chain.twists(at.nodes)[columns]
            twists *= signs
            at.twists = np.ascontiguousarray(twists.transpose(3, 0, 2, 1))
        B, k, r = rows.shape[:3]
        back, origin = at.a
        # The rows over the twists of the point at the common origin, in its axes.
        seen = (np.ascontiguousarray(rows).reshape(B, k, 2 * r, 3) @ back[:, which]).reshape(B, k, r, 6)
        seen[..., 3:] -= cross(seen[..., :3], origin[:, which, None])
        block = seen @ at.twists[:, which]
        if chosen is None:
            return block.reshape(B, k * r, self.n)
        width = block.shape[-1]
        of_block = (np.arange(k * r) * width).reshape(k, r, 1) + chosen[which, None]
        K: Matrix = block.reshape(B, k * r * width)[:, of_block.ravel()].reshape(B, k, r, self.n)
        for pair, column, place in added:
            if which.start <= pair < which.stop:
                K[:, pair - which.start, :, place] += block[:, pair - which.start, :, column]
        return K.reshape(B, k * r, self.n)

    def motions(self, q: Matrix, v: Matrix) -> RelativeMotions:
        """How the pairs move at q (B, nq) while every joint keeps its velocity v (B, nv)."""
        at = self.at(q)
        twists, changes = self._chain.motions(at.nodes, v)
        a, b = self._rows[: self.count], self._rows[self.count :]
        relative = twists[:, b] - twists[:, a]
        change = changes[:, b] - changes[:, a] + _cross6(twists[:, b], twists[:, a])
        back, origin = at.b
        return RelativeMotions(at, *(_seen_from(back, origin, each) for each in (relative, change)))


def _seen_from(back: Matrix, origin: Matrix, twists: Matrix) -> Matrix:
    """Twists (B, k, 6) of the point at the common origin, in its axes, as frames with these inverse poses see them."""
    linear = twists[..., :3] + cross(twists[..., 3:], origin)
    return np.concatenate((turned(back, linear), turned(back, twists[..., 3:])), axis=-1)
