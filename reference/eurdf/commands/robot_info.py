"""The output of ``eurdf info --json``, and its JSON Schema."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, Annotated, Any, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from eurdf.mechanism.constraint import CLOSURES
from eurdf.mechanism.joint_types import JointType

if TYPE_CHECKING:
    from eurdf.kinematics.analysis import Analysis
    from eurdf.pinocchio.robot import Robot

Count = Annotated[int, Field(ge=0)]


class _Entry(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid", use_attribute_docstrings=True)


class JointInfo(_Entry):
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
    """Leader of a mimic joint, or null."""
    stiffness: tuple[float, ...]
    """Stiffness of a spring on each coordinate, N·m/rad or N/m; empty without springs."""
    rest: tuple[float, ...]
    """Coordinate at which each of these springs has no force, rad or m."""


class ClosureInfo(_Entry):
    """A loop closure."""

    name: str
    """Name of the closure."""
    type: Annotated[str, Field(json_schema_extra={"enum": sorted(CLOSURES)})]
    """3d for position, 6d for position and orientation, hinge for position and an axis, distance for a distance."""
    rows: Count
    """Number of its constraint rows."""
    frames: tuple[str | None, str | None]
    """Names of frame A and frame B; null for an inline pose."""
    bodies: tuple[str, str]
    """Links that frame A and frame B are fixed to."""
    residual: float | None
    """Norm of its residual at the analysed configuration, m and rad."""
    compliance: tuple[float, float]
    """Linear (m/N) and angular (rad/(N·m)) compliance for simulators with soft constraints; 0 is rigid."""


class CouplingInfo(_Entry):
    """A coupling of joints."""

    name: str
    """Name of the coupling."""
    joints: dict[str, float]
    """Coefficients by the name of the joint."""
    offset: float
    """What the coordinates times the coefficients add up to."""
    residual: float | None
    """Size of its residual at the analysed configuration."""


class ActuatorInfo(_Entry):
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
    """Smallest and largest torque or force at the joint, N·m or N; null if not stated."""


class FrameInfo(_Entry):
    """A frame that the description adds."""

    name: str
    """Name of the frame."""
    body: str
    """Link it is fixed to."""


class ConfigurationInfo(_Entry):
    """A named configuration."""

    name: str
    """Name of the configuration."""
    residual: float | None
    """Norm of the residual of all closures and couplings at the configuration, m and rad."""


class LoopInfo(_Entry):
    """An independent group of loops: they share joints with one another and with no other loop."""

    closures: tuple[str, ...]
    """Names of its closures and couplings."""
    joints: tuple[str, ...]
    """Names of its joints, in the model's order."""
    nv: Count
    """Number of velocities of its joints."""
    nc: Count
    """Number of its constraint rows."""
    rank: Count
    """Rank of its constraint Jacobian."""
    mobility: Count
    """Degrees of freedom of the closed loops, nv - rank."""
    redundant: Count
    """Number of its redundant constraint rows, nc - rank."""
    uncontrolled: Count
    """Degrees of freedom left with every actuator held."""
    actuated: Count
    """Number of its velocities that are actuated."""
    controlled: Count
    """Degrees of freedom that its actuators control, mobility - uncontrolled."""
    singularity: float | None
    """Its distance to singularity, as for the whole robot."""
    actuation_singularity: float | None
    """Its distance to a singularity of the actuation, as for the whole robot."""
    infinitesimal_mobility: Count
    """Degrees of freedom to first order at the analysed configuration."""
    finite_mobility: Count | Literal["unknown"]
    """Degrees of freedom of motions that continue from the analysed configuration; 'unknown' if it was not decided."""
    evidence: Literal["constant rank", "second order", "continuation"] | None
    """What decides the finite mobility: a proof in the first two cases, else numerical evidence; null if unknown."""
    branches: tuple[Count, ...]
    """Degrees of freedom of each branch found that passes through the analysed configuration."""
    rigid_order: Count | None
    """Order of rigidity, if the finite mobility is 0: at 2 and above, the loops are shaky. Else null."""


