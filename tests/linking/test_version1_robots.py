"""What version 1, the published dialect, makes of a robot."""

from __future__ import annotations

import itertools
import math
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

from support.by_hand import rotation, transform
from support.described import at, body, codes, frame_poses, load, q_of
from support.plain_urdf import joint_element, link_element, robot

AXES = {"X": (1, 0, 0), "Y": (0, 1, 0), "Z": (0, 0, 1)}
PAIRS = ["".join(pair) for pair in itertools.permutations("XYZ", 2)]
ORIGIN = '<origin xyz="0.1 0.2 0.3" rpy="0 0 0.5"/>'
PLACEMENT = transform(rotation((0, 0, 1), 0.5), (0.1, 0.2, 0.3))
CONTENT = (
    '<axis xyz="0.6 0 0.8"/><limit lower="-0.5" upper="0.7" effort="3" velocity="4"/>'
    '<dynamics damping="5" friction="6"/>'
)


def _arm(kind: str = "revolute", arm: str = "arm", more: str = "") -> str:
    shape = "<visual><geometry><sphere radius='0.1'/></geometry></visual>"
    return robot(
        link_element("base"),
        body(arm, shape),
        body("cart"),
        joint_element("j", kind, "base", arm, CONTENT, ORIGIN),
        joint_element("slide", "prismatic", "base", "cart", CONTENT),
        more,
    )


def _universal(letters: str) -> str:
    return f"joint_name: [j]\njoint_type: [UJOINT_{letters}]\n"


@pytest.mark.parametrize("letters", PAIRS)
@pytest.mark.parametrize("root", ["fixed", "floating"])
def test_universal_joint_is_two_revolutes_about_frame_axes(letters: str, root: str) -> None:
    loaded = load(_arm(), _universal(letters), root=root)
    first, second = f"j_{letters[0]}", f"j_{letters[1]}"
    assert [name for name in loaded.model.names if name.startswith("j")] == [first, second]
    found = frame_poses(loaded.model, q_of(loaded, {first: (0.4,), second: (-0.3,)}))
    half = PLACEMENT @ transform(rotation(AXES[letters[0]], 0.4), (0, 0, 0))
    arm = half @ transform(rotation(AXES[letters[1]], -0.3), (0, 0, 0))
    np.testing.assert_allclose(found[first, "other"], half, atol=1e-12)
    for name in ((second, "other"), ("j", "other"), ("arm", "link")):
        np.testing.assert_allclose(found[name], arm, atol=1e-12)


def test_both_halves_have_limits_and_dynamics() -> None:
    model = load(_arm(), _universal("ZX")).model
    for name in ("j_Z", "j_X"):
        q, _, v, _ = at(model, name)
        assert (model.lowerPositionLimit[q], model.upperPositionLimit[q]) == (-0.5, 0.7)
        assert (model.upperEffortLimit[v], model.upperVelocityLimit[v]) == (3, 4)
        assert (model.damping[v], model.upperDryFrictionLimit[v]) == (5, 6)


def test_continuous_joint_becomes_two_continuous_joints() -> None:
    model = load(_arm("continuous"), _universal("ZX")).model
    assert [model.joints[model.getJointId(name)].shortname() for name in ("j_Z", "j_X")] == [
        "JointModelRUBZ",
        "JointModelRUBX",
    ]


@pytest.mark.parametrize("letters", PAIRS)
def test_versions_1_and_2_move_alike(letters: str) -> None:
    one = load(_arm(), _universal(letters))
    two = load(_arm(), f"joints: {{j: {{type: universal, axes: {letters.lower()}}}}}\n")
    q_one = q_of(one, {f"j_{letters[0]}": (0.4,), f"j_{letters[1]}": (-0.3,), "slide": (0.2,)})
    q_two = q_of(two, {"j": (0.4, -0.3), "slide": (0.2,)})
    before, after = frame_poses(one.model, q_one), frame_poses(two.model, q_two)
    for name in set(before) & set(after):
        np.testing.assert_allclose(after[name], before[name], atol=1e-12)
    M_one, M_two = pin.crba(one.model, one.data, q_one), pin.crba(two.model, two.data, q_two)
    np.testing.assert_allclose(M_one, M_two, atol=1e-12)
    np.testing.assert_array_equal(one.model.upperEffortLimit, two.model.upperEffortLimit)
    np.testing.assert_array_equal(one.model.lowerPositionLimit, two.model.lowerPositionLimit)


def test_geometry_and_mass_are_on_second_half() -> None:
    loaded = load(_arm(), _universal("XY"), geometry=True)
    second = loaded.model.getJointId("j_Y")
    assert loaded.visual_model.geometryObjects[0].parentJoint == second
    assert loaded.model.inertias[second].mass == pytest.approx(0.7)
    assert loaded.model.inertias[loaded.model.getJointId("j_X")].mass == 0


def test_intermediate_body_is_no_link() -> None:
    loaded = load(_arm(), _universal("XY"))
    links = {frame.name for frame in loaded.model.frames if frame.type == pin.FrameType.BODY}
    assert links == {"base", "arm", "cart"}


