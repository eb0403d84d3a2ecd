"""The words of errors in the two files, of a sound robot with one edit. The specification states codes and places."""

from __future__ import annotations

import re
import shutil
from pathlib import Path

import pytest

import eurdf
from support.described import body, revolute, written
from support.places import DATA
from support.plain_urdf import robot

YAML = "workbench.yaml"
ONE = "workbench.v1.yaml"
URDF = "workbench.urdf"

#: How the description begins.
HEAD = """\
extended_urdf: "2.0"
urdf: workbench.urdf
closures:
  - name: pin
    type: 3d
"""

#: The description up to its actuators.
TOP = (DATA / "workbench.yaml").read_text(encoding="utf-8").partition("actuators:")[0]


def later(old: str, new: str, more: str = "") -> tuple[str, str]:
    """An edit of the upper part of the description, which is then of version 2.1, and more below it."""
    assert TOP.count(old) == 1
    below = f"actuators:\n{more}"
    return (TOP + "actuators:\n") if more else TOP, TOP.replace("2.0", "2.1").replace(old, new) + (
        below if more else ""
    )


def coupled(name: str, *joints: str) -> str:
    """The beginning of a description with couplings: one of that name, then others."""
    items = "".join(
        f"  - {{name: {name}{i or ''}, joints: {{{each}}}}}\n" for i, each in zip((0, 2), joints, strict=False)
    )
    return HEAD.replace("2.0", "2.1").replace("closures:\n", f"couplings:\n{items}closures:\n")


#: The URDF up to the inertia of its first link.
BASE = (DATA / "workbench.urdf").read_text(encoding="utf-8").partition("<mass")[0]


def of_version(version: str, origin: str) -> tuple[str, str]:
    """An edit of the URDF, which then states a version, and the origin of its first inertia."""
    return BASE, BASE.replace('name="workbench"', f'name="workbench" version="{version}"') + f"<origin {origin}/>"


