"""Parsers that read and understand the files, and answer something else."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
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
from mutants.mutant import Answer, Members, text_of

# -- The canonical description --------------------------------------------------------------------------------------


def each(listed: str, change: Callable[[Any], Members]) -> Callable[[CanonicalRobot], Members]:
    """The entries of a list of the canonical description are others."""
    return lambda robot: {listed: [entry.model_copy(update=change(entry)) for entry in getattr(robot, listed)]}


def _limits(change: Callable[[float | None], float | None], *names: str) -> Callable[[CanonicalRobot], Members]:
    return each("joints", lambda joint: {name: [*map(change, getattr(joint, name))] for name in names})


def _that_move(robot: CanonicalRobot) -> Members:
    moved = {link for joint in robot.joints for link in (joint.parent, joint.child)}
    return {"links": [link for link in robot.links if link in moved]}


def _zeros_where_left_out(robot: CanonicalRobot) -> Members:
    zeros = {joint.name: [0.0] * len(KINDS[joint.type].neutral) for joint in robot.joints if joint.mimic is None}
    return {"configurations": {name: zeros | stated for name, stated in robot.configurations.items()}}


def _first(numbers: list[float] | None) -> list[float] | None:
    return numbers and [numbers[0], *[0.0] * (len(numbers) - 1)]


def _motors_of_one_velocity(robot: CanonicalRobot) -> Members:
    several = {joint.name for joint in robot.joints if len(joint.damping) > 1}
    return {"actuators": [motor for motor in robot.actuators if motor.joint not in several]}


def _with_transmissions(right: Answer, description: Path, urdf: Path) -> Answer:
    if not isinstance(right, Accepted) or right.robot is None:
        return right
    motors = {motor.joint for motor in right.robot.actuators}
    named = [joint.get("name") for joint in etree.parse(urdf).iterfind("transmission/joint")]
    more = [CanonicalActuator(joint=name) for name in named if name not in motors]
    robot = right.robot.model_copy(update={"actuators": [*right.robot.actuators, *more]})
    return right.model_copy(update={"robot": robot})


DESCRIBES = {
    "EU-CAN-001": {
        "Position limits are in degrees.": _limits(
            lambda limit: None if limit is None else math.degrees(limit), "lower", "upper"
        ),
        "Where there is no limit, there is a large number.": _limits(
            lambda limit: 1e30 if limit is None else limit, "velocity", "effort"
        ),
        "The child of a joint is said to be its parent.": each(
            "joints", lambda joint: {"parent": joint.child, "child": joint.parent}
        ),
        "Damping is not read.": each("joints", lambda joint: {"damping": [0.0] * len(joint.damping)}),
        "Only links that a joint moves are described, as in MuJoCo.": _that_move,
        "Closures are not described.": lambda robot: {"closures": []},
        "Actuators are not described.": lambda robot: {"actuators": []},
        "The robot's name is that of its file.": lambda robot: {"name": "robot"},
    },
    ("EU-CAN-001", "2"): {  # version 1 has no mimic joints, no frames and no configurations
        "That a joint mimics is not described.": each("joints", lambda joint: {"mimic": None}),
        "Frames that the description adds are not described.": lambda robot: {"frames": []},
        "Configurations are not described.": lambda robot: {"configurations": {}},
    },
    "EU-CAN-004": {
        "All coordinates of a joint that a configuration leaves out are 0, those of a quaternion too.": (
            _zeros_where_left_out
        ),
    },
    "EU-ACT-007": {
        "A motor acts along the first velocity of its joint alone.": each(
            "actuators", lambda motor: {name: _first(getattr(motor, name)) for name in ("gear_ratio", "rotor_inertia")}
        ),
        "A motor of a joint of several velocities is dropped.": _motors_of_one_velocity,
    },
    "EU-CLO-021": {"A closure has no compliance.": each("closures", lambda closure: {"compliance": None})},
    "EU-ACT-010": {
        "An actuator has the name of its joint, whatever the description states.": each(
            "actuators", lambda motor: {"name": None}
        ),
        "An actuator has no control range.": each("actuators", lambda motor: {"control": None}),
    },
}

# -- Values ---------------------------------------------------------------------------------------------------------


def _changed(quantity: str, change: Callable[[Any], Members]) -> Callable[[Values], Members]:
    """A quantity is another: change(quantity) -> its members that differ."""
    return lambda values: {quantity: (right := getattr(values, quantity)) and right.model_copy(update=change(right))}


def _without_the_root(K: Any) -> Members:
    kept = [i for i, (joint, _) in enumerate(K.columns) if joint != "root_joint"]
    rows = {name: [[row[i] for i in kept] for row in rows] for name, rows in K.rows.items()}
    return {"columns": [K.columns[i] for i in kept], "rows": rows}


def _of_six_decimals(values: Values) -> Members:
    rounded = {
        name: pose.model_copy(update={"translation": np.round(pose.translation, 6).tolist()})
        for name, pose in (values.poses or {}).items()
    }
    return {"poses": rounded}


EVALUATES = {
    "EU-PRO-007": {
        "Each column of a joint is said to be its first.": _changed(
            "jacobian", lambda K: {"columns": [(joint, 0) for joint, _ in K.columns]}
        ),
    },
    ("EU-PRO-007", "2"): {  # in version 1 no root floats
        "The velocities of a floating root are not named.": _changed("jacobian", _without_the_root),
    },
    "EU-PRO-008": {"Poses are rounded to six decimals.": _of_six_decimals},
    "EU-PRO-009": {
        "M is computed in single precision.": _changed(
            "mass_matrix", lambda M: {"matrix": np.float32(M.matrix).astype(float).tolist()}
        ),
    },
    "EU-INR-006": {
        "M is given by its upper triangle, as Pinocchio leaves it.": _changed(
            "mass_matrix", lambda M: {"matrix": np.triu(M.matrix).tolist()}
        ),
    },
}

# -- Conformance and the protocol -----------------------------------------------------------------------------------


def _only_stated_coordinates_are_checked(right: Answer, *_: Path) -> Answer:
    left_out = [issue.code == "configuration-limits" and "leaves out" in issue.message for issue in right.issues]
    return accepted() if isinstance(right, Rejected) and all(left_out) else right


def _lacking(answer: Any, right: Answer, description: Path, urdf: Path) -> Any:
    """The answer of one that lacks universal and helical joints."""
    if not isinstance(right, Accepted):
        return right
    joints: list[CanonicalJoint] = right.robot.joints if right.robot else []
    types = {joint.type for joint in joints}
    return answer if "UJOINT_" in text_of(description) or types & {"universal", "helical"} else right


def _overconstrained(right: Answer, *_: Path) -> Answer:
    if not isinstance(right, Accepted) or right.robot is None:
        return right
    rows = sum(3 if closure.type == "3d" else 6 for closure in right.robot.closures)
    velocities = sum(len(joint.damping) for joint in right.robot.joints if joint.mimic is None)
    return rejected("the loops are overconstrained") if rows > velocities else right


def _recursive(right: Answer, description: Path, urdf: Path) -> Answer:
    if isinstance(right, Accepted) and len(etree.parse(urdf).findall("joint")) > 1000:
        raise RecursionError("maximum recursion depth exceeded")
    return right


ANSWERS = {
    "EU-CAN-001": {
        "The robot that was read is not described.": lambda right, *_: (
            accepted(None, right.issues) if isinstance(right, Accepted) else right
        ),
    },
    "EU-ACT-007": {"A joint that a transmission names is actuated, as in ROS.": _with_transmissions},
    "EU-CNF-001": {
        "Whatever is wrong, the answer is `accepted`, with the errors beside it.": lambda right, *_: (
            accepted(None, right.issues) if isinstance(right, Rejected) else right
        ),
    },
    "EU-CFG-004": {
        "A configuration may leave out a joint whose limits exclude its neutral.": _only_stated_coordinates_are_checked,
    },
    "EU-CNF-002": {
        "A description that deserves a warning is rejected.": lambda right, *_: (
            rejected(*right.issues) if right.issues else right
        ),
    },
    "EU-CNF-004": {
        "A parser that lacks universal and helical joints rejects them.": partial(_lacking, rejected("no such joint")),
    },
    ("EU-CNF-007", Verdict.UNSUPPORTED): {
        "A parser that claims a level lacks universal and helical joints, and says so.": partial(
            _lacking, unsupported("universal")
        ),
    },
    ("EU-CNF-008", Verdict.UNSUPPORTED): {
        "A parser that lacks universal and helical joints answers with a name of its own.": partial(
            _lacking, unsupported("joints")
        ),
    },
    "EU-CLO-011": {"More rows of closures than velocities are refused.": _overconstrained},
    ("EU-SEC-005", Verdict.ERRORED): {
        "A function that calls itself for each link on a link walks the tree, and fails where it is 1000 links deep.": (
            _recursive
        ),
    },
}
