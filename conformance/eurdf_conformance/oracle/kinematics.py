"""Where the bodies are and how they can move, seen from the root link.

Residuals, K and M do not depend on the pose of a floating root, so none of them loses digits if that is far away.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from eurdf_conformance.oracle.spatial import Array, adjoint
from eurdf_conformance.oracle.transform import motion, transform
from eurdf_conformance.oracle.tree import Placed, Tree


@dataclass(frozen=True)
class Kinematics:
    """Of a tree at one configuration."""

    #: wMr, pose of the root link in the world.
    root: Array
    #: rMb, pose of each body in the root link.
    bodies: Array
    #: 6 × velocities of all joints, mimics too: twist of what each moves, seen from the root link where it is.
    columns: Array
    #: Bodies × these velocities: which of them move which body.
    moves: NDArray[np.bool_]

    def pose(self, frame: Placed) -> Array:
        """Of a frame, in the root link."""
        return np.asarray(self.bodies[frame.body] @ frame.pose)


def kinematics(tree: Tree, q: list[Array]) -> Kinematics:
    """Of a tree at the coordinates of its joints.

    rMc = rMp pMj jMc(q), and a column is the twist that the child's frame sees, seen from the root link.
    """
    nv = [joint.kind.nv for joint in tree.joints]
    first = np.concatenate([[0], np.cumsum(nv)])
    bodies = np.empty((len(tree.joints), 4, 4))
    columns = np.zeros((6, first[-1]))
    moves = np.zeros((len(tree.joints), first[-1]), dtype=bool)
    for i, joint in enumerate(tree.joints):
        own = slice(first[i], first[i + 1])
        jMc = transform(joint.type, joint.axes, joint.pitch, q[i])
        if i == 0:
            root, bodies[0] = jMc, np.eye(4)
        else:
            bodies[i] = bodies[joint.parent] @ joint.placement @ jMc
            moves[i] = moves[joint.parent]
        columns[:, own] = adjoint(bodies[i]) @ motion(joint.type, joint.axes, joint.pitch, q[i])
        moves[i, own] = True
    return Kinematics(root, bodies, columns, moves)
