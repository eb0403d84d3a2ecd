"""Single mistakes of actuation in robots of the collection: the cause is named, and its fix gives the robot back."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import pytest
import yaml
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import eurdf
from eurdf.advice.likely_closures import forgotten_closures
from eurdf.advice.trial import Evidence
from eurdf.collection import collection_names
from eurdf.linking.robot_files import read_valid
from eurdf.mechanism.mechanism import Mechanism
from support.places import ROBOTS

#: Small robots on a fixed root, without other configurations, which would have to change with the joints.
NAMES = (
    *("four_bar", "slider_crank", "five_bar", "planar_3rrr", "digit_leg", "digit_leg_3d", "unitree_g1_ankle", "delta"),
    *("stewart_platform", "talos_leg", "disney_leg", "tesla_optimus_ankle"),
)
DESCRIPTIONS = {name: yaml.safe_load((ROBOTS / name / "robot.yaml").read_text(encoding="utf-8")) for name in NAMES}
URDFS = {name: (ROBOTS / name / "robot.urdf").read_text(encoding="utf-8") for name in NAMES}
MECHANISMS = {name: read_valid(ROBOTS / name, geometry=False).mechanism for name in NAMES}

Draw = Callable[[st.SearchStrategy[Any]], Any]


def element(urdf: str, joint: str) -> str:
    found = re.search(rf'<joint name="{joint}".*?</joint>', urdf, re.DOTALL)
    assert found is not None
    return found[0]


def in_loops(name: str) -> list[str]:
    """The joints of one axis that loops depend on, in a robot whose description says nothing of them."""
    stated = DESCRIPTIONS[name].get("joints", {})
    loops = {joint for loop in eurdf.analyze(name).loops for joint in loop.joints}
    joints = (joint for joint in MECHANISMS[name].joints if joint.type in ("revolute", "continuous"))
    return [joint.name for joint in joints if joint.name in loops and joint.name not in stated]


def mistaken(draw: Draw, name: str, kind: str) -> tuple[dict, str, str]:
    """The description and the URDF of a robot with one mistake, and the name that the tool should say."""
    description, urdf = yaml.safe_load(yaml.safe_dump(DESCRIPTIONS[name])), URDFS[name]
    closures, actuators = description["closures"], description["actuators"]
    if kind == "no motor":
        return description, urdf, actuators.pop(draw(st.integers(0, len(actuators) - 1)))
    if kind == "no closure":
        assume(len(closures) > 1)
        closure = closures.pop(draw(st.integers(0, len(closures) - 1)))
        return description, urdf, closure["frames"][0]
    if kind == "other type":
        closure = draw(st.sampled_from(closures))
        closure["type"] = {"3d": "6d", "6d": "3d"}[closure["type"]]
        return description, urdf, closure["name"]
    if kind == "no ball":
        balls = [joint for joint, type_ in description.get("joints", {}).items() if type_ == "spherical"]
        assume(balls)
        ball = draw(st.sampled_from(balls))
        del description["joints"][ball]
        return description, urdf, ball
    joints = [joint for joint in in_loops(name) if kind == "odd axis" or joint not in actuators]
    assume(joints)
    if kind == "passive joint":
        passive = draw(st.sampled_from(joints))
        actuators.append(passive)
        return description, urdf, passive
    joint = draw(st.sampled_from(joints))
    was = element(urdf, joint)
    if kind == "locked":
        return description, urdf.replace(was, re.sub(r'type="\w+"', 'type="fixed"', was, count=1)), joint
    axis = next(each.axes[0] for each in MECHANISMS[name].joints if each.name == joint)
    off = np.roll(axis, 1) * draw(st.sampled_from([0.045, 1e3]))
    new = re.sub(r'axis xyz="[^"]*"', 'axis xyz="{} {} {}"'.format(*(axis + off)), was)
    return description, urdf.replace(was, new), joint


def differences(one: Mechanism, other: Mechanism) -> list[str]:
    """What distinguishes two mechanisms of the same bodies: actuators, closures, types, axes."""
    found = sorted(set(one.actuators) ^ set(other.actuators))
    closures = [{(each.type, frozenset(map(str, each.anchors))) for each in robot.closures} for robot in (one, other)]
    found += map(str, closures[0] ^ closures[1])
    for a, b in zip(one.joints, other.joints, strict=True):
        pairs = zip(a.axes, b.axes, strict=True) if a.type is b.type else ()
        turned = any(np.abs(np.cross(*axes)).max() > 1e-6 for axes in pairs)
        # Whether a pin has limits, and is revolute, is another question.
        if turned or a.type.coordinates != b.type.coordinates:
            found.append(a.name)
    return found


KINDS = ("no motor", "no closure", "other type", "no ball", "passive joint", "locked", "odd axis")


@pytest.mark.parametrize("kind", KINDS)
@settings(deadline=None, max_examples=12)
@given(name=st.sampled_from(NAMES), data=st.data())
def test_fix_gives_the_robot_back_and_names_the_cause(name: str, kind: str, data: st.DataObject) -> None:
    description, urdf, cause = mistaken(data.draw, name, kind)
    with TemporaryDirectory() as folder:
        files = Path(folder, "robot.yaml"), Path(folder, "robot.urdf")
        files[0].write_text(yaml.safe_dump(description, sort_keys=False), encoding="utf-8")
        files[1].write_text(urdf, encoding="utf-8")
        found = eurdf.check(folder).diagnostics
        fixes = [each.fix for each in found if each.fix is not None]
        said = " ".join(f"{each.message} {each.hint}" for each in found)
        # With some of these mistakes, robots move as they did.
        assert cause in said or (kind in ("other type", "odd axis", "passive joint", "locked") and not fixes)
        for fix in fixes[:1]:
            for path, text in fix.texts().items():
                Path(path).write_text(text, encoding="utf-8")
            left = eurdf.check(folder).diagnostics
            assert left or not differences(read_valid(folder).mechanism, MECHANISMS[name]), fix.summary


def checked(folder: Path, name: str, **changes: Any) -> list[tuple[str, str | None]]:
    """The code of each diagnostic of a robot of the collection with other keys, and the fix."""
    (folder / "robot.urdf").write_text(URDFS[name], encoding="utf-8")
    text = yaml.safe_dump({**DESCRIPTIONS[name], **changes}, sort_keys=False)
    (folder / "robot.yaml").write_text(text, encoding="utf-8")
    return [(each.code, each.fix and each.fix.summary) for each in eurdf.check(folder).diagnostics]


def test_passive_joint_in_the_place_of_a_motor_is_reported(tmp_path: Path) -> None:
    assert checked(tmp_path, "four_bar", actuators=["free_rocker"]) == [
        ("x-motor-not-actuated", "actuate 'motor_crank' in the place of 'free_rocker'")
    ]


def test_motor_of_several_velocities_is_reported(tmp_path: Path) -> None:
    joints = {**DESCRIPTIONS["digit_leg"]["joints"], "motor_knee": "spherical"}
    found = dict(checked(tmp_path, "digit_leg", joints=joints))
    assert (found["x-actuator-several"] or "").startswith("remove 'motor_knee' from 'joints'")


def test_spin_of_a_rod_is_not_counted_with_other_motions(tmp_path: Path) -> None:
    checked(tmp_path, "digit_leg", actuators=DESCRIPTIONS["digit_leg"]["actuators"][:-1])
    (found,) = eurdf.check(tmp_path).diagnostics
    assert found.message.startswith("1 motion remains")


def test_forgotten_closures_are_reported_by_the_convention_of_their_frames(tmp_path: Path) -> None:
    urdf = URDFS["four_bar"].replace("rocker_pin_a", "closing_pin_1").replace("rocker_pin_b", "closing_pin_2")
    (tmp_path / "robot.urdf").write_text(urdf, encoding="utf-8")
    (tmp_path / "robot.yaml").write_text('extended_urdf: "2.0"\nactuators: [motor_crank]\n', encoding="utf-8")
    (found,) = eurdf.check(tmp_path).diagnostics
    assert found.code == "x-no-closure"
    assert found.fix is not None
    assert found.fix.summary.startswith("add a closure of type 3d between 'closing_pin_1' and 'closing_pin_2'")


@pytest.mark.parametrize(
    ("frames", "expected"),
    [
        (["rod1_a", "rod1_b"], "name the frames 'rod2_a', 'rod2_b'"),
        (["rod2_a", "rod2_a"], "connect 'rod2_a' to 'rod2_b'"),
    ],
)
def test_wrong_frames_of_a_closure_get_a_fix(tmp_path: Path, frames: list[str], expected: str) -> None:
    closures = [*DESCRIPTIONS["digit_leg"]["closures"][:2], {"name": "rod2", "type": "6d", "frames": frames}]
    ((_, fix),) = checked(tmp_path, "digit_leg", closures=closures)
    assert (fix or "").startswith(expected)


def test_fix_that_makes_loops_rigid_is_refused(tmp_path: Path) -> None:
    """A rigid loop has no uncontrolled motion: to lock one is not to control it."""
    closures = [{**DESCRIPTIONS["four_bar"]["closures"][0], "type": "6d"}]
    moving = Evidence(Counter({"x-no-actuator": 1}), True, eurdf.analyze("four_bar"))
    checked(tmp_path, "four_bar", closures=closures, actuators=[])
    assert not Evidence(Counter(), True, eurdf.analyze(tmp_path)).is_as_good_as(moving, "x-no-actuator")
    assert Evidence(Counter(), True, moving.analysis).is_as_good_as(moving, "x-no-actuator")


@pytest.mark.parametrize("name", collection_names())
def test_no_closure_of_the_collection_is_missing(name: str) -> None:
    likely = [fix.question for fix in forgotten_closures(read_valid(name, geometry=False)) if fix.question]
    assert likely == []


@pytest.mark.parametrize(("place", "codes"), [("[0, 0, 0]", []), ("[0, 0, 0.1]", ["assembled-open"])])
def test_floating_body_may_be_welded(tmp_path: Path, place: str, codes: list[str]) -> None:
    box = '<link name="box"><inertial><mass value="0.1"/><inertia ixx="1e-4" ixy="0" ixz="0" iyy="1e-4" iyz="0" '
    box += 'izz="1e-4"/></inertial></link><joint name="box_joint" type="floating"><parent link="ground"/>'
    box += '<child link="box"/></joint></robot>'
    text = yaml.safe_dump(DESCRIPTIONS["four_bar"], sort_keys=False)
    text = text.replace(
        "closures:\n", f"closures:\n- {{name: held, type: 6d, frames: [box, {{link: ground, xyz: {place}}}]}}\n"
    )
    (tmp_path / "robot.urdf").write_text(URDFS["four_bar"].replace("</robot>", box), encoding="utf-8")
    (tmp_path / "robot.yaml").write_text(text, encoding="utf-8")
    assert [each.code for each in eurdf.check(tmp_path).diagnostics] == codes
