"""Columns of K and M that stand for other velocities than those of the specification."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pinocchio as pin

from eurdf.mechanism.joint_type import JointType
from eurdf.mechanism.mechanism import ROOT_JOINT
from eurdf.pinocchio.coordinates import slots
from eurdf.pinocchio.robot import Robot
from eurdf_conformance.adapters import reference_values
from eurdf_conformance.mutants.deviation import Deviation, around, result, together
from eurdf_conformance.mutants.mutant import mutant
from eurdf_conformance.mutants.of_the_reference import values
from eurdf_conformance.protocol.message import Jacobian, MassMatrix, Values

#: From the coordinates of a joint, as Pinocchio has them, J in v = J w, where w are the other velocities.
_Other = Callable[[Any], Any]


def _velocities(kind: JointType, other: _Other) -> Deviation:
    """The velocities of joints of one type are others: K J and Jᵀ M J in place of K and M."""

    def derivative(robot: Robot, q: Any) -> Any:
        J = np.eye(robot.model.nv)
        for slot in slots(robot.mechanism, robot.model).values():
            if slot.joint.type is kind:
                columns = slice(slot.idx_v, slot.idx_v + slot.nv)
                J[columns, columns] = other(q[slot.idx_q : slot.idx_q + slot.nq])
        if kind is JointType.FLOATING and robot.mechanism.root == "floating":
            J[:6, :6] = other(q[:7])
        return J

    def jacobian(original: Any, robot: Robot, q: Any, data: Any) -> Any:
        r, K = original(robot, q, data)
        return r, K @ derivative(robot, q)

    def mass_matrix(original: Any, robot: Robot, q: Any) -> Any:
        J = derivative(robot, q)
        return J.T @ original(robot, q) @ J

    return together(
        around(reference_values, "residual_and_jacobian", jacobian),
        around(reference_values, "_mass_matrix", mass_matrix),
    )


def _rotation(quaternion: Any) -> Any:
    return pin.Quaternion(quaternion[3], *quaternion[:3]).matrix()


@mutant("EU-JNT-026")
def ball_seen_from_the_joint() -> Deviation:
    """The angular velocity of a spherical joint is along the axes of the joint at rest, not of its child."""
    return _velocities(JointType.SPHERICAL, lambda q: _rotation(q).T)


@mutant("EU-JNT-026")
def root_seen_from_the_world() -> Deviation:
    """The velocities of a floating joint are along the axes at rest, those of the world for a root."""
    return _velocities(JointType.FLOATING, lambda q: np.kron(np.eye(2), _rotation(q[3:]).T))


@mutant("EU-JNT-026")
def linear_velocity_seen_from_the_world() -> Deviation:
    """The linear velocity of a floating joint is along the axes at rest, the angular one along its child's: MuJoCo."""

    def other(q: Any) -> Any:
        J = np.eye(6)
        J[:3, :3] = _rotation(q[3:]).T
        return J

    return _velocities(JointType.FLOATING, other)


@mutant("EU-JNT-026")
def angular_velocity_first() -> Deviation:
    """The velocities of a floating joint are angular, then linear, as in Featherstone and Drake."""
    return _velocities(JointType.FLOATING, lambda q: np.roll(np.eye(6), 3, axis=0))


@mutant("EU-JNT-026")
def planar_seen_from_the_joint() -> Deviation:
    """The velocities of a planar joint are the derivatives of its coordinates."""

    def other(q: Any) -> Any:
        cos, sin = q[2:]
        return np.array([[cos, sin, 0.0], [-sin, cos, 0.0], [0.0, 0.0, 1.0]])

    return _velocities(JointType.PLANAR, other)


@mutant("EU-JNT-026", versions=("2",))  # version 1 has no cylindrical joints
def cylindrical_velocities_reversed() -> Deviation:
    """The velocities of a cylindrical joint are angular, then linear."""
    return _velocities(JointType.CYLINDRICAL, lambda q: np.eye(2)[::-1])


@mutant("EU-JNT-026", versions=("2",))  # version 1 has no helical joints
def helical_velocity_is_linear() -> Deviation:
    """The velocity of a helical joint is that along its axis, in units of 10 mm/s."""
    return _velocities(JointType.HELICAL, lambda q: np.array([[100.0]]))


@mutant("EU-JNT-026", versions=("2",))  # version 1 has two hinges, named apart
def universal_velocities_reversed() -> Deviation:
    """The first velocity of a universal joint is that about its second axis."""
    return _velocities(JointType.UNIVERSAL, lambda q: np.eye(2)[::-1])


@mutant("EU-JNT-026")
def quaternion_rates_of_a_ball() -> Deviation:
    """The velocities of a spherical joint are twice the derivatives of x, y and z of its quaternion."""

    def other(q: Any) -> Any:
        x, y, z, w = q
        E = np.array([[w, -z, y], [z, w, -x], [-y, x, w]])  # dx/dt = E ω / 2
        return np.linalg.inv(E)

    return _velocities(JointType.SPHERICAL, other)


@mutant("EU-PRO-007", versions=("2",))  # in version 1 no joint mimics
def followers_have_columns() -> Deviation:
    """A joint that mimics has columns of its own, of zeros."""

    def columns(original: Any, self: Any, kind: Any, more: Any) -> Any:
        followers = [(joint.name, 0) for joint in self.robot.mechanism.joints if joint.mimic]
        return more(original(self), followers)

    def jacobian(K: Jacobian, followers: Any) -> Jacobian:
        zeros = [0.0] * len(followers)
        rows = {name: [[*row, *zeros] for row in of] for name, of in K.rows.items()}
        return K.model_copy(update={"columns": [*K.columns, *followers], "rows": rows})

    return around(
        reference_values.Quantities, "jacobian", lambda original, self: columns(original, self, Jacobian, jacobian)
    )


@mutant("EU-PRO-007", versions=("2",))  # the root of version 1 is fixed
def root_has_no_columns() -> Deviation:
    """The velocities of a floating root are not named."""

    def without(columns: Any) -> Any:
        return [column for column in columns if column[0] != ROOT_JOINT]

    def changed(said: Values) -> dict[str, Any]:
        found: dict[str, Any] = {}
        if said.jacobian is not None:
            K, kept = said.jacobian, without(said.jacobian.columns)
            first = len(K.columns) - len(kept)
            rows = {name: [row[first:] for row in of] for name, of in K.rows.items()}
            found["jacobian"] = Jacobian(columns=kept, rows=rows)
        if said.mass_matrix is not None:
            M, kept = said.mass_matrix, without(said.mass_matrix.columns)
            first = len(M.columns) - len(kept)
            found["mass_matrix"] = MassMatrix(columns=kept, matrix=[row[first:] for row in M.matrix[first:]])
        return found

    return values(changed)


@mutant("EU-PRO-007")
def columns_by_joint_alone() -> Deviation:
    """Each column of a joint is said to be its first."""
    return result(reference_values, "_columns", lambda columns: [(name, 0) for name, _ in columns])


@mutant("EU-PRO-008")
def k_of_single_precision() -> Deviation:
    """K is computed in single precision."""

    def jacobian(original: Any, *arguments: Any) -> Any:
        r, K = original(*arguments)
        return r, K.astype(np.float32).astype(float)

    return around(reference_values, "residual_and_jacobian", jacobian)


@mutant("EU-PRO-009")
def mass_matrix_of_single_precision() -> Deviation:
    """M is computed in single precision."""
    return result(reference_values, "_mass_matrix", lambda M: M.astype(np.float32).astype(float))