class MotionInfo(_Entry):
    """A motion left with every actuator held."""

    joints: tuple[str, ...]
    """Names of the joints that it moves."""


class RobotInfo(_Entry):
    """The output of 'eurdf info --json' for one robot; dimensions are for the chosen root."""

    name: str
    """Name of the robot in the URDF."""
    version: Literal["1", "2.0", "2.1", ""]
    """Extended URDF version of the description; empty for a plain URDF."""
    root: Literal["fixed", "floating"]
    """Whether the root link is fixed to the world or floating."""
    nq: Count
    """Length of Pinocchio's configuration vector."""
    nv: Count
    """Number of velocities of the spanning tree."""
    joints: Count
    """Number of moving joints, including that of a floating root."""
    closures: Count
    """Number of loop closures."""
    couplings: Count
    """Number of couplings."""
    nc: Count
    """Number of constraint rows of all closures and couplings."""
    rank: Count | None
    """Rank of the constraint Jacobian at a closed configuration; null if the loops do not close."""
    mobility: Count | None
    """Degrees of freedom of the closed mechanism, nv - rank; null if the loops do not close."""
    redundant: Count | None
    """Redundant constraint rows, nc - rank; null if the loops do not close."""
    uncontrolled: Count | None
    """Degrees of freedom left with every actuator held; null if the loops do not close."""
    actuated: Count
    """Number of actuated velocities."""
    controlled: Count | None
    """Degrees of freedom that the actuators control, mobility - uncontrolled; null if the loops do not close."""
    dependent: Count | None
    """Actuated velocities that depend on the others, actuated - controlled; null if the loops do not close."""
    singularity: float | None
    """Distance to singularity: least singular value of the dimensionless constraint Jacobian; null without loops."""
    actuation_singularity: float | None
    """The same for the constraint Jacobian stacked with the rows that select the actuated velocities."""
    infinitesimal_mobility: Count | None
    """Degrees of freedom to first order at the analysed configuration; null if the loops do not close."""
    finite_mobility: Count | Literal["unknown"] | None
    """Degrees of freedom of motions that continue from it; 'unknown' if undecided, null if the loops do not close."""
    rounded_mobility: Count | None
    """Degrees of freedom of loops that fail to close only by the rounding of numbers in the files; else null."""
    rounded_tolerance: float | None
    """How far open the loops may be for 'rounded_mobility', rad or characteristic lengths; else null."""
    mass: float | None
    """Mass of all links, including the root, kg."""
    residual: float | None
    """Norm of the residual of all closures and couplings at the configuration found, m and rad."""
    closes: bool
    """Whether a configuration was found at which every loop is closed."""
    left_out: str | None
    """What was not computed because the robot is too large; those values are null. Null if all was computed."""
    joint_list: tuple[JointInfo, ...]
    """The moving joints, depth first."""
    closure_list: tuple[ClosureInfo, ...]
    """The closures, in file order."""
    coupling_list: tuple[CouplingInfo, ...]
    """The couplings, in file order."""
    loop_list: tuple[LoopInfo, ...]
    """The independent groups of loops; empty if the loops do not close."""
    motion_list: tuple[MotionInfo, ...]
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
    """The output for one robot.

    Args:
        robot: The robot.
        analysis: The result of `eurdf.analyze`.
    """
    from eurdf.kinematics.residual import residual

    mechanism, model = robot.mechanism, robot.model
    moving = tuple(_joint_infos(robot))
    rows = residual(robot, analysis.q)
    starts = np.cumsum([0, *(constraint.rows for constraint in mechanism.constraints)])
    sizes = {
        constraint.name: _finite(np.linalg.norm(rows[start : start + constraint.rows]))
        for constraint, start in zip(mechanism.constraints, starts, strict=False)
    }
    joints = {joint.name: joint for joint in mechanism.joints}
    controls = {joint: motor.control for joint, motor in mechanism.motors.items()}
    return RobotInfo(
        name=mechanism.name,
        version=mechanism.version,  # type: ignore[arg-type]  # checked by the model
        root=mechanism.root,
        nq=model.nq,
        nv=model.nv,
        joints=len(moving),
        closures=len(mechanism.closures),
        couplings=len(mechanism.couplings),
        nc=mechanism.nc,
        rank=analysis.rank,
        mobility=analysis.mobility,
        redundant=analysis.redundant,
        uncontrolled=analysis.uncontrolled,
        actuated=len(robot.actuation.idx_v),
        controlled=analysis.controlled,
        dependent=analysis.dependent,
        singularity=_finite(analysis.singularity),
        actuation_singularity=_finite(analysis.actuation_singularity),
        infinitesimal_mobility=analysis.infinitesimal_mobility,
        finite_mobility=analysis.finite_mobility,
        rounded_mobility=analysis.rounded_mobility,
        rounded_tolerance=analysis.rounded_tolerance,
        mass=_finite(math.fsum(body.inertia.mass for body in mechanism.bodies if body.inertia)),
        residual=_finite(analysis.residual),
        closes=analysis.closes,
        left_out=analysis.left_out or None,
        joint_list=moving,
        closure_list=tuple(
            ClosureInfo(
                name=closure.name,
                type=closure.type,
                rows=closure.rows,
                frames=(closure.a.frame or None, closure.b.frame or None),
                bodies=(closure.a.body, closure.b.body),
                residual=sizes[closure.name],
                compliance=(closure.compliance.linear, closure.compliance.angular),
            )
            for closure in mechanism.closures
        ),
        coupling_list=tuple(
            CouplingInfo(
                name=coupling.name,
                joints=dict(coupling.coefficients),
                offset=coupling.offset,
                residual=sizes[coupling.name],
            )
            for coupling in mechanism.couplings
        ),
        loop_list=tuple(
            LoopInfo(
                closures=loops.closures,
                joints=loops.joints,
                nv=loops.nv,
                nc=loops.nc,
                rank=loops.rank,
                mobility=loops.mobility,
                redundant=loops.redundant,
                uncontrolled=loops.uncontrolled,
                actuated=loops.actuated,
                controlled=loops.controlled,
                singularity=_finite(loops.singularity),
                actuation_singularity=_finite(loops.actuation_singularity),
                infinitesimal_mobility=loops.infinitesimal_mobility,
                finite_mobility=loops.finite_mobility,
                evidence=loops.evidence,
                branches=loops.branches,
                rigid_order=loops.rigid_order,
            )
            for loops in analysis.loops
        ),
        motion_list=tuple(MotionInfo(joints=motion.joints) for motion in analysis.motions),
        dependent_list=analysis.dependent_actuators,
        actuator_list=tuple(
            ActuatorInfo(
                joint=joint,
                type=joints[joint].type,
                nv=joints[joint].type.nv,
                name=name,
                control=controls.get(joint),
            )
            for joint, name in zip(mechanism.actuators, robot.actuation.names, strict=True)
        ),
        frame_list=tuple(
            FrameInfo(name=frame.name, body=frame.body) for frame in mechanism.frames if frame.kind == "frame"
        ),
        configuration_list=tuple(
            ConfigurationInfo(name=name, residual=_finite(np.linalg.norm(residual(robot, q))))
            for name, q in robot.configurations.items()
        ),
    )


def _joint_infos(robot: Robot) -> Iterator[JointInfo]:
    from eurdf.pinocchio.configuration import slots

    mechanism = robot.mechanism
    if mechanism.root == "floating":
        yield JointInfo(
            name="root_joint",
            type=JointType.FLOATING,
            parent="world",
            child=mechanism.bodies[0].name,
            nq=7,
            nv=6,
            actuated=False,
            mimics=None,
            stiffness=(),
            rest=(),
        )
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


def _finite(number: float | np.floating[Any] | None) -> float | None:
    return None if number is None or not math.isfinite(number) else float(number)


def info_schema() -> dict[str, Any]:
    """The JSON Schema (2020-12) of `RobotInfo`."""
    schema = RobotInfo.model_json_schema(mode="serialization")
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **schema}
