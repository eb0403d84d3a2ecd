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
from support.by_hand import rotation
from support.described import at, codes, link_poses, load, written
from support.star import STAR

HALF = math.sqrt(0.5)

WORKBENCH = Path(__file__).parents[1] / "data" / "workbench.yaml"
HALF_LIMITED = "{d: {type: universal, axes: xy, limits: {lower: [0, 0], upper: [0, 1]}}}"

JOINTS = "joints: {d: spherical}\n"

#: joints, what a configuration says of a joint, that joint, its part of q
WRITTEN = [
    ("{}", "a: 0.5", "a", [0.5]),
    ("{}", "a: [0.5]", "a", [0.5]),
    ("{}", "b: 0.5", "b", [math.cos(0.5), math.sin(0.5)]),
    ("{}", "b: 7", "b", [math.cos(7), math.sin(7)]),
    ("{}", "c: -1.5", "c", [-1.5]),
    ("{}", "e: [1, 2, 0.5]", "e", [1, 2, math.cos(0.5), math.sin(0.5)]),
    ("{}", "f: [1, 2, 3, 0.5, -0.5, 0.5, 0.5]", "f", [1, 2, 3, 0.5, -0.5, 0.5, 0.5]),
    ("{d: spherical}", "d: [0.6, 0, 0, 0.8]", "d", [0.6, 0, 0, 0.8]),
    ("{d: spherical}", "d: [0.6, 0, 0, -0.8]", "d", [0.6, 0, 0, -0.8]),
    ("{d: {type: universal, axes: xy}}", "d: [0.1, 0.2]", "d", [0.1, 0.2]),
    ("{d: cylindrical}", "d: [7, 0.2]", "d", [7, 0.2]),
    ("{d: {type: helical, pitch: 1}}", "d: 0.2", "d", [0.2]),
    ("{b: {type: helical, pitch: 1}}", "b: 20", "b", [20]),
]


@pytest.mark.parametrize(("joints", "says", "name", "numbers"), WRITTEN)
@pytest.mark.parametrize("root", ["fixed", "floating"])
def test_configuration_fills_its_joints_others_are_neutral(
    joints: str, says: str, name: str, numbers: list[float], root: str
) -> None:
    loaded = load(STAR, f"joints: {joints}\nconfigurations: {{ready: {{{says}}}}}\n", root=root)
    idx_q, nq, _, _ = at(loaded.model, name)
    q = loaded.configurations["ready"]
    np.testing.assert_allclose(q[idx_q : idx_q + nq], numbers, atol=1e-12)
    others = np.delete(q, range(idx_q, idx_q + nq))
    np.testing.assert_array_equal(others, np.delete(pin.neutral(loaded.model), range(idx_q, idx_q + nq)))


def test_empty_configuration_is_neutral() -> None:
    loaded = load(STAR, "configurations: {zero: {}}\n")
    np.testing.assert_array_equal(loaded.configurations["zero"], pin.neutral(loaded.model))


def test_configurations_are_in_file_order() -> None:
    loaded = load(STAR, "configurations: {z: {}, a: {a: 1}, m: {}}\n")
    assert list(loaded.configurations) == ["z", "a", "m"]


def test_first_universal_angle_is_about_first_axis() -> None:
    loaded = load(STAR, "joints: {d: {type: universal, axes: xy}}\nconfigurations: {ready: {d: [0.5, 1.5]}}\n")
    turned = link_poses(loaded.model, loaded.configurations["ready"])["ld"][:3, :3]
    np.testing.assert_allclose(turned, rotation((1, 0, 0), 0.5) @ rotation((0, 1, 0), 1.5), atol=1e-12)


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