# code, file, text to replace, replacement, part of message or hint
# fmt: off
ERRORS = [
    # version 1
    ("unknown-frame", ONE, "[rod_tip, slider]", "[rod_tpi, slider]", "write 'rod_tip'"),
    ("unknown-joint", ONE, "joint_name: [elbow,", "joint_name: [ellbow,", "write 'elbow'"),
    ("unknown-actuator", ONE, "name_mot: [motor, grip,", "name_mot: [motor, elbow,", "'elbow_Z' or 'elbow_X'"),
    ("actuator-merged", ONE, "name_mot: [motor, grip,", "name_mot: [motor, wrist_x,", "actuate 'wrist_z', or keep the three joints apart: give a link"),
    ("duplicate-replacement", YAML, "[wrist_x, wrist_y, wrist_z]", "[wrist_x, wrist_x, wrist_z]", "write [wrist_x, wrist_y, wrist_z]"),
    # the URDF by itself
    ("urdf-not-found", YAML, "urdf: workbench.urdf", "urdf: workbnech.urdf", "workbench.urdf"),
    ("urdf-root-element", URDF, None, "<sdf/>", "this is SDFormat"),
    ("urdf-root-element", URDF, None, "<p:robot xmlns:p='u'/>", "the root element is <p:robot>"),
    ("urdf-missing-element", URDF, '<mass value="2"/>', "", "<mass>"),
    ("urdf-missing-element", URDF, '<parent link="wrist_1"/>', "", "<parent>"),
    ("urdf-missing-element", URDF, '<limit lower="-3" upper="3" effort="5" velocity="6"/>', "", "continuous"),
    ("urdf-missing-attribute", URDF, 'effort="5" ', "", "'effort'"),
    ("urdf-missing-attribute", URDF, '<link name="rod_tip"/>', '<link nmae="rod_tip"/>', "'name'"),
    ("urdf-bad-number", URDF, 'mass value="2"', 'mass value="2,0"', "comma"),
    ("urdf-bad-number", URDF, 'mass value="2"', 'mass value="nan"', "finite"),
    ("urdf-bad-number", URDF, 'xyz="0.4 0 0"', 'xyz="0.4 0"', "3 numbers"),
    ("urdf-bad-number", URDF, 'xyz="0.4 0 0"', 'xyz="${l} 0 0"', "xacro"),
    ("urdf-version", URDF, '<robot name="workbench">', '<robot name="workbench" version="2">', "1.0, 1.1 or 1.2"),
    ("urdf-version", URDF, '<robot name="workbench">', '<robot name="workbench" version="1">', 'version="1.0"'),
    ("urdf-two-orientations", URDF, *of_version("1.1", 'rpy="0 0 0" quat_xyzw="0 0 0 1"'), "'rpy' and"),
    ("urdf-zero-quaternion", URDF, *of_version("1.2", 'quat_xyzw="0 0 0 -0"'), "link 'base'"),
    ("urdf-later-version", URDF, *of_version("1.0", 'quat_xyzw="1 0 0 0"'), 'version="1.1"'),
    ("urdf-later-version", URDF, '<box size="0.2 0.04 0.04"/>', '<capsule radius="1" length="1"/>', "no version"),
    ("urdf-later-version", URDF, 'velocity="10"/>', 'velocity="10" jerk="1"/>', 'version="1.2"'),
    ("urdf-duplicate-link", URDF, '<link name="wrist_2"/>', '<link name="wrist_2"/>\n  <link name="wrist_2"/>', "'wrist_2'"),
    ("urdf-duplicate-joint", URDF, 'joint name="stage"', 'joint name="motor"', "'motor'"),
    ("urdf-joint-type", URDF, 'name="elbow" type="continuous"', 'name="elbow" type="continous"', "write 'continuous'"),
    ("urdf-joint-type", URDF, 'name="elbow" type="continuous"', 'name="elbow" type="spherical"', "'joints' in the YAML"),
    ("urdf-zero-axis", URDF, '<child link="rod"/><axis xyz="0 0 1"/>', '<child link="rod"/><axis xyz="0 0 0"/>', "'elbow'"),
    ("urdf-unknown-link", URDF, '<parent link="wrist_1"/>', '<parent link="wirst_1"/>', "write 'wrist_1'"),
    ("urdf-two-parents", URDF, '<child link="slider"/>', '<child link="rod"/>', "'closures'"),
    ("urdf-cycle", URDF, '<parent link="base"/><child link="crank"/>', '<parent link="rod_tip"/><child link="crank"/>', "'closures'"),
    ("urdf-two-roots", URDF, '<link name="rod_tip"/>', '<link name="rod_tip"/>\n  <link name="loose"/>', "'loose'"),
    ("urdf-reversed-limits", URDF, 'lower="-3" upper="3"', 'lower="3" upper="-3"', "swap"),
    ("urdf-negative-limit", URDF, 'effort="5" velocity="6"', 'effort="5" velocity="-6"', "'velocity'"),
    ("urdf-negative-limit", URDF, 'damping="0.3"', 'damping="-0.3"', "'damping'"),
    ("urdf-mimic-unknown", URDF, 'mimic joint="grip"', 'mimic joint="gripp"', "write 'grip'"),
    ("urdf-mimic-cycle", URDF, 'mimic joint="grip"', 'mimic joint="follow"', "'follow' -> 'follow'"),
    ("urdf-mimic-kind", URDF, 'mimic joint="grip"', 'mimic joint="tip"', "fixed"),
    ("urdf-geometry", URDF, '<box size="0.2 0.04 0.04"/>', '<box size="0.2 0 0.04"/>', "positive"),
    ("urdf-geometry", URDF, '<box size="0.2 0.04 0.04"/>', '<bxo size="0.2 1 0.04"/>', "write 'box'"),
    ("urdf-no-range", URDF, 'lower="-3" upper="3" ', "", "'pivot'"),
    ("urdf-unknown-element", URDF, '<dynamics damping="0.3" friction="0.4"/>', '<dynamcis damping="0.3"/>', "write 'dynamics'"),
    ("urdf-mimic-fixed", URDF, '<joint name="tip" type="fixed">', '<joint name="tip" type="fixed"><mimic joint="nobody"/>', "'tip' is fixed"),
    ("urdf-closure-ignored", URDF, "</robot>", '<loop name="l"/></robot>', "'closures'"),
    ("urdf-mesh-missing", URDF, '<box size="0.2 0.04 0.04"/>', '<mesh filename="package://a/b.stl"/>', "ROS_PACKAGE_PATH"),
    ("urdf-texture-missing", URDF, '<material name="grey"/>', '<material name="wood"><texture filename="wood.png"/></material>', "ROS_PACKAGE_PATH"),
    ("urdf-texture-missing", URDF, '<material name="grey"/>', '<material name="wood"><texture/></material>', "link 'crank' names no file (add filename"),
    ("urdf-unknown-element", URDF, '<material name="grey"/>', '<material name="wood"><texture filenam="a"/></material>', "did you mean 'filename'?"),
    ("urdf-unknown-material", URDF, '<material name="grey"/>', '<material name="gray"/>', "write 'grey'"),
    # names
    ("unknown-frame", YAML, "[rod_tip, rocker_top]", "[rod_tip, rocker_tpo]", "write 'rocker_top'"),
    ("duplicate-frame", YAML, "name: rocker_top, link", "name: rocker, link", None),
    ("duplicate-closure-name", YAML, "joints:\n", "  - {name: pin, type: 3d, frames: [base, hand]}\njoints:\n", "'pin'"),
    ("closure-axis-zero", YAML, HEAD, HEAD.replace("2.0", "2.1").replace("3d", "hinge\n    axis: [0, 0, 0.0]"), "hinge 'pin'"),
    ("closure-compliance", YAML, *later("type: 3d", "type: 3d\n    compliance: {linear: 1, angular: 0.5}"), "of type 3d"),
    ("duplicate-coupling-name", YAML, HEAD, coupled("pin", "motor: 1, pivot: -1"), "already a closure 'pin'"),
    ("unknown-coupled-joint", YAML, HEAD, coupled("belt", "motor: 1, pivto: -1"), "did you mean 'pivot'?"),
    ("unknown-coupled-joint", YAML, HEAD, coupled("belt", "motor: 1, rod: -1"), "is a link"),
    ("coupling-joint", YAML, HEAD, coupled("belt", "motor: 1, follow: 2"), "'follow' is "),
    ("coupling-joint", YAML, HEAD, coupled("belt", "motor: 1, tip: 2"), "fixed"),
    ("coupling-joint", YAML, HEAD, coupled("belt", "motor: 1, wrist_x: 2"), "merged into the spherical joint 'hand_ball'"),
    ("coupling-joint", YAML, HEAD, coupled("belt", "motor: 1, hand_ball: 2"), "3 velocities"),
    ("coupling-duplicate", YAML, HEAD, coupled("belt", "motor: 1, pivot: 2", "motor: 2, pivot: 4"), "multiple of coupling 'belt'"),
    ("closure-same-frame", YAML, "[rod_tip, rocker_top]", "[rod_tip, rod_tip]", "itself"),
    ("closure-same-body", YAML, "[rod_tip, rocker_top]", "[rod_tip, rod]", "'rod_tip' and 'rod'"),
    ("closure-duplicate", YAML, "joints:\n", "  - {name: again, type: 6d, frames: [rocker_top, rod_tip]}\njoints:\n", "'pin'"),
    ("closure-type-unknown", YAML, "joints:\n", "  - {name: belt, type: x-belt, frames: [slider, hand]}\njoints:\n", "left out"),
    ("unknown-joint", YAML, "  stage: {limits", "  stagee: {limits", "write 'stage'"),
    ("unknown-actuator", YAML, "  - motor\n", "  - moter\n", "write 'motor'"),
    ("unknown-actuator", YAML, "  - motor\n", "  - crank\n", "is a link"),
    ("duplicate-joint-name", YAML, "hand_ball: {type", "motor: {type", None),
    # meanings
    ("actuator-immobile", YAML, "  - motor\n", "  - motor\n  - tip\n", "fixed"),
    ("actuator-duplicate", YAML, "  - motor\n", "  - motor\n  - motor\n", "twice"),
    ("actuator-mimic", YAML, "  - motor\n", "  - motor\n  - follow\n", "'grip'"),
    ("actuator-merged", YAML, "  - motor\n", "  - motor\n  - wrist_y\n", "'hand_ball'"),
    ("joint-mimics", YAML, "  stage: {limits: {velocity: 1.5}, armature: 0.02}", "  follow: {type: helical, pitch: 1}", "'grip'"),
    ("joint-mimics", YAML, "  stage: {limits: {velocity: 1.5}, armature: 0.02}", "  grip: cylindrical", "'follow'"),
    ("joint-mimics", YAML, *later("  stage:", "  follow: {limits: {velocity: 1}}\n  stage:"), "limits of joint 'follow'"),
    ("joint-not-mimic", YAML, *later("  stage:", "  grip: {mimic: false}\n  stage:"), "'grip' mimics no other"),
    ("joint-not-mimic", YAML, *later("merges: [wrist_x, wrist_y, wrist_z]", "merges: [wrist_x, wrist_y, wrist_z], mimic: false"), "merged joints"),
    ("joint-property", YAML, *later("merges: [wrist_x, wrist_y, wrist_z]", "merges: [wrist_x, wrist_y, wrist_z], stiffness: 3"), "cannot have a spring"),
    ("joint-property", YAML, *later("armature: 0.02", "stiffness: [2, 3]"), "one number"),
    ("duplicate-actuator-name", YAML, *later("joints:", "joints:", "  - {joint: pivot, name: motor}\n"), "of joint 'pivot'"),
    ("actuator-control-reversed", YAML, *later("joints:", "joints:", "  - {joint: pivot, control: [5, -5]}\n"), "lower bound 5"),
    ("joint-kind", YAML, "  stage: {limits: {velocity: 1.5}, armature: 0.02}", "  stage: spherical", "prismatic"),
    ("number-out-of-bounds", YAML, "gear_ratio: 50", "gear_ratio: -1e-16", "is -1e-16"),
    ("number-out-of-bounds", YAML, "xyz: [0, 0.3, 0]", "xyz: [0, -1.7e308, 0]", "item 2 of 'xyz'"),
    ("number-out-of-bounds", URDF, '<mass value="2"/>', '<mass value="2"/><origin xyz="0 1e200 0"/>', "'xyz' of <origin>"),
    ("number-out-of-bounds", YAML, "  stage: {limits: {velocity: 1.5}, armature: 0.02}", "  stage: {type: helical, pitch: 5e-324}", "pitch"),
    ("joint-property", YAML, "  stage: {limits: {velocity: 1.5}, armature: 0.02}", "  tip: {armature: 1}", "fixed"),
    ("joint-property", YAML, "limits: {velocity: 1.5}", "limits: {velocity: [1.5, 2]}", "2 numbers"),
    ("joint-property", YAML, "  stage: {limits: {velocity: 1.5}", "  elbow: {limits: {lower: -1}", "position limits"),
    ("joint-limits-reversed", YAML, "limits: {velocity: 1.5}", "limits: {lower: 2}", "upper limit 0.5"),
    ("merge-inertia", URDF, '<link name="wrist_1"/>', '<link name="wrist_1"><inertial><mass value="0.1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>', "'wrist_1'"),
    ("merge-closure-frame", YAML, "joints:\n", "  - {name: bad, type: 3d, frames: [wrist_1, slider]}\njoints:\n", "'wrist_1'"),
    ("merge-axes", URDF, '<parent link="wrist_2"/>', '<origin xyz="0 0.01 0"/><parent link="wrist_2"/>', "mm"),
    ("configuration-joint", YAML, "ready: {motor: 0.5", "ready: {moter: 0.5", "write 'motor'"),
    ("configuration-joint", YAML, "ready: {motor: 0.5", "ready: {follow: 0.5", "mimics 'grip'"),
    ("configuration-joint", YAML, "ready: {motor: 0.5", "ready: {tip: 0.5", "fixed"),
    ("configuration-length", YAML, "ready: {motor: 0.5", "ready: {motor: [0.5, 1]", "angle"),
    ("configuration-length", YAML, "hand_ball: [0, 0, 0, 1]", "hand_ball: [0, 0, 0]", "x, y, z, w"),
    ("configuration-quaternion", YAML, "hand_ball: [0, 0, 0, 1]", "hand_ball: [0, 0, 0, 2]", "length 2"),
    ("configuration-limits", YAML, "ready: {motor: 0.5", "ready: {motor: 2.5", "-2 to 2"),
    # inertia
    ("negative-mass", URDF, 'mass value="0.7"', 'mass value="-0.7"', "'rocker'"),
    ("inertia-not-psd", URDF, '<mass value="2"/><inertia ixx="0.02"', '<mass value="2"/><inertia ixx="-0.02"', "'base'"),
    ("inertia-triangle", URDF, '<mass value="2"/><inertia ixx="0.02"', '<mass value="2"/><inertia ixx="0.2"', "'base'"),
    ("leaf-without-inertia", URDF, '<inertial><origin xyz="0 0.15 0"/><mass value="0.7"/><inertia ixx="0.006" ixy="0" ixz="0" iyy="0.001" iyz="0" izz="0.006"/></inertial>', "", "'pivot'"),
    # closures
    ("assembled-open", YAML, "assembled: {motor: 0,", "assembled: {motor: 0.1,", "'pin' by"),
    ("closure-cannot-close", ONE, "[rod_tip, slider]", "[rod_tip, rocker]", "'closure_1' by"),
]
# fmt: on


