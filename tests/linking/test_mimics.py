"""Mimic joints: ignored by version 1, respected by version 2 and by a bare URDF, free where a caller asks for it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest

import eurdf
from eurdf.commands.main import main
from eurdf.diagnostics import did_you_mean
from support.described import LIMITED, body, codes, load, revolute, written
from support.places import DATA, ROOT
from support.plain_urdf import inertial, joint_element, link_element, pinocchios_own, robot

URDFS = [DATA / "workbench.urdf", ROOT / "spec" / "examples" / "four_bar" / "robot.urdf"]

MIMIC = '<mimic joint="{}" multiplier="{}" offset="{}"/>'


def gripper(left: str = "drive", kind: str = "revolute", more: str = "") -> str:
    """Two fingers: `left` mimics another joint, and `tip`, on the left finger, is fixed."""
    law = MIMIC.format(left, -2, 0.1)
    return robot(
        link_element("base", inertial()),
        *(body(name) for name in ("right_finger", "left_finger", "nail")),
        revolute("drive", "base", "right_finger"),
        joint_element("left", kind, "base", "left_finger", LIMITED.format("1 0 0") + law),
        joint_element("tip", "fixed", "left_finger", "nail", more, '<origin xyz="0 0 0.1"/>'),
    )


MISTAKES = {
    "urdf-mimic-unknown": gripper("nobody"),
    "urdf-mimic-cycle": gripper("left"),
    "urdf-mimic-kind": gripper("tip"),
}


# -- version 1 --------------------------------------------------------------------------------------------------------


def test_version_1_advises_on_unmentioned_mimic_joint() -> None:
    assert codes(gripper(), "name_mot: [drive]\n") == ["x-mimic-ignored"]
    assert codes(gripper(), "name_mot: [drive]\njoint_name: [left]\njoint_type: [SPHERICAL]\n") == []
    assert codes(gripper(), "note: 1\n") == codes(gripper(), "actuators: [drive]\n") == codes(gripper()) == []


def test_migrate_keeps_mimic_of_fixed_joint(tmp_path: Path) -> None:
    text = gripper(more='<mimic joint="drive"/>').replace(MIMIC.format("drive", -2, 0.1), "")
    assert main(["migrate", str(written(tmp_path, text, "name_mot: [left]\n").parent)]) == 0


# -- version 2, and a bare URDF ---------------------------------------------------------------------------------------


def test_urdf_with_mimics_matches_pinocchio(tmp_path: Path) -> None:
    path = written(tmp_path, gripper(), "")
    followed, free = eurdf.load(path), eurdf.load(path, mimic=False)
    assert followed.model == pin.buildModelFromUrdf(str(path), mimic=True)
    assert free.model == pin.buildModelFromUrdf(str(path))
    assert (followed.model.nv, free.model.nv) == (1, 2)


@pytest.mark.parametrize("path", URDFS, ids=lambda path: path.parent.name)
def test_mimic_of_later_joint_is_built(path: Path) -> None:
    with pytest.raises(ValueError, match="The parent joint of the mimic joint is not in the kinematic tree"):
        pin.buildModelFromUrdf(str(path), mimic=True)
    followed, free = eurdf.load(path, geometry=False), eurdf.load(path, geometry=False, mimic=False)
    assert free.model == pin.buildModelFromUrdf(str(path))
    assert followed.model.nv == free.model.nv - 1


@pytest.mark.parametrize("title", MISTAKES)
def test_mimic_error_is_kept_where_mimics_are_ignored(title: str) -> None:
    text = MISTAKES[title]
    for yaml in ("", "actuators: [drive]\n"):
        with pytest.raises(eurdf.InvalidRobot):
            load(text, yaml)
        free = load(text, yaml, mimic=False)
        assert free.model == pinocchios_own(text, mimic=False)
        assert [found.code for found in free.diagnostics] == [title]
        with pytest.raises(eurdf.InvalidRobot):
            load(text, yaml, mimic=False, strict=True)


@pytest.mark.parametrize(
    "yaml",
    [
        "actuators: [left, drive]\n",
        "joints: {left: {armature: 0.1}, drive: spherical}\n",
        "joints: {left: fixed}\n",
        "configurations: {open: {left: 0.2}}\n",
    ],
)
def test_free_mimic_joint_is_a_normal_joint(yaml: str) -> None:
    with pytest.raises(eurdf.InvalidRobot):
        load(gripper(), yaml)
    found = load(gripper(), yaml, mimic=False)
    assert found.diagnostics == ()
    assert all(joint.mimic is None for joint in found.mechanism.joints)


def test_configurations_place_free_joints_as_mimics() -> None:
    yaml = "configurations: {half: {drive: 0.3}, stated: {drive: 0.3, left: 1}, neutral: {}}\n"
    found = load(gripper(), yaml, mimic=False)
    at = {name: found.model.joints[found.model.getJointId(name)].idx_q for name in ("drive", "left")}
    expected = {"half": (0.3, -0.5), "stated": (0.3, 1.0), "neutral": (0.0, 0.1)}
    for name, (drive, left) in expected.items():
        q = found.configurations[name]
        np.testing.assert_allclose((q[at["drive"]], q[at["left"]]), (drive, left), atol=1e-15)


# -- hints ------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("side", ["Left", "Right"])
def test_hint_prefers_name_of_same_side(side: str) -> None:
    known = ["Left_index_q1", "Right_index_q1", "Left_thumb_q1", "Right_thumb_q1"]
    assert did_you_mean("index_q1", known, f"{side}_index_q2") == f"did you mean '{side}_index_q1'?"


def test_much_closer_name_wins() -> None:
    assert did_you_mean("left_knee", ["left_kne", "right_hip_roll"], "right_hip_pitch") == "did you mean 'left_kne'?"


def test_mimic_hint_excludes_the_joint_itself() -> None:
    sides = ("left", "right_hand")
    text = robot(
        link_element("base", inertial()),
        *(body(f"{side}_{n}") for side in sides for n in "ab"),
        *(revolute(f"{side}_index_q1", "base", f"{side}_a") for side in sides),
        *(
            joint_element(
                f"{side}_index_q2",
                "revolute",
                f"{side}_a",
                f"{side}_b",
                LIMITED.format("1 0 0") + MIMIC.format("hand_index_q1", 1, 0),
            )
            for side in sides
        ),
    )
    hints = {found.message.split("'")[1]: found.hint for found in load(text, mimic=False).diagnostics}
    assert hints["right_hand_index_q2"] == "did you mean 'right_hand_index_q1'?"
    assert hints["left_index_q2"] != "did you mean 'left_index_q2'?"


# -- freed, in version 2.1 ------------------------------------------------------------

HEAD = 'extended_urdf: "2.1"\n'


def chain() -> str:
    """`third` mimics `second`, which mimics `first`."""
    law = '<mimic joint="{}" multiplier="{}" offset="0.1"/>'
    return robot(
        link_element("base", inertial()),
        *(body(name) for name in ("one", "two", "three")),
        revolute("first", "base", "one"),
        joint_element("second", "revolute", "one", "two", LIMITED.format("1 0 0") + law.format("first", 2)),
        joint_element("third", "revolute", "two", "three", LIMITED.format("0 1 0") + law.format("second", -3)),
    )


def test_freed_joints_make_the_model_without_mimics() -> None:
    yaml = f"{HEAD}joints: {{second: {{mimic: false}}, third: {{mimic: false}}}}\n"
    assert load(chain(), yaml).model == load(chain(), mimic=False).model


def test_freed_joint_left_out_of_a_configuration_is_neutral() -> None:
    more = "joints: {third: {mimic: false}}\nconfigurations: {bent: {first: 0.2}}\n"
    found = load(chain(), HEAD + more)
    assert found.joint_positions(found.configurations["bent"])["third"] == (0.0,)
    every = load(chain(), HEAD + more, mimic=False)
    at = every.joint_positions(every.configurations["bent"])
    assert (at["third"], at["second"]) == ((0.0,), (pytest.approx(0.5),))


def test_spring_of_mimic_joint_acts_on_the_first_leader() -> None:
    found = load(chain(), f"{HEAD}joints: {{third: {{stiffness: 5, rest: 0.3}}}}\n")
    (force,) = found.tree.springs.force(found.tree.neutral() + 0.2, 1)
    third = -3.0 * (2.0 * 0.2 + 0.1) + 0.1
    assert force == pytest.approx(-(-3.0 * 2.0) * 5.0 * (third - 0.3))
