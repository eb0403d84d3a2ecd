"""The inertia of motors and linkages, as joints feel it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from eurdf.array import Matrix, Vector, numbers
from eurdf.errors import NoTransmission
from eurdf.kinematics.dynamics import mass_matrix
from eurdf.kinematics.finite import finite, overflow_refused
from eurdf.kinematics.named import Named
from eurdf.kinematics.tolerances import FLOOR, MASSLESS
from eurdf.loading import of_any_robot
from eurdf.mechanism.mechanism import ROOT_JOINT
from eurdf.pinocchio.arguments import checked_array
from eurdf.pinocchio.robot import build_robot
from eurdf.transmissions.motors import linkage_bodies, sides
from eurdf.transmissions.selection import Selection, listed
from eurdf.transmissions.transmission import Transmission, at_one, configurations, require

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class ReflectedInertia:
    """The terms of the inertia that joints feel, as `reflected_inertia` returns them.

    Each term is symmetric, (nJ, nJ), or (B, nJ, nJ) for several configurations; kg·m² between angles, kg·m between an
    angle and a length, kg between lengths.

    Attributes:
        joints: Names of the joints, nJ.
        motors: Names of the motors.
        bodies: Names of the bodies of the linkage: those that the equivalent serial robot does not have.
        rotors: Gᵀ I_m G, with I_m the armature of the motors.
        linkage: Inertia of the bodies of the linkage.
        serial: Inertia of the other bodies.
        other_armature: Armature of the joints that are not motors.
    """

    joints: tuple[str, ...]
    motors: tuple[str, ...]
    bodies: tuple[str, ...]
    rotors: Matrix
    linkage: Matrix
    serial: Matrix
    other_armature: Matrix

    @property
    def total(self) -> Matrix:
        """M_J, the sum of all terms: at rest, τ_J = M_J a_J beside gravity."""
        return np.asarray(self.rotors + self.linkage + self.serial + self.other_armature)

    @property
    def equivalent_armature(self) -> Matrix:
        """Gᵀ I_m G and the inertia of the linkage: what a serial robot lacks.

        A simulator takes its diagonal as armature, if the masses of the linkage are left out there. What that neglects
        is off the diagonal, and how the terms change with the configuration.
        """
        return np.asarray(self.rotors + self.linkage)

    def __repr__(self) -> str:
        armature = np.diagonal(self.equivalent_armature, axis1=-2, axis2=-1)
        return f"<ReflectedInertia of {', '.join(self.joints)}: equivalent armature {numbers(armature)} kg·m² or kg>"


@of_any_robot
@overflow_refused("the inertia")
def reflected_inertia(
    robot: Robot,
    joints: str | Iterable[str],
    q: Named | Matrix | None = None,
    *,
    motors: str | Iterable[str] | None = None,
    armature: Mapping[str, float] | None = None,
) -> ReflectedInertia:
    """The inertia that joints feel, by constraint embedding: M_J = Nᵀ M N with N = dq/dq_J.

    N keeps the loops closed, the base, and all actuated joints that are neither among the joints nor among their
    motors, at rest. Motions that no actuator controls, such as the spin of a rod, follow by their own inertia: of all
    such N, it is the one with the least kinetic energy. Forces that are quadratic in velocities (Nᵀ M Ṅ) and the
    coupling with a moving base are no part of it.

    Source of constraint embedding: Jain, *Multibody graph transformations and analysis, part II*, 2012.

    Args:
        robot: The robot.
        joints: As in `transmission`.
        q: A closed configuration (nq,), or several (B, nq). The default is the `assembled` configuration, or the
            neutral one if there is none.
        motors: As in `transmission`.
        armature: By motor, its inertia after the gear, gear_ratio² · rotor_inertia, in kg·m² or kg, in place of that
            of the robot.

    Raises:
        NoTransmission: G does not exist, or the joints depend on each other.
        NotClosable: The loops are open at q.
        ValueError: An argument is wrong, as in `transmission`, or an inertia is negative.
    """
    chosen, by = sides(robot, joints, motors)
    rotors = _rotors(robot, by, armature)
    bodies, linkage = robot.cached(_linkage, chosen.joints, by.joints)
    each, single = configurations(robot, q)
    rows = [_terms(robot, linkage, at_one(robot, chosen, own, by), rotors) for own in each]
    terms = np.array(rows).reshape(-1, 4, len(chosen), len(chosen))
    finite("the inertia", terms)
    return ReflectedInertia(chosen.names, by.names, bodies, *(terms[0] if single else terms.swapaxes(0, 1)))


def _terms(robot: Robot, linkage: Robot, at: Transmission, rotors: Vector) -> tuple[Matrix, ...]:
    """Rotors, linkage, serial and other armature (nJ, nJ)."""
    (G,) = require(at, "G")
    if at.rank_joints < len(at.joints):
        raise NoTransmission("the inertia of the joints", "they depend on each other; leave out some of them")
    M, M_linkage = mass_matrix(robot, at.q), mass_matrix(linkage, at.q)
    armature = np.array(robot.model.armature)
    N = _embedding(robot, at, M)
    serial = M - M_linkage - np.diag(armature)
    armature[at.motor_index] = 0.0
    terms = (N.T @ M_linkage @ N, N.T @ serial @ N, (N.T * armature) @ N)
    return tuple(0.5 * (term + term.T) for term in ((G.T * rotors) @ G, *terms))


def _embedding(robot: Robot, at: Transmission, M: Matrix) -> Matrix:
    """N (nv, nJ): of the motions with unit joint velocities and others at rest, those with the least energy."""
    Z, n = at.motions, len(at.joints)
    still = [*robot.actuation.idx_v.tolist()]
    if robot.mechanism.root == "floating":
        still += robot.tree.velocities_of(ROOT_JOINT)
    others = np.setdiff1d(still, np.concatenate((at.joint_index, at.motor_index)))
    rows = Z[np.concatenate((at.joint_index, others))]
    left, values, right = np.linalg.svd(rows)
    rank = int(np.count_nonzero(values > np.sqrt(FLOOR) * values.max(initial=0.0)))
    wanted = np.vstack((np.eye(n), np.zeros((len(others), n))))
    N = Z @ (right[:rank].T / values[:rank]) @ (left[:, :rank].T @ wanted)
    missed = np.abs(N[at.joint_index] - np.eye(n)).max()
    if missed > np.sqrt(FLOOR):
        held = listed(name for name in robot.actuation.joints if robot.slots[name].idx_v in others)
        raise NoTransmission("the inertia of the joints", f"they cannot move while {held} are at rest")
    free = Z @ right[rank:].T
    inertia, axes = np.linalg.eigh(free.T @ M @ free)
    massive = inertia > MASSLESS * np.abs(M).max()
    U = free @ axes[:, massive]
    return np.asarray(N - U @ ((U.T @ (M @ N)) / inertia[massive, None]))


def _rotors(robot: Robot, motors: Selection, armature: Mapping[str, float] | None) -> Vector:
    """I_m (nm,)."""
    found = dict(zip(motors.names, robot.model.armature[motors.velocities].tolist(), strict=True))
    for name, value in (armature or {}).items():
        if name not in found:
            raise ValueError(f"armature names '{name}', which is no motor of these joints: {', '.join(found)}")
        found[name] = float(checked_array(f"armature['{name}']", value, ()))
        if found[name] < 0.0:
            raise ValueError(f"armature['{name}'] is {found[name]:g}; expected a number of at least 0")
    return np.array(list(found.values()))


def _linkage(robot: Robot, joints: tuple[str, ...], motors: tuple[str, ...]) -> tuple[tuple[str, ...], Robot]:
    """The bodies of the linkage, and the robot with these alone, without armature; the others have no mass."""
    bodies, mechanism = linkage_bodies(robot, *sides(robot, joints, motors)), robot.mechanism
    alone = replace(
        mechanism,
        bodies=tuple(body if body.name in bodies else replace(body, inertia=None) for body in mechanism.bodies),
        joints=tuple(joint.with_properties(replace(joint.properties, armature=())) for joint in mechanism.joints),
    )
    return bodies, build_robot(alone, geometry=False)
