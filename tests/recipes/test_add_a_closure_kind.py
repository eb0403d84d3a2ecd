"""To add a kind of closure, write one class: kinematics, dynamics, files, schema, and `eurdf info` know it at once.

The class goes into a file of its own in `eurdf.closures`, with a line in `MODULES` there; its clauses into
`spec/closures.md`, its residual into the oracle, and cases into the suite. A format to export to that can say it gets a
row in its ``facts.py`` and states it in its ``write.py``; Pinocchio's models are in `eurdf.pinocchio.constraint`, and
the residual in JavaScript in ``js/src/mechanism/constraints.js``.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, ClassVar

import jsonschema
import numpy as np
import pytest
import yaml

import eurdf
from eurdf.closures import REGISTRY
from eurdf.closures.kind import ClosureKind, RelativeMotions, RelativePoses, no_angle
from eurdf.closures.point import PointClosure
from eurdf.closures.se3 import velocity_of_origin
from eurdf.commands.output import output_schemas, to_json
from eurdf.commands.robot_info import robot_info
from eurdf.convert.formats import EXPORTS
from eurdf.errors import NoConstraintModel
from eurdf.format.schema import json_schema
from eurdf.kinematics.evaluate import frames
from eurdf.kinematics.residual import acceleration_drift
from eurdf.mechanism.constraint import Unit, key
from eurdf.mechanism.same_model import differences
from eurdf.pinocchio.robot import Robot, build_robot
from eurdf.writing.description import NotWritable, describe_mechanism
from support.differences import slope


@dataclass(frozen=True, slots=True)
class InPlane(ClosureKind):
    """The origin of B is in a plane across the z axis of A: r = p_z - height."""

    type: ClassVar[str] = "in-plane"
    units: ClassVar[tuple[Unit, ...]] = ("m",)
    text: ClassVar[str] = "the origin of frame B is in a plane across the z axis of frame A"
    height: float = key("Height", "Distance of the plane from the origin of A along z, m.", example=0.1, default=0.0)

    @classmethod
    def prepare(cls, closures: Sequence[InPlane]) -> Any:
        return np.array([closure.height for closure in closures])

    @staticmethod
    def residual(poses: RelativePoses, fixed: Any) -> Any:
        return poses.position[..., 2:] - fixed[:, None]

    @staticmethod
    def jacobian(poses: RelativePoses, fixed: Any) -> Any:
        return velocity_of_origin(poses.position)[..., 2:, :]

    @staticmethod
    def drift(motions: RelativeMotions, fixed: Any) -> Any:
        return motions.acceleration[..., 2:]

    @staticmethod
    def jacobian_derivative(poses: RelativePoses, fixed: Any) -> Any:
        return PointClosure.jacobian_derivative(poses, None)[..., 2:, :, :]

    @staticmethod
    def bend_derivative(poses: RelativePoses, fixed: Any, twist: Any) -> Any:
        return PointClosure.bend_derivative(poses, None, twist)[..., 2:, :]

    @staticmethod
    def opening(poses: RelativePoses, fixed: Any) -> Any:
        return no_angle(np.abs(poses.position[..., 2] - fixed))


@pytest.fixture(scope="module")
def robot() -> Robot:
    """digit_leg with its last closure, a weld, replaced by one row."""
    robot = eurdf.load("digit_leg", geometry=False)
    *others, last = robot.mechanism.closures
    in_plane = InPlane(last.name, last.a, last.b, 0.001)
    return build_robot(replace(robot.mechanism, closures=(*others, in_plane), configurations={}), geometry=False)


@pytest.fixture
def registered(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(REGISTRY, InPlane.type, InPlane)


def test_residual_has_its_derivatives(robot: Robot) -> None:
    random, tree = np.random.default_rng(0), robot.tree
    q, v = tree.integrate(tree.neutral(), random.uniform(-1.0, 1.0, tree.nv)), random.uniform(-1.0, 1.0, tree.nv)
    _, K = eurdf.residual_and_jacobian(robot, q)
    h = 1e-5
    ahead, here, behind = (eurdf.residual(robot, tree.integrate(q, t * v)) for t in (h, 0.0, -h))
    np.testing.assert_allclose(K @ v, (ahead - behind) / (2.0 * h), atol=1e-7)
    np.testing.assert_allclose(acceleration_drift(robot, q, v), (ahead - 2.0 * here + behind) / h**2, atol=1e-3)
    w = random.uniform(-1.0, 1.0, tree.nv)
    found = eurdf.dynamics_derivatives(robot, q, v, gains=(20.0, 5.0)).a_q @ w
    by_differences = slope(lambda t: eurdf.forward_dynamics(robot, tree.integrate(q, t * w), v, gains=(20.0, 5.0)).a, h)
    np.testing.assert_allclose(found, by_differences, rtol=0.0, atol=1e-5 * np.abs(found).max())


def test_robot_closes_moves_and_falls(robot: Robot) -> None:
    assembly = eurdf.assemble(robot)
    q = assembly.q
    assert assembly.converged
    assert robot.mechanism.nc == 13
    assert eurdf.analyze(robot, q).mobility == eurdf.analyze(eurdf.load("digit_leg", geometry=False)).mobility + 5
    motor = robot.actuation.joints[0]
    values = q[robot.actuation.idx_q] + 0.01
    there = eurdf.forward_kinematics(robot, values, q)
    np.testing.assert_allclose(eurdf.residual(robot, there), 0.0, atol=1e-9)
    found = eurdf.batch.forward_kinematics(robot, np.tile(values, (3, 1)), q)
    np.testing.assert_allclose(found.q, np.tile(there, (3, 1)), atol=1e-8)
    frame = robot.mechanism.bodies[-1].name
    target = frames(robot, [frame], few=True).at(there[None]).position[0, 0]
    assert eurdf.inverse_kinematics(robot, {frame: target}, q).converged
    v = eurdf.project_velocity(robot, q, np.ones(robot.tree.nv))
    a = eurdf.forward_dynamics(robot, q, v).a
    K = eurdf.residual_and_jacobian(robot, q)[1]
    np.testing.assert_allclose(K @ a + acceleration_drift(robot, q, v), 0.0, atol=1e-7 * np.abs(a).max())
    assert np.isfinite(eurdf.simulate(robot, q, v, duration=0.005).q).all()
    assert eurdf.lock(robot, [motor], q).tree.nv < robot.tree.nv
    assert len(eurdf.sweep(robot, motor, q, steps=5).upper.configurations) > 1


@pytest.mark.usefixtures("registered")
def test_file_that_states_it_is_written_checked_and_read(robot: Robot, tmp_path: Path) -> None:
    files = describe_mechanism(robot.mechanism)
    description, schema = yaml.safe_load(files.yaml), json_schema("2.1")
    stated = description["closures"][-1]
    assert {key: stated[key] for key in ("type", "height")} == {"type": "in-plane", "height": 0.001}
    assert schema["$defs"]["InPlane"]["properties"]["height"]["default"] == 0.0
    jsonschema.validate(description, schema)
    (tmp_path / "robot.urdf").write_bytes(files.urdf)
    (tmp_path / "robot.yaml").write_text(files.yaml, encoding="utf-8")
    assert eurdf.check(tmp_path).ok
    read = eurdf.load(tmp_path, geometry=False).mechanism
    assert differences(robot.mechanism, read) == []
    assert describe_mechanism(read).yaml == files.yaml


@pytest.mark.usefixtures("registered")
@pytest.mark.parametrize(
    ("right", "wrong", "hint"),
    [
        ("height:", "hight:", "write 'height'"),
        ("height: 0.001", "height: x", ""),
        ("type: in-plane", "type: in-plan", "write 'in-plane'"),
        (
            'extended_urdf: "2.1"',
            'extended_urdf: "2.0"',
            """type 'in-plane' is of version 2.1: write extended_urdf: "2.1" on line 1""",
        ),
    ],
)
def test_wrong_file_has_one_error_with_a_hint(robot: Robot, tmp_path: Path, right: str, wrong: str, hint: str) -> None:
    files = describe_mechanism(robot.mechanism, schema=None)
    assert right in files.yaml
    (tmp_path / "robot.urdf").write_bytes(files.urdf)
    (tmp_path / "robot.yaml").write_text(files.yaml.replace(right, wrong), encoding="utf-8")
    (found,) = eurdf.check(tmp_path).errors
    assert hint in (found.hint or "")


@pytest.mark.usefixtures("registered")
def test_info_matches_its_schema(robot: Robot) -> None:
    info = to_json(robot_info(robot, eurdf.analyze(robot)))
    assert info["closure_list"][-1]["type"] == "in-plane"
    jsonschema.validate(info, output_schemas()["info.schema.json"])


@pytest.mark.parametrize("name", EXPORTS)
def test_export_has_one_loss_that_names_it(robot: Robot, name: str) -> None:
    if name == "usd":
        pytest.importorskip("pxr")
    last = robot.mechanism.closures[-1].name
    (loss,) = [each for each in eurdf.export(robot, name).losses if each.name == last]
    assert loss.code == "export-closure-kind"
    assert "'in-plane'" in loss.message


def test_pinocchio_has_no_model_of_it(robot: Robot) -> None:
    with pytest.raises(NoConstraintModel, match=robot.mechanism.closures[-1].name):
        _ = robot.constraint_models


def test_kind_without_a_line_is_not_written(robot: Robot) -> None:
    with pytest.raises(NotWritable, match="has the type 'in-plane', which no version of the format has"):
        describe_mechanism(robot.mechanism)
