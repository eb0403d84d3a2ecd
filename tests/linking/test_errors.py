"""Every error that the two files can have: exactly one diagnostic, with its code, its line and column, its hint.

Each case is a sound robot with one edit, so that only that edit can be what is found.
"""

from __future__ import annotations

import re
import shutil
from pathlib import Path

import pytest

import eurdf
from eurdf.diagnostics import REGISTRY

DATA = Path(__file__).parents[1] / "data"

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
TOP = (Path(__file__).parents[1] / "data" / "workbench.yaml").read_text(encoding="utf-8").partition("actuators:")[0]


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
BASE = (Path(__file__).parents[1] / "data" / "workbench.urdf").read_text(encoding="utf-8").partition("<mass")[0]


def of_version(version: str, origin: str) -> tuple[str, str]:
    """An edit of the URDF, which then states a version, and the origin of its first inertia."""
    return BASE, BASE.replace('name="workbench"', f'name="workbench" version="{version}"') + f"<origin {origin}/>"


# code, file, text to replace, replacement, text at the place that the diagnostic points at, part of message or hint
# fmt: off
ERRORS = [
    # the description by itself
    ("yaml-syntax", YAML, "frames: [rod_tip, rocker_top]", "frames: [rod_tip, rocker_top", None, ""),
    ("yaml-duplicate-key", YAML, "x-note: kept", "urdf: other.urdf", "urdf: other", "'urdf'"),
    ("unsupported-version", YAML, '"2.0"', '"3.0"', '"3.0"', "2.0"),
    ("unknown-key", YAML, "actuators:", "actuator:", "actuator:", "did you mean 'actuators'?"),
    ("unknown-key", YAML, "armature: 0.02", "armatur: 0.02", "armatur:", "did you mean 'armature'?"),
    ("missing-key", YAML, "    type: 3d\n", "", None, "'type'"),
    ("wrong-type", YAML, "gear_ratio: 50", "gear_ratio: fast", "fast", "number"),
    ("wrong-type", YAML, "gear_ratio: 50", "gear_ratio: yes", "yes", "number"),
    ("wrong-length", YAML, "xyz: [0, 0.3, 0]", "xyz: [0, 0.3]", "[0, 0.3]", "3"),
    ("wrong-length", YAML, "frames: [rod_tip, rocker_top]", "frames: [rod_tip]", "[rod_tip]", "2"),
    ("wrong-value", YAML, "type: 3d", "type: 4d", "4d", "3d"),
    ("wrong-value", YAML, "type: spherical", "type: sferical", "sferical", "did you mean 'spherical'?"),
    ("out-of-range", YAML, "armature: 0.02", "armature: -0.02", "-0.02", ""),
    ("conflicting-keys", YAML, "link: rocker,", "link: rocker, joint: pivot,", None, ""),
    ("yaml-not-finite", YAML, "motor: 0.5", "motor: .inf", ".inf", ""),
    # version 1 by itself
    ("length-mismatch", ONE, "type: [3d]", "type: [3d, 6d]", None, ""),
    ("length-mismatch", ONE, "joint_type: [UJOINT_ZX, SPHERICAL]", "joint_type: [UJOINT_ZX]", None, ""),
    ("wrong-value", ONE, "type: [3d]", "type: [5d]", "5d", ""),
    ("wrong-value", ONE, "UJOINT_ZX", "UJOINT_XX", "UJOINT_XX", ""),
    ("near-miss-key", ONE, "note: kept", "name_mots: kept", "name_mots", "did you mean 'name_mot'?"),
    ("unknown-frame", ONE, "[rod_tip, slider]", "[rod_tpi, slider]", "rod_tpi", "did you mean 'rod_tip'?"),
    ("unknown-actuator", ONE, "name_mot: [motor, grip,", "name_mot: [motr, grip,", "motr", "did you mean 'motor'?"),
    ("unknown-joint", ONE, "joint_name: [elbow,", "joint_name: [ellbow,", "ellbow", "did you mean 'elbow'?"),
    ("unknown-actuator", ONE, "name_mot: [motor, grip,", "name_mot: [motor, elbow,", "elbow, follow", "'elbow_Z' or 'elbow_X'"),
    ("actuator-merged", ONE, "name_mot: [motor, grip,", "name_mot: [motor, wrist_x,", "wrist_x", "'wrist_z'"),
    ("duplicate-replacement", ONE, "joint_name: [elbow, pivot]", "joint_name: [elbow, elbow]", "elbow]\njoint_type", ""),
    ("duplicate-replacement", YAML, "[wrist_x, wrist_y, wrist_z]", "[wrist_x, wrist_x, wrist_z]", "wrist_x, wrist_z", "different"),
    # the URDF by itself
    ("xml-syntax", URDF, "</robot>", "</robo>", None, ""),
    ("xml-doctype", URDF, '<robot name="workbench">', '<!DOCTYPE robot><robot name="workbench">', None, ""),
    ("urdf-not-found", YAML, "urdf: workbench.urdf", "urdf: workbnech.urdf", "workbnech.urdf", "workbench.urdf"),
    ("urdf-root-element", URDF, None, "<sdf/>", "<sdf", "this is SDFormat"),
    ("urdf-root-element", URDF, None, "<p:robot xmlns:p='u'/>", "<p:robot", "the root element is <p:robot>"),
    ("urdf-missing-element", URDF, '<mass value="2"/>', "", "<inertial", "<mass>"),
    ("urdf-missing-element", URDF, '<parent link="wrist_1"/>', "", '<joint name="wrist_y"', "<parent>"),
    (
        "urdf-missing-element",
        URDF,
        '<limit lower="-3" upper="3" effort="5" velocity="6"/>',
        "",
        '<joint name="pivot"',
        "continuous",
    ),
    ("urdf-missing-attribute", URDF, 'effort="5" ', "", "<limit lower=\"-3\"", "'effort'"),
    ("urdf-missing-attribute", URDF, '<link name="rod_tip"/>', '<link nmae="rod_tip"/>', "<link nmae", "'name'"),
    ("urdf-repeated-element", URDF, '<mass value="2"/>', '<mass value="2"/><mass value="2"/>', '<mass value="2"/><inertia', ""),
    ("urdf-bad-number", URDF, 'mass value="2"', 'mass value="2,0"', '2,0', "comma"),
    ("urdf-bad-number", URDF, 'mass value="2"', 'mass value="nan"', "nan", "finite"),
    ("urdf-bad-number", URDF, 'mass value="2"', 'mass value="1e999"', "1e999", "finite"),
    ("urdf-bad-number", URDF, 'xyz="0.4 0 0"', 'xyz="0.4 0"', "0.4 0", "3 numbers"),
    ("urdf-bad-number", URDF, 'xyz="0.4 0 0"', 'xyz="${l} 0 0"', "${l}", "xacro"),
    ("urdf-version", URDF, '<robot name="workbench">', '<robot name="workbench" version="2">', '2">', "1.0, 1.1 or 1.2"),
    ("urdf-version", URDF, '<robot name="workbench">', '<robot name="workbench" version="1">', '1">', 'version="1.0"'),
    ("urdf-empty-name", URDF, '<link name="rod_tip"/>', '<link name=""/>', None, ""),
    ("urdf-empty-name", URDF, '<link name="rod_tip"/>', '<link name="&#9;"/>', None, ""),
    ("urdf-two-orientations", URDF, *of_version("1.1", 'rpy="0 0 0" quat_xyzw="0 0 0 1"'), "0 0 0 1", "'rpy' and"),
    ("urdf-zero-quaternion", URDF, *of_version("1.2", 'quat_xyzw="0 0 0 -0"'), "0 0 0 -0", "link 'base'"),
    ("urdf-later-version", URDF, *of_version("1.0", 'quat_xyzw="1 0 0 0"'), "1 0 0 0", 'version="1.1"'),
    ("urdf-later-version", URDF, '<box size="0.2 0.04 0.04"/>', '<capsule radius="1" length="1"/>', "<capsule", "no version"),
    ("urdf-later-version", URDF, 'velocity="10"/>', 'velocity="10" jerk="1"/>', '1"/>', 'version="1.2"'),
    ("urdf-duplicate-link", URDF, '<link name="wrist_2"/>', '<link name="wrist_2"/>\n  <link name="wrist_2"/>', None, "'wrist_2'"),
    ("urdf-duplicate-joint", URDF, 'joint name="stage"', 'joint name="motor"', 'motor" type="prismatic"', "'motor'"),
    ("urdf-reserved-name", URDF, 'joint name="tip"', 'joint name="universe"', "universe", ""),
    ("urdf-joint-type", URDF, 'name="elbow" type="continuous"', 'name="elbow" type="continous"', "continous", "did you mean 'continuous'?"),
    ("urdf-joint-type", URDF, 'name="elbow" type="continuous"', 'name="elbow" type="spherical"', "spherical", "'joints' in the YAML"),
    ("urdf-zero-axis", URDF, '<child link="rod"/><axis xyz="0 0 1"/>', '<child link="rod"/><axis xyz="0 0 0"/>', '0 0 0"/>\n  </joint>', "'elbow'"),
    ("urdf-unknown-link", URDF, '<parent link="wrist_1"/>', '<parent link="wirst_1"/>', "wirst_1", "did you mean 'wrist_1'?"),
    ("urdf-two-parents", URDF, '<child link="slider"/>', '<child link="rod"/>', None, "'closures'"),
    ("urdf-cycle", URDF, '<parent link="base"/><child link="crank"/>', '<parent link="rod_tip"/><child link="crank"/>', None, "'closures'"),
    ("urdf-two-roots", URDF, '<link name="rod_tip"/>', '<link name="rod_tip"/>\n  <link name="loose"/>', "loose", "'loose'"),
    ("urdf-reversed-limits", URDF, 'lower="-3" upper="3"', 'lower="3" upper="-3"', '3" upper="-3"', "swap"),
    ("urdf-negative-limit", URDF, 'effort="5" velocity="6"', 'effort="5" velocity="-6"', '-6', "'velocity'"),
    ("urdf-negative-limit", URDF, 'damping="0.3"', 'damping="-0.3"', "-0.3", "'damping'"),
    ("urdf-mimic-unknown", URDF, 'mimic joint="grip"', 'mimic joint="gripp"', "gripp", "did you mean 'grip'?"),
    ("urdf-mimic-cycle", URDF, 'mimic joint="grip"', 'mimic joint="follow"', 'follow" multi', "'follow' -> 'follow'"),
    ("urdf-mimic-kind", URDF, 'mimic joint="grip"', 'mimic joint="tip"', 'tip" multi', "fixed"),
    ("urdf-geometry", URDF, '<box size="0.2 0.04 0.04"/>', '<box size="0.2 0 0.04"/>', "<box", "positive"),
    ("urdf-geometry", URDF, '<box size="0.2 0.04 0.04"/>', '<bxo size="0.2 1 0.04"/>', "<bxo", "did you mean 'box'?"),
    ("urdf-no-range", URDF, 'lower="-3" upper="3" ', "", "<limit effort=\"5\"", "'pivot'"),
    ("urdf-unknown-element", URDF, '<dynamics damping="0.3" friction="0.4"/>', '<dynamcis damping="0.3"/>', "<dynamcis", "did you mean 'dynamics'?"),
    ("urdf-unknown-element", URDF, '<dynamics damping="0.3" friction="0.4"/>', '<dynamics dampin="0.3"/>', "<dynamics", "did you mean 'damping'?"),
    ("urdf-unknown-element", URDF, '<mimic joint="grip"', '<mimic joint="grip" multiplyer="2"', "<mimic", "did you mean 'multiplier'?"),
    ("urdf-mimic-fixed", URDF, '<joint name="tip" type="fixed">', '<joint name="tip" type="fixed"><mimic joint="nobody"/>', '<mimic joint="nobody"/>', "'tip' is fixed"),
    ("urdf-closure-ignored", URDF, "</robot>", '<loop name="l"/></robot>', "<loop", "'closures'"),
    ("urdf-mesh-missing", URDF, '<box size="0.2 0.04 0.04"/>', '<mesh filename="package://a/b.stl"/>', "package://a/b.stl", "ROS_PACKAGE_PATH"),
    ("urdf-texture-missing", URDF, '<material name="grey"/>', '<material name="wood"><texture filename="wood.png"/></material>', "wood.png", "ROS_PACKAGE_PATH"),
    ("urdf-texture-missing", URDF, '<material name="grey"/>', '<material name="wood"><texture/></material>', "<texture/>", "link 'crank' names no file (add filename"),
    ("urdf-unknown-element", URDF, '<material name="grey"/>', '<material name="wood"><texture filenam="a"/></material>', "<texture", "did you mean 'filename'?"),
    ("urdf-unknown-material", URDF, '<material name="grey"/>', '<material name="gray"/>', "gray", "did you mean 'grey'?"),
    # names
    ("unknown-frame", YAML, "[rod_tip, rocker_top]", "[rod_tip, rocker_tpo]", "rocker_tpo", "did you mean 'rocker_top'?"),
    ("unknown-frame", YAML, "link: rocker,", "link: roker,", "roker", "did you mean 'rocker'?"),
    ("duplicate-frame", YAML, "name: rocker_top, link", "name: rocker, link", None, None),
    ("duplicate-closure-name", YAML, "joints:\n", "  - {name: pin, type: 3d, frames: [base, hand]}\njoints:\n", "pin, type", "'pin'"),
    ("closure-axis-zero", YAML, HEAD, HEAD.replace("2.0", "2.1").replace("3d", "hinge\n    axis: [0, 0, 0.0]"), "[0, 0, 0.0]", "hinge 'pin'"),
    ("closure-compliance", YAML, *later("type: 3d", "type: 3d\n    compliance: {linear: 1, angular: 0.5}"), "0.5}", "of type 3d"),
    ("duplicate-coupling-name", YAML, HEAD, coupled("pin", "motor: 1, pivot: -1"), "pin, joints", "already a closure 'pin'"),
    ("unknown-coupled-joint", YAML, HEAD, coupled("belt", "motor: 1, pivto: -1"), "pivto", "did you mean 'pivot'?"),
    ("unknown-coupled-joint", YAML, HEAD, coupled("belt", "motor: 1, rod: -1"), "rod: -1", "is a link"),
    ("coupling-joint", YAML, HEAD, coupled("belt", "motor: 1, follow: 2"), "follow: 2", "'follow' is "),
    ("coupling-joint", YAML, HEAD, coupled("belt", "motor: 1, tip: 2"), "tip: 2", "fixed"),
    ("coupling-joint", YAML, HEAD, coupled("belt", "motor: 1, wrist_x: 2"), "wrist_x: 2", "merged into the spherical joint 'hand_ball'"),
    ("coupling-joint", YAML, HEAD, coupled("belt", "motor: 1, hand_ball: 2"), "hand_ball: 2", "3 velocities"),
    ("coupling-duplicate", YAML, HEAD, coupled("belt", "motor: 1, pivot: 2", "motor: 2, pivot: 4"), "{name: belt2", "multiple of coupling 'belt'"),
    ("closure-same-frame", YAML, "[rod_tip, rocker_top]", "[rod_tip, rod_tip]", "rod_tip]", "itself"),
    ("closure-same-body", YAML, "[rod_tip, rocker_top]", "[rod_tip, rod]", None, "'rod_tip' and 'rod'"),
    ("closure-duplicate", YAML, "joints:\n", "  - {name: again, type: 6d, frames: [rocker_top, rod_tip]}\njoints:\n", "{name: again", "'pin'"),
    ("closure-type-unknown", YAML, "joints:\n", "  - {name: belt, type: x-belt, frames: [slider, hand]}\njoints:\n", "x-belt", "left out"),
    ("unknown-joint", YAML, "  stage: {limits", "  stagee: {limits", "stagee", "did you mean 'stage'?"),
    ("unknown-joint", YAML, "[wrist_x, wrist_y, wrist_z]", "[wrist_x, wrist_y, wrist_zz]", "wrist_zz", "did you mean 'wrist_z'?"),
    ("unknown-actuator", YAML, "  - motor\n", "  - moter\n", "moter", "did you mean 'motor'?"),
    ("unknown-actuator", YAML, "  - motor\n", "  - crank\n", "crank", "is a link"),
    ("unknown-actuator", YAML, "{joint: grip,", "{joint: grib,", "grib", "did you mean 'grip'?"),
    ("duplicate-joint-name", YAML, "hand_ball: {type", "motor: {type", None, None),
    # meanings
    ("actuator-immobile", YAML, "  - motor\n", "  - motor\n  - tip\n", "tip\n", "fixed"),
    ("actuator-duplicate", YAML, "  - motor\n", "  - motor\n  - motor\n", "motor\n  - {", "twice"),
    ("actuator-mimic", YAML, "  - motor\n", "  - motor\n  - follow\n", "follow\n", "'grip'"),
    ("actuator-merged", YAML, "  - motor\n", "  - motor\n  - wrist_y\n", "wrist_y\n", "'hand_ball'"),
    ("joint-mimics", YAML, "  stage: {limits: {velocity: 1.5}, armature: 0.02}", "  follow: {type: helical, pitch: 1}", "{type: helical", "'grip'"),
    ("joint-mimics", YAML, "  stage: {limits: {velocity: 1.5}, armature: 0.02}", "  grip: cylindrical", "cylindrical", "'follow'"),
    ("joint-mimics", YAML, *later("  stage:", "  follow: {limits: {velocity: 1}}\n  stage:"), "{velocity: 1}}", "limits of joint 'follow'"),
    ("joint-not-mimic", YAML, *later("  stage:", "  grip: {mimic: false}\n  stage:"), "false", "'grip' mimics no other"),
    ("joint-not-mimic", YAML, *later("merges: [wrist_x, wrist_y, wrist_z]", "merges: [wrist_x, wrist_y, wrist_z], mimic: false"), "false", "merged joints"),
    ("joint-property", YAML, *later("merges: [wrist_x, wrist_y, wrist_z]", "merges: [wrist_x, wrist_y, wrist_z], stiffness: 3"), "3}", "cannot have a spring"),
    ("joint-property", YAML, *later("armature: 0.02", "stiffness: [2, 3]"), "[2, 3]", "one number"),
    ("duplicate-actuator-name", YAML, *later("joints:", "joints:", "  - {joint: pivot, name: motor}\n"), "motor", "of joint 'pivot'"),
    ("actuator-control-reversed", YAML, *later("joints:", "joints:", "  - {joint: pivot, control: [5, -5]}\n"), "[5, -5]", "lower bound 5"),
    ("joint-kind", YAML, "  stage: {limits: {velocity: 1.5}, armature: 0.02}", "  stage: spherical", "spherical\n", "prismatic"),
    ("joint-kind", YAML, "  stage: {limits: {velocity: 1.5}, armature: 0.02}", "  tip: spherical", "spherical\n", "fixed"),
    ("joint-axis-zero", YAML, "  stage: {limits: {velocity: 1.5}, armature: 0.02}", "  elbow: {type: universal, axes: [[0, 0, 1], [0, 0, 0]]}", "[0, 0, 0]", ""),
    ("joint-axes-parallel", YAML, "  stage: {limits: {velocity: 1.5}, armature: 0.02}", "  elbow: {type: universal, axes: [[0, 0, 1], [0, 0, -2]]}", "[[0, 0, 1]", ""),
    ("joint-pitch-zero", YAML, "  stage: {limits: {velocity: 1.5}, armature: 0.02}", "  stage: {type: helical, pitch: 0}", "0}", ""),
    ("number-out-of-bounds", YAML, "gear_ratio: 50", "gear_ratio: 1e200", "1e200", "is 1e+200"),
    ("number-out-of-bounds", YAML, "gear_ratio: 50", "gear_ratio: -1e-16", "-1e-16", "is -1e-16"),
    ("number-out-of-bounds", YAML, "xyz: [0, 0.3, 0]", "xyz: [0, -1.7e308, 0]", "-1.7e308", "item 2 of 'xyz'"),
    ("number-out-of-bounds", URDF, '<mass value="2"/>', '<mass value="2"/><origin xyz="0 1e200 0"/>', "0 1e200 0", "'xyz' of <origin>"),
    ("number-out-of-bounds", YAML, "  stage: {limits: {velocity: 1.5}, armature: 0.02}", "  stage: {type: helical, pitch: 5e-324}", "5e-324", "pitch"),
    ("number-out-of-bounds", YAML, "limits: {velocity: 1.5}", "limits: {upper: -1e16}", "-1e16", "'upper' is -1e+16"),
    ("joint-property", YAML, "  stage: {limits: {velocity: 1.5}, armature: 0.02}", "  tip: {armature: 1}", "1}", "fixed"),
    ("joint-property", YAML, "limits: {velocity: 1.5}", "limits: {velocity: [1.5, 2]}", "[1.5, 2]", "2 numbers"),
    ("joint-property", YAML, "  stage: {limits: {velocity: 1.5}", "  elbow: {limits: {lower: -1}", "-1}", "position limits"),
    ("joint-limits-reversed", YAML, "limits: {velocity: 1.5}", "limits: {lower: 2}", "2}", "upper limit 0.5"),
    ("merge-not-chain", YAML, "[wrist_x, wrist_y, wrist_z]", "[wrist_x, wrist_z, wrist_y]", "[wrist_x", ""),
    ("merge-not-chain", YAML, "[wrist_x, wrist_y, wrist_z]", "[motor, elbow, pivot]", "[motor", ""),
    (
        "merge-inertia",
        URDF,
        '<link name="wrist_1"/>',
        '<link name="wrist_1"><inertial><mass value="0.1"/>'
        '<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>',
        None,
        "'wrist_1'",
    ),
    ("merge-closure-frame", YAML, "joints:\n", "  - {name: bad, type: 3d, frames: [wrist_1, slider]}\njoints:\n", "[wrist_x", "'wrist_1'"),
    ("merge-axes", URDF, '<parent link="wrist_2"/>', '<origin xyz="0 0.01 0"/><parent link="wrist_2"/>', None, "mm"),
    ("joint-axes-parallel", URDF, '<child link="wrist_2"/><axis xyz="0 1 0"/>', '<child link="wrist_2"/><axis xyz="1 0 0"/>', None, ""),
    ("configuration-joint", YAML, "ready: {motor: 0.5", "ready: {moter: 0.5", "moter", "did you mean 'motor'?"),
    ("configuration-joint", YAML, "ready: {motor: 0.5", "ready: {follow: 0.5", "follow", "mimics 'grip'"),
    ("configuration-joint", YAML, "ready: {motor: 0.5", "ready: {tip: 0.5", "tip: 0.5", "fixed"),
    ("configuration-length", YAML, "ready: {motor: 0.5", "ready: {motor: [0.5, 1]", "[0.5, 1]", "angle"),
    ("configuration-length", YAML, "hand_ball: [0, 0, 0, 1]", "hand_ball: [0, 0, 0]", "[0, 0, 0]}", "x, y, z, w"),
    ("configuration-quaternion", YAML, "hand_ball: [0, 0, 0, 1]", "hand_ball: [0, 0, 0, 2]", "[0, 0, 0, 2]", "length 2"),
    ("configuration-limits", YAML, "ready: {motor: 0.5", "ready: {motor: 2.5", "2.5", "-2 to 2"),
    # inertia
    ("negative-mass", URDF, 'mass value="0.7"', 'mass value="-0.7"', '-0.7', "'rocker'"),
    ("inertia-not-psd", URDF, '<mass value="2"/><inertia ixx="0.02"', '<mass value="2"/><inertia ixx="-0.02"', '<inertia ixx="-0.02"', "'base'"),
    ("inertia-triangle", URDF, '<mass value="2"/><inertia ixx="0.02"', '<mass value="2"/><inertia ixx="0.2"', '<inertia ixx="0.2"', "'base'"),
    (
        "leaf-without-inertia",
        URDF,
        '<inertial><origin xyz="0 0.15 0"/><mass value="0.7"/>'
        '<inertia ixx="0.006" ixy="0" ixz="0" iyy="0.001" iyz="0" izz="0.006"/></inertial>',
        "",
        '<link name="rocker"',
        "'pivot'",
    ),
    # closures
    ("assembled-open", YAML, "assembled: {motor: 0,", "assembled: {motor: 0.1,", "assembled", "'pin' by"),
    ("closure-cannot-close", ONE, "[rod_tip, slider]", "[rod_tip, rocker]", "[rod_tip, rocker]", "'closure_1' by"),
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
    ("code", "file", "old", "new", "at", "says"), ERRORS, ids=[f"{row[0]}-{index}" for index, row in enumerate(ERRORS)]
)
def test_one_error_gives_one_diagnostic(
    tmp_path: Path, code: str, file: str, old: str | None, new: str, at: str | None, says: str | None
) -> None:
    report = _check(_workbench(tmp_path, file, old, new), file)
    found = [diagnostic for diagnostic in report.diagnostics if diagnostic.code == code]
    others = [str(diagnostic) for diagnostic in report.diagnostics if diagnostic.code != code]
    assert len(found) == 1, [str(diagnostic) for diagnostic in report.diagnostics]
    # A name taken from a frame leaves what referred to it dangling: two errors from one edit.
    if says is not None:
        assert others == []
    error = found[0]
    assert error.line is not None
    assert error.column is not None
    if at is not None:
        lines = Path(error.file).read_text(encoding="utf-8").split("\n")
        rest = "\n".join([lines[error.line - 1][error.column - 1 :], *lines[error.line :]])
        assert rest.startswith(at), rest[:60]
    if says:
        assert says in f"{error.message} ({error.hint})"


