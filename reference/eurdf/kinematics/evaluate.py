"""Residual, K and drift of groups of constraints at B configurations (adapter)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from eurdf.kinematics.array import Indices, Matrix
from eurdf.kinematics.constraint_stack import ConstraintStack
from eurdf.kinematics.derived import derived
from eurdf.kinematics.old_batch import rigid
from eurdf.kinematics.old_batch.frames import BatchFrames
from eurdf.kinematics.old_batch.stack import BatchStack
from eurdf.kinematics.old_batch.tree import BatchTree


class _Few:
    def __init__(self, robot: Any, closures: Sequence[int], velocities: Indices) -> None:
        self.closures, self.velocities = tuple(closures), velocities
        self._stack = ConstraintStack(robot.tree, [robot.constraints[i] for i in closures], velocities)
        self._memory = self._stack.memory()
        self.m, self.n = self._stack.m, len(velocities)
        self.numbers = 0
        self._last: Any = None
        self._key = b""

    def at(self, q: Matrix) -> Any:
        if len(q) == 1:
            key = q.tobytes()
            if key != self._key:
                self._last, self._key = self._stack.at(q[0], self._memory), key
            return self._last
        return [q[i : i + 1] for i in range(len(q))]

    def residual(self, at: Any) -> Matrix:
        if isinstance(at, list):
            return np.array([self.residual(self.at(q))[0] for q in at]).reshape(len(at), self.m)
        return self._stack.residual(at)[None]

    def jacobian(self, at: Any) -> Matrix:
        if isinstance(at, list):
            return np.array([self.jacobian(self.at(q))[0] for q in at]).reshape(len(at), self.m, self.n)
        if at is not self._last:
            at = self.at(at.q[None])
        return self._stack.jacobian(at)[None]

    def openings(self, at: Any) -> tuple[Matrix, Matrix]:
        states = at if isinstance(at, list) else [at]
        found = [self._stack.openings(self.at(q) if isinstance(at, list) else q) for q in states]
        both = np.array(found).reshape(len(states), len(self.closures), 2)
        return both[..., 0], both[..., 1]


class _Many:
    def __init__(self, robot: Any, closures: Sequence[int], velocities: Indices) -> None:
        self.closures, self.velocities = tuple(closures), velocities
        chosen = [robot.constraints[index] for index in closures]
        coordinates = {name: robot.tree.coordinate(name) for each in chosen for name in each.joints}
        self._stack = BatchStack(derived(robot, BatchTree), chosen, velocities, coordinates)
        self.m, self.n, self.numbers = self._stack.m, self._stack.n, self._stack.numbers
        self.moving = self._stack.moving

    def at(self, q: Matrix) -> Any:
        return self._stack.at(np.ascontiguousarray(q.T))

    def residual(self, at: Any) -> Matrix:
        return np.ascontiguousarray(self._stack.residual(at).T)

    def jacobian(self, at: Any) -> Matrix:
        return np.ascontiguousarray(np.moveaxis(self._stack.jacobian(at), -1, 0))

    def openings(self, at: Any) -> tuple[Matrix, Matrix]:
        a, b = self._stack.openings(at)
        return a.T, b.T


def evaluator(robot: Any, closures: Sequence[int], velocities: Indices, *, few: bool) -> Any:
    return (_Few if few else _Many)(robot, closures, velocities)


class _FewTree:
    def __init__(self, robot: Any) -> None:
        self._tree = robot.tree
        self.nq, self.nv = robot.tree.nq, robot.tree.nv

    def normalized(self, q: Matrix) -> Matrix:
        return np.array([self._tree.normalized(each) for each in q])

    def integrate(self, q: Matrix, v: Matrix) -> Matrix:
        if len(q) == 1:
            return self._tree.normalized(self._tree.integrate(q[0], v[0]))[None]
        return np.array([self._tree.normalized(self._tree.integrate(a, b)) for a, b in zip(q, v)])

    def difference(self, q: Matrix, other: Matrix) -> Matrix:
        if len(q) == 1:
            return self._tree.difference(q[0], other[0])[None]
        return np.array([self._tree.difference(a, b) for a, b in zip(q, other)])

    def difference_derivative(self, q: Matrix, other: Matrix) -> Matrix:
        return np.array([self._tree.difference_derivative(a, b) for a, b in zip(q, other)])


class _FewFrames:
    def __init__(self, memory: Any, count: int) -> None:
        self._memory, self._count = memory, count

    def at(self, q: Matrix) -> Any:
        if not len(q):
            return np.zeros((0, self._count, 3, 3)), np.zeros((0, self._count, 3))
        oMf = self._memory.placements(q[0])
        return (
            np.array([each.rotation for each in oMf]).reshape(1, -1, 3, 3),
            np.array([each.translation for each in oMf]).reshape(1, -1, 3),
        )

    def poses(self, at: Any) -> Any:
        return at

    def jacobians(self, at: Any) -> Matrix:
        p = at[1][0]
        rows = np.zeros((self._count, 6, 6))
        rows[:] = np.eye(6)
        x, y, z = p.T
        rows[:, 0, 4], rows[:, 0, 5], rows[:, 1, 5] = z, -y, x
        rows[:, 1, 3], rows[:, 2, 3], rows[:, 2, 4] = -z, y, -x
        return self._memory.jacobian(rows, range(self._count)).reshape(1, self._count, 6, -1)


class _ManyTree:
    def __init__(self, robot: Any) -> None:
        self._tree = derived(robot, BatchTree)
        self.nq, self.nv = robot.tree.nq, robot.tree.nv

    def normalized(self, q: Matrix) -> Matrix:
        return np.ascontiguousarray(self._tree.normalized(q.T).T)

    def integrate(self, q: Matrix, v: Matrix) -> Matrix:
        return np.ascontiguousarray(self._tree.integrate(q.T, v.T).T)

    def difference(self, q: Matrix, other: Matrix) -> Matrix:
        return np.ascontiguousarray(self._tree.difference(q.T, other.T).T)

    def difference_derivative(self, q: Matrix, other: Matrix) -> Matrix:
        nv, B = self.nv, len(q)
        J = np.empty((B, nv, nv))
        for i in range(nv):
            f = np.zeros((nv, B))
            f[i] = 1.0
            J[:, i] = self._tree.difference_derivative_times(q.T, other.T, f).T
        return J


class _ManyFrames:
    def __init__(self, frames: BatchFrames) -> None:
        self._frames = frames

    def at(self, q: Matrix) -> Any:
        return q.T, self._frames.place(q.T)

    def poses(self, at: Any) -> Any:
        q, place = at
        B = q.shape[1]
        found = self._frames.poses(place, B)
        F = len(found)
        R = np.array([np.moveaxis(each, -1, 0) for each, _ in found]).reshape(F, B, 3, 3)
        p = np.array([each.T for _, each in found]).reshape(F, B, 3)
        return np.swapaxes(R, 0, 1), np.swapaxes(p, 0, 1)

    def jacobians(self, at: Any) -> Matrix:
        q, place = at
        found = self._frames.jacobians(q, place)
        return (
            np.array([np.moveaxis(each, -1, 0) for each in found])
            .reshape(-1, q.shape[1], 6, len(found and found[0][0]))
            .swapaxes(0, 1)
        )


def few_tree(robot: Any) -> Any:
    return _FewTree(robot)


def many_tree(robot: Any) -> Any:
    return derived(robot, _ManyTree)


def log3(R: Matrix) -> Matrix:
    return np.moveaxis(rigid.log3(np.moveaxis(R, (-2, -1), (0, 1))), 0, -1)


def log3_derivative(w: Matrix) -> Matrix:
    return np.moveaxis(rigid.jacobian_log3(np.moveaxis(w, -1, 0)), (0, 1), (-2, -1))


def frames(robot: Any, names: Sequence[str], *, few: bool) -> Any:
    if few:
        return _FewFrames(robot.tree.frames(names).memory(), len(names))
    return _ManyFrames(BatchFrames(robot, derived(robot, BatchTree), names))
