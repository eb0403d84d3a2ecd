"""The motion of a closed mechanism whose driven joints move as given."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from eurdf.kinematics.array import Indices, Matrix, Vector
from eurdf.kinematics.derived import derived
from eurdf.kinematics.evaluation import Evaluation
from eurdf.kinematics.least_solution import least_solution
from eurdf.kinematics.loop import find_loops, independent_groups, joints_of_loops, merged
from eurdf.kinematics.scale import row_scale
from eurdf.kinematics.tangent_space import TangentSpaces

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot

# Above this many velocities, groups of loops are solved one by one.
_MOST_AT_ONCE = 60


class DrivenMotion:
    """Finds the velocities of the other joints, K v = 0, that have the least norm (rad/s and m/s)."""

    def __init__(self, robot: Robot, driven: tuple[int, ...]) -> None:
        """Prepare the loops of a robot; ``driven`` are the indices in v of the driven velocities."""
        tree, loops = robot.tree, find_loops(robot)
        self._driven = np.array(driven, np.intp)
        groups = list(independent_groups(robot, driven))
        if len(groups) > 1 and tree.nv <= _MOST_AT_ONCE:
            groups = [merged(groups)]
        spaces = derived(robot, TangentSpaces)
        rows, raw = row_scale(robot, spaces.length), np.ones(tree.nv)
        self._nv = tree.nv
        self._column = np.zeros(tree.nv, np.intp)
        self._column[self._driven] = np.arange(len(driven))
        #: Of each group its evaluation by its own and by the driven velocities, both, and the ratio of their units.
        self._groups: list[tuple[Evaluation, Indices, Indices, float]] = []
        for group in groups:
            joints = joints_of_loops(robot, [loops[index] for index in group.closures])
            moving = {velocity for joint in joints for velocity in tree.moving_velocities[joint]}
            by = np.array(sorted(moving.intersection(driven)), np.intp)
            if len(by) and len(group.velocities):
                columns = group._replace(velocities=np.concatenate((group.velocities, by)))
                unit = spaces.scale[columns.velocities]
                spread = float(unit.max() / unit.min())
                self._groups.append((Evaluation(robot, columns, rows, raw), group.velocities, by, spread))

    def velocity(self, q: Vector, driven: Vector) -> Vector | None:
        """The velocity (nv,) at q (nq,) with these driven ones (k,); None if there is none, or that is in doubt."""
        v = np.zeros(self._nv)
        v[self._driven] = driven
        for evaluation, own, by, spread in self._groups:
            drive = v[by]
            if drive.any():
                solution = self._solve(evaluation, len(own), q, drive, spread)
                if solution is None:
                    return None
                v[own] = solution
        return v

    def derivative(self, q: Vector) -> Matrix | None:
        """Its derivative (nv, k) by the driven velocities; None as for `velocity`."""
        D = np.zeros((self._nv, len(self._driven)))
        D[self._driven, np.arange(len(self._driven))] = 1.0
        for evaluation, own, by, spread in self._groups:
            solution = self._solve(evaluation, len(own), q, np.eye(len(by)), spread)
            if solution is None:
                return None
            D[own[:, None], self._column[by]] = solution
        return D

    def _solve(self, evaluation: Evaluation, count: int, q: Vector, drive: Matrix, spread: float) -> Matrix | None:
        """The first velocities of a group that follow from the driven ones, (k,) or (k, …)."""
        evaluation.residual(q)
        A = evaluation.jacobian()
        norm = spread * math.sqrt(float(np.vdot(A, A)))
        return least_solution(A[:, :count], -(A[:, count:] @ drive), norm) if math.isfinite(norm) else None
