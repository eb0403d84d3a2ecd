"""The equivalent serial robot: joints that are motors, without rods and cranks, for simulators and trainings."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal, NamedTuple, cast

import numpy as np

from eurdf.array import Mask, Matrix, Vector
from eurdf.convert.export import export, files_of_meshes
from eurdf.diagnostics import enumerated
from eurdf.errors import NoTransmission
from eurdf.json_schema import PAIRS, ROW, ROWS, Keywords, to_json
from eurdf.kinematics.named import Named
from eurdf.kinematics.problem import Problem
from eurdf.loading import as_robot
from eurdf.mechanism.joint import JointProperties
from eurdf.mechanism.mechanism import ROOT_JOINT
from eurdf.pinocchio.robot import build_robot
from eurdf.reading.robot_source import RobotSource
from eurdf.transmissions.drive import closed_pose
from eurdf.transmissions.inertia import reflected_inertia
from eurdf.transmissions.limits import CommonLimits, serial_limits
from eurdf.transmissions.motors import linkage_bodies, sides, unlimited_motors
from eurdf.transmissions.polynomial_map import PolynomialMap, fitted_map
from eurdf.transmissions.reachable_set import Workspace, points_along, workspace
from eurdf.transmissions.selection import Selection, listed
from eurdf.transmissions.serial_mechanism import serial_mechanism, springs_left_out, with_properties
from eurdf.transmissions.transmission import Transmission, at_one
from eurdf.writing.output_folder import write_files

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot

#: How limits and armature are chosen.
Choice = Literal["conservative", "fitted"]

# The numbers of a joint, as a report names them.
_NUMBERS = ("position", "torque", "velocity", "armature", "damping", "friction")

# Number of points of a grid, about, and along one joint, at most, where the caller does not say how fine it is.
_POINTS, _MOST_ALONG = 441, 51


@dataclass(frozen=True, slots=True, eq=False)
class Neglected:
    """What a serial twin neglects, over the points of the workspace.

    Smallest and largest values are (nJ, 2), in kg·m² or kg, N·m or N, rad/s or m/s.

    Attributes:
        mass: Mass of the bodies that are lumped onto others, kg.
        armature: Smallest and largest armature that would be exact for each joint alone, the diagonal of M_J less the
            inertia of the twin.
        rotors: Smallest and largest part of it that comes from the rotors.
        linkage: Smallest and largest part of it that comes from the bodies of the linkage, where they are.
        coupling: Largest inertia between two different joints (nJ, nJ) that no armature can state.
        inertia: Largest error of the inertia matrix, ‖M_twin - M_J‖ / ‖M_J‖.
        gravity: Largest error (nJ,) of the torque that holds a joint against gravity, N·m or N.
        torque: Smallest and largest torque of each joint alone; None where a motor has no limit.
        velocity: Smallest and largest velocity of each joint alone; None where a motor has no limit.
        covered: Part of the points that are inside the position limits of the twin.
    """

    mass: float
    armature: Annotated[Matrix, PAIRS]
    rotors: Annotated[Matrix, PAIRS]
    linkage: Annotated[Matrix, PAIRS]
    coupling: Annotated[Matrix, ROWS]
    inertia: float
    gravity: Annotated[Vector, ROW]
    torque: Annotated[Matrix, PAIRS] | None
    velocity: Annotated[Matrix, PAIRS] | None
    covered: Annotated[float, Keywords(minimum=0.0, maximum=1.0)]


@dataclass(frozen=True, eq=False, repr=False)
class SerialTwin:
    """The serial equivalent of a robot with a parallel transmission.

    Attributes:
        robot: The serial robot. Its joints are actuated, with the limits and armatures below.
        joints: Name of each joint velocity, nJ of them.
        motors: Name of each motor velocity of the parallel robot.
        q: Configuration (nq,) of the parallel robot at which masses are lumped.
        bodies: Names of the bodies left out; their masses are lumped onto those that carry them.
        chosen: How limits and armature are chosen.
        position: Smallest and largest position (nJ, 2) of the joints, rad or m.
        torque: Largest torque or force (nJ,), N·m or N; inf where a motor has no limit.
        velocity: Largest velocity (nJ,), rad/s or m/s; inf where a motor has no limit.
        armature: Armature (nJ,), kg·m² or kg.
        damping: Viscous damping (nJ,) at q, that of the motors included, N·m·s/rad or N·s/m.
        friction: Dry friction (nJ,) at q while a joint moves alone, that of the motors included, N·m or N.
        map: The positions of the motors as polynomials.
        neglected: What the twin neglects.
        workspace: The reachable set that the numbers refer to.
        notes: What was left out: limits for want of numbers, and springs of the linkage.
    """

    robot: Robot
    joints: tuple[str, ...]
    motors: tuple[str, ...]
    q: Vector
    bodies: tuple[str, ...]
    chosen: Choice
    position: Matrix
    torque: Vector
    velocity: Vector
    armature: Vector
    damping: Vector
    friction: Vector
    map: PolynomialMap
    neglected: Neglected
    workspace: Workspace
    notes: tuple[str, ...]

    def report(self) -> dict[str, Any]:
        """The numbers as plain values, for JSON; infinite ones are None."""
        q = self.workspace.robot.joint_positions(self.q)
        found: dict[str, Any] = to_json(
            {
                "joints": self.joints,
                "motors": self.motors,
                "lumped": self.bodies,
                "lumped_at": q,
                "chosen": self.chosen,
                **{name: getattr(self, name) for name in _NUMBERS},
                "neglected": self.neglected,
                "stops": {str(stop): count for stop, count in self.workspace.stops.items()},
                "map": self.map,
                "notes": self.notes,
            }
        )
        return found

    def files(self) -> dict[str, bytes]:
        """The twin as URDF and MJCF, and its report: the content by path."""
        found: dict[str, bytes] = {}
        for to in ("urdf", "mjcf"):
            found |= {f"{to}/{path}": content for path, content in export(self.robot, to).files.items()}
        text = json.dumps(self.report(), indent=2, ensure_ascii=False, allow_nan=False)
        return {**found, "transmission.json": f"{text}\n".encode()}

    def write(self, folder: str | os.PathLike[str], *, force: bool = False) -> tuple[Path, ...]:
        """Write the files to a folder: all of them or none.

        Raises:
            FileExistsError: A file exists, and ``force`` is False.
            OSError: A file cannot be written.
        """
        return write_files(folder, self.files(), force=force)

    def __repr__(self) -> str:
        return f"<SerialTwin of '{self.workspace.robot.mechanism.name}': {', '.join(self.joints)}>"


def serial_twin(
    robot: Robot | RobotSource,
    joints: str | Iterable[str],
    q: Named | None = None,
    *,
    motors: str | Iterable[str] | None = None,
    limits: Choice = "conservative",
    armature: Mapping[str, float] | None = None,
    grid: int | None = None,
    ranges: Mapping[str, Sequence[float]] | None = None,
    degree: int = 8,
) -> SerialTwin:
    """The serial equivalent of a robot whose joints are moved through rods.

    The bodies of the linkage are left out, and their masses are lumped onto the bodies that carry them, as they are at
    q. The armature of a joint is the diagonal of M_J less the inertia of the twin, at least 0, so that no mass counts
    twice. ``conservative``: positions in a box inside the workspace; torques and velocities that the motors reach
    together at all points of the grid in it; the largest armature there. ``fitted``: the range of the workspace, and
    the means over its points of the torques, velocities and armatures.

    Springs of the joints are kept. Those of the linkage are left out with it, and named in the notes: their torque
    depends on the pose. As in `transmission`, springs that hold their joints do so as they are at q.

    Args:
        robot: The robot, with the geometry that it was loaded with.
        joints: As in `transmission`.
        q: As in `workspace`; the masses are lumped there.
        motors: As in `transmission`.
        limits: How limits and armatures are chosen.
        armature: By motor, as in `reflected_inertia`.
        grid: As in `workspace`; by default 21 for two joints, and about 450 points in all.
        ranges: As in `workspace`.
        degree: Degree of the polynomials in each joint; lowered where the workspace has too few points.

    Raises:
        NotClosable: The loops cannot be closed near q.
        NoTransmission: The motors do not hold the joints at q, other actuated joints are in the way, or the
            linkage has other motors.
        ValueError: An argument is wrong, as in `workspace`; or the grid is too coarse to find a range of a joint.
    """
    robot = as_robot(robot, geometry=True)
    if limits not in ("conservative", "fitted"):
        raise ValueError(f"limits is {limits!r}; it must be 'conservative' or 'fitted'")
    if not 1 <= degree <= 30:
        raise ValueError(f"degree is {degree}; it must be from 1 to 30")
    serial, by = sides(robot, joints, motors)
    pose = closed_pose(robot, q)
    grid = max(5, points_along(len(serial), _POINTS, _MOST_ALONG)) if grid is None else grid
    bodies = linkage_bodies(robot, serial, by)
    _refuse_other_motors(robot, bodies, serial, by)
    found = workspace(robot, serial.joints, pose, motors=by.joints, grid=grid, ranges=ranges)
    plain = _without_linkage(robot, pose, bodies, serial, by)
    inside = _box(found, serial.read(pose))
    chosen = inside if limits == "conservative" else np.ones(len(found.q), dtype=bool)
    points = found.positions[chosen]
    position = np.stack((points.min(axis=0), points.max(axis=0)), axis=1)
    for name, (lower, upper) in zip(serial.names, position.tolist(), strict=True):
        if lower == upper:  # limits of 0 and 0 are no range, other equal ones a lock
            raise ValueError(
                f"joint '{name}' has no range around q: of the {grid} points of the grid along it, only {lower:.6g} is "
                "reached with the other joints; use a finer grid"
            )
    most, notes = _limits(robot, found, serial, by, chosen, limits)
    terms = reflected_inertia(robot, serial.joints, found.q, motors=by.joints, armature=armature)
    own = np.array([_of_twin(robot, plain, each) for each in found.q])
    lumped = reflected_inertia(plain, serial.joints, own, motors=serial.joints).total
    needed = terms.total - lumped
    diagonal = np.maximum(np.diagonal(needed, axis1=1, axis2=2), 0.0)
    added = diagonal[chosen].max(axis=0) if limits == "conservative" else diagonal.mean(axis=0)
    losses = _losses(robot, at_one(robot, serial, pose, by))
    notes += springs_left_out(robot.mechanism, bodies)
    numbers = {
        "lower": position[:, 0],
        "upper": position[:, 1],
        "velocity": most.velocity,
        "effort": most.torque,
        "damping": losses[0],
        "friction": losses[1],
        "armature": added,
    }
    mechanism = with_properties(plain.mechanism, _properties(robot, serial, numbers))
    meshes = {uri: os.fspath(path) for uri, path in files_of_meshes(robot).items()}
    twin = build_robot(mechanism, geometry=robot.geometry is not None, resolve=meshes.get)
    error = np.linalg.norm(lumped + np.diag(added) - terms.total, 2, axis=(1, 2))
    neglected = Neglected(
        sum(body.inertia.mass for body in robot.mechanism.bodies if body.name in bodies and body.inertia is not None),
        _extent(diagonal),
        _extent(np.diagonal(terms.rotors, axis1=1, axis2=2)),
        _extent(np.diagonal(terms.linkage, axis1=1, axis2=2)),
        np.abs(needed * (1.0 - np.eye(len(serial)))).max(axis=0),
        float((error / np.linalg.norm(terms.total, 2, axis=(1, 2))).max()),
        np.abs(_holding(robot, found.q, serial, by) - _holding(plain, own, serial, by)).max(axis=0),
        most.torque_alone,
        most.velocity_alone,
        float(chosen.mean()),
    )
    return SerialTwin(
        twin,
        serial.names,
        by.names,
        pose,
        bodies,
        limits,
        position,
        most.torque,
        most.velocity,
        added,
        *losses,
        fitted_map(found, degree),
        neglected,
        found,
        notes,
    )


def _refuse_other_motors(robot: Robot, bodies: Sequence[str], joints: Selection, motors: Selection) -> None:
    """Refuse a linkage that carries motors of other joints, which would go with it."""
    lost = [name for name in robot.actuation.joints if name not in motors.joints]
    lost = [name for name in lost if robot.slots[name].joint.child in bodies]
    if lost:
        reason = (
            f"the linkage of {enumerated(joints.joints)}, which it leaves out, has other motors: {enumerated(lost)}; "
            "add the joints that they drive"
        )
        raise NoTransmission("the serial twin", reason)


def _without_linkage(robot: Robot, q: Vector, bodies: Sequence[str], joints: Selection, motors: Selection) -> Robot:
    """The twin without armature of its joints."""
    coordinates = robot.joint_positions(q, mimic=True)
    mechanism = serial_mechanism(robot.mechanism, set(bodies), coordinates, joints.joints, set(motors.joints))
    bare = {
        joint.name: replace(joint.properties, armature=(), gear_ratio=(), rotor_inertia=())
        for joint in mechanism.joints
        if joint.name in joints.joints
    }
    return build_robot(with_properties(mechanism, bare), geometry=False)


def _of_twin(robot: Robot, twin: Robot, q: Vector) -> Vector:
    """The configuration of the twin at one of the robot."""
    own = {*twin.slots, ROOT_JOINT}
    return twin.configuration({name: values for name, values in robot.joint_positions(q).items() if name in own})


def _box(found: Workspace, start: Vector) -> Mask:
    """Which points are in a box of points that are all reached: it grows from the start in all directions in turn."""
    reached = np.zeros(tuple(map(len, found.axes)), dtype=bool)
    reached[tuple(found.index.T)] = True
    cell = np.array([axis[1] - axis[0] for axis in found.axes])
    nearest = found.index[np.abs((found.positions - start) / cell).sum(axis=1).argmin()]
    low, high = nearest.copy(), nearest.copy()
    directions = [(axis, step) for axis in range(len(found.axes)) for step in (-1, 1)]
    while directions:
        for axis, step in tuple(directions):
            wider = low.copy(), high.copy()
            wider[0 if step < 0 else 1][axis] += step
            inside = wider[0][axis] >= 0 and wider[1][axis] < reached.shape[axis]
            if inside and reached[tuple(slice(a, b + 1) for a, b in zip(*wider, strict=True))].all():
                low, high = wider
            else:
                directions.remove((axis, step))
    return np.asarray(((found.index >= low) & (found.index <= high)).all(axis=1))


class _Limits(NamedTuple):
    """Limits (nJ,), and the smallest and largest of each joint alone (nJ, 2), which are None if motors have none."""

    torque: Vector
    velocity: Vector
    torque_alone: Matrix | None
    velocity_alone: Matrix | None


def _limits(
    robot: Robot, found: Workspace, joints: Selection, motors: Selection, chosen: Mask, choice: Choice
) -> tuple[_Limits, tuple[str, ...]]:
    """The limits of the joints, and what could not be stated."""
    unlimited = unlimited_motors(robot, motors)
    if unlimited:
        none = np.full(len(joints), np.inf)
        note = f"torque and velocity limits are left out: {listed(unlimited)} have no effort or no velocity limit"
        return _Limits(none, none, None, None), (note,)
    at = cast(CommonLimits, serial_limits(robot, joints.joints, found.q, motors=motors.joints))
    alone = _extent(np.abs(at.torque_axes).min(axis=2)), _extent(np.abs(at.velocity_axes).min(axis=2))
    if choice == "fitted":
        boxes = [(each.torque_box, each.velocity_box) for each in at.each]
        torque, velocity = np.mean(boxes, axis=0)
        return _Limits(torque, velocity, *alone), ()
    within = cast(CommonLimits, serial_limits(robot, joints.joints, found.q[chosen], motors=motors.joints))
    return _Limits(within.torque_box, within.velocity_box, *alone), ()


def _losses(robot: Robot, at: Transmission) -> tuple[Vector, Vector]:
    """Damping and dry friction (nJ,) of the joints, those of their motors included."""
    assert at.G is not None
    passive = ~np.isin(at.joint_index, at.motor_index)
    damping, friction = robot.tree.damping, robot.tree.dry_friction
    return (
        np.where(passive, damping[at.joint_index], 0.0) + damping[at.motor_index] @ at.G**2,
        np.where(passive, friction[at.joint_index], 0.0) + friction[at.motor_index] @ np.abs(at.G),
    )


def _properties(robot: Robot, joints: Selection, numbers: Mapping[str, Vector]) -> dict[str, JointProperties]:
    """The properties of each joint: its numbers by velocity (nJ,), and the spring and rates of the robot's."""
    found: dict[str, JointProperties] = {}
    for name in joints.joints:
        own = np.isin(joints.velocities, robot.tree.velocities_of(name))
        of = {word: tuple(values[own].tolist()) for word, values in numbers.items()}
        found[name] = replace(robot.slots[name].joint.properties, **of, gear_ratio=(), rotor_inertia=())
    return found


def _holding(robot: Robot, q: Matrix, joints: Selection, motors: Selection) -> Matrix:
    """Torques (B, nJ) that hold the joints against gravity at q (B, nq), while actuators that are not motors are held.

    NaN where the motion is in doubt.
    """
    tree, own = robot.tree, {*joints.joints, *motors.joints}
    names = (*joints.joints, *(name for name in robot.actuation.joints if name not in own))
    D, sure = Problem(robot, [velocity for name in names for velocity in tree.velocities_of(name)]).derivative(q)
    dynamics, zero = tree.dynamics(), np.zeros(tree.nv)
    gravity = np.array([dynamics.inverse_dynamics(each, zero, zero) for each in q])
    torques = (gravity[:, None] @ D[:, :, : len(joints)])[:, 0]
    return np.where(sure[:, None], torques, np.nan)


def _extent(values: Matrix) -> Matrix:
    """Smallest and largest (n, 2) of values (B, n)."""
    return np.stack((values.min(axis=0), values.max(axis=0)), axis=1)
