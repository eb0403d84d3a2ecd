"""Named frames of many elements: their poses in the world, and their Jacobians."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from eurdf.kinematics.array import Matrix
from eurdf.kinematics.old_batch import rigid
from eurdf.kinematics.old_batch.stack import frame_at
from eurdf.kinematics.old_batch.tree import BatchTree, Place, Site

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot


class BatchFrames:
    """Some frames of a tree; plain data, which can be pickled.

    Attributes:
        sites: Where they are.
    """

    def __init__(self, robot: Robot, tree: BatchTree, names: Sequence[str]) -> None:
        """Take the frames with these names.

        Raises:
            ValueError: A frame is unknown, or two different frames have this name.
        """
        found = [frame for _, frame in robot.tree.frames(list(names)).pairs]
        self._tree = tree
        self.sites = [
            Site(tree.joint_of(joint), np.array(placement.rotation), np.array(placement.translation))
            for joint, placement in found
        ]
        self._joints = sorted(set().union(*(tree.path(site.joint) for site in self.sites)))

    def place(self, q: Matrix) -> Place:
        """Where the joints are at q (nq, B)."""
        return self._tree.place(self._joints, q)

    def poses(self, place: Place, count: int) -> list[tuple[Matrix, Matrix]]:
        """Rotation (3, 3, B) and origin (3, B) of each frame in the world, of ``count`` elements."""
        return [
            (np.broadcast_to(R, (3, 3, count)), np.broadcast_to(p, (3, count)))
            for R, p in (frame_at(site, place) for site in self.sites)
        ]

    def jacobians(self, q: Matrix, place: Place) -> list[Matrix]:
        """For each frame the velocity of its origin and its angular velocity by v, in world axes, (6, nv, B)."""
        twists = {joint: self._tree.twists(joint, q, place.rotation[joint]) for joint in self._joints}
        jacobians = []
        for site, (_, p) in zip(self.sites, self.poses(place, q.shape[1]), strict=True):
            J = np.zeros((6, self._tree.nv, q.shape[1]))
            for joint in self._tree.path(site.joint):
                linear, angular = twists[joint]
                first = self._tree.joints[joint].idx_v
                columns = slice(first, first + linear.shape[1])
                arm = np.broadcast_to((p - place.position[joint])[:, None], angular.shape)
                J[:3, columns] += linear + rigid.cross(angular, arm)
                J[3:, columns] += angular
            jacobians.append(J)
        return jacobians