@pytest.mark.parametrize(("frame", "joint"), [("j", "j_Y"), ("arm", "j_Y"), ("j_Y", "j_Y"), ("j_X", "j_X")])
def test_closure_can_be_on_any_universal_frame(frame: str, joint: str) -> None:
    loaded = load(_arm(), f"closed_loop: [[{frame}, cart]]\n" + _universal("XY"))
    constraint = loaded.constraint_models[0]
    assert loaded.model.names[constraint.joint1_id] == joint
    np.testing.assert_allclose(constraint.joint1_placement.homogeneous, np.eye(4), atol=0)


def test_universal_halves_are_actuated_separately() -> None:
    loaded = load(_arm(), "name_mot: [slide, j_Y, j_X]\n" + _universal("XY"))
    assert loaded.actuation.joints == ("slide", "j_Y", "j_X")
    assert loaded.actuation.idx_v.tolist() == [at(loaded.model, name)[2] for name in ("slide", "j_Y", "j_X")]
    assert codes(_arm(), "name_mot: [j]\n" + _universal("XY")) == ["unknown-actuator"]


def test_link_can_have_name_of_unused_half() -> None:
    urdf = _arm(arm="j_X")
    assert codes(urdf, _universal("XY")) == []
    loaded = load(urdf, _universal("XY"))
    found = frame_poses(loaded.model, q_of(loaded, {"j_X": (0.4,), "j_Y": (0.2,)}))
    turned = rotation((1, 0, 0), 0.4) @ rotation((0, 1, 0), 0.2)
    np.testing.assert_allclose(found["j_X", "link"], PLACEMENT @ transform(turned, (0, 0, 0)), atol=1e-12)
    assert codes(urdf, "closed_loop: [[j_X, cart]]\n" + _universal("XY")) == ["ambiguous-frame"]


def test_half_cannot_have_name_of_other_joint() -> None:
    more = body("side") + joint_element("j_Y", "revolute", "base", "side", CONTENT)
    assert codes(_arm(more=more), _universal("XY")) == ["duplicate-joint-name"]
    assert codes(_arm(more=more), "name_mot: [j_X]\n" + _universal("XY")) == ["duplicate-joint-name"]
    assert codes(_arm(more=more), _universal("XZ")) == []


@pytest.mark.parametrize("kind", ["revolute", "continuous"])
def test_spherical_is_a_ball_at_joint_origin(kind: str) -> None:
    loaded = load(_arm(kind), "joint_name: [j]\njoint_type: [SPHERICAL]\n")
    half = math.sqrt(0.5)
    found = frame_poses(loaded.model, q_of(loaded, {"j": (0, half, 0, half)}))
    quarter = transform(rotation((0, 1, 0), math.pi / 2), (0, 0, 0))
    np.testing.assert_allclose(found["arm", "link"], PLACEMENT @ quarter, atol=1e-12)


@pytest.mark.parametrize("kind", ["revolute", "continuous", "prismatic"])
def test_fixed_locks_joint_at_zero(kind: str) -> None:
    loaded = load(_arm(kind), "joint_name: [j]\njoint_type: [FIXED]\n")
    assert (loaded.model.nv, loaded.model.names.tolist()) == (1, ["universe", "slide"])
    found = frame_poses(loaded.model, np.zeros(1))
    np.testing.assert_allclose(found["j", "other"], PLACEMENT, atol=1e-12)


@pytest.mark.parametrize(
    ("kind", "new", "found"),
    [
        ("prismatic", "SPHERICAL", "joint-kind"),
        ("prismatic", "UJOINT_XY", "joint-kind"),
        ("floating", "SPHERICAL", "joint-kind"),
        ("planar", "UJOINT_XY", "joint-kind"),
        ("fixed", "FIXED", "joint-kind"),
    ],
)
def test_impossible_replacement_is_reported_once(kind: str, new: str, found: str) -> None:
    yaml = f"name_mot: [j{new[-3:-1] if 'UJ' in new else ''}]\njoint_name: [j]\njoint_type: [{new}]\n"
    assert [code for code in codes(_arm(kind), yaml) if code != "urdf-planar-axis"] == [found]


def test_closure_types_ignore_case_and_names_are_numbered() -> None:
    loops = "closed_loop: [[arm, cart], [j, base], [cart, base]]\n"
    loaded = load(_arm(), loops + "type: [3d, 6D, 3D]\n")
    assert [(found.name, found.residualSize()) for found in loaded.constraint_models] == [
        ("closure_1", 3),
        ("closure_2", 6),
        ("closure_3", 3),
    ]
    assert [found.residualSize() for found in load(_arm(), loops).constraint_models] == [6, 6, 6]


def test_root_is_fixed_unless_given() -> None:
    assert load(_arm(), "name_mot: [j]\n").model.nv == 2
    assert load(_arm(), "name_mot: [j]\n", root="floating").model.nv == 8


def test_empty_description_keeps_plain_urdf() -> None:
    text: Any = _arm()
    assert load(text, "note: mine\n").model == pin.buildModelFromXML(text, mimic=True)
    assert load(text, "note: mine\n").mechanism.own_data == {"/note": "mine"}
