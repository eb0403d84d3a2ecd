"""Relative poses of pairs of frames, and their Jacobians, in models of the joints between the frames alone.

A `pin.Data` takes some 8 nv³ numbers. So pairs that share joints, and several such clusters as long as they are small,
have a model of their own. For what Pinocchio has no Jacobian, and for a cluster that is too large, the joints are
followed one by one, in time and memory linear in their number.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
import pinocchio as pin

from eurdf.pinocchio.ancestry import Ancestry

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

# A model of several clusters has at most this many velocities, ...
_BUNDLED = 40
# ... and that of one cluster at most this many: its `pin.Data` takes 14 MB.
_LARGEST = 60


class FramePairs:
    """Pairs of frames A, B of one model, and what does not depend on a configuration. Threads may share it."""

    def __init__(
        self, model: pin.Model, parents: Sequence[int], pairs: Sequence[Pair], velocities: Indices | None
    ) -> None:
        """Take pairs of a model.

        Args:
            model: The model.
            parents: Of each of its joints the parent.
            pairs: The pairs.
            velocities: Indices (n,) in v of the columns of the Jacobian, all if None.
        """
        self.model = model
        self._parents = parents
        self.pairs = pairs
        self.velocities = velocities

    def memory(self) -> PartMemories:
        """Memory to compute in."""
        return PartMemories(self)

    def placements_once(self, q: Vector) -> list[Any]:
        """ᴬM_B of each pair at q (nq,), without memory for other configurations, which takes longer to make."""
        model, parents = self.model, self._parents
        needed: set[int] = set()
        for pair in self.pairs:
            for joint, _ in pair:
                while joint and joint not in needed:
                    needed.add(joint)
                    joint = parents[joint]
        order = sorted(needed)  # a parent has a lower index than its child
        joints, placements = model.joints, model.jointPlacements
        oMi = {0: pin.SE3.Identity()}
        if all(a and b for (a, _), (b, _) in self.pairs) and sum(not parents[joint] for joint in order) == 1:
            oMi[order.pop(0)] = oMi[0]  # what carries all frames does not matter, however far away it moves
        for joint in order:
            moving = joints[joint]
            data = moving.createData()
            moving.calc(data, q)
            oMi[joint] = oMi[parents[joint]] * placements[joint] * data.M
        return [(oMi[a] * aMf).actInv(oMi[b] * bMf) for (a, aMf), (b, bMf) in self.pairs]

    @cached_property
    def parts(self) -> list[Part]:
        """The pairs, divided among models that share no joint."""
        bundles: list[tuple[list[int], set[int]]] = []
        found: list[Part] = []
        size = 0
        for which, joints in self._clusters:
            velocities = sum(self.model.nvs[joint] for joint in joints)
            # Mimic joints have columns of their own in Pinocchio's Jacobians, which only the paths add to their
            # leaders'. Without velocities, Jacobians of Pinocchio 4.1 read memory that is not their own.
            if velocities > _LARGEST or not all(self.model.nvs[joint] for joint in joints) or not joints:
                found.append(
                    Part(which, FramePairs(self.model, self._parents, [self.pairs[i] for i in which], self.velocities))
                )
            elif bundles and size + velocities <= _BUNDLED:
                bundles[-1][0].extend(which)
                bundles[-1][1].update(joints)
                size += velocities
            else:
                bundles.append((list(which), set(joints)))
                size = velocities
        return found + [self._part(sorted(which), sorted(joints)) for which, joints in bundles]

    @cached_property
    def _clusters(self) -> list[tuple[list[int], set[int]]]:
        """Pairs that share joints with one another, and these joints.

        The time is linear in the number of pairs and of joints, however many pairs share a joint.
        """
        runs = _JointRuns(self._parents)
        ancestry = Ancestry(self._parents)
        lowest = []  # of each pair a joint between its frames; 0 if there is none
        for (a, _), (b, _) in self.pairs:
            above = ancestry.common(a, b)
            ends = [joint for joint in (a, b) if joint != above]
            for joint in ends:
                runs.add(joint, above)
            if len(ends) == 2:
                runs.join(a, b)
            lowest.append(ends[0] if ends else 0)
        clusters: dict[int, tuple[list[int], set[int]]] = {}
        alone = itertools.count(-1, -1)
        for index, joint in enumerate(lowest):
            key = runs.cluster(joint) if joint else next(alone)
            clusters.setdefault(key, ([], set()))[0].append(index)
        for joint in runs.joints:
            clusters[runs.cluster(joint)][1].add(joint)
        return list(clusters.values())

    def _part(self, which: list[int], joints: list[int]) -> Part:
        """The pairs with these indices, in a model of the joints between them; a parent comes before its children."""
        model, small = self.model, pin.Model()
        index = {0: 0}
        for joint in joints:
            above = index.get(self._parents[joint], 0)  # what carries both frames of a pair does not matter
            placement = model.jointPlacements[joint]
            index[joint] = small.addJoint(above, model.joints[joint], placement, model.names[joint])
        pairs = [
            (Site(index.get(a.joint, 0), a.placement), Site(index.get(b.joint, 0), b.placement))
            for a, b in (self.pairs[each] for each in which)
        ]
        coordinates = _joined(range(model.idx_qs[joint], model.idx_qs[joint] + model.nqs[joint]) for joint in joints)
        velocities = _joined(range(model.idx_vs[joint], model.idx_vs[joint] + model.nvs[joint]) for joint in joints)
        wanted = range(model.nv) if self.velocities is None else self.velocities.tolist()
        column = {velocity: at for at, velocity in enumerate(wanted)}
        own = [at for at, velocity in enumerate(velocities.tolist()) if velocity in column]
        own.sort(key=lambda at: column[int(velocities[at])])
        columns = np.array([column[velocity] for velocity in velocities[own].tolist()], np.intp)
        small_velocities = None if own == list(range(small.nv)) else np.array(own, np.intp)
        return Part(
            which, FramePairs(small, small.parents.tolist(), pairs, small_velocities), coordinates, velocities, columns
        )

    @property
    def size(self) -> int:
        """Number of columns of the Jacobian."""
        return int(self.model.nv) if self.velocities is None else len(self.velocities)

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
        for joint in sorted(set().union(*(joints for _, joints in self._clusters))):
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


class _JointRuns:
    """Joints of a tree, joined to clusters by the paths that they are on; a run is joined from each to its parent.

    Attributes:
        joints: The joints on paths so far.
    """

    def __init__(self, parents: Sequence[int]) -> None:
        self.joints: dict[int, None] = {}
        self._parents = parents
        self._above = list(range(len(parents)))  # of each joint another of its run, farther up
        self._leader = list(range(len(parents)))  # of each joint another of its cluster

    def add(self, joint: int, above: int) -> None:
        """Join the joints from one up to an ancestor, which is no part of them."""
        self.joints[joint] = None
        top = _last(self._above, joint)
        while (parent := self._parents[top]) > above and top > above:  # a parent has a lower index than its child
            self.joints[parent] = None
            self._above[top] = parent
            self.join(top, parent)
            top = _last(self._above, parent)

    def join(self, a: int, b: int) -> None:
        """Join the clusters of two joints."""
        self._leader[self.cluster(a)] = self.cluster(b)

    def cluster(self, joint: int) -> int:
        """The joint that represents a cluster."""
        return _last(self._leader, joint)


def _last(following: list[int], index: int) -> int:
    """The end of a chain of indices, which is shortened."""
    while following[index] != index:
        following[index] = following[following[index]]
        index = following[index]
    return index


@dataclass(frozen=True, eq=False)
class Part:
    """Some of the pairs, and where they are evaluated.

    Attributes:
        which: Indices of the pairs, ascending.
        pairs: The same in a model of the joints between them; or in the whole model, to be followed joint by joint.
        coordinates: Indices in q of the coordinates of that model; None for the whole model.
        velocities: Indices in v of its velocities.
        columns: Columns of the Jacobian that its own columns are, ascending.
    """

    which: list[int]
    pairs: FramePairs
    coordinates: Indices | None = None
    velocities: Indices | None = None
    columns: Indices | None = None

    @cached_property
    def position(self) -> dict[int, int]:
        """Of each pair its index among those of the part."""
        return {pair: index for index, pair in enumerate(self.which)}

    @cached_property
    def adjacent(self) -> slice | None:
        """The columns, if they are next to one another."""
        if self.columns is None or not len(self.columns):
            return None
        first, last = int(self.columns[0]), int(self.columns[-1])
        return slice(first, last + 1) if last + 1 - first == len(self.columns) else None

    def memory(self) -> DataMemory | PathMemory:
        """Memory to evaluate them in."""
        return PathMemory(self.pairs) if self.coordinates is None else DataMemory(self.pairs)


class PartMemories:
    """Memory of all parts of some pairs. See `eurdf.kinematics.tree_kinematics.PairMemory`."""

    def __init__(self, pairs: FramePairs) -> None:
        self._size, self._count = pairs.size, len(pairs.pairs)
        self._parts = [(part, part.memory()) for part in pairs.parts]
        self._selections: dict[tuple[int, ...], list[tuple[list[int], list[int]]]] = {}

    def placements(self, q: Vector) -> list[Any]:
        """ᴬM_B of each pair at q (nq,)."""
        if len(self._parts) == 1:
            ((part, memory),) = self._parts
            return memory.placements(q if part.coordinates is None else q[part.coordinates])
        found: list[Any] = [None] * self._count
        for part, memory in self._parts:
            placements = memory.placements(q if part.coordinates is None else q[part.coordinates])
            for index, placement in zip(part.which, placements, strict=True):
                found[index] = placement
        return found

    def jacobian(self, rows: Matrix, which: Sequence[int]) -> Matrix:
        """Derivative of rows of some pairs by the velocities, where `placements` last was."""
        k, r = rows.shape[:2]
        key = tuple(which)
        selections = self._selections.get(key)
        if selections is None:
            selections = self._selections[key] = [_selection(part, key) for part, _ in self._parts]
        if len(self._parts) == 1:
            ((part, memory),) = self._parts
            block = memory.jacobian(rows, selections[0][1])
            if part.columns is None or len(part.columns) == self._size:
                return block
            K = np.zeros((k * r, self._size))
            K[:, part.columns if part.adjacent is None else part.adjacent] = block
            return K
        K = np.zeros((k, r, self._size))
        for (part, memory), (of_rows, of_part) in zip(self._parts, selections, strict=True):
            if of_part:
                block = memory.jacobian(rows[of_rows], of_part).reshape(len(of_part), r, -1)
                if part.columns is None:
                    K[of_rows] = block
                else:
                    K[np.array(of_rows)[:, None], :, part.columns] = np.swapaxes(block, 1, 2)
        return K.reshape(k * r, self._size)

    def motions(self, q: Vector, v: Vector) -> tuple[list[Any], list[Any], list[Any]]:
        """See `eurdf.kinematics.tree_kinematics.PairMemory`."""
        found: list[list[Any]] = [[None] * self._count for _ in range(3)]
        for part, memory in self._parts:
            own = memory.motions(*((q, v) if part.coordinates is None else (q[part.coordinates], v[part.velocities])))
            for all_pairs, of_part in zip(found, own, strict=True):
                for index, value in zip(part.which, of_part, strict=True):
                    all_pairs[index] = value
        return found[0], found[1], found[2]


def _selection(part: Part, which: Sequence[int]) -> tuple[list[int], list[int]]:
    """Those of the pairs asked for that are in a part: their indices among these, and in the part."""
    chosen = [(row, part.position[pair]) for row, pair in enumerate(which) if pair in part.position]
    return [row for row, _ in chosen], [index for _, index in chosen]


class DataMemory:
    """A `pin.Data`, for small models without mimic joints: nearly all is done by Pinocchio."""

    def __init__(self, pairs: FramePairs) -> None:
        self._pairs = pairs.pairs
        self._model, self._data = pairs.model, pairs.model.createData()
        self._constraints, models, datas = pairs.constraints
        self._datas = pin.StdVec_RigidConstraintData(datas)
        self._each = list(zip(models, self._datas, strict=True))
        self._velocities, self._still = pairs.velocities, np.zeros(pairs.model.nv)
        self._all = list(range(len(self._each)))
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
        J = self._J if list(which) == self._all else self._J[list(which)]
        K = np.matmul(-rows, J)
        K = K.reshape(K.shape[0] * K.shape[1], self._model.nv)
        return K if self._velocities is None else np.asarray(K[:, self._velocities])

    def motions(self, q: Vector, v: Vector) -> tuple[list[Any], list[Any], list[Any]]:
        """See `eurdf.kinematics.tree_kinematics.PairMemory`."""
        pin.forwardKinematics(self._model, self._data, q, v, self._still)
        data = self._data
        return _relative(
            tuple((data.oMi[joint], data.v[joint], data.a[joint], placement) for joint, placement in pair)
            for pair in self._pairs
        )


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
        n = self._pairs.size
        K = np.zeros((*rows.shape[:2], n))
        for own, index, part in zip(rows, which, K, strict=True):
            in_J, signs, in_K, twice = self._pairs.columns[index]
            block = own @ self._oMa[index].toActionMatrixInverse() @ (self._J[:, in_J] * signs)
            if twice:
                np.add.at(part.T, in_K, block.T)
            else:
                part[:, in_K] = block
        return K.reshape(K.shape[0] * K.shape[1], n)

    def motions(self, q: Vector, v: Vector) -> tuple[list[Any], list[Any], list[Any]]:
        """See `eurdf.kinematics.tree_kinematics.PairMemory`."""
        still = (pin.SE3.Identity(), pin.Motion.Zero(), pin.Motion.Zero())
        moved: dict[int, Any] = {}
        for (joint, parent, placement, moving, _), data in zip(self._pairs.joints, self._datas, strict=True):
            moving.calc(data, q, v)
            oMi, twist, acceleration = moved.get(parent, still)
            iMj = placement * data.M
            own = pin.Motion(data.v)
            twist = iMj.actInv(twist) + own
            moved[joint] = oMi * iMj, twist, iMj.actInv(acceleration) + pin.Motion(data.c) + twist.cross(own)
        return _relative(
            tuple((*moved.get(joint, still), placement) for joint, placement in pair) for pair in self._pairs.pairs
        )

    def _jacobian(self) -> Matrix:
        """The world Jacobian (6, …) of the joints between the frames, each with columns of its own."""
        joints = self._pairs.joints
        J = np.zeros((6, joints[-1][-1].stop if joints else 0))
        for (joint, _, _, _, columns), data in zip(joints, self._datas, strict=True):
            J[:, columns] = self._oMi[joint].toActionMatrix() @ data.S.reshape(6, -1)
        return J


def _relative(ends: Iterable[Sequence[Any]]) -> tuple[list[Any], list[Any], list[Any]]:
    """How frames B move against frames A.

    With V and A the twists and spatial accelerations of the frames, each in its own axes, and M = ᴬM_B, the twist of B
    in A is ξ = V_B - Ad(M⁻¹) V_A, and ξ̇ = A_B - Ad(M⁻¹) A_A + ξ × Ad(M⁻¹) V_A.

    Args:
        ends: Of each pair, for A and for B: the placement, twist and acceleration of the joint, and the placement of
            the frame in it.
    """
    placements, twists, accelerations = [], [], []
    for (oMa, twist_a, acceleration_a), (oMb, twist_b, acceleration_b) in (
        ((oMi * iMf, iMf.actInv(v), iMf.actInv(a)) for oMi, v, a, iMf in pair) for pair in ends
    ):
        aMb = oMa.actInv(oMb)
        carried = aMb.actInv(twist_a)
        twist = twist_b - carried
        placements.append(aMb)
        twists.append(twist)
        accelerations.append(acceleration_b - aMb.actInv(acceleration_a) + twist.cross(carried))
    return placements, twists, accelerations


def _joined(ranges: Iterable[range]) -> Indices:
    return np.array([index for each in ranges for index in each], np.intp)
