"""Advice: what is within the rules and yet is mostly a mistake. Each piece has what it warns of and near misses."""

from __future__ import annotations

import re
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest
import yaml

import eurdf
from eurdf.collection import collection_names
from eurdf.diagnostics import Diagnostic

ROBOTS = Path(__file__).parent.parent / "robots"

Description = dict[str, object]


@pytest.fixture
def advice(tmp_path: Path) -> Callable[..., list[Diagnostic]]:
    """What `eurdf.check` finds in a robot of the collection after an edit of its files."""

    def found(
        name: str,
        edit: Callable[[dict], object] = lambda description: None,
        urdf: Callable[[str], str] = lambda text: text,
    ) -> list[Diagnostic]:
        folder = tmp_path / name
        shutil.copytree(ROBOTS / name, folder, ignore=shutil.ignore_patterns("*.png", "*.py", "__pycache__"))
        described, tree = folder / "robot.yaml", folder / "robot.urdf"
        description = yaml.safe_load(described.read_text(encoding="utf-8"))
        edit(description)
        described.write_text(yaml.safe_dump(description, sort_keys=False), encoding="utf-8")
        tree.write_text(urdf(tree.read_text(encoding="utf-8")), encoding="utf-8")
        return list(eurdf.check(folder).diagnostics)

    return found


def actuated(entry: str | dict) -> str:
    return entry if isinstance(entry, str) else entry["joint"]


def without(*joints: str) -> Callable[[dict], object]:
    """Takes actuators out."""

    def edit(description: dict) -> None:
        description["actuators"] = [each for each in description["actuators"] if actuated(each) not in joints]

    return edit


def typed(kind: str, *closures: str) -> Callable[[dict], object]:
    """Gives closures another type."""

    def edit(description: dict) -> None:
        for each in description["closures"]:
            if each["name"] in closures:
                each["type"] = kind

    return edit


def codes(found: list[Diagnostic]) -> list[str]:
    return [each.code for each in found]


@pytest.mark.parametrize("name", collection_names())
def test_the_collection_needs_no_advice(name: str) -> None:
    assert [str(found) for found in eurdf.check(name).diagnostics] == []


def test_a_robot_with_closures_and_no_actuator_is_reported_at_the_closures(advice) -> None:
    (found,) = advice("four_bar", without("motor_crank"))
    assert (found.code, found.severity, found.clause, found.pointer) == ("x-no-actuator", "warning", None, "/closures")
    assert "1 closure and no actuator" in found.message
    assert "'actuators'" in (found.hint or "")


def test_no_actuator_is_missed_where_the_key_that_lists_them_is_misspelt(tmp_path: Path) -> None:
    shutil.copy(ROBOTS / "four_bar" / "robot.urdf", tmp_path)
    text = (ROBOTS / "four_bar" / "robot.v1.yaml").read_text(encoding="utf-8")
    for key, expected in (("name_motor", ["near-miss-key"]), ("motors", ["x-no-actuator"])):
        (tmp_path / "robot.yaml").write_text(text.replace("name_mot", key), encoding="utf-8")
        report = eurdf.check(tmp_path)
        assert codes(list(report.diagnostics)) == expected
    assert "'name_mot'" in (report.diagnostics[0].hint or "")
    assert report.diagnostics[0].pointer == "/closed_loop"


def test_a_robot_without_closures_needs_no_actuator(tmp_path: Path) -> None:
    shutil.copy(ROBOTS / "four_bar" / "robot.urdf", tmp_path)
    (tmp_path / "robot.yaml").write_text('extended_urdf: "2.0"\n', encoding="utf-8")
    assert eurdf.check(tmp_path).diagnostics == ()


@pytest.mark.parametrize(
    ("name", "closure", "actuators"),
    [
        ("digit_leg_3d", "achilles", ["motor_knee"]),
        ("four_bar", "rocker_pin", ["motor_crank"]),
        ("slider_crank", "slider_pin", ["motor_crank"]),
        ("spherical_four_bar", "rocker_pin", ["motor_crank"]),
        ("talos_2legs", "left_rod", ["left_motor_shin"]),
        ("unitree_g1_ankle", "rod_b", ["motor_a", "motor_b"]),
        ("kangaroo_leg", "hip_rod", ["motor_leg_length"]),
        ("five_bar_3d", "tip", ["motor_1", "motor_2"]),
        ("planar_3rrr", "pin_3", ["motor_1", "motor_2", "motor_3"]),
        ("delta", "rod_2a", ["motor_1", "motor_2", "motor_3"]),
    ],
)
def test_a_6d_closure_that_locks_actuators_is_named_and_3d_proposed(advice, name, closure, actuators) -> None:
    (found,) = advice(name, typed("6d", closure))
    text = (ROBOTS / name / "robot.yaml").read_text(encoding="utf-8")
    index = [each["name"] for each in yaml.safe_load(text)["closures"]].index(closure)
    assert (found.code, found.pointer) == ("x-dependent-actuators", f"/closures/{index}")
    assert all(f"'{actuator}'" in found.message for actuator in actuators)
    assert f"type 3d for closure '{closure}'" in (found.hint or "")


