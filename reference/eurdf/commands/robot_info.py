"""The output of ``eurdf info --json``."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

import numpy as np

from eurdf.closures import REGISTRY
from eurdf.json_schema import Count, Keywords, NullIfInfinite
from eurdf.kinematics.analysis import Analysis
from eurdf.kinematics.loop_analysis import LoopAnalysis, Motion
from eurdf.mechanism.joint_types import JointType
from eurdf.mechanism.mechanism import root_joint

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot


@dataclass(frozen=True, slots=True)
class JointInfo:
    """A moving joint of the spanning tree."""

    name: str
    """Name of the joint; root_joint for a floating root."""
    type: JointType
    """Type of the joint."""
    parent: str
    """Parent link; world for the joint of a floating root."""
    child: str
    """Child link."""
    nq: Count
    """Number of its own coordinates in Pinocchio's configuration vector; 0 for a mimic joint."""
    nv: Count
    """Number of its own velocities; 0 for a mimic joint."""
    actuated: bool
    """Whether it is actuated."""
    mimics: str | None
    """Leader of a mimic joint, or None."""
    stiffness: tuple[float, ...]
    """Stiffness of a spring on each coordinate, N·m/rad or N/m; empty without springs."""
    rest: tuple[float, ...]
    """Coordinate at which each of these springs has no force, rad or m."""


@dataclass(frozen=True, slots=True)
class ClosureInfo:
    """A loop closure."""

    name: str
    """Name of the closure."""
    type: Annotated[str, Keywords(enum=lambda: sorted(REGISTRY))]
    """3d for position, 6d for position and orientation, hinge for position and an axis, distance for a distance."""
    rows: Count
    """Number of its constraint rows."""
    frames: tuple[str | None, str | None]
    """Names of frame A and frame B; None for an inline pose."""
    bodies: tuple[str, str]
    """Links that frame A and frame B are fixed to."""
    residual: NullIfInfinite
    """Norm of its residual at the analysed configuration, m and rad."""
    compliance: tuple[float, float]
    """Linear (m/N) and angular (rad/(N·m)) compliance for simulators with soft constraints; 0 is rigid."""


@dataclass(frozen=True, slots=True)
class CouplingInfo:
    """A coupling of joints."""

    name: str
    """Name of the coupling."""
    joints: dict[str, float]
    """Coefficients by the name of the joint."""
    offset: float
    """What the coordinates times the coefficients add up to."""
    residual: NullIfInfinite
    """Size of its residual at the analysed configuration."""


@dataclass(frozen=True, slots=True)
class ActuatorInfo:
    """An actuated joint."""

    joint: str
    """Name of the joint."""
    type: JointType
    """Type of the joint."""
    nv: Count
    """Number of velocities actuated."""
    name: str
    """Name of the actuator: that of the joint unless stated."""
    control: tuple[float, float] | None
    """Smallest and largest torque or force at the joint, N·m or N; None if not stated."""


@dataclass(frozen=True, slots=True)
class FrameInfo:
    """A frame that the description adds."""

    name: str
    """Name of the frame."""
    body: str
    """Link it is fixed to."""


@dataclass(frozen=True, slots=True)
class ConfigurationInfo:
    """A named configuration."""

    name: str
    """Name of the configuration."""
    residual: NullIfInfinite
    """Norm of the residual of all closures and couplings at the configuration, m and rad."""


@dataclass(frozen=True, slots=True)
class RobotInfo:
    """The output of 'eurdf info --json' for one robot; dimensions are for the chosen root."""

    LIKE: ClassVar = "eurdf.kinematics.analysis:Analysis"

    name: str
    """Name of the robot in the URDF."""
    version: Literal["1", "2.0", "2.1", ""]
    """Extended URDF version of the description; empty for a plain URDF."""
    root: Literal["fixed", "floating"]
    """Whether the root link is fixed to the world or floating."""
    nq: Count
    nv: Count
    joints: Count
    """Number of moving joints, including that of a floating root."""
    closures: Count
    """Number of loop closures."""
    couplings: Count
    """Number of couplings."""
    nc: Count
    rank: Count | None
    mobility: Count | None
    redundant: Count | None
    uncontrolled: Count | None
    actuated: Count
    controlled: Count | None
    dependent: Count | None
    singularity: float | None
    actuation_singularity: float | None
    infinitesimal_mobility: Count | None
    finite_mobility: Count | Literal["unknown"] | None
    rounded_mobility: Count | None
    rounded_tolerance: float | None
    mass: NullIfInfinite
    """Mass of all links, including the root, kg."""
    residual: NullIfInfinite
    closes: bool
    left_out: str | None
    """What was not computed because the robot is too large; those values are None. None if all was computed."""
    joint_list: tuple[JointInfo, ...]
    """The moving joints, depth first."""
    closure_list: tuple[ClosureInfo, ...]
    """The closures, in file order."""
    coupling_list: tuple[CouplingInfo, ...]
    """The couplings, in file order."""
    loop_list: tuple[LoopAnalysis, ...]
    """The independent groups of loops; empty if the loops do not close."""
    motion_list: tuple[Motion, ...]
    """The motions left with every actuator held, each of few joints; empty if the loops do not close."""
    dependent_list: tuple[tuple[str, ...], ...]
    """Sets of dependent actuators: none moves unless another one of its set moves; alone in a set, it cannot move."""
    actuator_list: tuple[ActuatorInfo, ...]
    """The actuated joints, in file order."""
    frame_list: tuple[FrameInfo, ...]
    """The frames that the description adds."""
    configuration_list: tuple[ConfigurationInfo, ...]
    """The named configurations."""


