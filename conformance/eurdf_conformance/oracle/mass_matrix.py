"""Mass, centre of mass and the joint-space inertia: chapter Inertia, EU-INR-005 and 006."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from eurdf_conformance.oracle.kinematics import Kinematics
from eurdf_conformance.oracle.spatial import Array
from eurdf_conformance.oracle.tree import Placed
from eurdf_conformance.oracle.urdf import Inertia

#: Inertias and poses of links.
Masses = Iterable[tuple[Inertia, Placed]]


def mass_matrix(at: Kinematics, sharing: Array, armature: Array, masses: Masses) -> Array:
    """M = Gᵀ (Σ m J_cᵀ J_c + J_ωᵀ I J_ω) G + diag(armature), so that ½ vᵀ M v is the kinetic energy.

    The sum is over links. J_c and J_ω take the velocities of all joints to ċ = v + ω × c of the link's centre of mass,
    and to its ω; I is about c. What is on one body needs no sum of its own: it has the same columns.
    """
    M = np.zeros((at.columns.shape[1],) * 2)
    for inertia, link in masses:
        moves = at.moves[link.body]
        v, w = at.columns[:3, moves], at.columns[3:, moves]
        rMl = at.pose(link)
        c = rMl[:3, :3] @ inertia.center + rMl[:3, 3]
        of_center = v + np.cross(w, c, axisa=0, axisc=0)
        along_link = rMl[:3, :3].T @ w
        M[np.ix_(moves, moves)] += inertia.mass * of_center.T @ of_center + along_link.T @ inertia.moments @ along_link
    return np.asarray(sharing.T @ M @ sharing + np.diag(armature))


def mass(masses: Masses) -> float:
    """Mass of all bodies, including the root, kg."""
    return float(sum(inertia.mass for inertia, _ in masses))


def center_of_mass(at: Kinematics, masses: Masses) -> Array | None:
    """Centre of mass in the world, m: Σ m c / Σ m; undefined for a robot without mass."""
    total, moment = 0.0, np.zeros(3)
    for inertia, link in masses:
        rMl = at.pose(link)
        total += inertia.mass
        moment += inertia.mass * (rMl[:3, :3] @ inertia.center + rMl[:3, 3])
    if total == 0.0:
        return None
    return np.asarray(at.root[:3, :3] @ (moment / total) + at.root[:3, 3])
