"""Changes values to other velocities, and to another world frame."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from eurdf_conformance.comparison.columns import Column
from eurdf_conformance.properties.placement import Matrix
from eurdf_conformance.protocol.message import Jacobian, MassMatrix, Pose, Values


def moved(values: Values, T: Matrix) -> Values:
    """The values in the world of a robot that was moved as a whole by T."""
    changed: dict[str, object] = {}
    if values.poses is not None:
        changed["poses"] = {name: pose_message(T @ pose_matrix(pose)) for name, pose in values.poses.items()}
    if values.center_of_mass is not None:
        changed["center_of_mass"] = (T[:3, :3] @ values.center_of_mass + T[:3, 3]).tolist()
    return values.model_copy(update=changed)


def in_velocities(values: Values, J: Matrix, columns: Sequence[Column]) -> Values:
    """K J and Jᵀ M J, where v = J w gives the velocities of K and M from other velocities w."""
    changed: dict[str, object] = {}
    if (K := values.jacobian) is not None:
        rows = {name: (np.array(rows).reshape(-1, len(J)) @ J).tolist() for name, rows in K.rows.items()}
        changed["jacobian"] = Jacobian(columns=list(columns), rows=rows)
    if (M := values.mass_matrix) is not None:
        matrix = J.T @ np.array(M.matrix).reshape(len(J), len(J)) @ J
        changed["mass_matrix"] = MassMatrix(columns=list(columns), matrix=matrix.tolist())
    return values.model_copy(update=changed)


def with_poses_of(values: Values, frames: Sequence[str]) -> Values:
    """The same values with the poses of these frames only."""
    if values.poses is None:
        return values
    return values.model_copy(update={"poses": {name: values.poses[name] for name in frames}})


def pose_matrix(pose: Pose) -> Matrix:
    """A pose as a 4×4 matrix."""
    M = np.eye(4)
    M[:3, :3], M[:3, 3] = pose.rotation, pose.translation
    return M


def pose_message(M: Matrix) -> Pose:
    """The message of a 4×4 matrix."""
    return Pose(rotation=M[:3, :3].tolist(), translation=M[:3, 3].tolist())
