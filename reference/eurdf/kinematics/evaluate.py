"""Residual, K and drift of constraints, and the tree, at B configurations: the leading axis of all arrays.

Few configurations are evaluated one after the other by Pinocchio, which is fast for one; many by NumPy at once. Both
give the same numbers. What overflows is inf or NaN.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from eurdf.array import Indices, Matrix, Vector
from eurdf.closures.coupling import Couplings
from eurdf.closures.kind import ClosureKind, RelativePoses
from eurdf.closures.se3 import IDENTITY_ROTATION, velocity_of_origin
from eurdf.kinematics.pairs_many import ManyPairs
from eurdf.kinematics.tree_many import TreeMany
from eurdf.mechanism.constraint import Constraint, Coupling
from eurdf.pinocchio.tree_few import FewPairs, Pair, as_slice, poses_once

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot
    from eurdf.pinocchio.tree import Tree


class SameKind(NamedTuple):
    """The closures of one kind.

    Attributes:
        kind: Evaluates them.
        fixed: What it prepared.
        members: Their indices among the constraints.
        pairs: Which pairs of frames are theirs.
        rows: Which rows of the residual.
        m: Their number.
    """

    kind: type[ClosureKind]
    fixed: Any
    members: slice | Indices
    pairs: slice
    rows: slice | Indices
    m: int


class State(NamedTuple):
    """Constraints at some configurations.

    Attributes:
        q: The configurations (B, nq).
        poses: ᴬM_B of the frames of the closures.
        by_kind: Those of each kind.
    """

    q: Matrix
    poses: Any
    by_kind: list[RelativePoses]


class _ByConfiguration(ABC):
    """Evaluates something at configurations; for few, what it found at the last one is kept.

    Solvers ask for values and derivatives at one configuration in different places.
    """

    _few: bool
    _key: bytes | None = None  # of the configuration of the last state of one element
    _last: Any = None

    def fresh(self, q: Matrix) -> Any:
        """The state at q (B, nq), which the caller leaves as it is; it is not kept."""
        return self._state(q)

    def at(self, q: Matrix) -> Any:
        """The state at q (B, nq)."""
        if not self._few or len(q) != 1:
            return self._state(np.array(q))
        key = q.tobytes()
        if key != self._key:
            self._last, self._key = self._state(q.copy()), key
        return self._last

    @abstractmethod
    def _state(self, q: Matrix) -> Any:
        """The state at q (B, nq), which the caller leaves as it is."""


class Evaluator(_ByConfiguration):
    """Some constraints, and the velocities by which K has columns.

    One by Pinocchio has memory of its own, for one thread at a time; one by NumPy is plain data.

    Attributes:
        closures: Indices of the constraints among those of the robot, in the order of their rows.
        velocities: Indices (n,) in v of the columns of K.
        m: Number of rows.
        n: Number of columns.
        sites: Frames A and B of each closure, kind by kind; of an evaluator for few configurations.
        groups: The closures of each kind.
        couplings: The couplings, their indices among the constraints, and their rows; None if there are none.
    """

    def __init__(
        self,
        tree: Tree,
        constraints: Sequence[Constraint],
        velocities: Indices,
        *,
        few: bool,
        sites: Mapping[int, Pair] | None = None,
    ) -> None:
        """Take constraints, in the order of their rows, and indices in v; for few configurations at once, or many.

        ``sites`` are the frames of constraints, by index, that are not between bodies.

        Raises:
            NotImplementedError: A constraint is of a kind that has no mathematics.
        """
        self.closures: tuple[int, ...] = tuple(range(len(constraints)))
        self.velocities, self.n = velocities, len(velocities)
        self._count, self.m = len(constraints), 0
        sites = {} if sites is None else sites
        members: dict[type[Constraint], list[int]] = {}
        first: list[int] = []  # of each constraint its first row
        for index, constraint in enumerate(constraints):
            members.setdefault(type(constraint), []).append(index)
            first.append(self.m)
            self.m += constraint.rows
        self.sites: list[Pair] = []
        self._pair_of: dict[int, int] = {}  # of each constraint with a pair
        self.groups: list[SameKind] = []
        self.couplings: tuple[Couplings, slice | Indices, slice | Indices] | None = None
        for kind, found in members.items():
            own: list[Any] = [constraints[index] for index in found]
            rows = np.array([first[each] + row for each in found for row in range(own[0].rows)], dtype=np.intp)
            indices, chosen = as_slice(np.array(found, dtype=np.intp)), as_slice(rows)
            if kind is Coupling:
                self.couplings = Couplings(own, tree.coordinate, velocities), indices, chosen
                continue
            if not issubclass(kind, ClosureKind):
                raise NotImplementedError(f"constraint '{own[0].name}' has the type '{kind.type}', which has no kind")
            pairs = slice(len(self.sites), len(self.sites) + len(own))
            for index, each in zip(found, own, strict=True):
                self._pair_of[index] = len(self.sites)
                self.sites.append(sites[index] if index in sites else (tree.site(each.a), tree.site(each.b)))
            self.groups.append(SameKind(kind, kind.prepare(own), indices, pairs, chosen, len(rows)))
        # The rows of the residual are those of one kind, in order.
        self._is_plain = self.couplings is None and len(self.groups) == 1
        self._tree: Tree | None = tree
        self._few = few
        if not few:
            self._pairs = ManyPairs(tree.cached(TreeMany), self.sites, velocities)
            self.sites, self._tree = [], None  # what is Pinocchio's cannot be sent to another process

    @cached_property
    def _pairs(self) -> Any:  # memory is made when it is first used
        assert self._tree is not None
        return _few_pairs(self._tree, self.sites, self.velocities)

    @property
    def is_by_pinocchio(self) -> bool:
        """Whether Pinocchio evaluates the constraints, and frames can be moved."""
        return isinstance(self._pairs, FewPairs)

    @property
    def numbers(self) -> int:
        """Numbers that the residual and K of one element take, roughly."""
        return self.numbers_of_residual + 3 * self.m * self.n + 2 * self.m * self.m

    @property
    def numbers_of_residual(self) -> int:
        """Numbers that the residual of one element takes, roughly."""
        return int(self._pairs.numbers)

    def at_once(self, q: Matrix) -> State:
        """The constraints at q (1, nq), by Pinocchio, sooner than memory to evaluate them in is made."""
        assert self._tree is not None
        return self._state(q, poses_once(self._tree.model, self._tree.parents, self.sites, q[0]))

    def place(self, index: int, rotation: Matrix, position: Vector) -> None:
        """Move frame A of a constraint to another pose in its joint, for the configurations that follow."""
        self._pairs.place(self._pair_of[index], rotation, position)
        self._key = None

    def residual(self, at: State) -> Matrix:
        """The residual (B, m), m and rad, to read: it may be kept with the poses."""
        B = len(at.q)
        if self._is_plain:
            (group,), (poses,) = self.groups, at.by_kind
            return group.kind.residual(poses, group.fixed).reshape(B, self.m)
        r = np.empty((B, self.m))
        for group, poses in zip(self.groups, at.by_kind, strict=True):
            r[:, group.rows] = group.kind.residual(poses, group.fixed).reshape(B, group.m)
        if self.couplings is not None:
            couplings, _, rows = self.couplings
            r[:, rows] = couplings.residual(at.q)
        return r

    def jacobian(self, at: State) -> Matrix:
        """K (B, m, n), the derivative of the residual by the velocities."""
        jacobian: Callable[..., Matrix] = self._pairs.jacobian
        if self._is_plain:
            (group,), (poses,) = self.groups, at.by_kind
            return jacobian(at.poses, group.pairs, group.kind.jacobian(poses, group.fixed))
        K = np.empty((len(at.q), self.m, self.n))
        for group, poses in zip(self.groups, at.by_kind, strict=True):
            K[:, group.rows] = jacobian(at.poses, group.pairs, group.kind.jacobian(poses, group.fixed))
        if self.couplings is not None:
            couplings, _, rows = self.couplings
            K[:, rows] = couplings.K
        return K

    def drift(self, q: Matrix, v: Matrix) -> Matrix:
        """r̈ = K̇ v (B, m) at q (B, nq) while every joint keeps its velocity v (B, nv)."""
        d = np.zeros((len(q), self.m))  # that of couplings is zero
        if not self.groups:
            return d
        if not self._few or len(q) != 1:
            motions = self._pairs.motions(q, v)
        else:  # poses that the residual and K have used
            at = self.at(q)
            motions = self._pairs.motions(at.q, v)._replace(poses=at.poses)
        for group in self.groups:
            own = motions if self._is_plain else motions.of(group.pairs)
            d[:, group.rows] = group.kind.drift(own, group.fixed).reshape(len(q), group.m)
        return d

    def openings(self, at: State) -> tuple[Matrix, Matrix]:
        """How far each constraint is open, m and rad, (B, c) each."""
        if self._is_plain:
            (group,), (poses,) = self.groups, at.by_kind
            return group.kind.opening(poses, group.fixed)
        lengths, angles = np.empty((2, len(at.q), self._count))
        for group, poses in zip(self.groups, at.by_kind, strict=True):
            lengths[:, group.members], angles[:, group.members] = group.kind.opening(poses, group.fixed)
        if self.couplings is not None:
            couplings, members, _ = self.couplings
            lengths[:, members], angles[:, members] = couplings.opening(at.q)
        return lengths, angles

    def _state(self, q: Matrix, poses: RelativePoses | None = None) -> State:
        poses = self._pairs.at(q) if poses is None else poses
        return State(q, poses, [poses] if self._is_plain else [poses.of(group.pairs) for group in self.groups])


def evaluator(
    robot: Robot, closures: Sequence[int] | None = None, velocities: Indices | None = None, *, few: bool
) -> Evaluator:
    """An evaluator, made anew.

    Args:
        robot: The robot.
        closures: Indices of the constraints, in the order of their rows; all if None.
        velocities: Indices (n,) in v of the columns of K; all if None.
        few: Whether it is for few configurations at once.
    """
    closures = range(len(robot.constraints)) if closures is None else closures
    velocities = np.arange(robot.tree.nv) if velocities is None else velocities
    made = Evaluator(robot.tree, [robot.constraints[index] for index in closures], velocities, few=few)
    made.closures = tuple(closures)
    return made


def _few_pairs(tree: Tree, sites: Sequence[Pair], velocities: Indices) -> FewPairs | ManyPairs:
    try:
        return FewPairs(tree.model, tree.parents, sites, velocities)
    except NotImplementedError:
        return ManyPairs(tree.cached(TreeMany), sites, velocities)


class Frames(_ByConfiguration):
    """Named frames: their poses in the world, and their Jacobians. As for an `Evaluator`, few or many."""

    def __init__(self, pairs: Any, *, few: bool) -> None:
        """Take pairs of the world and the frames."""
        self._pairs, self._few = pairs, few

    def _state(self, q: Matrix) -> Any:
        return self._pairs.at(q)

    def poses(self, at: Any) -> tuple[Matrix, Matrix]:
        """The rotations (B, F, 3, 3) and the origins (B, F, 3), m."""
        return at.rotation, at.position

    def jacobians(self, at: Any) -> Matrix:
        """Of each frame (B, F, 6, nv) the velocity of its origin and its angular velocity, by v, in world axes."""
        p = at.position
        rows = np.zeros((*p.shape[:2], 6, 6))
        rows[..., :3, :], rows[..., 3:, 3:] = velocity_of_origin(p), IDENTITY_ROTATION
        return self.rows(at, rows).reshape(*p.shape[:2], 6, self._pairs.n)

    def rows(self, at: Any, rows: Matrix, which: slice | None = None) -> Matrix:
        """The derivative (B, F r, n) of rows (B, F, r, 6) over the twists of the point at the world's origin.

        They are those of all frames, or of some.
        """
        K: Matrix = self._pairs.jacobian(at, slice(0, rows.shape[1]) if which is None else which, rows)
        return K


def frames(robot: Robot, names: Sequence[str], *, few: bool) -> Frames:
    """Frames, named by a link, a joint (its frame on the child side), or a frame of the description.

    Raises:
        ValueError: A frame is unknown, or two different frames have this name.
    """
    return frames_at(robot.tree, robot.tree.frame_sites(names), few=few)


def frames_at(tree: Tree, sites: Sequence[Any], velocities: Indices | None = None, *, few: bool) -> Frames:
    """Frames at some sites of the tree, with derivatives by some velocities, or all."""
    pairs, velocities = [(tree.world, site) for site in sites], np.arange(tree.nv) if velocities is None else velocities
    if few:
        return Frames(_few_pairs(tree, pairs, velocities), few=True)
    return Frames(ManyPairs(tree.cached(TreeMany), pairs, velocities), few=False)


class TreeFew:
    """The spanning tree at few configurations, one after the other; as `TreeMany`."""

    def __init__(self, tree: Tree) -> None:
        self.nq, self.nv = tree.nq, tree.nv
        self._tree = tree

    def integrate(self, q: Matrix, v: Matrix) -> Matrix:
        tree = self._tree
        if len(q) != 1:
            there = _each(tree.integrate, self.nq, q, v)
            return there if self.nq == self.nv else _each(tree.normalized, self.nq, there)
        moved = tree.integrate(q[0], v[0])
        # A quaternion, and a cosine and a sine, are one number more than they have velocities.
        return (moved if self.nq == self.nv else tree.normalized(moved))[None]

    def difference(self, q: Matrix, other: Matrix) -> Matrix:
        if len(q) == 1:
            return self._tree.difference(q[0], other[0])[None]
        return _each(self._tree.difference, self.nv, q, other)

    def integrate_derivative(self, q: Matrix, v: Matrix) -> Matrix:
        return _each(self._tree.integrate_derivative, (self.nv, self.nv), q, v)

    def difference_derivative(self, q: Matrix, other: Matrix) -> Matrix:
        return _each(self._tree.difference_derivative, (self.nv, self.nv), q, other)

    def difference_derivative_times(self, q: Matrix, other: Matrix, forces: Matrix) -> Matrix:
        return (forces[:, None] @ self.difference_derivative(q, other))[:, 0]

    def normalized(self, q: Matrix) -> Matrix:
        return _each(self._tree.normalized, self.nq, q)


def _each(function: Callable[..., Matrix], shape: int | tuple[int, ...], *arrays: Matrix) -> Matrix:
    """The results of a function of one element after the other, which have the given shape."""
    if len(arrays[0]) == 1:
        return function(*[array[0] for array in arrays])[None]
    found = [function(*each) for each in zip(*arrays, strict=True)]
    return np.array(found) if found else np.empty((0, *np.atleast_1d(shape)))


def few_tree(robot: Robot) -> TreeFew:
    """The tree for few configurations."""
    return robot.tree.cached(TreeFew)


def many_tree(robot: Robot) -> TreeMany:
    """The tree for many configurations."""
    return robot.tree.cached(TreeMany)
