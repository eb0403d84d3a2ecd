"""The spanning tree by a Pinocchio model, as kinematics asks for it: its joints, configurations and places."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
import pinocchio as pin

from eurdf.array import Mask, Matrix, Vector
from eurdf.closures.coupling import Coordinate
from eurdf.diagnostics.wording import meant
from eurdf.mechanism.body import Anchor
from eurdf.mechanism.mechanism import ROOT_JOINT, Mechanism
from eurdf.pinocchio.arguments import checked_data
from eurdf.pinocchio.configuration import Slot
from eurdf.pinocchio.frames import body_frame_ids, frame_index, placement_of
from eurdf.pinocchio.memory import Cached
from eurdf.pinocchio.springs import NO_SPRINGS, Springs, build_springs
from eurdf.pinocchio.tree_dynamics import MOST_VELOCITIES_WITH_DATA, TreeDynamics, TreeRecursion
from eurdf.pinocchio.tree_few import Site


class MovingJoint(NamedTuple):
    """How a joint moves: where its coordinates are neutral, and by its velocities from there.

    Attributes:
        name: Its name.
        parent: Index of its parent.
        placement: Pose (4, 4) of its moving frame in its parent's, where its coordinates are neutral.
        subspace: Motion subspace (6, n) there: rows linear, then angular, in its moving frame.
        nq: Number of its own coordinates: none of one that mimics another.
        idx_q: Index in q of the first coordinate; its leader's if it mimics.
        idx_v: Indices (n,) in v of the velocities that move it.
    """

    name: str
    parent: int
    placement: Matrix
    subspace: Matrix
    nq: int
    idx_q: int
    idx_v: tuple[int, ...]


class Tree(Cached):
    """A spanning tree.

    Its joints are those of the model, numbered from the root, number 0, to the leaves: a parent has a lower number.

    Attributes:
        model: The model.
        springs: The springs of its joints, which the model does not contain.
        derived: What kinematics has computed from the tree and keeps with it.
    """

    #: The frame of the world.
    world = Site(0, pin.SE3.Identity())

    def __init__(
        self,
        model: pin.Model,
        sites: Mapping[str, Site],
        at: Mapping[str, Slot],
        springs: Springs = NO_SPRINGS,
    ) -> None:
        """Take a model, where the frame of each body is, and where each joint has its own coordinates."""
        self.model = model
        self.springs = springs
        self._sites = sites
        self.derived: dict[Any, Any] = {}
        self._slots = at

    @cached_property
    def nq(self) -> int:
        """Number of coordinates."""
        return int(self.model.nq)

    @cached_property
    def nv(self) -> int:
        """Number of velocities."""
        return int(self.model.nv)

    @cached_property
    def parents(self) -> list[int]:
        """Of each joint its parent."""
        return list(self.model.parents.tolist())

    @cached_property
    def own_velocities(self) -> list[range]:
        """Of each joint the indices in v of its own velocities: none of one that mimics another."""
        return _ranges(self.model.idx_vs, self.model.nvs)

    @cached_property
    def own_coordinates(self) -> list[range]:
        """Of each joint the indices in q of its own coordinates."""
        return _ranges(self.model.idx_qs, self.model.nqs)

    @cached_property
    def moving_velocities(self) -> list[range]:
        """Of each joint the indices in v of the velocities that move it: its leader's if it mimics."""
        return _ranges(self.model.idx_vs, self.model.nvExtendeds)

    @cached_property
    def reach(self) -> list[float]:
        """Of each joint the distance of its origin from that of its parent at zero, m."""
        return [math.hypot(*placement.translation) for placement in self.model.jointPlacements]

    def translates(self, joint: int) -> Mask:
        """Which of the velocities of a joint only translate, m/s; the others turn, rad/s."""
        return np.asarray(~self.moving_joints[joint - 1].subspace[3:].any(axis=0))

    @cached_property
    def commutes(self) -> bool:
        """Whether q ⊕ v ⊕ w is q ⊕ (v + w): no joint has several velocities."""
        return all(len(own) <= 1 for own in self.own_velocities)

    @cached_property
    def velocity_names(self) -> list[str]:
        """For each velocity (nv) the name of its joint."""
        names = [ROOT_JOINT] * self.nv
        for name, slot in self._slots.items():
            names[slot.idx_v : slot.idx_v + slot.nv] = [name] * slot.nv
        return names

    @cached_property
    def in_series(self) -> dict[int, int]:
        """The first of each two joints that are one joint of the mechanism, with the second, which has its name."""
        own = [self.model.getJointId(name) for name, slot in self._slots.items() if slot.nv > 1]
        return {self.parents[joint]: joint for joint in own if len(self.own_velocities[joint]) == 1}

    @property
    def position_limits(self) -> tuple[Vector, Vector]:
        """The lower and the upper position limits (nq,) as in the files, both zero where there is no range."""
        return np.array(self.model.lowerPositionLimit), np.array(self.model.upperPositionLimit)

    @property
    def damping(self) -> Vector:
        """The viscous damping (nv,) of the joints, N·m·s/rad and N·s/m."""
        return np.array(self.model.damping)

    @property
    def dry_friction(self) -> Vector:
        """The dry friction (nv,) of the joints, N·m and N."""
        return np.array(self.model.upperDryFrictionLimit)

    @cached_property
    def whole_turns(self) -> Mask:
        """Which velocities (nv,) drive an angle whose whole turns change nothing, since it is not unwrapped."""
        turns: Mask = np.zeros(self.nv, dtype=bool)
        for joint, (q, v) in enumerate(zip(self.own_coordinates, self.own_velocities, strict=True)):
            if len(v) and len(q) == len(v):
                turns[v.start : v.stop] = ~self.moving_joints[joint - 1].subspace[:3].any(axis=0)
        for joint in self.model.mimicking_joints:  # a multiplier of 0.5 makes whole turns matter
            turns[self.model.idx_vs[joint]] = False
        return turns

    def velocities_of(self, joint: str) -> range:
        """The indices in v of the velocities that move a joint: its leader's if it mimics.

        Raises:
            ValueError: The tree has no such joint.
        """
        slot = self._slots.get(joint)
        if slot is not None and slot.nv:
            return range(slot.idx_v, slot.idx_v + slot.nv)
        if not self.model.existJointName(joint):
            raise ValueError(f"the model has no joint '{joint}'{meant(joint, self.model.names)}")
        index: int = self.model.getJointId(joint)
        return self.moving_velocities[index]

    @cached_property
    def moving_joints(self) -> list[MovingJoint]:
        """Its joints but the universe; a mimic joint has the first coordinate and the velocity of its leader."""
        model, found, neutral = self.model, [], pin.neutral(self.model)
        for index in range(1, model.njoints):
            moving = model.joints[index]
            data = moving.createData()
            moving.calc(data, neutral)
            placement = (model.jointPlacements[index] * data.M).homogeneous
            S, first = np.array(data.S.reshape(6, -1)), moving.idx_v
            idx_v = tuple(range(first, first + moving.nvExtended))
            name, parent = model.names[index], self.parents[index]
            found.append(MovingJoint(name, parent, placement, S, moving.nq, moving.idx_q, idx_v))
        return found

    def joint_of(self, anchor: Anchor) -> int:
        """The joint that carries an anchor; 0 if nothing moves it."""
        return self._sites[anchor.body].joint

    def distance_of(self, anchor: Anchor) -> float:
        """Distance of an anchor from the joint that carries it, m."""
        return math.hypot(*self.site(anchor).placement.translation)

    def site(self, anchor: Anchor) -> Site:
        """Where an anchor is."""
        joint, placement = self._sites[anchor.body]
        return Site(joint, placement * placement_of(anchor.pose))

    def coordinate(self, joint: str) -> Coordinate:
        """The coordinate of a joint that has one of its own.

        Raises:
            ValueError: The joint has none, or several.
        """
        slot = self._slots.get(joint)
        if slot is None or (slot.nq, slot.nv) != (1, 1):
            raise ValueError(f"joint '{joint}' does not have one coordinate of its own")
        owner = next(index for index, own in enumerate(self.own_velocities) if slot.idx_v in own)
        return Coordinate(owner, slot.idx_q, slot.idx_v, bool(self.translates(owner)[0]))

    def neutral(self) -> Vector:
        """The neutral configuration (nq,)."""
        return np.array(pin.neutral(self.model))

    def integrate(self, q: Vector, v: Vector) -> Vector:
        """The configuration (nq,) that v (nv,) leads to from q in unit time, q ⊕ v."""
        return np.asarray(pin.integrate(self.model, q, v))

    def integrate_derivative(self, q: Vector, v: Vector) -> Matrix:
        """Derivative (nv, nv) of q ⊕ v by v."""
        return np.asarray(pin.dIntegrate(self.model, q, v, pin.ARG1))

    def difference(self, q: Vector, other: Vector) -> Vector:
        """The velocity (nv,) that leads from q to the other configuration in unit time."""
        return np.asarray(pin.difference(self.model, q, other))

    def difference_derivative(self, q: Vector, other: Vector) -> Matrix:
        """Derivative (nv, nv) of `difference` by the motion of the other configuration."""
        return np.asarray(pin.dDifference(self.model, q, other, pin.ARG1))

    def normalized(self, q: Vector) -> Vector:
        """The configuration with its quaternions, and cosines and sines, of unit length."""
        return np.asarray(pin.normalize(self.model, q))

    def is_normalized(self, q: Vector, tolerance: float = 1e-9) -> bool:
        """Whether they are of unit length, to the tolerance."""
        return bool(pin.isNormalized(self.model, q, tolerance))

    def dynamics(self, data: pin.Data | None = None) -> TreeDynamics:
        """Its dynamics in the given `pin.Data`; by default in a new one, or joint by joint if the tree is large.

        Raises:
            ValueError: It is no `pin.Data`, or one of another model.
        """
        if data is None and self.nv > MOST_VELOCITIES_WITH_DATA:
            return TreeRecursion(self.model, self.springs)
        return TreeDynamics(self.model, self.springs, checked_data(self.model, data))

    def frame_sites(self, names: Sequence[str]) -> list[Site]:
        """Where frames are. A frame is named by a link, a joint (its frame on the child side), or in the description.

        Raises:
            ValueError: A frame is unknown, or two different frames have this name.
        """
        frames = [self.model.frames[frame_index(self.model, name)] for name in names]
        return [Site(frame.parentJoint, pin.SE3(frame.placement)) for frame in frames]

    def jacobian_along(self, joints: Sequence[int], q: Vector) -> Matrix:
        """The world Jacobian (6, nvExtended) at q (nq,), zero but in the columns of the joints and of their ancestors.

        Rows are linear, of the point at the origin of the world, and angular. A mimic joint has columns
        of its own, those from ``model.idx_vExtendeds[joint]``.
        """
        model, needed = self.model, {0}
        for joint in joints:
            while joint not in needed:
                needed.add(joint)
                joint = self.parents[joint]
        placements, J = {0: pin.SE3.Identity()}, np.zeros((6, model.nvExtended))
        for joint in sorted(needed - {0}):  # a parent has a lower index than its child
            moving = model.joints[joint]
            data = moving.createData()
            moving.calc(data, q)
            oMi = placements[joint] = placements[self.parents[joint]] * model.jointPlacements[joint] * data.M
            first = model.idx_vExtendeds[joint]
            J[:, first : first + moving.nvExtended] = oMi.toActionMatrix() @ data.S.reshape(6, -1)
        return J


def build_tree(mechanism: Mechanism, model: pin.Model, at: Mapping[str, Slot]) -> Tree:
    """The tree of a mechanism, whose `build_model` and `slots` are given."""
    frames = model.frames
    sites = {
        name: Site(frames[index].parentJoint, pin.SE3(frames[index].placement))
        for name, index in body_frame_ids(mechanism).items()
    }
    return Tree(model, sites, at, build_springs(mechanism, at))


def _ranges(first: Sequence[int], count: Sequence[int]) -> list[range]:
    return [range(start, start + number) for start, number in zip(first, count, strict=True)]