def _workbench(folder: Path, file: str, old: str | None, new: str) -> Path:
    for name in (YAML, ONE, URDF):
        shutil.copy(DATA / name, folder / name)
    edited = folder / file
    text = edited.read_text(encoding="utf-8")
    if old is None:
        text = new
    else:
        assert text.count(old) == 1, f"{old!r} stands {text.count(old)} times in {file}"
        text = text.replace(old, new)
    edited.write_text(text, encoding="utf-8")
    return folder


def _check(folder: Path, file: str) -> eurdf.Report:
    if file == ONE:
        return eurdf.check(folder / ONE, urdf=folder / URDF)
    return eurdf.check(folder / YAML)


@pytest.mark.parametrize("file", [YAML, ONE])
def test_unedited_workbench_is_valid(file: str) -> None:
    report = _check(DATA, file)
    assert [str(found) for found in report.diagnostics] == []


@pytest.mark.parametrize(
    ("code", "file", "old", "new", "says"), ERRORS, ids=[f"{row[0]}-{index}" for index, row in enumerate(ERRORS)]
)
def test_one_error_gives_one_diagnostic_in_these_words(
    tmp_path: Path, code: str, file: str, old: str | None, new: str, says: str | None
) -> None:
    report = _check(_workbench(tmp_path, file, old, new), file)
    found = [diagnostic for diagnostic in report.diagnostics if diagnostic.code == code]
    assert len(found) == 1, [str(diagnostic) for diagnostic in report.diagnostics]
    # A name taken from a frame leaves what referred to it dangling: two errors from one edit.
    if says is not None:
        assert len(report.diagnostics) == 1
    error = found[0]
    assert (error.line, error.column) != (None, None)
    assert not re.search(r"[.\n]$", error.message), error.message
    assert error.hint is None or not re.search(r"[.\n]$", error.hint), error.hint
    assert (says or "") in f"{error.message} ({error.hint})"


