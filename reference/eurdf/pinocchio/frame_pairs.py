"""Relative poses of pairs of frames, and their Jacobians, in two ways.

Through a `pin.Data` of the whole model, which takes some 8 nv³ numbers, and along the joints between the frames alone,
in time and memory linear in their number.
"""

from __future__ import annotations

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


class DataPairs:
    """Through a `pin.Data`, for small models without mimic joints: nearly all is done by Pinocchio."""

    def __init__(self, model: pin.Model, pairs: Sequence[Pair], velocities: Indices | None, data: pin.Data) -> None:
        """``velocities`` (n,) are indices in v, all if None; ``data`` is of the model."""
        self._model, self._data = model, data
        self._constraints, self._datas = pin.StdVec_RigidConstraintModel(), pin.StdVec_RigidConstraintData()
        for a, b in pairs:
            # Also where only positions matter all six rows: they turn with A.
            self._constraints.append(
                pin.RigidConstraintModel(pin.ContactType.CONTACT_6D, model, *a, *b, pin.ReferenceFrame.LOCAL)
            )
            self._datas.append(self._constraints[-1].createData())
        self._each = list(zip(self._constraints, self._datas, strict=True))
        self._velocities = None if velocities is None or len(velocities) == model.nv else velocities
        self._J: Matrix | None = None

    def placements(self, q: Vector) -> list[Any]:
        """ᴬM_B of each pair at q (nq,)."""
        pin.computeJointJacobians(self._model, self._data, q)
        for constraint, data in self._each:
            constraint.calc(self._model, self._data, data)
        self._J = None
        return [data.c1Mc2 for _, data in self._each]

    def jacobian(self, rows: Matrix, which: Sequence[int]) -> Matrix:
        """See `eurdf.kinematics.tree_kinematics.FramePairs`."""
        if self._J is None:
            J = pin.getConstraintsJacobian(self._model, self._data, self._constraints, self._datas)
            self._J = J.reshape(len(self._each), 6, -1)  # of the twist of A against B
        J = self._J if len(which) == len(self._J) else self._J[which]
        K = np.matmul(-rows, J)
        K = K.reshape(K.shape[0] * K.shape[1], -1)
        return K if self._velocities is None else np.asarray(K[:, self._velocities])


class PathPairs:
    """Along the joints between the frames, seen from where they leave the rest of the tree."""

    def __init__(self, model: pin.Model, pairs: Sequence[Pair], velocities: Indices | None) -> None:
        """``velocities`` (n,) are indices in v, all if None."""
        parents = model.parents.tolist()
        self._pairs = pairs
        self._signs = [_signs(a.joint, b.joint, parents) for a, b in pairs]
        self._joints: list[tuple[int, int, Any, Any, Any, slice]] = []
        self._moved_by: dict[int, tuple[range, range]] = {}  # columns in J and velocities, by joint
        first = 0
        for joint in sorted(set().union(*self._signs)):
            moving = model.joints[joint]
            columns = slice(first, first + moving.nvExtended)
            placement = pin.SE3(model.jointPlacements[joint])
            self._joints.append((joint, parents[joint], placement, moving, moving.createData(), columns))
            self._moved_by[joint] = range(first, columns.stop), range(moving.idx_v, moving.idx_v + moving.nvExtended)
            first = columns.stop
        self._J = np.zeros((6, first))
        self._oMa: list[Any] = []
        self._velocities = range(model.nv) if velocities is None else velocities.tolist()

    @cached_property
    def _columns(self) -> list[tuple[Indices, Vector, Indices, bool]]:
        """Of each pair its columns in J, their signs, their columns in K, and whether one of these occurs twice.

        Columns of velocities that were not asked for are left out.
        """
        column = {velocity: index for index, velocity in enumerate(self._velocities)}
        found = []
        for signs in self._signs:
            entries = [
                (in_J, sign, column[velocity])
                for joint, sign in sorted(signs.items())
                for in_J, velocity in zip(*self._moved_by[joint], strict=True)
                if velocity in column
            ]
            in_J, sign, in_K = ([entry[k] for entry in entries] for k in range(3))
            twice = len(set(in_K)) < len(in_K)  # where a joint mimics another one of the path
            found.append((np.array(in_J, np.intp), np.array(sign), np.array(in_K, np.intp), twice))
        return found

    def placements(self, q: Vector) -> list[Any]:
        """ᴬM_B of each pair at q (nq,)."""
        placements: dict[int, Any] = {}
        still = pin.SE3.Identity()
        for joint, parent, placement, moving, data, columns in self._joints:
            moving.calc(data, q)
            oMi = placements[joint] = placements.get(parent, still) * placement * data.M
            self._J[:, columns] = oMi.toActionMatrix() @ data.S.reshape(6, -1)
        self._oMa = [placements.get(a.joint, still) * a.placement for a, _ in self._pairs]
        return [
            oMa.actInv(placements.get(b.joint, still) * b.placement)
            for oMa, (_, b) in zip(self._oMa, self._pairs, strict=True)
        ]

    def jacobian(self, rows: Matrix, which: Sequence[int]) -> Matrix:
        """See `eurdf.kinematics.tree_kinematics.FramePairs`."""
        K = np.zeros((*rows.shape[:2], len(self._velocities)))
        for own, index, part in zip(rows, which, K, strict=True):
            in_J, signs, in_K, twice = self._columns[index]
            block = own @ self._oMa[index].toActionMatrixInverse() @ (self._J[:, in_J] * signs)
            if twice:
                np.add.at(part.T, in_K, block.T)
            else:
                part[:, in_K] = block
        return K.reshape(K.shape[0] * K.shape[1], K.shape[2])


def _signs(joint_a: int, joint_b: int, parents: Sequence[int]) -> dict[int, float]:
    """The joints between two, without the common ancestor: +1 for those that move B against A, -1 for the others."""
    signs = {}
    while joint_a != joint_b:
        if joint_a > joint_b:  # a parent has a lower index than its child
            signs[joint_a], joint_a = -1.0, parents[joint_a]
        else:
            signs[joint_b], joint_b = 1.0, parents[joint_b]
    return signs
