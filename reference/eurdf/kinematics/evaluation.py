"""Residual and Jacobian of one group of loops, free of unit, over and over.

Two ways to the same numbers: through a `pin.Data` of the whole model, which takes some 8 nv³ numbers, and along the
joints of the loops alone, in time and memory linear in their number.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
import pinocchio as pin

from eurdf.kinematics.array import Indices, Matrix, Vector
from eurdf.kinematics.loop import Loop, LoopGroup, find_loops, joints_of_loops
from eurdf.kinematics.residual import residual_rows, rows_of_twist

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot


class Evaluation(ABC):
    """The residual of a group of loops and its derivative, at one configuration after the other.

    Attributes:
        group: The group.
        row_scale: Factors (m,) that make the rows of its residual free of unit.
        unit: Unit (n,) of each of its velocities.
    """

    def __init__(self, group: LoopGroup, loops: Sequence[Loop], row_scale: Vector, velocity_scale: Vector) -> None:
        """``loops``, ``row_scale`` (nc,) and ``velocity_scale`` (nv,) are those of the whole robot."""
        self.group = group
        self.row_scale = row_scale[group.rows]
        self.unit = velocity_scale[group.velocities]
        self._spatial = [loops[index].spatial for index in group.closures]
        self._aMb: list[Any] = []

    @cached_property
    def _scale(self) -> Matrix:
        """Factors (m, n) that make the derivative free of unit."""
        with np.errstate(over="ignore", invalid="ignore"):
            return self.row_scale[:, None] * self.unit

    def residual(self, q: Vector) -> Vector:
        """Rows (m,) of the group at q (nq,), m and rad."""
        self._aMb = self._closures(q)
        return np.concatenate([residual_rows(*each) for each in zip(self._aMb, self._spatial, strict=True)])

    def jacobian(self) -> Matrix:
        """Derivative (m, n) of the rows by the velocities, where `residual` last was, free of unit."""
        K = self._jacobian([rows_of_twist(*each) for each in zip(self._aMb, self._spatial, strict=True)])
        K *= self._scale
        return K

    def openings(self) -> list[tuple[float, float]]:
        """How far each closure is open where `residual` last was: distance, m, and angle, rad; 0 for a 3d one."""
        return [
            (math.hypot(*aMb.translation), math.hypot(*pin.log3(aMb.rotation)) if spatial else 0.0)
            for aMb, spatial in zip(self._aMb, self._spatial, strict=True)
        ]

    @abstractmethod
    def _closures(self, q: Vector) -> list[Any]:
        """ᴬM_B of each closure at q, and the joint Jacobians there."""

    @abstractmethod
    def _jacobian(self, rows: Sequence[Matrix]) -> Matrix:
        """K (m, n), in units: the ``rows`` (6 or 3, 6) of each closure times the twist of B against A, seen from A."""


class DataEvaluation(Evaluation):
    """Through a `pin.Data`, for small robots without mimic joints: nearly all is done by Pinocchio."""

    def __init__(
        self,
        robot: Robot,
        group: LoopGroup,
        loops: Sequence[Loop],
        row_scale: Vector,
        velocity_scale: Vector,
        data: pin.Data,
    ) -> None:
        """``data`` is of the robot's model. Groups may share it that go from one configuration to the next together."""
        super().__init__(group, loops, row_scale, velocity_scale)
        model = self._model = robot.model
        self._data = data
        # Also for a 3d closure all six rows: its residual turns with A.
        self._constraints, self._datas = pin.StdVec_RigidConstraintModel(), pin.StdVec_RigidConstraintData()
        for index in group.closures:
            self._constraints.append(_in_6d(model, robot.constraint_models[index]))
            self._datas.append(self._constraints[-1].createData())
        self._pairs = list(zip(self._constraints, self._datas, strict=True))
        self._rows = np.zeros((len(self._pairs), 6, 6))
        rows = [6 * i + k for i, spatial in enumerate(self._spatial) for k in range(6 if spatial else 3)]
        self._kept = None if all(self._spatial) else np.array(rows, dtype=np.intp)
        self._columns = None if len(group.velocities) == model.nv else group.velocities

    def _closures(self, q: Vector) -> list[Any]:
        pin.computeJointJacobians(self._model, self._data, q)
        for constraint, data in self._pairs:
            constraint.calc(self._model, self._data, data)
        return [data.c1Mc2 for _, data in self._pairs]

    def _jacobian(self, rows: Sequence[Matrix]) -> Matrix:
        J = pin.getConstraintsJacobian(self._model, self._data, self._constraints, self._datas)
        for index, place in enumerate(rows):
            self._rows[index, : len(place)] = -place  # Pinocchio's is the Jacobian of the twist of A against B
        K = np.matmul(self._rows, J.reshape(len(rows), 6, -1)).reshape(6 * len(rows), -1)
        if self._kept is not None:
            K = K[self._kept]
        return np.asarray(K if self._columns is None else K[:, self._columns])