def _robot(folder: Path, urdf: str, yaml: str | None = None) -> eurdf.Report:
    (folder / "robot.urdf").write_text(urdf, encoding="utf-8")
    if yaml is not None:
        (folder / "robot.yaml").write_text(yaml, encoding="utf-8")
    return eurdf.check(folder)


def test_shared_name_is_ambiguous_only_if_used(tmp_path: Path) -> None:
    joint = '<joint name="{0}" type="revolute"><parent link="a"/><child link="{1}"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint>'
    body = '<link name="{0}"><inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>'
    urdf = f'<robot name="r"><link name="a"/>{body.format("b")}{body.format("c")}{joint.format("b", "c")}{joint.format("c2", "b")}</robot>'
    closure = 'extended_urdf: "2.0"\nclosures:\n  - {{name: k, type: 3d, frames: [{0}, c]}}\n'
    report = _robot(tmp_path, urdf, closure.format("b"))
    assert [found.code for found in report.diagnostics] == ["ambiguous-frame"]
    assert "{link: b}" in (report.diagnostics[0].hint or "")
    assert _robot(tmp_path, urdf, closure.format("{link: b}")).ok
    assert _robot(tmp_path, urdf, 'extended_urdf: "2.0"\n').ok


def test_invalid_mesh_is_refused_with_geometry(tmp_path: Path) -> None:
    folder = _workbench(tmp_path, URDF, '<box size="0.2 0.04 0.04"/>', '<mesh filename="bad.stl"/>')
    (folder / "bad.stl").write_bytes(b"no mesh")
    with pytest.raises(eurdf.InvalidRobot, match="geometry=False") as refusal:
        eurdf.load(folder / YAML)
    (error,) = refusal.value.diagnostics
    assert error.code == "urdf-mesh-unreadable"
    assert "bad.stl" in (folder / URDF).read_text(encoding="utf-8").split("\n")[error.line - 1][error.column - 1 :]
    assert eurdf.load(folder / YAML, geometry=False).model.nv > 0