def test_every_linking_code_has_a_case() -> None:
    shown = {row[0] for row in ERRORS}
    elsewhere = {
        "ambiguous-frame",
        "urdf-no-link",
        "urdf-planar-axis",
        "own-key-is-joint",
        "urdf-mesh-unreadable",
    }  # below
    elsewhere |= {code for code in REGISTRY if code.startswith(("yaml-", "file-"))}  # the tests of reading
    elsewhere |= {code for code, rule in REGISTRY.items() if rule.clause is None}  # the tests of advice
    assert set(REGISTRY) - shown - elsewhere == set()


def test_messages_are_sentences_without_full_stop(tmp_path: Path) -> None:
    for index, (_, file, old, new, _, _) in enumerate(ERRORS):
        folder = tmp_path / str(index)
        folder.mkdir()
        for found in _check(_workbench(folder, file, old, new), file).diagnostics:
            assert not re.search(r"[.\n]$", found.message), found.message
            assert found.hint is None or not re.search(r"[.\n]$", found.hint), found.hint


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


def test_link_and_its_joint_can_share_a_name(tmp_path: Path) -> None:
    body = '<inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>'
    urdf = (
        f'<robot name="r"><link name="a"/><link name="b">{body}</link>'
        '<joint name="b" type="continuous"><parent link="a"/><child link="b"/></joint></robot>'
    )
    assert _robot(tmp_path, urdf, 'extended_urdf: "2.0"\nclosures:\n  - {name: k, type: 3d, frames: [a, b]}\n').ok


