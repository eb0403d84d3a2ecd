"""What the kinematics asks of a spanning tree: a `Tree` alone, and what that answers."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

import eurdf
from eurdf.kinematics.frame_jacobian import frame_jacobian
from support.places import ROBOTS

#: What must not need Pinocchio's model, for a robot with an actuator 'motor_crank' and a link 'coupler'.
ANSWERS: dict[str, Callable[[Any, Any], Any]] = {
    "actuated_jacobian": lambda robot, q: eurdf.actuated_jacobian(robot, "coupler", q, reference=pin.WORLD),
    "analyze": lambda robot, q: eurdf.analyze(robot, q).loops[0].motions,
    "assemble": lambda robot, q: eurdf.assemble(robot, q + 0.1, hold="motor_crank", limits=True).q,
    "closure_openings": lambda robot, q: eurdf.kinematics.closure_openings(robot, q + 0.1)[0].position,
    "differential_inverse_kinematics": lambda robot, q: (
        eurdf.differential_inverse_kinematics(robot, "coupler", q, np.ones(6)).v
    ),
    "dq_dq_actuated": eurdf.kinematics.dq_dq_actuated,
    "forward_kinematics": lambda robot, q: eurdf.forward_kinematics(robot, q[robot.actuation.idx_q] + 0.1, q),
    "inverse_kinematics": lambda robot, q: eurdf.inverse_kinematics(robot, {"coupler": [0.1, 0.0, 0.3]}, q).q,
    "project_acceleration": lambda robot, q: eurdf.project_acceleration(robot, q, np.ones(3), np.ones(3)),
    "project_configuration": lambda robot, q: eurdf.project_configuration(robot, q + 0.1),
    "project_velocity": lambda robot, q: eurdf.project_velocity(robot, q, np.ones(3)),
    "residual": lambda robot, q: eurdf.residual_and_jacobian(robot, q + 0.1)[1],
    "split_configuration": lambda robot, q: eurdf.split_configuration(robot, q)[1],
    "sweep": lambda robot, q: eurdf.sweep(robot, "motor_crank", q, steps=5).upper.configurations,
}


class Refused:
    """A model that nothing may ask."""

    def __getattr__(self, name: str) -> Any:
        raise AssertionError(f"the kinematics asks the model for {name}, not the tree")


@pytest.mark.parametrize("name", ANSWERS)
def test_kinematics_asks_the_tree_alone(name: str) -> None:
    robot = eurdf.load(ROBOTS / "four_bar", geometry=False)
    q = eurdf.assemble(robot).q
    expected = ANSWERS[name](robot, q)
    asked = replace(robot, model=Refused())
    vars(asked).update(tree=robot.tree, actuation=robot.actuation, configurations=robot.configurations)
    np.testing.assert_equal(ANSWERS[name](asked, q), expected)


@pytest.mark.parametrize("reference", [pin.LOCAL, pin.WORLD, pin.LOCAL_WORLD_ALIGNED])
@pytest.mark.parametrize("name", ["digit_leg", "cassie_leg", "stewart_platform"])
def test_frame_jacobian_equals_pinocchio(name: str, reference: Any) -> None:
    robot = eurdf.load(ROBOTS / name, geometry=False)
    model, tree = robot.model, robot.tree
    q = tree.integrate(tree.neutral(), np.random.default_rng(0).uniform(-1.0, 1.0, tree.nv))
    for index in (model.nframes // 2, model.nframes - 1):
        expected = pin.computeFrameJacobian(model, model.createData(), q, index, reference)
        found = frame_jacobian(robot, q, model.frames[index].name, reference)
        np.testing.assert_allclose(found, expected, rtol=0.0, atol=1e-12 * np.abs(expected).max())


def test_unknown_reference_is_refused() -> None:
    robot = eurdf.load(ROBOTS / "four_bar", geometry=False)
    with pytest.raises(ValueError, match=r"^reference is 'world'; expected pin\.LOCAL, "):
        eurdf.actuated_jacobian(robot, "coupler", robot.tree.neutral(), reference="world")


def test_configuration_and_coordinates_are_inverse() -> None:
    robot = eurdf.load(ROBOTS / "digit_2legs", geometry=False)
    q = eurdf.assemble(robot).q
    np.testing.assert_allclose(robot.configuration(robot.joint_positions(q)), q, rtol=0.0, atol=1e-12)