def test_two_closures_that_only_together_lock_are_named_together(advice) -> None:
    (found,) = advice("unitree_g1_ankle", typed("6d", "rod_a", "rod_b"))
    assert "type 3d for closures 'rod_a', 'rod_b'" in (found.hint or "")


def test_more_actuators_than_motions_are_named_where_no_closure_is_to_blame(advice) -> None:
    (found,) = advice("four_bar", lambda description: description["actuators"].append("free_rocker"))
    assert (found.code, found.pointer) == ("x-dependent-actuators", "/actuators/1")
    assert "'motor_crank'" in found.message
    assert "'free_rocker'" in found.message
    assert "only actuators that can move independently" in (found.hint or "")


ACTUATORS = [
    (name, actuated(each))
    for name in collection_names()
    for each in yaml.safe_load((ROBOTS / name / "robot.yaml").read_text(encoding="utf-8"))["actuators"]
]


@pytest.mark.parametrize(("name", "joint"), [(name, joint) for name, joint in ACTUATORS if "2legs" not in name])
def test_an_actuator_that_is_forgotten_leaves_a_motion_that_is_reported(advice, name: str, joint: str) -> None:
    (found,) = advice(name, without(joint))
    alone = sum(other == name for other, _ in ACTUATORS) == 1
    assert found.code == ("x-no-actuator" if alone else "x-uncontrolled-motion")
    assert found.pointer == ("/closures" if alone else "/actuators")


def test_a_closure_that_leaves_the_orientation_free_leaves_a_motion_that_is_reported(advice) -> None:
    (found,) = advice("talos_leg", typed("3d", "rod"))
    assert found.code == "x-uncontrolled-motion"
    assert "use type 6d" in (found.hint or "")


def test_no_motion_is_reported_where_a_closure_was_left_out(advice) -> None:
    assert codes(advice("delta", typed("x-magnet", "rod_2a"))) == ["closure-type-unknown"]


WHEEL = """
  <link name="wheel">
    <inertial>
      <origin xyz="{lever} 0.02 0"/>
      <mass value="0.2"/>
      <inertia ixx="0.0001" ixy="0" ixz="0" iyy="0.0002" iyz="0" izz="0.0001"/>
    </inertial>
  </link>
  <joint name="axle" type="continuous">
    <parent link="{parent}"/>
    <child link="wheel"/>
    <axis xyz="0 1 0"/>
  </joint>
</robot>"""


@pytest.mark.parametrize(("lever", "expected"), [("0", []), ("0.05", ["x-uncontrolled-motion"])])
def test_a_wheel_needs_no_actuator_and_a_pendulum_does(advice, lever: str, expected: list[str]) -> None:
    def urdf(text: str) -> str:
        parent = text.split('<link name="')[1].split('"')[0]
        return text.replace("</robot>", WHEEL.format(lever=lever, parent=parent))

    assert codes(advice("four_bar", urdf=urdf)) == expected


def rocker(lower: float, upper: float) -> Callable[[str], str]:
    """Gives the rocker of the four-bar linkage other limits; it swings from -0.798 to 0.031 rad."""
    return lambda text: text.replace('lower="-0.9372" upper="0.11"', f'lower="{lower}" upper="{upper}"')


def without_configurations(description: dict) -> None:
    del description["configurations"]


@pytest.mark.parametrize("edit", [lambda description: None, without_configurations])
@pytest.mark.parametrize(
    ("lower", "upper", "expected"),
    [
        (0.3, 0.6, ["x-closes-beyond-limits"]),
        (-1.2, -0.9, ["x-closes-beyond-limits"]),
        (-0.9, -0.3, []),  # at the start it is beyond, but it closes within
        (0.02, 0.6, []),
        (0, 0, ["urdf-no-range"]),
    ],
)
def test_loops_that_close_only_beyond_limits_are_reported(advice, edit, lower, upper, expected: list[str]) -> None:
    found = advice("four_bar", edit, rocker(lower, upper))
    assert codes(found) == expected
    if expected == ["x-closes-beyond-limits"]:
        assert (found[0].severity, found[0].clause, found[0].pointer) == ("warning", None, "/closures/0")
        assert "at the best, 'rocker_pin' by " in found[0].message
        side, limit = ("below", lower) if lower > 0.0 else ("above", upper)
        said = rf"they close with 'free_rocker' (\S+) rad {side} its \w+ limit {limit}: correct"
        match = re.search(said, found[0].hint or "")
        assert match is not None
        farthest = 0.031 if lower > 0.0 else -0.798  # where the rocker comes nearest to its limits
        assert float(match[1]) >= abs(limit - farthest) - 1e-3


def test_a_joint_outside_the_loops_may_be_beyond_its_limits(advice) -> None:
    def urdf(text: str) -> str:
        lid = WHEEL.format(lever="0", parent=text.split('<link name="')[1].split('"')[0])
        lid = lid.replace("continuous", "revolute").replace(
            '<axis xyz="0 1 0"/>', '<axis xyz="0 1 0"/><limit lower="1" upper="2" effort="1" velocity="1"/>'
        )
        return text.replace("</robot>", lid)

    def driven(description: dict) -> None:
        description["actuators"].append("axle")

    assert codes(advice("four_bar", driven, urdf)) == []