@pytest.mark.parametrize(
    ("joints", "says", "error"),
    [
        ("{}", "a: 2.000000002", "configuration-limits"),
        ("{}", "a: -2.000000002", "configuration-limits"),
        ("{}", "a: 2.0000000005", ""),
        ("{}", "b: 100.3", ""),
        ("{a: {limits: {upper: 1}}}", "a: 1.5", "configuration-limits"),
        ("{a: {limits: {upper: 3}}}", "a: 2.5", ""),
        ("{d: {type: universal, axes: xy}}", "d: [0, 2.1]", "configuration-limits"),
        ("{a: {limits: {lower: 0, upper: 0}}}", "a: 1.5", ""),
        ("{a: {limits: {lower: 0, upper: 0.1}}}", "a: -0.1", "configuration-limits"),
        ("{a: {limits: {lower: 0.1, upper: 0.1}}}", "a: 0.2", "configuration-limits"),
        ("{d: {type: universal, axes: xy, limits: {lower: [0, 0], upper: [0, 1]}}}", "d: [2, 0.5]", ""),
        (
            "{d: {type: universal, axes: xy, limits: {lower: [0, 0], upper: [0, 1]}}}",
            "d: [2, 1.5]",
            "configuration-limits",
        ),
        ("{d: cylindrical}", "d: [2.1, 0]", ""),
        ("{d: cylindrical}", "d: [0, 2.1]", "configuration-limits"),
        ("{c: cylindrical}", "c: [0, 2.1]", ""),
        ("{c: cylindrical}", "c: [2.1, 0]", "configuration-limits"),
        # 2 m of travel at 1 m a revolution are two turns.
        ("{c: {type: helical, pitch: 1}}", f"c: {2.01 * math.tau}", "configuration-limits"),
        ("{c: {type: helical, pitch: 1}}", f"c: {1.99 * math.tau}", ""),
        ("{}", "e: [100, 100, 100.3]", ""),
        ("{a: {limits: {lower: 0.000000002}}}", "b: 0.5", "configuration-limits"),
        ("{a: {limits: {lower: 0.0000000005}}}", "b: 0.5", ""),
        ("{a: {limits: {lower: 0.1}}, c: {limits: {upper: -0.1}}}", "b: 0.5", "configuration-limits"),
        ("{a: {limits: {lower: 0.1}}, c: {limits: {upper: -0.1}}}", "a: 0.1, c: -0.1", ""),
        ("{a: {limits: {lower: 0.1}}}", "aa: 0.5", "configuration-joint"),
        ("{d: {type: universal, axes: xy, limits: {lower: [0, 0.1]}}}", "b: 0.5", "configuration-limits"),
        ("{}", "a: []", "wrong-length"),
        ("{}", "e: [1, 2]", "configuration-length"),
        ("{}", "f: [0, 0, 0, 0, 0, 0, 2]", "configuration-quaternion"),
        ("{d: spherical}", "d: 0.5", "configuration-length"),
        ("{d: spherical}", f"d: [0, 0, {HALF}]", "configuration-length"),
        ("{}", "g: 0", "configuration-joint"),
        ("{a: fixed}", "a: 0", "configuration-joint"),
        ("{}", "la: 0", "configuration-joint"),
    ],
)
def test_coordinate_respects_limits_of_the_description(joints: str, says: str, error: str) -> None:
    assert codes(STAR, f"joints: {joints}\nconfigurations: {{ready: {{{says}}}}}\n") == ([error] if error else [])


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
    coordinates = robot.coordinates(q)
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
    coordinates = robot.coordinates(q)
    assert ("follow" in coordinates) != mimic
    back = configuration_vector(robot.mechanism, robot.model, coordinates)
    np.testing.assert_allclose(back, q, rtol=0.0, atol=1e-12)


def test_coordinates_of_named_configuration_match_file() -> None:
    robot = eurdf.load(WORKBENCH, geometry=False)
    coordinates = robot.coordinates(robot.configurations["ready"])
    stated = {name: values for name, values in coordinates.items() if name in ("motor", "grip", "hand_ball", "elbow")}
    assert stated == {"motor": (0.5,), "elbow": (0.0,), "hand_ball": (0.0, 0.0, 0.0, 1.0), "grip": (0.1,)}


@pytest.mark.parametrize("shape", [(0,), (3,), (1, 12)])
def test_wrong_shape_is_refused(shape: tuple[int, ...]) -> None:
    robot = eurdf.load(WORKBENCH, geometry=False)
    with pytest.raises(ValueError, match="q has the shape"):
        robot.coordinates(np.zeros(shape))


def test_message_shows_digits_that_are_beyond_the_bound(tmp_path: Path) -> None:
    text = "joints: {d: spherical}\nconfigurations: {ready: {a: 2.000000002, d: [0, 0.6, 0, 0.8000014]}}\n"
    limit, length = eurdf.check(written(tmp_path, STAR, text)).diagnostics
    assert "2.000000002 of joint 'a'" in limit.message
    assert "has length 1.00000112, not 1" in length.message
