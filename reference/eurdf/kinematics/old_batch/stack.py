"""Some constraints of a robot, stacked: their residual and Jacobian at arrays of configurations."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from eurdf.kinematics.array import Indices, Mask, Matrix, Vector
from eurdf.kinematics.old_batch import rigid
from eurdf.kinematics.old_batch.constraints import CLOSURE_KINDS, ClosureKind
from eurdf.kinematics.old_batch.tree import BatchTree, Place, Site
from eurdf.mechanism.constraint import Closure, Constraint, Coupling


class Columns(NamedTuple):
    """Columns of the twist of a frame against another.

    Attributes:
        joints: Where each is in the twists of all joints of a stack.
        signs: +1 for joints that move B, -1 for those that move A.
        velocities: Where each is in K.
        shared: Whether two of them belong to one velocity.
    """

    joints: Indices
    signs: Vector
    velocities: Indices
    shared: bool


@dataclass(frozen=True, slots=True, eq=False)
class State:
    """Some configurations, and the closures there.

    Attributes:
        q: The configurations (nq, B).
        place: Where the joints of the loops are.
        rotation: Of the closures of each kind the rotations (3, 3, k, B) of B in A.
        position: The origins (3, k, B) of B in A, m.
    """

    q: Matrix
    place: Place
    rotation: list[Matrix]
    position: list[Matrix]


class _Closures(NamedTuple):
    """The closures of one kind.

    Attributes:
        kind: Evaluates them.
        members: Their indices in the stack.
        rows: Their rows (k, r) in the residual.
        sites: Where A and B of each are.
        columns: Of each the columns of the twist of B against A.
    """

    kind: ClosureKind[Any]
    members: list[int]
    rows: Indices
    sites: list[tuple[Site, Site]]
    columns: list[Columns]


class _Couplings:
    """Σ cᵢ qᵢ - offset, of k couplings."""

    def __init__(
        self, couplings: Sequence[Coupling], tree: BatchTree, coordinates: dict[str, Any], column: dict[int, int]
    ) -> None:
        k = len(couplings)
        self.offsets = np.array([coupling.offset for coupling in couplings])
        self.by_coordinate = np.zeros((k, tree.nq))
        self.K = np.zeros((k, len(column)))
        self.translates = np.zeros(k, dtype=bool)
        for row, coupling in enumerate(couplings):
            for name, coefficient in coupling.coefficients:
                at = coordinates[name]
                self.by_coordinate[row, at.idx_q] += coefficient
                if at.idx_v in column:
                    self.K[row, column[at.idx_v]] += coefficient
            largest, _ = max(coupling.coefficients, key=lambda each: abs(each[1]))
            self.translates[row] = coordinates[largest].translates
        self.largest = np.abs(self.by_coordinate).max(axis=1, initial=0.0)

    def residual(self, q: Matrix) -> Matrix:
        """(k, B), in the unit of cᵢ qᵢ."""
        return np.asarray(self.by_coordinate @ q - self.offsets[:, None])

    def openings(self, q: Matrix) -> tuple[Matrix, Matrix]:
        """What the joint with the largest cᵢ would have to move, (k, B), m and rad."""
        amounts = np.abs(self.residual(q)) / self.largest[:, None]
        moves = self.translates[:, None]
        return np.where(moves, amounts, 0.0), np.where(moves, 0.0, amounts)


class BatchStack:
    """Some constraints, and the velocities by which K has columns; plain data, which can be pickled.

    Attributes:
        m: Number of rows.
        n: Number of velocities.
        velocities: Their indices (n,) in v.
    """

    def __init__(
        self,
        tree: BatchTree,
        constraints: Sequence[Constraint],
        velocities: Indices,
        coordinates: dict[str, Any],
    ) -> None:
        """Stack the constraints.

        Args:
            tree: The tree.
            constraints: The constraints, in the order of their rows.
            velocities: Indices (n,) in v of the columns of K.
            coordinates: Of each joint that a coupling relates where its coordinate is
                (`eurdf.kinematics.tree_kinematics.Coordinate`), by its name.

        Raises:
            NotImplementedError: A constraint is of a kind that is not known here.
        """
        self._tree, self.velocities = tree, velocities
        self.m, self.n = 0, len(velocities)
        self._count = len(constraints)
        column = {velocity: index for index, velocity in enumerate(velocities.tolist())}
        members: dict[type[Constraint], list[tuple[int, Any, int]]] = {}
        for index, constraint in enumerate(constraints):
            members.setdefault(type(constraint), []).append((index, constraint, self.m))
            self.m += constraint.rows
        self._related = [at.idx_v for at in coordinates.values()]
        self._coupled: tuple[_Couplings, list[int], Indices] | None = None
        paired: list[tuple[ClosureKind[Any], list[int], Indices, list[tuple[Site, Site]]]] = []
        for data, found in members.items():
            indices, own = [index for index, _, _ in found], [constraint for _, constraint, _ in found]
            rows = np.array([range(first, first + constraint.rows) for _, constraint, first in found], dtype=np.intp)
            if data is Coupling:
                self._coupled = _Couplings(own, tree, coordinates, column), indices, rows[:, 0]
            elif issubclass(data, Closure) and data in CLOSURE_KINDS:
                sites = [tuple(tree.site(anchor.body, anchor.pose) for anchor in each.anchors) for each in own]
                paired.append((CLOSURE_KINDS[data](own), indices, rows, sites))  # type: ignore[arg-type]
            else:
                raise NotImplementedError(
                    f"eurdf.batch does not support constraints of type '{data.type}' ('{own[0].name}')"
                )
        signs = [[tree.between(a.joint, b.joint) for a, b in sites] for _, _, _, sites in paired]
        self._joints = sorted(set().union(*(found for kind in signs for found in kind)))
        moved_by, first = {}, 0
        for joint in self._joints:
            nv = tree.joints[joint].motion.nv
            moved_by[joint] = list(enumerate(range(tree.joints[joint].idx_v, tree.joints[joint].idx_v + nv), first))
            first += nv
        self._twists = first
        self._closures = [
            _Closures(*kind, [_columns(each, moved_by, column) for each in found])
            for kind, found in zip(paired, signs, strict=True)
        ]

    @property
    def moving(self) -> Indices:
        """Indices in v of all velocities that move joints of the constraints, also of those without a column in K."""
        joints = [self._tree.joints[joint] for joint in self._joints]
        own = [range(joint.idx_v, joint.idx_v + joint.motion.nv) for joint in joints]
        return np.unique(np.array([velocity for each in own for velocity in each] + self._related, dtype=np.intp))

    @property
    def numbers(self) -> int:
        """Numbers that the evaluation of one element takes, roughly."""
        return 40 * len(self._joints) + 12 * self._twists + 3 * self.m * self.n + 2 * self.m * self.m + self._tree.nq

    def at(self, q: Matrix) -> State:
        """The constraints at q (nq, B)."""
        place = self._tree.place(self._joints, q)
        rotation, position = [], []
        for closures in self._closures:
            k = len(closures.sites)
            R, p = np.empty((3, 3, k, q.shape[1])), np.empty((3, k, q.shape[1]))
            for index, (a, b) in enumerate(closures.sites):
                (R_a, p_a), (R_b, p_b) = (frame_at(site, place) for site in (a, b))
                R[:, :, index] = rigid.product(rigid.transposed(R_a), R_b)
                p[:, index] = rigid.turned_back(R_a, p_b - p_a)
            rotation.append(R)
            position.append(p)
        return State(q, place, rotation, position)

    def residual(self, at: State) -> Matrix:
        """The residual (m, B), m and rad."""
        r = np.empty((self.m, at.q.shape[1]))
        for closures, R, p in zip(self._closures, at.rotation, at.position, strict=True):
            r[closures.rows] = np.swapaxes(closures.kind.rows(R, p), 0, 1)
        if self._coupled is not None:
            couplings, _, rows = self._coupled
            r[rows] = couplings.residual(at.q)
        return r

    def jacobian(self, at: State) -> Matrix:
        """K (m, n, B)."""
        B = at.q.shape[1]
        K = np.zeros((self.m, self.n, B))
        linear, angular = self._all_twists(at)
        for closures, R, p in zip(self._closures, at.rotation, at.position, strict=True):
            of_twist = closures.kind.rows_of_twist(R, p)
            for index, ((a, _), columns) in enumerate(zip(closures.sites, closures.columns, strict=True)):
                if not len(columns.joints):
                    continue
                R_a, p_a = frame_at(a, at.place)
                signs = columns.signs[:, None]
                about = signs * angular[:, columns.joints]
                p_a = np.broadcast_to(p_a[:, None], about.shape)
                along = signs * linear[:, columns.joints] + rigid.cross(about, p_a)
                twists = np.empty((6, len(columns.joints), B))
                twists[:3] = np.einsum("ijb,inb->jnb", R_a, along)
                twists[3:] = np.einsum("ijb,inb->jnb", R_a, about)
                block = np.einsum("rsb,snb->rnb", of_twist[:, :, index], twists)
                rows = slice(closures.rows[index, 0], closures.rows[index, -1] + 1)
                if columns.shared:
                    for column, velocity in enumerate(columns.velocities):
                        K[rows, velocity] += block[:, column]
                else:
                    K[rows, columns.velocities] = block
        if self._coupled is not None:
            couplings, _, coupled = self._coupled
            K[coupled] = couplings.K[:, :, None]
        return K

    def openings(self, at: State) -> tuple[Matrix, Matrix]:
        """How far each constraint is open, m and rad, (c, B) each."""
        lengths, angles = np.empty((2, self._count, at.q.shape[1]))
        for closures, R, p in zip(self._closures, at.rotation, at.position, strict=True):
            lengths[closures.members], angles[closures.members] = closures.kind.openings(R, p)
        if self._coupled is not None:
            couplings, members, _ = self._coupled
            lengths[members], angles[members] = couplings.openings(at.q)
        return lengths, angles

    def closes(self, at: State, enough: float) -> Mask:
        """Whether every constraint is open by at most ``enough``, m and rad, (B,); NaN is not closed."""
        lengths, angles = self.openings(at)
        return np.asarray(((lengths <= enough) & (angles <= enough)).all(axis=0))

    def _all_twists(self, at: State) -> tuple[Matrix, Matrix]:
        """Twists (3, …, B) of all joints, linear of the point at the common origin, and angular."""
        linear, angular = np.empty((2, 3, self._twists, at.q.shape[1]))
        first = 0
        for joint in self._joints:
            along, about = self._tree.twists(joint, at.q, at.place.rotation[joint])
            own = slice(first, first + along.shape[1])
            p = np.broadcast_to(at.place.position[joint][:, None], about.shape)
            linear[:, own], angular[:, own] = along + rigid.cross(p, about), about
            first = own.stop
        return linear, angular


def frame_at(site: Site, place: Place) -> tuple[Matrix, Matrix]:
    """Rotation (3, 3, B) and origin (3, B) of a frame; of one element if nothing moves it."""
    R = place.rotation.get(site.joint)
    if R is None:
        return site.rotation[:, :, None], site.position[:, None]
    position = place.position[site.joint] + np.einsum("ijb,j->ib", R, site.position)
    return np.einsum("ijb,jk->ikb", R, site.rotation), position


def _columns(signs: dict[int, float], moved_by: dict[int, list[tuple[int, int]]], column: dict[int, int]) -> Columns:
    entries = [
        (in_J, sign, column[velocity])
        for joint, sign in sorted(signs.items())
        for in_J, velocity in moved_by[joint]
        if velocity in column
    ]
    joints, sign, velocities = ([entry[part] for entry in entries] for part in range(3))
    return Columns(
        np.array(joints, dtype=np.intp),
        np.array(sign, dtype=np.float64),
        np.array(velocities, dtype=np.intp),
        len(set(velocities)) < len(velocities),
    )
