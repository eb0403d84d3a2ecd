"""Robots exported for Drake: it finds the constraints that we find, and holds them."""

from __future__ import annotations

import numpy as np
import pinocchio as pin

import eurdf
from support.drake_witness import InDrake
from support.exported import BODY, LIMIT, random_robot
from support.plain_urdf import joint_element, link_element
from support.plain_urdf import robot as robot_element

ARM = robot_element(
    link_element("world"),
    link_element("upper", BODY),
    link_element("fore", BODY),
    joint_element("shoulder", "revolute", "world", "upper", LIMIT + '<dynamics damping="0.2" friction="0.1"/>'),
    joint_element("elbow", "revolute", "upper", "fore", LIMIT),
)
DESCRIPTION = """\
extended_urdf: "2.1"
joints:
  elbow: {type: spherical}
  shoulder: {stiffness: 30}
actuators:
  - {joint: shoulder, gear_ratio: 5, rotor_inertia: 0.01, control: [-4, 6]}
  - elbow
"""


def test_motor_has_rotor_gear_and_effort_limit() -> None:
    export = eurdf.export(DESCRIPTION, "drake", urdf=ARM)
    there = InDrake(eurdf.load(DESCRIPTION, urdf=ARM), export)
    actuator = there.plant.GetJointActuatorByName("shoulder")
    assert (actuator.default_gear_ratio(), actuator.default_rotor_inertia()) == (5.0, 0.01)
    assert actuator.effort_limit() == 7.0
    shoulder = there.plant.GetJointByName("shoulder")
    assert (shoulder.position_lower_limits()[0], shoulder.velocity_upper_limits()[0]) == (-1.0, 3.0)
    assert shoulder.default_damping_vector()[0] == 0.2
    lost = {(loss.code, loss.name) for loss in export.losses}
    assert {
        ("export-actuator", "elbow"),
        ("export-control-range", "shoulder"),
        ("export-friction", "shoulder"),
        ("export-spring", "shoulder"),
    } <= lost


def test_armature_without_motor_is_a_loss() -> None:
    description = (
        'extended_urdf: "2.0"\njoints: {shoulder: {armature: 0.3}, elbow: {armature: 0.2}}\nactuators: [elbow]\n'
    )
    export = eurdf.export(description, "drake", urdf=ARM)
    assert [loss.name for loss in export.losses if loss.code == "export-armature"] == ["shoulder"]
    robot = eurdf.load(description, urdf=ARM)
    there = InDrake(robot, export)
    there.at(pin.neutral(robot.model))
    difference = eurdf.mass_matrix(robot, pin.neutral(robot.model)) - there.mass_matrix
    np.testing.assert_allclose(difference, np.diag([0.3, 0.0]), atol=1e-12)


def test_link_called_world_is_renamed_if_it_moves() -> None:
    description = 'extended_urdf: "2.0"\nroot: floating\n'
    export = eurdf.export(description, "drake", urdf=ARM)
    assert [loss.message for loss in export.losses if loss.code == "export-name"] == ["becomes 'world_'"]
    there = InDrake(eurdf.load(description, urdf=ARM), export)
    assert there.plant.num_velocities() == 8


def test_missing_distance_is_a_loss_with_its_points() -> None:
    robot, _ = random_robot(3)
    (closure,) = (each for each in robot.mechanism.closures if each.type == "distance")
    (loss,) = (loss for loss in eurdf.export(robot, "drake").losses if loss.code == "export-distance-closure")
    assert loss.name == closure.name
    assert str(closure.length) in loss.message