def robot_info(robot: Robot, analysis: Analysis) -> RobotInfo:
    """The output for one robot."""
    from eurdf.kinematics.residual import residual

    mechanism = robot.mechanism
    moving = tuple(_joint_infos(robot))
    rows = residual(robot, analysis.q)
    starts = np.cumsum([0, *(constraint.rows for constraint in mechanism.constraints)])
    sizes = {
        constraint.name: float(np.linalg.norm(rows[start : start + constraint.rows]))
        for constraint, start in zip(mechanism.constraints, starts, strict=False)
    }
    joints = {joint.name: joint for joint in mechanism.joints}
    controls = {joint: motor.control for joint, motor in mechanism.motors.items()}
    own: dict[str, Any] = {field.name: getattr(analysis, field.name, None) for field in fields(RobotInfo)}
    own |= {
        "name": mechanism.name,
        "version": mechanism.version,
        "root": mechanism.root,
        "joints": len(moving),
        "closures": len(mechanism.closures),
        "couplings": len(mechanism.couplings),
        "mass": math.fsum(body.inertia.mass for body in mechanism.bodies if body.inertia),
        "left_out": analysis.left_out or None,
        "joint_list": moving,
        "loop_list": analysis.loops,
        "motion_list": analysis.motions,
        "dependent_list": analysis.dependent_actuators,
    }
    own["closure_list"] = tuple(
        ClosureInfo(
            closure.name,
            closure.type,
            closure.rows,
            (closure.a.frame or None, closure.b.frame or None),
            (closure.a.body, closure.b.body),
            sizes[closure.name],
            (closure.compliance.linear, closure.compliance.angular),
        )
        for closure in mechanism.closures
    )
    own["coupling_list"] = tuple(
        CouplingInfo(coupling.name, dict(coupling.coefficients), coupling.offset, sizes[coupling.name])
        for coupling in mechanism.couplings
    )
    own["actuator_list"] = tuple(
        ActuatorInfo(joint, joints[joint].type, joints[joint].type.nv, name, controls.get(joint))
        for joint, name in zip(mechanism.actuators, robot.actuation.names, strict=True)
    )
    own["frame_list"] = tuple(FrameInfo(frame.name, frame.body) for frame in mechanism.frames if frame.kind == "frame")
    own["configuration_list"] = tuple(
        ConfigurationInfo(name, float(np.linalg.norm(residual(robot, q)))) for name, q in robot.configurations.items()
    )
    return RobotInfo(**own)


def _joint_infos(robot: Robot) -> Iterator[JointInfo]:
    from eurdf.pinocchio.configuration import slots

    mechanism = robot.mechanism
    if mechanism.root == "floating":
        root = root_joint(mechanism.bodies[0].name)
        yield JointInfo(root.name, root.type, "world", root.child, 7, 6, False, None, (), ())
    at, actuated = slots(mechanism), set(robot.actuation.joints)
    for joint in mechanism.joints:
        if joint.type.is_fixed:
            continue
        slot = at.get(joint.name)
        yield JointInfo(
            name=joint.name,
            type=joint.type,
            parent=joint.parent,
            child=joint.child,
            nq=slot.nq if slot else 0,
            nv=slot.nv if slot else 0,
            actuated=joint.name in actuated,
            mimics=joint.mimic.joint if joint.mimic else None,
            stiffness=joint.properties.stiffness,
            rest=joint.properties.rest,
        )
