"""The actuated joints: their indices in the model, and what their motors add."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import eurdf
from eurdf.commands.main import main
from support.described import STAR, at, body, load, revolute, written
from support.plain_urdf import link_element, robot

BALL = "joints: {d: spherical}\n"


@pytest.mark.parametrize("root", ["fixed", "floating"])
@pytest.mark.parametrize("names", [["a"], ["c", "a"], ["d", "b", "a"], ["f", "e", "d", "c", "b", "a"]])
def test_actuated_joints_are_in_file_order_with_all_coordinates(names: list[str], root: str) -> None:
    loaded = load(STAR, f"{BALL}actuators: [{', '.join(names)}]\n", root=root)
    model, actuation = loaded.model, loaded.actuation
    assert actuation.joints == tuple(names)
    idx_q = [index for name in names for index in range(at(model, name)[0], sum(at(model, name)[:2]))]
    idx_v = [index for name in names for index in range(at(model, name)[2], sum(at(model, name)[2:]))]
    assert actuation.idx_q.tolist() == idx_q
    assert actuation.idx_v.tolist() == idx_v
    expected = np.zeros((model.nv, len(idx_v)))
    for column, row in enumerate(idx_v):
        expected[row, column] = 1.0
    np.testing.assert_array_equal(actuation.selection, expected)


@pytest.mark.parametrize(
    ("joints", "actuator", "gear_ratio", "rotor_inertia", "armature"),
    [
        ("{}", "a", [1], [0], [0]),
        ("{}", "{joint: a}", [1], [0], [0]),
        ("{}", "{joint: a, gear_ratio: 50, rotor_inertia: 2.0e-4}", [50], [2e-4], [0.5]),
        ("{}", "{joint: a, gear_ratio: -50, rotor_inertia: 2.0e-4}", [-50], [2e-4], [0.5]),
        ("{}", "{joint: a, gear_ratio: 50}", [50], [0], [0]),
        ("{}", "{joint: a, rotor_inertia: 2.0e-4}", [1], [2e-4], [2e-4]),
        ("{a: {armature: 0.7}}", "{joint: a, gear_ratio: 50, rotor_inertia: 2.0e-4}", [50], [2e-4], [0.7]),
        ("{a: {armature: 0}}", "{joint: a, gear_ratio: 50, rotor_inertia: 2.0e-4}", [50], [2e-4], [0]),
        ("{a: {armature: 0.7}}", "a", [1], [0], [0.7]),
        ("{a: spherical}", "{joint: a, gear_ratio: 10, rotor_inertia: 0.01}", [10] * 3, [0.01] * 3, [1] * 3),
        (
            "{a: {type: universal, axes: xy, armature: [1, 2]}}",
            "{joint: a, gear_ratio: 10, rotor_inertia: 0.01}",
            [10] * 2,
            [0.01] * 2,
            [1, 2],
        ),
    ],
)
@pytest.mark.parametrize("root", ["fixed", "floating"])
def test_armature_is_stated_or_reflected_rotor_inertia(
    joints: str, actuator: str, gear_ratio: list[float], rotor_inertia: list[float], armature: list[float], root: str
) -> None:
    model = load(STAR, f"joints: {joints}\nactuators: [{actuator}, c]\n", root=root).model
    _, _, idx_v, nv = at(model, "a")
    own = slice(idx_v, idx_v + nv)
    assert model.rotorGearRatio[own].tolist() == pytest.approx(gear_ratio, rel=1e-12)
    assert model.rotorInertia[own].tolist() == pytest.approx(rotor_inertia, rel=1e-12)
    assert model.armature[own].tolist() == pytest.approx(armature, rel=1e-12)
    others = np.delete(model.armature, range(idx_v, idx_v + nv))
    assert not others.any()


def test_merged_spherical_joint_can_be_actuated() -> None:
    axes = {"x": ("base", "one", (1, 0, 0)), "y": ("one", "two", (0, 1, 0)), "z": ("two", "hand", (0, 0, 1))}
    links = [link_element("base"), link_element("one"), link_element("two"), body("hand")]
    urdf = robot(*links, *(revolute(name, *of) for name, of in axes.items()))
    merged = "joints: {ball: {type: spherical, merges: [x, y, z]}}\n"
    model = load(urdf, merged + "actuators: [{joint: ball, gear_ratio: 10, rotor_inertia: 0.01}]\n").model
    assert model.armature.tolist() == [1, 1, 1]


# -- names and control ranges ----------------------------------------------------------------------------------------

MOTORS = """\
extended_urdf: "2.1"
joints: {d: spherical}
actuators:
  - {joint: c, name: a, control: [-3, 4.5]}
  - {joint: a, name: c}
  - {joint: d, control: [0, 2]}
  - b
"""


def test_actuators_have_names_and_a_control_range_for_each_velocity() -> None:
    actuation = load(STAR, MOTORS).actuation
    assert (actuation.joints, actuation.names) == (("c", "a", "d", "b"), ("a", "c", "d", "b"))
    unlimited = [-np.inf, np.inf]
    assert actuation.control.tolist() == [[-3.0, 4.5], unlimited, [0.0, 2.0], [0.0, 2.0], [0.0, 2.0], unlimited]


def test_locked_actuator_loses_name_and_range() -> None:
    locked = eurdf.lock(load(STAR, MOTORS), ["c"])
    assert locked.actuation.names == ("c", "d", "b")
    assert "c" not in locked.mechanism.motors


def test_info_shows_names_ranges_and_springs(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = MOTORS.replace("{d: spherical}", "{d: spherical, b: {stiffness: 7.5, rest: 0.25}}")
    path = str(written(tmp_path, STAR, text))
    assert main(["info", path, "--json"]) == 0
    info = json.loads(capsys.readouterr().out)
    motors = {each["joint"]: (each["name"], each["control"]) for each in info["actuator_list"]}
    assert motors == {"c": ("a", [-3.0, 4.5]), "a": ("c", None), "d": ("d", [0.0, 2.0]), "b": ("b", None)}
    springs = {each["name"]: (each["stiffness"], each["rest"]) for each in info["joint_list"] if each["stiffness"]}
    assert springs == {"b": ([7.5], [0.25])}
    assert main(["info", path]) == 0
    shown = capsys.readouterr().out
    assert "spring 7.5, rest 0.25" in shown
    assert "actuated as a, -3 to 4.5" in shown
