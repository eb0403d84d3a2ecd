"""Poses and other quantities of a robot of `eurdf`: Pinocchio's numbers in the conventions of the protocol.

Joint by joint the velocities of `eurdf`'s models are those of the specification, in their order and their frame: only
where they are has to be said. Coordinates differ (an angle may be a cosine and a sine) and are converted by `eurdf`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt
import pinocchio as pin

from eurdf.kinematics.residual import residual_and_jacobian
from eurdf.mechanism.mechanism import ROOT_JOINT, Mechanism
from eurdf.pinocchio.configuration import slots
from eurdf.pinocchio.frames import body_frame_ids, placement_of
from eurdf.pinocchio.robot import Robot
from eurdf_conformance.protocol.message import Jacobian, MassMatrix, Pose, Quantity, Values

Matrix = npt.NDArray[np.float64]


class Quantities:
    """The quantities of a robot at a configuration, each computed when requested."""

    def __init__(self, robot: Robot, configuration: Mapping[str, Sequence[float]], frames: Sequence[str]) -> None:
        """Set the robot's configuration.

        Args:
            robot: The robot.
            configuration: By joint its coordinates as files have them; one left out is at its neutral.
            frames: Names of the frames of which poses are asked for.

        Raises:
            ValueError: A name is no joint with coordinates, or a joint is given too few or too many of them.
        """
        self.robot = robot
        self.frames = frames
        self.q = robot.configuration(configuration)
        pin.forwardKinematics(robot.model, robot.data, self.q)
        self._bodies = body_frame_ids(robot.mechanism)

    def values(self, quantities: Sequence[Quantity]) -> Values:
        """The requested quantities."""
        every: dict[Quantity, Any] = {
            "poses": self.poses,
            "residuals": self.residuals,
            "jacobian": self.jacobian,
            "mass_matrix": self.mass_matrix,
            "mass": self.mass,
            "center_of_mass": self.center_of_mass,
        }
        return Values(**{name: every[name]() for name in quantities})

    def poses(self) -> dict[str, Pose]:
        """The pose of each frame in the world; a ValueError if a name means no frame, or two."""
        found = {}
        for name in self.frames:
            body, placement = _frame(self.robot.mechanism, name)
            oMf = self._body(body) * placement
            found[name] = Pose(rotation=oMf.rotation.tolist(), translation=oMf.translation.tolist())
        return found

    def residuals(self) -> dict[str, list[float]]:
        """The residual of each closure, seen from A, m and rad; and of each coupling."""
        return {name: rows.tolist() for name, rows in self._by_constraint(self._residual_and_jacobian[0]).items()}

    def jacobian(self) -> Jacobian:
        """EU-PRO-007: the constraint Jacobian, a column for each velocity."""
        rows = {name: rows.tolist() for name, rows in self._by_constraint(self._residual_and_jacobian[1]).items()}
        return Jacobian(columns=_columns(self.robot), rows=rows)

    def mass_matrix(self) -> MassMatrix:
        """The joint-space inertia, with armatures."""
        return MassMatrix(columns=_columns(self.robot), matrix=_mass_matrix(self.robot, self.q).tolist())

    def mass(self) -> float:
        """Mass of all bodies, including the root, kg."""
        return float(sum(mass for mass, _ in self._masses))

    def center_of_mass(self) -> list[float] | None:
        """Centre of mass in the world, m; undefined for a robot without mass."""
        mass = self.mass()
        if mass == 0.0:
            return None
        x, y, z = sum((mass * center for mass, center in self._masses), np.zeros(3)) / mass
        return [float(x), float(y), float(z)]

    @cached_property
    def _residual_and_jacobian(self) -> tuple[Matrix, Matrix]:
        return residual_and_jacobian(self.robot, self.q)

    @cached_property
    def _masses(self) -> list[tuple[float, Matrix]]:
        """For each body that weighs something its mass, kg, and its centre of mass in the world, m."""
        inertias = ((body.name, body.inertia) for body in self.robot.mechanism.bodies)
        return [
            (inertia.mass, self._body(name).act(np.array(inertia.pose.xyz)))
            for name, inertia in inertias
            if inertia is not None
        ]

    def _body(self, name: str) -> Any:
        """Pose of a body's frame in the world."""
        frame = self.robot.model.frames[self._bodies[name]]
        return self.robot.data.oMi[frame.parentJoint] * frame.placement

    def _by_constraint(self, rows: Matrix) -> dict[str, Matrix]:
        found, first = {}, 0
        for constraint in self.robot.constraints:
            found[constraint.name] = rows[first : first + constraint.rows]
            first += constraint.rows
        return found


def _frame(mechanism: Mechanism, name: str) -> tuple[str, Any]:
    """The body that a frame is on, and its placement there."""
    bodies = {body.name for body in mechanism.bodies if body.virtual is False and body.name == name}
    bodies |= {joint.child for joint in mechanism.joints if joint.name == name}
    if len(bodies) > 1:
        raise ValueError(f"'{name}' is both a link and a joint, which carries another link")
    if bodies:
        return bodies.pop(), pin.SE3.Identity()
    for frame in mechanism.frames:
        if frame.name == name:
            return frame.body, placement_of(frame.pose)
    raise ValueError(f"'{name}' is not a link, joint or frame of the robot")


def _columns(robot: Robot) -> list[tuple[str, int]]:
    """EU-JNT-026: for each velocity of the model the joint that it is of, and which of its velocities it is."""
    columns = [("", 0)] * robot.model.nv
    if robot.mechanism.root == "floating":
        columns[:6] = [(ROOT_JOINT, index) for index in range(6)]
    for name, slot in slots(robot.mechanism).items():
        columns[slot.idx_v : slot.idx_v + slot.nv] = [(name, index) for index in range(slot.nv)]
    return columns


def _mass_matrix(robot: Robot, q: Matrix) -> Matrix:
    model, data = robot.model, robot.data
    if not len(model.mimicking_joints):
        M = np.triu(pin.crba(model, data, q))
        return np.asarray(M + np.triu(M, 1).T)
    # Pinocchio's crba is wrong, up to 4.1, where a follower carries several branches: column by column then.
    still = np.zeros(model.nv)
    bias = pin.rnea(model, data, q, still, still).copy()
    columns = [pin.rnea(model, data, q, still, unit) - bias for unit in np.eye(model.nv)]
    return np.array(columns).reshape(model.nv, model.nv).T
