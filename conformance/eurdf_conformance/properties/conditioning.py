"""Whether a mechanism is so well conditioned that rounding decides nothing."""

from __future__ import annotations

import numpy as np

from eurdf_conformance.level import Version
from eurdf_conformance.oracle import OracleRobot
from eurdf_conformance.properties.document import configuration
from eurdf_conformance.properties.mechanism import Configuration, Mechanism
from eurdf_conformance.properties.placement import Matrix
from eurdf_conformance.properties.truth import truth

#: Singular values of K, free of units, are rounding below the first and none is between the two.
ZERO, SMALL = 1e-9, 3e-4

#: The smallest eigenvalue of M, by its largest entry.
_DEFINITE = 1e-6

#: rad, the most that a 6d closure or a hinge is turned by: at a half turn its residual has two values.
_TURN = 2.8

#: m, the least between the ends of a distance: where they meet, its residual has no derivative.
_APART = 0.3


def is_well_conditioned(mechanism: Mechanism, version: Version) -> bool:
    """Whether ranks, the definiteness of M and the logarithm of poses are beyond doubt where it is evaluated."""
    robot = truth(mechanism, version)
    for name, stated in mechanism.configurations.items():
        q = configuration(mechanism, stated, version)
        residuals = robot.residuals(q)
        if any(np.linalg.norm(r[3:]) > _TURN for r in residuals.values()):
            return False
        lengths = {closure.name: closure.length for closure in robot.description.closures if closure.length is not None}
        if any(residuals[each][0] + length < _APART for each, length in lengths.items()):
            return False
        M = robot.mass_matrix(q)
        if len(M) and np.linalg.eigvalsh(M)[0] < _DEFINITE * np.abs(M).max():
            return False
        if name == "assembled" and not has_clear_ranks(robot, q):
            return False
    return True


def has_clear_ranks(robot: OracleRobot, q: Configuration) -> bool:
    """Whether no singular value of K, nor of K and S together, is near zero but not zero."""
    K = scaled(robot.jacobian(q), robot, q)
    for A in (K, np.vstack([K, selection(robot)])):
        values = np.linalg.svd(A, compute_uv=False) if A.size else np.zeros(0)
        if np.any((values > ZERO) & (values < SMALL)):
            return False
    return True


def selection(robot: OracleRobot) -> Matrix:
    """S, which selects the actuated velocities, one row each."""
    driven = {actuator.joint for actuator in robot.description.actuators}
    return np.asarray(np.eye(len(robot.velocities))[[name in driven for name, _ in robot.velocities]])


def scaled(K: Matrix, robot: OracleRobot, q: Configuration) -> Matrix:
    """K free of units: a row in metres is divided by the robot's size, a column of what slides multiplied by it."""
    L = robot.size(q) or 1.0
    rows = [size for sizes in robot.row_sizes(L).values() for size in sizes]
    factors = [L if is_length(robot, column) else 1.0 for column in robot.velocities]
    return np.asarray(K / np.array(rows).reshape(-1, 1) * np.array(factors).reshape(1, -1))


def is_length(robot: OracleRobot, column: tuple[str, int]) -> bool:
    """Whether a velocity is in m/s."""
    types = {joint.name: joint.type for joint in robot.tree.joints}
    lengths = {"prismatic": 1, "cylindrical": 1, "planar": 2, "floating": 3}
    return column[1] < lengths.get(types[column[0]], 0)
