"""Relative poses of pairs of frames and their Jacobians at few configurations, one after the other, by Pinocchio.

A `pin.Data` takes some 8 nv³ numbers. So pairs that share joints, and several such clusters as long as they are small,
have a model of their own, of the joints between the frames alone.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from operator import attrgetter
from typing import Any, NamedTuple

import numpy as np
import pinocchio as pin

from eurdf.array import Indices, Matrix, Vector
from eurdf.closures.kind import PoseArrays, RelativeMotions, RelativePoses
from eurdf.pinocchio.ancestry import between


class Site(NamedTuple):
    """Where a frame is fixed to.

    Attributes:
        joint: Index of the joint; 0 is the universe.
        placement: Pose of the frame in the joint, `pin.SE3`.
    """

    joint: int
    placement: Any


Pair = tuple[Site, Site]

_ROTATION, _TRANSLATION = attrgetter("rotation"), attrgetter("translation")

#: A model of several clusters has at most this many velocities, ...
BUNDLED = 40
# ... and that of one cluster at most this many: its `pin.Data` takes 14 MB.
_LARGEST = 60


class FewPoses(RelativePoses):
    """Poses of pairs as Pinocchio has them: `pin.SE3`, which are computed again if others were in their place since."""

    _rotation: Matrix | None = None
    _position: Matrix | None = None

    def __init__(self, pairs: FewPairs, q: Matrix, which: slice) -> None:
        self.q = q
        self._pairs, self._which = pairs, which
        self._shape = len(q), which.stop - which.start

    def of(self, which: slice) -> FewPoses:
        """Those of some of the pairs."""
        return self if which == self._which else FewPoses(self._pairs, self.q, which)

    @property
    def rotation(self) -> Matrix:  # type: ignore[override]
        """ᴬR_B (B, k, 3, 3)."""
        if self._rotation is None:
            self._rotation = np.array(list(map(_ROTATION, self._each()))).reshape(*self._shape, 3, 3)
        return self._rotation

    @property
    def position(self) -> Matrix:  # type: ignore[override]
        """Origin p of B in A (B, k, 3), m."""
        if self._position is None:
            self._position = np.array(list(map(_TRANSLATION, self._each()))).reshape(*self._shape, 3)
        return self._position

    def logarithm(self) -> Matrix:
        """log6(ᴬM_B) (B, k, 6)."""
        if self._logarithm is None:
            self._logarithm = np.array([pin.log6(aMb).vector for aMb in self._each()]).reshape(*self._shape, 6)
        return self._logarithm

    def logarithm_by_twist(self) -> Matrix:
        """Jlog6(ᴮM_A) (B, k, 6, 6)."""
        if self._by_twist is None:
            self._by_twist = np.array([pin.Jlog6(aMb.inverse()) for aMb in self._each()]).reshape(*self._shape, 6, 6)
        return self._by_twist

    def twist_in_b(self) -> Matrix:
        """Ad(ᴮM_A) (B, k, 6, 6)."""
        return np.array([aMb.toActionMatrixInverse() for aMb in self._each()]).reshape(*self._shape, 6, 6)

    def turn_from(self, rotation: Matrix) -> Matrix:
        each = zip(rotation.reshape(-1, 3, 3), self._each(), strict=True)
        return np.array([pin.log3(S.T.dot(aMb.rotation)) for S, aMb in each]).reshape(*self._shape, 3)

    def turn_by_omega(self, turn: Matrix) -> Matrix:
        each = zip(turn.reshape(-1, 3), self._each(), strict=True)
        found = [pin.Jlog3(pin.exp3(own)).dot(aMb.rotation.T) for own, aMb in each]
        return np.array(found).reshape(*self._shape, 3, 3)

    def _each(self) -> Sequence[Any]:
        pairs, q = self._pairs, self.q
        if len(q) == 1:
            placed = pairs.placed(q, 0)
            return placed if self._which is pairs.all else placed[self._which]
        return [pin.SE3(aMb) for element in range(len(q)) for aMb in pairs.placed(q, element)[self._which]]


class FewPairs:
    """Pairs of frames A, B, with the memory to compute in, for one thread."""

    #: Few configurations need no blocks.
    numbers = 0

    def __init__(self, model: pin.Model, parents: Sequence[int], pairs: Sequence[Pair], velocities: Indices) -> None:
        """Take pairs of a model.

        Args:
            model: The model.
            parents: Of each of its joints the parent.
            pairs: The pairs.
            velocities: Indices (n,) in v of the columns of the Jacobian.

        Raises:
            NotImplementedError: Pinocchio has no Jacobian for them, or it would take too much memory.
        """
        self.count, self.n = len(pairs), len(velocities)
        self._bundles = [
            _Bundle(model, parents, pairs, sorted(which), sorted(joints), velocities.tolist())
            for which, joints in _bundled(model, (set(between(parents, a.joint, b.joint)) for a, b in pairs))
        ]
        self.all = slice(0, self.count)
        self._at: tuple[Matrix | None, int] = None, 0  # what placements were computed of last
        self._placements: list[Any] = []

    def at(self, q: Matrix) -> FewPoses:
        """The poses at q (B, nq), which the caller leaves as it is."""
        return FewPoses(self, q, self.all)

    def placed(self, q: Matrix, element: int) -> list[Any]:
        """ᴬM_B of each pair at one of q (B, nq), valid until they are computed at another configuration.

        They are not computed again if they were last computed of this element of this very array.
        """
        last, last_element = self._at
        if q is not last or element != last_element:
            if len(self._bundles) == 1:
                self._placements = self._bundles[0].placements(q[element])
            else:
                self._placements = [None] * self.count
                for bundle in self._bundles:
                    for index, placement in zip(bundle.which, bundle.placements(q[element]), strict=True):
                        self._placements[index] = placement
            self._at = q, element
        return self._placements

    def place(self, index: int, rotation: Matrix, position: Vector) -> None:
        """Move frame A of a pair to another pose in its joint; poses that were computed before are not valid."""
        for bundle in self._bundles:
            if index in bundle.which:
                bundle.place(bundle.which.index(index), pin.SE3(rotation, position))
        self._at = None, 0

    def jacobian(self, at: FewPoses, which: slice, rows: Matrix) -> Matrix:
        """The derivative (B, k r, n) by the velocities of rows (B, k, r, 6) over the twists of some pairs."""
        B, k, r = rows.shape[:3]
        if B == 1 and len(self._bundles) == 1:
            (bundle,) = self._bundles
            self.placed(at.q, 0)
            J = bundle.jacobian()
            part: Matrix = (rows @ (J if k == self.count else J[which])).reshape(1, k * r, J.shape[2])
            if bundle.is_whole:
                return part
            K = np.zeros((1, k * r, self.n))
            K[..., bundle.columns] = part
            return K
        K = np.zeros((B, k, r, self.n))
        for element, (of_rows, block) in enumerate(zip(rows, K, strict=True)):
            self.placed(at.q, element)
            for bundle in self._bundles:
                chosen, own = bundle.within(which)
                part = of_rows[chosen] @ bundle.jacobian()[own]
                if isinstance(chosen, slice):
                    block[chosen][..., bundle.columns] = part
                else:
                    block[chosen[:, None, None], np.arange(r)[:, None], np.arange(self.n)[bundle.columns]] = part
        return K.reshape(B, k * r, self.n)

    def motions(self, q: Matrix, v: Matrix) -> RelativeMotions:
        """How the pairs move at q (B, nq) while every joint keeps its velocity v (B, nv)."""
        if len(q) == 1 and len(self._bundles) == 1:
            found = self._bundles[0].motions(q[0], v[0])[:, None]
        else:
            found = np.empty((2, len(q), self.count, 6))
            for element in range(len(q)):
                for bundle in self._bundles:
                    found[:, element, bundle.which] = bundle.motions(q[element], v[element])
        if len(q) != 1 or self._at[0] is not q:
            self._at = None, 0
        return RelativeMotions(self.at(q), *found)


def _bundled(model: pin.Model, paths: Iterable[set[int]]) -> Iterator[tuple[list[int], set[int]]]:
    """Clusters of pairs that share joints with one another, small ones together: the pairs, and the joints."""
    clusters: list[tuple[list[int], set[int]]] = []
    cluster_of: dict[int, tuple[list[int], set[int]]] = {}  # by joint
    for index, path in enumerate(paths):
        sharing = {id(cluster): cluster for joint in path if (cluster := cluster_of.get(joint))}
        largest = max(sharing.values(), key=lambda cluster: len(cluster[1]), default=([], set()))
        if not sharing:
            clusters.append(largest)
        for cluster in sharing.values():
            if cluster is not largest:
                largest[0].extend(cluster[0])
                largest[1].update(cluster[1])
                cluster_of.update(dict.fromkeys(cluster[1], largest))
                cluster[0].clear()
        largest[0].append(index)
        new = path - largest[1]
        largest[1].update(new)
        cluster_of.update(dict.fromkeys(new, largest))
        if len(largest[1]) > _LARGEST:
            raise NotImplementedError("these loops share too many joints")
    open_: tuple[list[int], set[int]] = ([], set())
    size = 0
    for which, joints in clusters:
        if not which:  # it is part of another
            continue
        own = sum(model.nvs[joint] for joint in joints)
        if own > _LARGEST:
            raise NotImplementedError("these loops share too many joints")
        if not all(model.nvs[joint] for joint in joints):
            raise NotImplementedError("mimic joints have columns of their own in Pinocchio's Jacobians")
        if size and own and size + own > BUNDLED:
            yield open_
            open_, size = ([], set()), 0
        open_[0].extend(which)
        open_[1].update(joints)
        size += own
    yield open_


class _Bundle:
    """Some of the pairs, in a model of the joints between them.

    Attributes:
        which: Their indices, ascending.
        columns: Columns of the Jacobian that the velocities of the model are.
        is_whole: Whether these are all of them.
    """

    def __init__(
        self,
        model: pin.Model,
        parents: Sequence[int],
        pairs: Sequence[Pair],
        which: list[int],
        joints: list[int],
        velocities: list[int],
    ) -> None:
        small, index = model_of_joints(model, parents, joints)
        self.which = which
        self._pairs = [tuple(Site(index.get(end.joint, 0), end.placement) for end in pairs[each]) for each in which]
        self._model, self._data = small, small.createData()
        # References to what Pinocchio writes, since each attribute takes time.
        oMi, v, a = self._data.oMi, self._data.v, self._data.a
        ends = {end.joint for pair in self._pairs for end in pair} - {0}
        self._ends = [(joint, oMi[joint], v[joint], a[joint]) for joint in ends]
        self._still = pin.SE3.Identity(), pin.Motion.Zero(), pin.Motion.Zero()
        self._coordinates = _joined(model.idx_qs, model.nqs, joints)
        self._velocities = _joined(model.idx_vs, model.nvs, joints)
        column = {velocity: at for at, velocity in enumerate(velocities)}
        own = [at for at, velocity in enumerate(self._velocities.tolist()) if velocity in column]
        own.sort(key=lambda at: column[int(self._velocities[at])])
        columns = np.array([column[velocity] for velocity in self._velocities[own].tolist()], np.intp)
        self.columns = as_slice(columns)
        self._own = None if own == list(range(small.nv)) else np.array(own, np.intp)
        self.is_whole = len(own) == len(velocities)
        # Constraint models of all six rows, also where only positions matter: they turn with A.
        self._models, self._datas = pin.StdVec_RigidConstraintModel(), pin.StdVec_RigidConstraintData()
        for a, b in self._pairs:
            constraint = pin.RigidConstraintModel(pin.ContactType.CONTACT_6D, small, *a, *b, pin.ReferenceFrame.LOCAL)
            self._models.append(constraint)
            self._datas.append(constraint.createData())
        self._each = list(zip(self._models, self._datas, strict=True))
        self._J: Matrix | None = None
        self._within: dict[tuple[int, int], tuple[slice | Indices, slice]] = {}

    def placements(self, q: Vector) -> list[Any]:
        """ᴬM_B of each pair at q (nq,)."""
        model, data = self._model, self._data
        pin.computeJointJacobians(model, data, q[self._coordinates])
        self._J, placements = None, []
        for constraint, found in self._each:
            constraint.calc(model, data, found)
            placements.append(found.c1Mc2)
        return placements

    def place(self, index: int, placement: Any) -> None:
        """Move frame A of one of its pairs to another pose in its joint."""
        a, b = self._pairs[index]
        self._pairs[index] = Site(a.joint, placement), b
        self._each[index][0].joint1_placement = placement

    def jacobian(self) -> Matrix:
        """The twists (k, 6, own n) of B against A where `placements` last was, by the velocities."""
        if self._J is None:
            if self._model.nv:
                J = pin.getConstraintsJacobian(self._model, self._data, self._models, self._datas)
                J = -J.reshape(len(self._each), 6, self._model.nv)  # of A against B
                self._J = J if self._own is None else J[..., self._own]
            else:  # those of Pinocchio 4.1 without velocities read memory that is not their own
                self._J = np.empty((len(self._each), 6, 0))
        return self._J

    def within(self, which: slice) -> tuple[slice | Indices, slice]:
        """Those of some adjacent pairs that are in this bundle: their indices among these, and here."""
        key = which.start, which.stop
        if key not in self._within:
            first, last = np.searchsorted(self.which, key).tolist()
            chosen = np.array(self.which[first:last], np.intp) - which.start
            self._within[key] = as_slice(chosen), slice(first, last)
        return self._within[key]

    def motions(self, q: Vector, v: Vector) -> Matrix:
        """The twists ξ of B against A in the axes of B, and ξ̇: (2, k, 6).

        With V and A the twists and spatial accelerations of the joints of both frames, in the axes of the world, and
        M the pose of B there, ξ = Ad(M⁻¹) (V_B - V_A) and ξ̇ = Ad(M⁻¹) (A_B - A_A - V_B × (V_B - V_A)).
        """
        data = self._data
        pin.forwardKinematics(self._model, data, q[self._coordinates], v[self._velocities], np.zeros(self._model.nv))
        moves = {0: self._still}
        for joint, oMi, own, change in self._ends:
            moves[joint] = oMi, oMi.act(own), oMi.act(change)
        twists, changes = [], []
        for (a, _), (b, jMb) in self._pairs:
            (_, twist_a, change_a), (oMi, twist_b, change_b) = moves[a], moves[b]
            oMb, twist = oMi * jMb, twist_b - twist_a
            twists.append(oMb.actInv(twist).vector)
            changes.append(oMb.actInv(change_b - change_a - twist_b.cross(twist)).vector)
        return np.array((twists, changes))


def model_of_joints(
    model: pin.Model, parents: Sequence[int], joints: Iterable[int]
) -> tuple[pin.Model, dict[int, int]]:
    """A model of some joints, ascending, without inertia, and where they are in it.

    A joint whose parent is not among them moves against the universe.
    """
    small, index = pin.Model(), {0: 0}
    for joint in joints:
        above = index.get(parents[joint], 0)
        index[joint] = small.addJoint(above, model.joints[joint], model.jointPlacements[joint], model.names[joint])
    return small, index


def as_slice(indices: Indices) -> slice | Indices:
    """The same indices as a slice, which is faster, if they are adjacent and ascending."""
    first = int(indices[0]) if len(indices) else 0
    is_adjacent = np.array_equal(indices, np.arange(first, first + len(indices)))
    return slice(first, first + len(indices)) if is_adjacent else indices


def _joined(first: Sequence[int], count: Sequence[int], joints: Sequence[int]) -> Indices:
    return np.array([first[joint] + k for joint in joints for k in range(count[joint])], np.intp)


def poses_once(model: pin.Model, parents: Sequence[int], pairs: Sequence[Pair], q: Vector) -> PoseArrays:
    """ᴬM_B of pairs at q (nq,), without memory for other configurations, which takes longer to make."""
    needed: set[int] = set()
    for pair in pairs:
        for joint, _ in pair:
            while joint and joint not in needed:
                needed.add(joint)
                joint = parents[joint]
    order = sorted(needed)  # a parent has a lower index than its child
    joints, placements = model.joints, model.jointPlacements
    oMi = {0: pin.SE3.Identity()}
    if all(a.joint and b.joint for a, b in pairs) and sum(not parents[joint] for joint in order) == 1:
        oMi[order.pop(0)] = oMi[0]  # what carries all frames does not matter, however far away it moves
    for joint in order:
        moving = joints[joint]
        data = moving.createData()
        moving.calc(data, q)
        oMi[joint] = oMi[parents[joint]] * placements[joint] * data.M
    found = [(oMi[a] * aMf).actInv(oMi[b] * bMf) for (a, aMf), (b, bMf) in pairs]
    rotation, position = [aMb.rotation for aMb in found], [aMb.translation for aMb in found]
    return PoseArrays(np.array(rotation).reshape(1, -1, 3, 3), np.array(position).reshape(1, -1, 3))
