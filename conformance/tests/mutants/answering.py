"""Parsers that read and understand the files, and answer something else."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from lxml import etree

from eurdf_conformance.judging.verdict import Verdict
from eurdf_conformance.oracle.joint_kind import KINDS
from eurdf_conformance.protocol.message import (
    Accepted,
    CanonicalActuator,
    CanonicalJoint,
    CanonicalRobot,
    Rejected,
    Values,
)
from eurdf_conformance.protocol.reply import accepted, rejected, unsupported
from mutants.mutant import Answer, Members, answers, describes, evaluates

# -- The canonical description --------------------------------------------------------------------------------------


def _joints(robot: CanonicalRobot, change: Callable[[CanonicalJoint], Members]) -> Members:
    return {"joints": [joint.model_copy(update=change(joint)) for joint in robot.joints]}


wrong = answers("EU-CAN-001")
wrong(
    "The robot that was read is not described.",
    lambda right, description, urdf: accepted(None, right.issues) if isinstance(right, Accepted) else right,
)


@describes("EU-CAN-001")
def limits_in_degrees(robot: CanonicalRobot) -> Members:
    """Position limits are in degrees."""

    def degrees(limits: list[float | None]) -> list[float | None]:
        return [None if limit is None else math.degrees(limit) for limit in limits]

    return _joints(robot, lambda joint: {"lower": degrees(joint.lower), "upper": degrees(joint.upper)})


@describes("EU-CAN-001")
def no_limit_is_a_large_number(robot: CanonicalRobot) -> Members:
    """Where there is no limit, there is a large number."""

    def large(limits: list[float | None]) -> list[float]:
        return [1e30 if limit is None else limit for limit in limits]

    return _joints(robot, lambda joint: {"velocity": large(joint.velocity), "effort": large(joint.effort)})


wrong = describes("EU-CAN-001")
wrong(
    "The child of a joint is said to be its parent.",
    lambda robot: _joints(robot, lambda joint: {"parent": joint.child, "child": joint.parent}),
)

wrong = describes("EU-CAN-001", versions=("2",))
# in version 1 no joint mimics
wrong("That a joint mimics is not described.", lambda robot: _joints(robot, lambda joint: {"mimic": None}))

wrong = describes("EU-CAN-001")
wrong("Damping is not read.", lambda robot: _joints(robot, lambda joint: {"damping": [0.0] * len(joint.damping)}))


@describes("EU-CAN-001")
def links_behind_fixed_joints_are_not_described(robot: CanonicalRobot) -> Members:
    """Only links that a joint moves are described, as in MuJoCo."""
    moved = {link for joint in robot.joints for link in (joint.parent, joint.child)}
    return {"links": [link for link in robot.links if link in moved]}


wrong = describes("EU-CAN-001")
wrong("Closures are not described.", lambda robot: {"closures": []})

wrong = describes("EU-CAN-001", versions=("2",))
# version 1 adds no frames
wrong("Frames that the description adds are not described.", lambda robot: {"frames": []})

wrong = describes("EU-CAN-001")
wrong("Actuators are not described.", lambda robot: {"actuators": []})
wrong("The robot's name is that of its file.", lambda robot: {"name": "robot"})

wrong = describes("EU-CAN-001", versions=("2",))
# version 1 has none
wrong("Configurations are not described.", lambda robot: {"configurations": {}})


def _left_out(robot: CanonicalRobot, value: Callable[[CanonicalJoint], list[float]]) -> Members:
    """What configurations leave out is filled in."""
    filled = {joint.name: value(joint) for joint in robot.joints if joint.mimic is None}
    return {"configurations": {name: filled | stated for name, stated in robot.configurations.items()}}


wrong = describes("EU-CAN-004")
wrong(
    "All coordinates of a joint that a configuration leaves out are 0, those of a quaternion too.",
    lambda robot: _left_out(robot, lambda joint: [0.0] * len(KINDS[joint.type].neutral)),
)


@describes("EU-ACT-007")
def motors_act_on_the_first_velocity(robot: CanonicalRobot) -> Members:
    """A motor acts along the first velocity of its joint alone."""

    def first(numbers: list[float] | None) -> list[float] | None:
        return numbers and [numbers[0], *[0.0] * (len(numbers) - 1)]

    return {
        "actuators": [
            each.model_copy(update={"gear_ratio": first(each.gear_ratio), "rotor_inertia": first(each.rotor_inertia)})
            for each in robot.actuators
        ]
    }


@describes("EU-ACT-007")
def motors_of_several_velocities_are_dropped(robot: CanonicalRobot) -> Members:
    """A motor of a joint of several velocities is dropped."""
    several = {joint.name for joint in robot.joints if len(joint.damping) > 1}
    return {"actuators": [each for each in robot.actuators if each.joint not in several]}


@answers("EU-ACT-007")
def transmissions_are_motors(right: Answer, description: Path, urdf: Path) -> Answer:
    """A joint that a transmission names is actuated, as in ROS."""
    if not isinstance(right, Accepted) or right.robot is None:
        return right
    motors = {each.joint for each in right.robot.actuators}
    named = [joint.get("name") for joint in etree.parse(urdf).iterfind("transmission/joint")]
    more = [CanonicalActuator(joint=name) for name in named if name not in motors]
    robot = right.robot.model_copy(update={"actuators": [*right.robot.actuators, *more]})
    return right.model_copy(update={"robot": robot})


# -- Values ---------------------------------------------------------------------------------------------------------


@evaluates("EU-PRO-007")
def columns_by_joint_alone(values: Values) -> Members:
    """Each column of a joint is said to be its first."""
    K = values.jacobian
    return {"jacobian": K and K.model_copy(update={"columns": [(joint, 0) for joint, _ in K.columns]})}


@evaluates("EU-PRO-007", versions=("2",))  # in version 1 no root floats
def root_has_no_columns(values: Values) -> Members:
    """The velocities of a floating root are not named."""
    if (K := values.jacobian) is None:
        return {}
    kept = [i for i, (joint, _) in enumerate(K.columns) if joint != "root_joint"]
    rows = {name: [[row[i] for i in kept] for row in rows] for name, rows in K.rows.items()}
    return {"jacobian": K.model_copy(update={"columns": [K.columns[i] for i in kept], "rows": rows})}


@evaluates("EU-PRO-008")
def poses_of_six_decimals(values: Values) -> Members:
    """Poses are rounded to six decimals."""
    if values.poses is None:
        return {}
    rounded = {
        name: pose.model_copy(update={"translation": np.round(pose.translation, 6).tolist()})
        for name, pose in values.poses.items()
    }
    return {"poses": rounded}


@evaluates("EU-PRO-009")
def mass_matrix_of_single_precision(values: Values) -> Members:
    """M is computed in single precision."""
    M = values.mass_matrix
    return {"mass_matrix": M and M.model_copy(update={"matrix": np.float32(M.matrix).astype(float).tolist()})}


@evaluates("EU-INR-006")
def upper_triangle_of_m(values: Values) -> Members:
    """M is given by its upper triangle, as Pinocchio leaves it."""
    M = values.mass_matrix
    return {"mass_matrix": M and M.model_copy(update={"matrix": np.triu(M.matrix).tolist()})}


# -- Conformance and the protocol -----------------------------------------------------------------------------------


wrong = answers("EU-CNF-001")
wrong(
    "Whatever is wrong, the answer is `accepted`, with the errors beside it.",
    lambda right, description, urdf: accepted(None, right.issues) if isinstance(right, Rejected) else right,
)


@answers("EU-CFG-004")
def only_stated_coordinates_are_checked(right: Answer, description: Path, urdf: Path) -> Answer:
    """A configuration may leave out a joint whose limits exclude its neutral."""
    left_out = [issue.code == "configuration-limits" and "leaves out" in issue.message for issue in right.issues]
    return accepted() if isinstance(right, Rejected) and all(left_out) else right


wrong = answers("EU-CNF-002")
wrong(
    "A description that deserves a warning is rejected.",
    lambda right, description, urdf: rejected(*right.issues) if right.issues else right,
)


def _types(right: Answer) -> set[str]:
    return {joint.type for joint in right.robot.joints} if isinstance(right, Accepted) and right.robot else set()


@answers("EU-CNF-004")
def missing_features_are_errors(right: Answer, description: Path, urdf: Path) -> Answer:
    """A parser that lacks universal and helical joints rejects them."""
    lacking = "UJOINT_" in description.read_text("utf-8-sig") or _types(right) & {"universal", "helical"}
    return rejected("no such joint") if isinstance(right, Accepted) and lacking else right


@answers("EU-CNF-007", verdict=Verdict.UNSUPPORTED)
def claims_what_it_does_not_support(right: Answer, description: Path, urdf: Path) -> Any:
    """A parser that claims a level lacks universal and helical joints, and says so."""
    lacking = "UJOINT_" in description.read_text("utf-8-sig") or _types(right) & {"universal", "helical"}
    return unsupported("universal") if isinstance(right, Accepted) and lacking else right


@answers("EU-CNF-008", verdict=Verdict.UNSUPPORTED)
def names_no_feature_of_the_list(right: Answer, description: Path, urdf: Path) -> Any:
    """A parser that lacks universal and helical joints answers with a name of its own."""
    lacking = "UJOINT_" in description.read_text("utf-8-sig") or _types(right) & {"universal", "helical"}
    return unsupported("joints") if isinstance(right, Accepted) and lacking else right


@answers("EU-CLO-011")
def redundant_closures_are_refused(right: Answer, description: Path, urdf: Path) -> Answer:
    """More rows of closures than velocities are refused."""
    if not isinstance(right, Accepted) or right.robot is None:
        return right
    rows = sum(3 if closure.type == "3d" else 6 for closure in right.robot.closures)
    velocities = sum(len(joint.damping) for joint in right.robot.joints if joint.mimic is None)
    return rejected("the loops are overconstrained") if rows > velocities else right


@answers("EU-SEC-005", verdict=Verdict.ERRORED)
def trees_are_walked_by_recursion(right: Answer, description: Path, urdf: Path) -> Answer:
    """A function that calls itself for each link on a link walks the tree, and fails where it is 1000 links deep."""
    if isinstance(right, Accepted) and len(etree.parse(urdf).findall("joint")) > 1000:
        raise RecursionError("maximum recursion depth exceeded")
    return right
