"""Frames: what a name refers to, and its pose, whatever the description makes of the joints."""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from support.by_hand import rotation, transform
from support.described import body, codes, frame_poses, free_names, load, q_of
from support.plain_urdf import joint_element, link_element, mechanism_of, robot, trees

SHOULDER, BRACE, ELBOW = '<origin xyz="0 0 1"/>', '<origin xyz="0 0.2 0" rpy="0.3 0 0"/>', '<origin xyz="0.5 0 0"/>'
LIMIT = '<limit lower="-2" upper="2" effort="1" velocity="1"/>'

#: base -shoulder- arm -brace(fixed)- plate -pin(fixed)- stub; arm -elbow- fore; base -slide- cart
ARM = robot(
    link_element("base"),
    body("arm"),
    link_element("plate"),
    link_element("stub"),
    body("fore"),
    body("cart"),
    joint_element("shoulder", "revolute", "base", "arm", f'<axis xyz="0 0 1"/>{LIMIT}', SHOULDER),
    joint_element("brace", "fixed", "arm", "plate", "", BRACE),
    joint_element("pin", "fixed", "plate", "stub", "", BRACE),
    joint_element("elbow", "revolute", "arm", "fore", f'<axis xyz="0 1 0"/>{LIMIT}', ELBOW),
    joint_element("slide", "prismatic", "base", "cart", f'<axis xyz="1 0 0"/>{LIMIT}'),
)
_BRACE = transform(rotation((1, 0, 0), 0.3), (0, 0.2, 0))
_ARM = transform(rotation((0, 0, 1), 0.7), (0, 0, 1))
_FORE = _ARM @ transform(rotation((0, 1, 0), -0.4), (0.5, 0, 0))
_RPY = rotation((0, 0, 1), 0.3) @ rotation((0, 1, 0), 0.2) @ rotation((1, 0, 0), 0.1)
AT = {"shoulder": (0.7,), "elbow": (-0.4,), "slide": (0.1,)}

#: Of the description's frame: where it is put, its pose in the world at AT.
PLACES = [
    ("link: fore", _FORE),
    ("joint: elbow", _FORE),
    ("link: fore, xyz: [1, 2, 3]", _FORE @ transform(np.eye(3), (1, 2, 3))),
    ("joint: elbow, xyz: [1, 2, 3], rpy: [0.1, 0.2, 0.3]", _FORE @ transform(_RPY, (1, 2, 3))),
    ("link: stub, rpy: [0.1, 0.2, 0.3]", _ARM @ _BRACE @ _BRACE @ transform(_RPY, (0, 0, 0))),
    ("joint: pin, xyz: [1, 0, 0]", _ARM @ _BRACE @ _BRACE @ transform(np.eye(3), (1, 0, 0))),
    ("link: base, xyz: [1, 2, 3]", transform(np.eye(3), (1, 2, 3))),
]


@pytest.mark.parametrize(("place", "pose"), PLACES)
@pytest.mark.parametrize("root", ["fixed", "floating"])
def test_frame_is_found_by_name_at_its_pose(place: str, pose: Any, root: str) -> None:
    loaded = load(ARM, f"frames:\n  - {{name: mark, {place}}}\n", root=root)
    found = frame_poses(loaded.model, q_of(loaded, AT))
    np.testing.assert_allclose(found["mark", "other"], pose, atol=1e-12)
    assert loaded.model.frames[loaded.model.getFrameId("mark")].type == pin.FrameType.OP_FRAME


@pytest.mark.parametrize(("place", "pose"), PLACES)
@pytest.mark.parametrize("kind", ["3d", "6d"])
def test_inline_pose_equals_named_frame(place: str, pose: Any, kind: str) -> None:
    named = load(
        ARM,
        f"frames: [{{name: mark, {place}}}]\nclosures: [{{name: c, type: {kind}, frames: [mark, cart]}}]\n",
    )
    in_place = load(ARM, f"closures: [{{name: c, type: {kind}, frames: [{{{place}}}, cart]}}]\n")
    assert named.constraint_models == in_place.constraint_models
    constraint = named.constraint_models[0]
    pin.forwardKinematics(named.model, named.data, q_of(named, AT))
    oMa = named.data.oMi[constraint.joint1_id] * constraint.joint1_placement
    np.testing.assert_allclose(oMa.homogeneous, pose, atol=1e-12)


def test_closure_on_fixed_links_joins_moving_joints() -> None:
    assert codes(ARM, "closures: [{name: c, type: 6d, frames: [stub, brace]}]\n") == ["closure-same-body"]
    loaded = load(ARM, "closures: [{name: c, type: 6d, frames: [stub, fore]}]\n")
    constraint = loaded.constraint_models[0]
    assert constraint.joint1_id == loaded.model.getJointId("shoulder")
    assert constraint.joint2_id == loaded.model.getJointId("elbow")
    np.testing.assert_allclose(constraint.joint1_placement.homogeneous, _BRACE @ _BRACE, atol=1e-12)
    np.testing.assert_allclose(constraint.joint2_placement.homogeneous, np.eye(4), atol=1e-12)


