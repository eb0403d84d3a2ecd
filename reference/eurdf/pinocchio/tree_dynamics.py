"""Dynamics of a spanning tree, with the memory to compute in, for one thread at a time.

A `pin.Data` takes some 64 nv³ bytes, 1.7 GB for 300 velocities. The recursions of a large tree take memory linear in
the number of joints, and nv² numbers where the mass matrix is asked for.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property, lru_cache

import numpy as np
import pinocchio as pin

from eurdf.array import Indices, Mask, Matrix, Vector
from eurdf.pinocchio.springs import Springs

#: The dynamics of trees with more velocities do without a `pin.Data`, which would take more than 140 MB.
MOST_VELOCITIES_WITH_DATA = 130


class TreeDynamics:
    """The dynamics of a tree, in a `pin.Data`."""

    def __init__(self, model: pin.Model, springs: Springs, data: pin.Data | None) -> None:
        """Take a model, the springs that it does not contain, and memory."""
        self.model, self.data = model, data
        self._springs = springs

    def update(self) -> None:
        """Take over what was changed in the model."""

    def inverse_dynamics(self, q: Vector, v: Vector, a: Vector) -> Vector:
        """The generalized force (nv,) M a + h that the acceleration a (nv,) takes; with a = 0 the bias h."""
        return np.array(pin.rnea(self.model, self.data, q, v, a))

    def mass_times(self, q: Vector, motions: Matrix) -> Matrix:
        """The mass matrix at q (nq,), the armature included, times the columns (nv, n) of accelerations.

        Up to Pinocchio 4.1, `pin.crba` has wrong entries if a mimic joint carries several branches.
        """
        if not len(self.model.mimicking_joints):
            return np.asarray(whole_matrix(pin.crba(self.model, self.data, q)) @ motions)
        still = np.zeros(self.model.nv)
        gravity = self.inverse_dynamics(q, still, still)
        columns = [self.inverse_dynamics(q, still, a) - gravity for a in motions.T]
        return np.array(columns).reshape(motions.T.shape).T

    def columns(self, q: Vector) -> tuple[Matrix, Matrix]:
        """The poses (joints, 4, 4) of all joints in the world at q (nq,), and the world Jacobian (nvExtended, 6).

        Columns of the Jacobian, here rows, are linear, of the point at the origin of the world, and angular. A mimic
        joint has one of its own, for a unit velocity of its leader.
        """
        data = self.data
        J = np.array(pin.computeJointJacobians(self.model, data, q).T)
        return np.array([placement.homogeneous for placement in data.oMi]), J  # type: ignore[union-attr]

    def derivatives(
        self, q: Vector, v: Vector, a: Vector, joints: Sequence[int]
    ) -> tuple[Matrix, Matrix, Matrix] | None:
        """What Pinocchio differentiates at q (nq,), v and a (nv,); None without a `pin.Data`, or with mimic joints.

        Returns:
            The poses (k, 4, 4) of the joints; the columns of the Jacobian, J̇, V′ and A′ (4, nv, 6) as in
            `eurdf.kinematics.variation`, without gravity; and the derivatives (3, nv, nv) of M a + h by q, v and a.
        """
        data = self.data
        if data is None or len(self.model.mimicking_joints):
            return None
        pin.computeRNEADerivatives(self.model, data, q, v, a)
        columns = np.array((data.J.T, data.dJ.T, data.dAdv.T, data.dAdq.T))
        columns[2] -= columns[1]
        terms = np.array((data.dtau_dq, data.dtau_dv, whole_matrix(data.M)))
        oMi = data.oMi
        return np.array([oMi[joint].homogeneous for joint in joints]).reshape(-1, 4, 4), columns, terms

    def inverse_mass_diagonal(self, q: Vector) -> Vector:
        """The diagonal (nv,) of the inverse of the mass matrix at q (nq,), of a tree without mimic joints."""
        return np.array(pin.computeMinverse(self.model, self.data, q).diagonal())

    def kinetic_energy(self, q: Vector, v: Vector) -> float:
        """The kinetic energy at q (nq,) and v (nv,), J, that of the armature included.

        `pin.computeKineticEnergy` leaves out the armature of some joints, up to Pinocchio 4.1, and has no mimic joints.
        """
        if self.data is not None and not self.model.armature.any() and not len(self.model.mimicking_joints):
            return float(pin.computeKineticEnergy(self.model, self.data, q, v))
        still = np.zeros(self.model.nv)
        momentum = self.inverse_dynamics(q, still, v) - self.inverse_dynamics(q, still, still)
        return 0.5 * float(v @ momentum)

    def potential_energy(self, q: Vector) -> float:
        """The potential energy of gravity and springs at q (nq,), J."""
        gravity = self._energy_of_gravity(q)
        return gravity + self._springs.energy(q) if len(self._springs) else gravity

    def _energy_of_gravity(self, q: Vector) -> float:
        if len(self.model.mimicking_joints):  # not supported by Pinocchio 4.1
            return TreeRecursion(self.model, self._springs)._energy_of_gravity(q)
        return float(pin.computePotentialEnergy(self.model, self.data, q))


def whole_matrix(M: Matrix) -> Matrix:
    """The mass matrix (nv, nv) of whose entries Pinocchio wrote those on or above the diagonal."""
    return np.where(_upper(len(M)), M, M.T)


@lru_cache(maxsize=8)
def _upper(n: int) -> Mask:
    """Which entries of a matrix (n, n) are on or above the diagonal."""
    return np.triu(np.ones((n, n), dtype=bool))


class TreeRecursion(TreeDynamics):
    """The dynamics of a large tree, joint by joint.

    Source: Featherstone, *Rigid Body Dynamics Algorithms*, 2008, chapters 5 and 6.
    """

    def __init__(self, model: pin.Model, springs: Springs) -> None:
        """Take a model; a mimic joint has the velocities of its leader."""
        super().__init__(model, springs, None)
        # Of each joint but the universe: its index, itself, its data, its parent, and its velocities.
        self._joints = [
            (
                joint,
                model.joints[joint],
                model.joints[joint].createData(),
                int(model.parents[joint]),
                slice(model.idx_vs[joint], model.idx_vs[joint] + model.nvExtendeds[joint]),
            )
            for joint in range(1, model.njoints)
        ]

    def inverse_dynamics(self, q: Vector, v: Vector, a: Vector) -> Vector:
        """M a + h (nv,), by recursive Newton-Euler, each joint in its own axes."""
        model = self.model
        velocities = [pin.Motion.Zero()] * model.njoints
        accelerations = [-model.gravity] * model.njoints
        forces = [pin.Force.Zero()] * model.njoints
        placements = [pin.SE3.Identity()] * model.njoints
        for joint, moving, data, parent, columns in self._joints:
            moving.calc(data, q, v)
            placements[joint] = liMi = model.jointPlacements[joint] * data.M
            own = data.v
            velocities[joint] = velocity = liMi.actInv(velocities[parent]) + own
            change = pin.Motion(data.S.reshape(6, -1) @ a[columns]) + data.c + velocity.cross(own)
            accelerations[joint] = acceleration = liMi.actInv(accelerations[parent]) + change
            inertia = model.inertias[joint]
            forces[joint] = inertia * acceleration + velocity.cross(inertia * velocity)
        tau: Vector = model.armature * a
        for joint, _, data, parent, columns in reversed(self._joints):
            tau[columns] += data.S.reshape(6, -1).T @ forces[joint].vector
            forces[parent] = forces[parent] + placements[joint].act(forces[joint])
        return tau

    def mass_times(self, q: Vector, motions: Matrix) -> Matrix:
        """M (nv, nv), from the inertias of subtrees in the axes of the world, times the columns (nv, n)."""
        model = self.model
        placements = self._placements(q)
        subtrees = [placement.act(inertia) for placement, inertia in zip(placements, model.inertias, strict=True)]
        J, F = np.zeros((6, model.nvExtended)), np.zeros((6, model.nvExtended))
        last = model.nvExtended
        for joint, moving, data, parent, _ in reversed(self._joints):
            own = slice(last - moving.nvExtended, last)
            last = own.start
            J[:, own] = placements[joint].toActionMatrix() @ data.S.reshape(6, -1)
            F[:, own] = subtrees[joint].matrix() @ J[:, own]
            subtrees[parent] = subtrees[parent] + subtrees[joint]
        above = J.T @ F  # of a joint, in rows, and one that it carries
        above *= self._carries
        M = above + above.T
        M[self._same] *= 0.5  # of a joint with itself
        if model.nv < model.nvExtended:
            M = self._velocities.T @ M @ self._velocities
        return np.asarray((M + np.diag(model.armature)) @ motions)

    def columns(self, q: Vector) -> tuple[Matrix, Matrix]:
        """See `TreeDynamics.columns`."""
        placements, J = self._placements(q), np.zeros((self.model.nvExtended, 6))
        for joint, moving, data, _, _ in self._joints:
            first = self.model.idx_vExtendeds[joint]
            own = placements[joint].toActionMatrix() @ data.S.reshape(6, -1)
            J[first : first + moving.nvExtended] = own.T
        return np.array([placement.homogeneous for placement in placements]), J

    def _energy_of_gravity(self, q: Vector) -> float:
        gravity = self.model.gravity.linear
        placements = self._placements(q)
        return -sum(
            float(inertia.mass) * float(gravity @ placements[joint].act(inertia.lever))
            for joint, inertia in enumerate(self.model.inertias)
            if joint
        )

    def _placements(self, q: Vector) -> list[pin.SE3]:
        """Pose of each joint in the world at q (nq,)."""
        placements = [pin.SE3.Identity()] * self.model.njoints
        for joint, moving, data, parent, _ in self._joints:
            moving.calc(data, q)
            placements[joint] = placements[parent] * self.model.jointPlacements[joint] * data.M
        return placements

    @cached_property
    def _owners(self) -> Indices:
        """The joint of each column of J (nvExtended,)."""
        counts = [moving.nvExtended for _, moving, _, _, _ in self._joints]
        return np.repeat(np.arange(1, self.model.njoints), counts)

    @cached_property
    def _carries(self) -> Mask:
        """Whether the joint of a column of J carries that of another, or is the same."""
        n = self.model.njoints
        carries = np.zeros((n, n), dtype=bool)
        for joint, _, _, parent, _ in self._joints:  # a parent has a lower index than its child
            carries[:, joint] = carries[:, parent]
            carries[joint, joint] = True
        return np.asarray(carries[np.ix_(self._owners, self._owners)])

    @cached_property
    def _same(self) -> Mask:
        return np.asarray(self._owners[:, None] == self._owners)

    @cached_property
    def _velocities(self) -> Matrix:
        """The velocities of the columns of J, over v: (nvExtended, nv)."""
        found = np.zeros((self.model.nvExtended, self.model.nv))
        row = 0
        for _, moving, _, _, columns in self._joints:
            own = np.arange(moving.nvExtended)
            found[row + own, columns.start + own] = 1.0
            row += moving.nvExtended
        return found
