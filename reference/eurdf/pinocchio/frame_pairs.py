"""Relative poses of pairs of frames, and their Jacobians, by two methods.

Through a `pin.Data` of the whole model, which takes some 8 nv³ numbers, and along the joints between the frames alone,
in time and memory linear in their number.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
import pinocchio as pin

Vector = npt.NDArray[np.float64]
Matrix = npt.NDArray[np.float64]
Indices = npt.NDArray[np.intp]


class Site(NamedTuple):
    """Where a frame is fixed to.

    Attributes:
        joint: Index of the joint; 0 is the universe.
        placement: Pose of the frame in the joint, `pin.SE3`.
    """

    joint: int
    placement: Any


Pair = tuple[Site, Site]


class FramePairs:
    """Pairs of frames A, B of one model, and what does not depend on a configuration. Threads may share it."""

    def __init__(self, model: pin.Model, pairs: Sequence[Pair], velocities: Indices | None) -> None:
        """``velocities`` (n,) are the indices in v of the columns of the Jacobian, all if None."""
        self.model = model
        self.pairs = pairs
        self.velocities = velocities

    def memory(self, data: pin.Data | None = None) -> DataMemory | PathMemory:
        """Memory to compute in: ``data``, of the whole model, or without it the joints between the frames alone."""
        # Mimic joints have columns of their own in Pinocchio's Jacobians, which only the paths add to their leaders'.
        # Without velocities, Jacobians of Pinocchio 4.1 read memory that is not their own.
        if data is None or not self.model.nv or self.model.nv < self.model.nvExtended:
            return PathMemory(self)
        return DataMemory(self, data)

    def motions(self, q: Vector, v: Vector, data: pin.Data) -> tuple[list[Any], list[Any], list[Any]]:
        """See `eurdf.kinematics.tree_kinematics.FramePairs`.

        With V and A the twists and spatial accelerations of the frames, each in its own axes, and M = ᴬM_B, the twist
        of B in A is ξ = V_B - Ad(M⁻¹) V_A, and ξ̇ = A_B - Ad(M⁻¹) A_A + ξ × Ad(M⁻¹) V_A.
        """
        pin.forwardKinematics(self.model, data, q, v, np.zeros(self.model.nv))
        placements, twists, accelerations = [], [], []
        for a, b in self.pairs:
            oMa, twist_a, acceleration_a = _motion(data, a)
            oMb, twist_b, acceleration_b = _motion(data, b)
            aMb = oMa.actInv(oMb)
            carried = aMb.actInv(twist_a)
            twist = twist_b - carried
            placements.append(aMb)
            twists.append(twist)
            accelerations.append(acceleration_b - aMb.actInv(acceleration_a) + twist.cross(carried))
        return placements, twists, accelerations

    @cached_property
    def constraints(self) -> tuple[Any, list[Any], Any]:
        """For each pair a constraint model of all six rows, also where only positions matter: they turn with A.

        As Pinocchio's list, as Python's, and with constraint data to copy, which is faster than making it.
        """
        constraints, datas = pin.StdVec_RigidConstraintModel(), pin.StdVec_RigidConstraintData()
        for a, b in self.pairs:
            constraint = pin.RigidConstraintModel(
                pin.ContactType.CONTACT_6D, self.model, *a, *b, pin.ReferenceFrame.LOCAL
            )
            constraints.append(constraint)
            datas.append(constraint.createData())
        return constraints, list(constraints), datas

    @cached_property
    def joints(self) -> list[tuple[int, int, Any, Any, slice]]:
        """Of each joint between frames: its index, its parent, its placement, itself, and its columns in J."""
        model, found, first = self.model, [], 0
        for joint in sorted(set().union(*self._signs)):
            moving = model.joints[joint]
            columns = slice(first, first + moving.nvExtended)
            found.append((joint, self._parents[joint], pin.SE3(model.jointPlacements[joint]), moving, columns))
            first = columns.stop
        return found

    @cached_property
    def columns(self) -> list[tuple[Indices, Vector, Indices, bool]]:
        """Of each pair its columns in J, their signs, their columns in K, and whether one of these occurs twice.

        Columns of velocities that were not requested are left out.
        """
        wanted = range(self.model.nv) if self.velocities is None else self.velocities.tolist()
        column = {velocity: index for index, velocity in enumerate(wanted)}
        moved_by = {
            joint: list(zip(range(columns.start, columns.stop), itertools.count(moving.idx_v)))
            for joint, _, _, moving, columns in self.joints
        }
        found = []
        for signs in self._signs:
            entries = [
                (in_J, sign, column[velocity])
                for joint, sign in sorted(signs.items())
                for in_J, velocity in moved_by[joint]
                if velocity in column
            ]
            in_J, sign, in_K = ([entry[k] for entry in entries] for k in range(3))
            twice = len(set(in_K)) < len(in_K)  # where a joint mimics another one of the path
            found.append((np.array(in_J, np.intp), np.array(sign), np.array(in_K, np.intp), twice))
        return found

    @cached_property
    def _parents(self) -> list[int]:
        return list(self.model.parents.tolist())

    @cached_property
    def _signs(self) -> list[dict[int, float]]:
        """Of each pair the joints between the frames: +1 for those that move B against A, -1 for the others."""
        parents, found = self._parents, []
        for (joint_a, _), (joint_b, _) in self.pairs:
            signs = {}
            while joint_a != joint_b:
                if joint_a > joint_b:  # a parent has a lower index than its child
                    signs[joint_a], joint_a = -1.0, parents[joint_a]
                else:
                    signs[joint_b], joint_b = 1.0, parents[joint_b]
            found.append(signs)
        return found


class DataMemory:
    """A `pin.Data`, for small models without mimic joints: nearly all is done by Pinocchio."""

    def __init__(self, pairs: FramePairs, data: pin.Data) -> None:
        self._model, self._data = pairs.model, data
        self._constraints, models, datas = pairs.constraints
        self._datas = pin.StdVec_RigidConstraintData(datas)
        self._each = list(zip(models, self._datas, strict=True))
        everything = pairs.velocities is None or len(pairs.velocities) == self._model.nv
        self._velocities = None if everything else pairs.velocities
        self._J: Matrix | None = None

    def placements(self, q: Vector) -> list[Any]:
        """ᴬM_B of each pair at q (nq,)."""
        pin.computeJointJacobians(self._model, self._data, q)
        for constraint, data in self._each:
            constraint.calc(self._model, self._data, data)
        self._J = None
        return [data.c1Mc2 for _, data in self._each]

    def jacobian(self, rows: Matrix, which: Sequence[int]) -> Matrix:
        """See `eurdf.kinematics.tree_kinematics.PairMemory`."""
        if self._J is None:
            J = pin.getConstraintsJacobian(self._model, self._data, self._constraints, self._datas)
            self._J = J.reshape(len(self._each), 6, self._model.nv)  # of the twist of A against B
        J = self._J if len(which) == len(self._J) else self._J[which]
        K = np.matmul(-rows, J)
        K = K.reshape(K.shape[0] * K.shape[1], self._model.nv)
        return K if self._velocities is None else np.asarray(K[:, self._velocities])


class PathMemory:
    """The joints between the frames alone, seen from where they leave the rest of the tree."""

    def __init__(self, pairs: FramePairs) -> None:
        self._pairs = pairs
        self._datas = [moving.createData() for _, _, _, moving, _ in pairs.joints]
        self._oMi: dict[int, Any] = {}
        self._oMa: list[Any] = []
        self._J: Matrix | None = None

    def placements(self, q: Vector) -> list[Any]:
        """ᴬM_B of each pair at q (nq,)."""
        still = pin.SE3.Identity()
        placements = self._oMi = {}
        for (joint, parent, placement, moving, _), data in zip(self._pairs.joints, self._datas, strict=True):
            moving.calc(data, q)
            placements[joint] = placements.get(parent, still) * placement * data.M
        self._oMa = [placements.get(a.joint, still) * a.placement for a, _ in self._pairs.pairs]
        self._J = None
        return [
            oMa.actInv(placements.get(b.joint, still) * b.placement)
            for oMa, (_, b) in zip(self._oMa, self._pairs.pairs, strict=True)
        ]

    def jacobian(self, rows: Matrix, which: Sequence[int]) -> Matrix:
        """See `eurdf.kinematics.tree_kinematics.PairMemory`."""
        if self._J is None:
            self._J = self._jacobian()
        n = self._pairs.model.nv if self._pairs.velocities is None else len(self._pairs.velocities)
        K = np.zeros((*rows.shape[:2], n))
        for own, index, part in zip(rows, which, K, strict=True):
            in_J, signs, in_K, twice = self._pairs.columns[index]
            block = own @ self._oMa[index].toActionMatrixInverse() @ (self._J[:, in_J] * signs)
            if twice:
                np.add.at(part.T, in_K, block.T)
            else:
                part[:, in_K] = block
        return K.reshape(K.shape[0] * K.shape[1], n)

    def _jacobian(self) -> Matrix:
        """The world Jacobian (6, …) of the joints between the frames, each with columns of its own."""
        joints = self._pairs.joints
        J = np.zeros((6, joints[-1][-1].stop if joints else 0))
        for (joint, _, _, _, columns), data in zip(joints, self._datas, strict=True):
            J[:, columns] = self._oMi[joint].toActionMatrix() @ data.S.reshape(6, -1)
        return J


def _motion(data: pin.Data, site: Site) -> tuple[Any, Any, Any]:
    """Placement in the world of a frame, and its twist and spatial acceleration in its own axes."""
    joint, placement = site
    return data.oMi[joint] * placement, placement.actInv(data.v[joint]), placement.actInv(data.a[joint])