def test_locking_joins_bodies_rigidly() -> None:
    closure = "closures: [{name: c, type: 3d, frames: [stub, {link: fore, xyz: [0, 0.4, 0]}]}]\n"
    assert codes(ARM, closure + "joints: {elbow: fixed}\n") == ["closure-same-body"]
    loaded = load(ARM, closure.replace("stub", "cart") + "joints: {elbow: fixed}\n")
    constraint = loaded.constraint_models[0]
    assert constraint.joint2_id == loaded.model.getJointId("shoulder")
    np.testing.assert_allclose(constraint.joint2_placement.translation, (0.5, 0.4, 0), atol=1e-12)


@pytest.mark.parametrize(
    "entry", ["spherical", "{type: universal, axes: xy}", "cylindrical", "{type: helical, pitch: 1}"]
)
def test_closure_on_replaced_joint_is_on_child_link(entry: str) -> None:
    loaded = load(ARM, f"joints: {{elbow: {entry}}}\nclosures: [{{name: c, type: 3d, frames: [elbow, cart]}}]\n")
    by_link = load(ARM, f"joints: {{elbow: {entry}}}\nclosures: [{{name: c, type: 3d, frames: [fore, cart]}}]\n")
    assert loaded.constraint_models == by_link.constraint_models


def test_frames_can_be_on_created_joints() -> None:
    wrist = '<axis xyz="{}"/>' + LIMIT
    urdf = robot(
        link_element("base"),
        link_element("a"),
        link_element("b"),
        body("hand"),
        body("cart"),
        joint_element("x", "revolute", "base", "a", wrist.format("1 0 0"), '<origin xyz="0 0 1"/>'),
        joint_element("y", "revolute", "a", "b", wrist.format("0 1 0"), '<origin xyz="0 1 0"/>'),
        joint_element("z", "revolute", "b", "hand", wrist.format("0 0 1"), '<origin xyz="0 -1 1"/>'),
        joint_element("slide", "prismatic", "base", "cart", wrist.format("1 0 0")),
    )
    entry = "joints: {ball: {type: spherical, merges: [x, y, z]}}\n"
    for name in ("ball", "z", "hand"):
        loaded = load(
            urdf,
            f"{entry}frames: [{{name: mark, joint: {'ball' if name == 'hand' else name}, xyz: [0, 0, 3]}}]\n"
            f"closures: [{{name: c, type: 3d, frames: [{name}, cart]}}]\n",
        )
        found = frame_poses(loaded.model, pin.neutral(loaded.model))
        np.testing.assert_allclose(found["mark", "other"][:3, 3], (0, 0, 5), atol=1e-12)
        constraint = loaded.constraint_models[0]
        oMa = loaded.model.jointPlacements[constraint.joint1_id] * constraint.joint1_placement
        np.testing.assert_allclose(oMa.translation, (0, 0, 2), atol=1e-12)


def test_failed_joint_is_reported_once() -> None:
    yaml = (
        "joints: {ball: {type: spherical, merges: [shoulder, elbow, slide]}}\n"
        "frames: [{name: mark, joint: ball}]\nactuators: [ball]\nconfigurations: {ready: {ball: [0, 0, 0, 1]}}\n"
        "closures: [{name: c, type: 3d, frames: [ball, cart]}, {name: d, type: 3d, frames: [mark, cart]}]\n"
    )
    assert codes(ARM, yaml) == ["merge-not-chain"]


@settings(max_examples=40, deadline=None)
@given(st.data(), trees(), st.integers(0, 2**32 - 1))
def test_random_frames_have_expected_poses(data: st.DataObject, urdf: str, seed: int) -> None:
    mechanism = mechanism_of(urdf)
    names = free_names(mechanism)
    places = [("link", found.name, found.name) for found in mechanism.bodies]
    places += [("joint", found.name, found.child) for found in mechanism.joints]
    kind, name, link = data.draw(st.sampled_from(places))
    locked = data.draw(st.sampled_from([None, *names]))
    xyz, angle = data.draw(st.tuples(*[st.floats(-2, 2)] * 3)), data.draw(st.floats(-3, 3))
    loaded = load(
        urdf,
        f"frames: [{{name: mark, {kind}: {name}, xyz: {list(xyz)}, rpy: [0, 0, {angle}]}}]\n"
        + (f"joints: {{{locked}: fixed}}\n" if locked else ""),
    )
    pin.seed(seed % 2**31)
    q = pin.randomConfiguration(loaded.model, -np.ones(loaded.model.nq), np.ones(loaded.model.nq))
    found = frame_poses(loaded.model, q)
    expected = found[link, "link"] @ transform(rotation((0, 0, 1), angle), xyz)
    np.testing.assert_allclose(found["mark", "other"], expected, atol=1e-12)


@pytest.mark.parametrize(
    ("entry", "error"),
    [
        ("{name: base, link: arm}", "duplicate-frame"),
        ("{name: elbow, link: arm}", "duplicate-frame"),
        ("{name: twice, link: arm}, {name: twice, link: fore}", "duplicate-frame"),
        ("{name: universe, link: arm}", "urdf-reserved-name"),
        ("{name: mark, link: elbow}", "unknown-frame"),
        ("{name: mark, joint: fore}", "unknown-frame"),
    ],
)
def test_frame_has_own_name_and_place(entry: str, error: str) -> None:
    assert codes(ARM, f"frames: [{entry}]\n") == [error]


def test_frame_cannot_be_named_root_joint() -> None:
    yaml = "frames: [{name: root_joint, link: arm}]\n"
    assert codes(ARM, yaml) == []
    assert codes(ARM, "root: floating\n" + yaml) == ["urdf-reserved-name"]
