"""What a simulator was seen to do with a robot, and the numbers that follow."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from eurdf.closures.distance import DistanceClosure
from eurdf.closures.frame import FrameClosure
from eurdf.closures.hinge import HingeClosure
from eurdf.mechanism.body import Anchor
from eurdf.mechanism.joint_types import JointType
from eurdf.mechanism.mechanism import Mechanism
from eurdf.mechanism.pose import Pose, Quaternion, Vector3, direction

Array = npt.NDArray[np.float64]

#: m/s².
GRAVITY = 9.81


@dataclass(frozen=True, slots=True)
class Refused:
    """A simulator that does not simulate a robot.

    Attributes:
        reason: What it says.
    """

    reason: str


@dataclass(frozen=True, slots=True, eq=False)
class Run:
    """A simulation.

    Attributes:
        freedoms: Velocities of the tree.
        rows: Rows of the constraints that close its loops.
        bodies: Names of the moving bodies.
        orientations: Of each body at each time, (times, bodies, 3, 3).
        origins: (times, bodies, 3), m.
        linear: Velocity of each centre of mass in the world, (times, bodies, 3), m/s.
        angular: Angular velocity in the world, (times, bodies, 3), rad/s.
        duration: Simulated time, s.
        seconds: Processor time for a simulated second, s.
    """

    freedoms: int
    rows: int
    bodies: tuple[str, ...]
    orientations: Array
    origins: Array
    linear: Array
    angular: Array
    duration: float
    seconds: float

    @property
    def diverges_at(self) -> float | None:
        """The time (s) at which a number is infinite or undefined for the first time; None if there is none."""
        moving = np.concatenate((self.origins, self.linear, self.angular), axis=2)
        bad = np.flatnonzero(~np.isfinite(moving).all(axis=(1, 2)))
        return self.duration * float(bad[0]) / (len(moving) - 1) if len(bad) else None


def worst_opening(run: Run, mechanism: Mechanism) -> tuple[float, float]:
    """The largest distance (m) and angle (rad) by which a closure is open at any time."""
    distance = angle = 0.0
    for closure in mechanism.closures:
        (R, p), (S, r) = (_anchor(run, mechanism, anchor) for anchor in (closure.a, closure.b))
        gap = np.linalg.norm(r - p, axis=1)
        if isinstance(closure, DistanceClosure):
            gap = np.abs(gap - closure.length)
        distance = max(distance, float(gap.max()))
        if isinstance(closure, FrameClosure):
            angle = max(angle, float(_angles(np.swapaxes(R, 1, 2) @ S).max()))
        if isinstance(closure, HingeClosure):
            a, b = (np.array(direction(axis)) for axis in closure.axes)
            sine = np.linalg.norm(np.cross(R @ a, S @ b), axis=1)
            angle = max(angle, float(np.arctan2(sine, np.sum((R @ a) * (S @ b), axis=1)).max()))
    return distance, angle


def energy_changes(run: Run, mechanism: Mechanism) -> tuple[float, float]:
    """What is gained of energy at most, and what is lost in the end, as parts of the largest kinetic energy."""
    kinetic = potential = np.zeros(len(run.origins))
    inertias = {body.name: body.inertia for body in mechanism.bodies}
    for index, name in enumerate(run.bodies):
        inertia = inertias[name]
        if inertia is None or inertia.mass == 0.0:
            continue
        R, p = run.orientations[:, index], run.origins[:, index]
        xx, xy, xz, yy, yz, zz = inertia.moments
        turned = R @ _matrix(inertia.pose.quaternion)
        spin = np.einsum("tji,tj->ti", turned, run.angular[:, index])
        moments = np.array(((xx, xy, xz), (xy, yy, yz), (xz, yz, zz)))
        speed = np.sum(run.linear[:, index] ** 2, axis=1)
        kinetic = kinetic + 0.5 * (inertia.mass * speed + np.einsum("ti,ij,tj->t", spin, moments, spin))
        potential = potential + inertia.mass * GRAVITY * (p + R @ np.array(inertia.pose.xyz))[:, 2]
    energy = kinetic + potential
    return float((energy - energy[0]).max() / kinetic.max()), float((energy[0] - energy[-1]) / kinetic.max())


def _anchor(run: Run, mechanism: Mechanism, anchor: Anchor) -> tuple[Array, Array]:
    """Orientation and origin of a frame at each time; of what is fixed to a body or to the world, from there."""
    carried = {joint.child: joint for joint in mechanism.joints}
    body, pose = anchor.body, anchor.pose
    while body not in run.bodies and body in carried:
        joint = carried[body]
        assert joint.type is JointType.FIXED, f"body '{body}' is not in the simulation"
        body, pose = joint.parent, joint.placement * joint.offset * pose
    R, p = _matrix(pose.quaternion), np.array(pose.xyz)
    if body not in run.bodies:
        times = len(run.origins)
        return np.broadcast_to(R, (times, 3, 3)), np.broadcast_to(p, (times, 3))
    index = run.bodies.index(body)
    turned = run.orientations[:, index]
    return turned @ R, run.origins[:, index] + turned @ p


def _angles(R: Array) -> Array:
    """Of rotations (n, 3, 3)."""
    axial = np.stack((R[:, 2, 1] - R[:, 1, 2], R[:, 0, 2] - R[:, 2, 0], R[:, 1, 0] - R[:, 0, 1]), axis=1)
    return np.asarray(np.arctan2(np.linalg.norm(axial, axis=1), np.trace(R, axis1=1, axis2=2) - 1.0))


def _matrix(quaternion: Quaternion) -> Array:
    turn = Pose(quaternion=quaternion)
    units: tuple[Vector3, ...] = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
    return np.array([turn.rotate(unit) for unit in units]).T


def rotations(quaternions: Array) -> Array:
    """Of quaternions x, y, z, w of any length, (…, 4): (…, 3, 3)."""
    x, y, z, w = np.moveaxis(quaternions / np.linalg.norm(quaternions, axis=-1, keepdims=True), -1, 0)
    rows = (
        (1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)),
        (2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)),
        (2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)),
    )
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


def split(motion: Array) -> tuple[Array, Array, Array, Array]:
    """Orientations, origins, linear and angular velocities of rows (times, bodies, 18) that have them in this order."""
    return motion[..., :9].reshape(*motion.shape[:2], 3, 3), motion[..., 9:12], motion[..., 12:15], motion[..., 15:]