@pytest.mark.parametrize(
    ("yaml", "without"),
    [
        ("", ["x", "y", "z", "grip"]),
        ("joints: {ball: {type: spherical, merges: [x, y, z]}}\n", ["grip"]),
        ("joints: {grip: fixed}\n", ["x", "y", "z"]),
        ("joints: {grip: {limits: {lower: -1, upper: 1}}, x: spherical}\n", ["y", "z"]),
        ("joints: {ball: {type: spherical, merges: [x, y, z]}, grip: {type: universal, axes: xy}}\n", []),
        ("name_mot: [grip]\n", ["grip"]),  # version 1 merges by itself
        ("name_mot: []\njoint_name: [grip]\njoint_type: [UJOINT_XY]\n", []),
    ],
)
def test_only_remaining_joints_need_ranges(tmp_path: Path, yaml: str, without: list[str]) -> None:
    chain = [("x", "base", "one"), ("y", "one", "two"), ("z", "two", "hand"), ("grip", "hand", "finger")]
    axes = [(1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 2, 3)]
    joints = [
        revolute(*names, axis).replace('lower="-3" upper="3" ', "") for names, axis in zip(chain, axes, strict=True)
    ]
    links = [body("base"), '<link name="one"/><link name="two"/>', body("hand"), body("finger")]
    found = eurdf.check(written(tmp_path, robot(*links, *joints), yaml)).diagnostics
    told = [each.message for each in found if each.code == "urdf-no-range"]
    if not without:
        assert told == []
        return
    count = "1 joint has" if len(without) == 1 else f"{len(without)} joints have"
    named = ", ".join(f"'{name}'" for name in without[:3]) + (", ..." if len(without) > 3 else "")
    assert told == [f"{count} the position limits 0 and 0: {named}"]
