"""Named configurations: from the coordinates of files to Pinocchio's q."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import eurdf
from eurdf.mechanism.mechanism import Root
from eurdf.pinocchio.configuration import configuration_vector
from eurdf.pinocchio.robot import Robot, build_robot
from support import by_hand
from support.described import STAR, at, codes, load, written
from support.places import DATA

WORKBENCH = DATA / "workbench.yaml"

JOINTS = "joints: {d: spherical}\n"


@settings(max_examples=50, deadline=None)
@given(st.tuples(*[st.floats(-1, 1)] * 4), st.floats(-1.9e-6, 1.9e-6))
def test_nearly_unit_quaternion_is_normalized_others_refused(direction: tuple[float, ...], off: float) -> None:
    norm = math.hypot(*direction)
    assume(norm > 1e-3 and abs(abs(off) - 1e-6) > 1e-9)
    written = [float(value / norm * (1.0 + off)) for value in direction]
    yaml = f"{JOINTS}configurations: {{ready: {{d: {written}}}}}\n"
    if abs(off) > 1e-6:
        assert codes(STAR, yaml) == ["configuration-quaternion"]
        return
    loaded = load(STAR, yaml)
    idx_q = at(loaded.model, "d")[0]
    found = loaded.configurations["ready"][idx_q : idx_q + 4]
    assert np.linalg.norm(found) == pytest.approx(1.0, abs=1e-12)
    np.testing.assert_allclose(found, np.array(direction) / norm, atol=1e-12)


def test_message_says_what_to_write_of_joints_left_out(tmp_path: Path) -> None:
    limits = "a: {limits: {lower: 0.1}}, d: {type: universal, axes: xy, limits: {upper: [1, -0.5]}}"
    path = written(tmp_path, STAR, f"joints: {{{limits}}}\nconfigurations:\n  ready: {{b: 1}}\n")
    (found,) = eurdf.check(path).diagnostics
    assert "'ready' leaves out joints" in found.message
    assert "'a' (limits 0.1 to 2 rad), 'd' (limits -2 to -0.5 rad)" in found.message
    added = (found.hint or "").partition("for example ")[2]
    assert added == "{a: 0.1, d: [0.0, -0.5]}"
    path.write_text(path.read_text(encoding="utf-8").replace("{b: 1}", added), encoding="utf-8")
    assert eurdf.check(path).diagnostics == ()


@pytest.mark.parametrize(
    ("value", "hint"), [(57.3, "57.3 degrees are 1.00007 rad"), (-4, "-4 degrees"), (400, "400 degrees")]
)
def test_angle_beyond_its_limits_may_be_in_degrees(tmp_path: Path, value: float, hint: str) -> None:
    (found,) = eurdf.check(written(tmp_path, STAR, f"configurations: {{ready: {{a: {value}}}}}\n")).diagnostics
    assert found.code == "configuration-limits"
    assert found.hint is not None
    assert found.hint.startswith("is it in degrees? ")
    assert hint in found.hint


def test_limit_zero_of_left_handed_screw_is_not_negative(tmp_path: Path) -> None:
    yaml = "joints: {c: {type: helical, pitch: -1}}\nconfigurations: {ready: {c: 1}}\n"
    (found,) = eurdf.check(written(tmp_path, STAR.replace('lower="-2"', 'lower="0"'), yaml)).diagnostics
    assert found.message.endswith("outside its limits -12.5663706144 to 0")


def test_caller_root_overrides_description() -> None:
    fixed, floating = "configurations: {ready: {a: 1}}\n", "root: floating\nconfigurations: {ready: {a: 1}}\n"
    assert load(STAR, fixed).model.nv + 6 == load(STAR, floating).model.nv
    assert load(STAR, fixed, root="floating").model == load(STAR, floating).model
    assert load(STAR, floating, root="fixed").model == load(STAR, fixed).model
    q = load(STAR, floating).configurations["ready"]
    np.testing.assert_array_equal(q[:7], [0, 0, 0, 0, 0, 0, 1])
    assert load(STAR, floating).model.names[1] == "root_joint"


def test_mimic_joint_has_same_pose_when_free() -> None:
    places = []
    for mimic in (True, False):
        robot = eurdf.load(WORKBENCH, geometry=False, mimic=mimic)
        pin.framesForwardKinematics(robot.model, robot.data, robot.configurations["ready"])
        places.append(robot.data.oMf[robot.model.getFrameId("thumb")].homogeneous)
    np.testing.assert_allclose(places[1], places[0], rtol=0.0, atol=1e-12)


def some_configuration(robot: Robot, data: st.DataObject) -> np.ndarray:
    """Any configuration, angles beyond a turn and quaternions of both signs among them."""
    velocity = st.lists(st.floats(-10.0, 10.0), min_size=robot.model.nv, max_size=robot.model.nv)
    return np.array(pin.integrate(robot.model, pin.neutral(robot.model), np.array(data.draw(velocity))))


@settings(max_examples=50, deadline=None)
@given(data=st.data(), seed=st.integers(0, 1000), root=st.sampled_from(["fixed", "floating"]))
def test_coordinates_invert_configurations(data: st.DataObject, seed: int, root: Root) -> None:
    mechanism = replace(by_hand.tree_of_all_types(np.random.default_rng(seed)), root=root)
    robot = build_robot(mechanism, geometry=False)
    q = some_configuration(robot, data)
    coordinates = robot.joint_positions(q)
    assert ("root_joint" in coordinates) == (root == "floating")
    for joint in mechanism.joints:
        assert len(coordinates.get(joint.name, ())) == len(joint.type.coordinates)
    np.testing.assert_allclose(configuration_vector(mechanism, robot.model, coordinates), q, rtol=0.0, atol=1e-12)


@pytest.mark.parametrize("mimic", [True, False])
@pytest.mark.parametrize("root", ["fixed", "floating"])
@settings(max_examples=20, deadline=None)
@given(data=st.data())
def test_coordinates_name_mimic_joints_only_if_free(data: st.DataObject, root: Root, mimic: bool) -> None:
    robot = eurdf.load(WORKBENCH, root=root, geometry=False, mimic=mimic)
    q = some_configuration(robot, data)
    coordinates = robot.joint_positions(q)
    assert ("follow" in coordinates) != mimic
    back = configuration_vector(robot.mechanism, robot.model, coordinates)
    np.testing.assert_allclose(back, q, rtol=0.0, atol=1e-12)


@pytest.mark.parametrize("shape", [(0,), (3,), (1, 12)])
def test_wrong_shape_is_refused(shape: tuple[int, ...]) -> None:
    robot = eurdf.load(WORKBENCH, geometry=False)
    with pytest.raises(ValueError, match="q has the shape"):
        robot.joint_positions(np.zeros(shape))


def test_message_shows_digits_that_are_beyond_the_bound(tmp_path: Path) -> None:
    text = "joints: {d: spherical}\nconfigurations: {ready: {a: 2.000000002, d: [0, 0.6, 0, 0.8000014]}}\n"
    limit, length = eurdf.check(written(tmp_path, STAR, text)).diagnostics
    assert "2.000000002 of joint 'a'" in limit.message
    assert "has length 1.00000112, not 1" in length.message