def test_joint_named_like_user_key_is_warned(tmp_path: Path) -> None:
    folder = _workbench(
        tmp_path, YAML, "  stage: {limits: {velocity: 1.5}, armature: 0.02}", "  x-stage: {armature: 0.02}"
    )
    urdf = folder / URDF
    urdf.write_text(urdf.read_text(encoding="utf-8").replace('"stage"', '"x-stage"'), encoding="utf-8")
    yaml = folder / YAML
    yaml.write_text(yaml.read_text(encoding="utf-8").replace("- stage", "- x-stage"), encoding="utf-8")
    report = eurdf.check(folder / YAML)
    assert [(found.code, found.line) for found in report.diagnostics] == [("own-key-is-joint", 9)]


def test_invalid_mesh_is_refused_with_geometry(tmp_path: Path) -> None:
    folder = _workbench(tmp_path, URDF, '<box size="0.2 0.04 0.04"/>', '<mesh filename="bad.stl"/>')
    (folder / "bad.stl").write_bytes(b"no mesh")
    with pytest.raises(eurdf.InvalidRobot, match="geometry=False") as refusal:
        eurdf.load(folder / YAML)
    (error,) = refusal.value.diagnostics
    assert error.code == "urdf-mesh-unreadable"
    assert "bad.stl" in (folder / URDF).read_text(encoding="utf-8").split("\n")[error.line - 1][error.column - 1 :]
    assert eurdf.load(folder / YAML, geometry=False).model.nv > 0


def test_robot_without_links_is_reported(tmp_path: Path) -> None:
    assert [found.code for found in _robot(tmp_path, '<robot name="r"/>').diagnostics] == ["urdf-no-link"]


def test_planar_axis_other_than_z_is_warned(tmp_path: Path) -> None:
    urdf = (
        '<robot name="r"><link name="a"/><link name="b"><inertial><mass value="1"/>'
        '<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>'
        '<joint name="j" type="planar"><parent link="a"/><child link="b"/><axis xyz="1 0 0"/></joint></robot>'
    )
    report = _robot(tmp_path, urdf)
    assert [found.code for found in report.diagnostics] == ["urdf-planar-axis"]
    assert report.ok


def test_two_independent_errors_are_both_reported(tmp_path: Path) -> None:
    folder = _workbench(tmp_path, YAML, "  - motor\n", "  - moter\n")
    urdf = folder / URDF
    urdf.write_text(urdf.read_text(encoding="utf-8").replace('mass value="0.7"', 'mass value="-0.7"'), encoding="utf-8")
    assert {found.code for found in eurdf.check(folder / YAML).diagnostics} == {"unknown-actuator", "negative-mass"}
