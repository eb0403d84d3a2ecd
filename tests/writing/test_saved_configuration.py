"""The configuration ``assembled`` as it is written to a description."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import eurdf
from eurdf.linking.configurations import beyond_limits
from eurdf.linking.robot_files import read_robot
from eurdf.pinocchio.robot import build_robot
from eurdf.writing.saved_configuration import CLOSED_IN_FULL, with_closed_configuration
from support.described import STAR, written
from support.places import ROBOTS

#: Joints of every type that has coordinates, between them and those that STAR has by itself.
TYPES = [
    "{}",
    "{a: spherical, b: {type: helical, pitch: 0.1}, c: cylindrical, d: {type: universal, axes: zx}}",
    "{d: cylindrical, a: {type: universal, axes: yx}, b: spherical}",
]


@pytest.mark.parametrize("root", ["fixed", "floating"])
@pytest.mark.parametrize("joints", TYPES)
@settings(max_examples=20, deadline=None)
@given(data=st.data())
def test_configuration_of_every_joint_type_survives_round_trip(
    tmp_path_factory: pytest.TempPathFactory, data: st.DataObject, joints: str, root: str
) -> None:
    path = written(tmp_path_factory.mktemp("star"), STAR, f"root: {root}\njoints: {joints}\n")
    description = read_robot(path, geometry=False)
    assert description.mechanism is not None
    robot = build_robot(description.mechanism, geometry=False)
    nv = robot.model.nv
    v = data.draw(st.lists(st.floats(-1.0, 1.0) | st.just(0.0), min_size=nv, max_size=nv))
    q = np.array(pin.integrate(robot.model, pin.neutral(robot.model), np.array(v)))
    text, diagnostics = with_closed_configuration(description, robot, q)
    assert not beyond_limits(robot.mechanism.joints, robot.joint_positions(q))
    assert not diagnostics.errors
    path.write_text(text, encoding="utf-8")
    back = eurdf.load(path, geometry=False).configurations["assembled"]
    np.testing.assert_allclose(back, q, rtol=0.0, atol=1e-12)


@pytest.mark.parametrize("name", ["bennett", "digit_leg", "five_bar_6d", "stewart_platform", "unitree_g1_ankle"])
def test_written_assembly_is_closed_when_read(name: str, tmp_path: Path) -> None:
    description = read_robot(ROBOTS / name, geometry=False)
    assert description.mechanism is not None
    robot = build_robot(description.mechanism, geometry=False)
    away = np.random.default_rng(1).uniform(-0.1, 0.1, robot.model.nv)
    start = pin.integrate(robot.model, robot.configurations["assembled"], away)
    assembly = eurdf.assemble(robot, start, tolerance=1e-13, limits=True)
    assert assembly.closes
    assert np.abs(assembly.q - robot.configurations["assembled"]).max() > 1e-3
    text, diagnostics = with_closed_configuration(description, robot, assembly.q)
    assert not diagnostics.errors
    (tmp_path / "robot.yaml").write_text(text, encoding="utf-8")
    (tmp_path / "robot.urdf").write_bytes((ROBOTS / name / "robot.urdf").read_bytes())
    back = eurdf.load(tmp_path, geometry=False)
    assert np.abs(eurdf.residual(back, back.configurations["assembled"])).max() <= CLOSED_IN_FULL
    assert "assembled-open" not in [found.code for found in eurdf.check(tmp_path).diagnostics]