class PathEvaluation(Evaluation):
    """Along the joints of the loops, seen from where they leave the rest of the tree."""

    def __init__(
        self, robot: Robot, group: LoopGroup, loops: Sequence[Loop], row_scale: Vector, velocity_scale: Vector
    ) -> None:
        """For the arguments see `Evaluation`."""
        super().__init__(group, loops, row_scale, velocity_scale)
        model, loops = robot.model, [loops[index] for index in group.closures]
        parents = model.parents.tolist()
        self._joints: list[tuple[int, int, Any, Any, Any, slice]] = []
        first = 0
        for joint in joints_of_loops(loops, parents):
            joint_model = model.joints[joint]
            columns = slice(first, first + joint_model.nvExtended)
            placement = pin.SE3(model.jointPlacements[joint])
            self._joints.append((joint, parents[joint], placement, joint_model, joint_model.createData(), columns))
            first = columns.stop
        self._loops = loops
        constraints = [robot.constraint_models[index] for index in group.closures]
        self._frames = [
            (found.joint1_id, pin.SE3(found.joint1_placement), found.joint2_id, pin.SE3(found.joint2_placement))
            for found in constraints
        ]
        self._J = np.zeros((6, first))
        self._oMa: list[Any] = []

    @cached_property
    def _columns(self) -> list[tuple[Indices, Vector, Indices, bool]]:
        """Of each loop its columns in J, their signs, their columns in K, and whether one of these occurs twice.

        Columns of joints that are held are left out.
        """
        of_joint = {joint: range(columns.start, columns.stop) for joint, _, _, _, _, columns in self._joints}
        column = {velocity: index for index, velocity in enumerate(self.group.velocities.tolist())}
        found = []
        for path in (loop.path for loop in self._loops):
            in_J = [index for joint in path.joints for index in of_joint[joint]]
            moving = [k for k, velocity in enumerate(path.velocities.tolist()) if velocity in column]
            in_K = np.array([column[path.velocities[k]] for k in moving], dtype=np.intp)
            found.append((np.array(in_J, dtype=np.intp)[moving], path.signs[moving], in_K, path.mimics))
        return found

    def _closures(self, q: Vector) -> list[Any]:
        placements: dict[int, Any] = {}
        still = pin.SE3.Identity()
        for joint, parent, placement, joint_model, joint_data, columns in self._joints:
            joint_model.calc(joint_data, q)
            oMi = placements[joint] = placements.get(parent, still) * placement * joint_data.M
            self._J[:, columns] = oMi.toActionMatrix() @ joint_data.S.reshape(6, -1)
        self._oMa = [placements.get(a, still) * aMc for a, aMc, _, _ in self._frames]
        return [
            oMa.actInv(placements.get(b, still) * bMc)
            for oMa, (_, _, b, bMc) in zip(self._oMa, self._frames, strict=True)
        ]

    def _jacobian(self, rows: Sequence[Matrix]) -> Matrix:
        K, first = np.zeros((len(self.group.rows), len(self.group.velocities))), 0
        for oMa, place, (in_J, signs, in_K, mimics) in zip(self._oMa, rows, self._columns, strict=True):
            part = K[first : first + len(place)]
            block = place @ oMa.toActionMatrixInverse() @ (self._J[:, in_J] * signs)
            if mimics:
                np.add.at(part.T, in_K, block.T)
            else:
                part[:, in_K] = block
            first += len(place)
        return K


def evaluations(
    robot: Robot, groups: Sequence[LoopGroup], row_scale: Vector, velocity_scale: Vector, data: pin.Data | None
) -> list[Evaluation]:
    """An evaluation of each group.

    Args:
        robot: The robot.
        groups: The groups.
        row_scale: Factors (nc,) that make the rows of the residual free of unit.
        velocity_scale: Unit (nv,) of each velocity.
        data: What to compute in, for a robot without mimic joints; without it, along the loops alone.
    """
    loops = find_loops(robot)
    if data is None:
        return [PathEvaluation(robot, group, loops, row_scale, velocity_scale) for group in groups]
    return [DataEvaluation(robot, group, loops, row_scale, velocity_scale, data) for group in groups]


def _in_6d(model: pin.Model, constraint: Any) -> Any:
    return pin.RigidConstraintModel(
        pin.ContactType.CONTACT_6D,
        model,
        constraint.joint1_id,
        constraint.joint1_placement,
        constraint.joint2_id,
        constraint.joint2_placement,
        pin.ReferenceFrame.LOCAL,
    )
