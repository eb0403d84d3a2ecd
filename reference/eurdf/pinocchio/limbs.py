"""Limbs: parts of a tree that share a trunk alone, each with a model of its own.

A `pin.Data` takes some 64 nv³ bytes, and time that grows with nv² or more. The limbs of a legged robot, or many loops
on one base, take the sum of theirs. A joint of the trunk is part of each limb that it carries, with an equal share of
its inertia: generalized forces, the mass matrix and energies are the sums of those of the limbs.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from functools import cached_property

import numpy as np
import pinocchio as pin

from eurdf.array import Indices, Matrix, Vector
from eurdf.mechanism.body import Anchor
from eurdf.pinocchio.springs import NO_SPRINGS
from eurdf.pinocchio.tree import Tree
from eurdf.pinocchio.tree_dynamics import TreeDynamics
from eurdf.pinocchio.tree_few import Site, as_slice, model_of_joints


class Limb:
    """A part of a tree, or all of it.

    Attributes:
        model: Its model.
        is_whole: Whether it is all of the tree.
        velocities: Indices (n,) in v of its velocities.
    """

    def __init__(self, tree: Tree, joints: Sequence[int] | None = None, shares: Counter[int] | None = None) -> None:
        """Take joints, ascending, with all that carry them, and the number of limbs that have each; all by default."""
        self._site, self._whole = tree.site, tree.model
        self.is_whole = joints is None or shares is None
        self._index: dict[int, int] | None = None
        self.velocities: Indices = np.arange(tree.nv)
        self._own_q: slice | Indices | None = None
        self._own_v: slice | Indices | None = None
        if joints is None or shares is None:
            self.model = tree.model
            return
        self.model, self._index = model_of_joints(tree.model, tree.parents, joints)
        self._shares = {joint: shares[joint] for joint in joints}
        self.velocities = np.array([each for joint in joints for each in tree.own_velocities[joint]], dtype=np.intp)
        coordinates = [each for joint in joints for each in tree.own_coordinates[joint]]
        self._own_q, self._own_v = as_slice(np.array(coordinates, dtype=np.intp)), as_slice(self.velocities)
        self._share_of_v = np.array([shares[joint] for joint in joints for _ in tree.own_velocities[joint]])
        self.update()

    def update(self) -> None:
        """Take its share of the inertias, armature and gravity that the model of the tree has now."""
        own, whole = self.model, self._whole
        for index, (joint, share) in enumerate(self._shares.items(), 1):
            inertia = whole.inertias[joint]
            own.inertias[index] = pin.Inertia(inertia.mass / share, inertia.lever, inertia.inertia / share)
            own.jointPlacements[index] = whole.jointPlacements[joint]
        own.armature = self.part_of_v(whole.armature) / self._share_of_v
        own.gravity = whole.gravity

    def part_of_q(self, q: Vector) -> Vector:
        """Its part of q (nq,) of the tree."""
        return q if self._own_q is None else q[self._own_q]

    def part_of_v(self, v: Vector) -> Vector:
        """Its part (n, …) of an array (nv, …) of the tree."""
        return v if self._own_v is None else v[self._own_v]

    def site(self, anchor: Anchor) -> Site:
        """Where an anchor is in its model."""
        joint, placement = self._site(anchor)
        return Site(joint if self._index is None else self._index[joint], placement)

    @cached_property
    def dynamics(self) -> TreeDynamics:
        """Its dynamics, in memory of its own, without springs."""
        return TreeDynamics(self.model, NO_SPRINGS, self.model.createData())


class LimbsDynamics(TreeDynamics):
    """The dynamics of a tree, limb by limb.

    Attributes:
        limbs: The limbs.
        trunk: Indices (t,) in v of the velocities that several limbs have.
        shares: Number (nv,) of the limbs that have each velocity.
    """

    def __init__(self, tree: Tree, limbs: Sequence[Sequence[int]]) -> None:
        """Take the joints of each limb, ascending, with all that carry them."""
        super().__init__(tree.model, tree.springs, None)
        shares = Counter(joint for joints in limbs for joint in joints)
        self.limbs = [Limb(tree, joints, shares) for joints in limbs]
        self.shares = np.bincount(np.concatenate([limb.velocities for limb in self.limbs]), minlength=tree.nv)
        self.trunk = np.flatnonzero(self.shares > 1)
        self._known = tree.model.copy()

    def update(self) -> None:
        """Take over what was changed in the model of the tree."""
        if self.model != self._known:
            for limb in self.limbs:
                limb.update()
            self._known = self.model.copy()

    def inverse_dynamics(self, q: Vector, v: Vector, a: Vector) -> Vector:
        """The sum of those of the limbs."""
        force = np.zeros(len(v))
        for limb in self.limbs:
            own = limb.part_of_q(q), limb.part_of_v(v), limb.part_of_v(a)
            force[limb.velocities] += limb.dynamics.inverse_dynamics(*own)
        return force

    def mass_times(self, q: Vector, motions: Matrix) -> Matrix:
        """The sum of those of the limbs."""
        found = np.zeros(motions.shape)
        for limb in self.limbs:
            found[limb.velocities] += limb.dynamics.mass_times(limb.part_of_q(q), limb.part_of_v(motions))
        return found

    def inverse_mass_diagonal(self, q: Vector) -> Vector:
        """The same of the limbs alone, which is at least as large: what the trunk carries besides is left out."""
        found = np.full(self.model.nv, np.inf)
        for limb in self.limbs:
            own = limb.dynamics.inverse_mass_diagonal(limb.part_of_q(q))
            found[limb.velocities] = np.minimum(found[limb.velocities], own)
        return found

    def kinetic_energy(self, q: Vector, v: Vector) -> float:
        """The sum of those of the limbs, J."""
        return sum(limb.dynamics.kinetic_energy(limb.part_of_q(q), limb.part_of_v(v)) for limb in self.limbs)

    def _energy_of_gravity(self, q: Vector) -> float:
        return sum(limb.dynamics.potential_energy(limb.part_of_q(q)) for limb in self.limbs)
