"""Three revolute joints whose axes meet in one point become one spherical joint."""

from __future__ import annotations

import math
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import eurdf
from support.by_hand import rotation
from support.described import (
    at,
    body,
    codes,
    frame_poses,
    link_poses,
    load,
    mass_matrix,
    origin,
    q_of,
    revolute,
    written,
)
from support.plain_urdf import inertial, joint_element, link_element, robot

ANGLES = st.floats(-3.0, 3.0)


class Wrist:
    """base -(x)- one -(y)- two -(z)- hand -(grip)- finger, with the axes, joint frames and origins given at zero.

    Attributes:
        oMj: Pose of each of the three joints in the base at zero.
        axes: Unit vectors of the axes, in the base at zero.
        urdf: The text.
    """

    NAMES = ("x", "y", "z")

    def __init__(self, oMj: list[Any], axes: list[Any], joints: tuple[str, ...] = NAMES) -> None:
        self.oMj = oMj
        self.axes = [axis / np.linalg.norm(axis) for axis in axes]
        links = ("base", "one", "two", "hand")
        before = [pin.SE3.Identity(), *oMj]
        elements = [
            revolute(name, links[k], links[k + 1], oMj[k].rotation.T @ axes[k], origin(before[k].actInv(oMj[k])))
            for k, name in enumerate(joints)
        ]
        grip = revolute("grip", "hand", "finger", (1, 2, 3), '<origin xyz="0.1 0.2 0.3" rpy="1 2 3"/>')
        shape = "<visual><geometry><sphere radius='0.1'/></geometry></visual>"
        tiny = inertial(9e-6, moments=(0.0,) * 6)
        self.urdf = robot(
            body("base"),
            link_element("one", shape),
            link_element("two", tiny),
            body("hand", shape),
            body("finger"),
            *elements,
            grip,
        )

    def quaternion(self, angles: Any) -> tuple[float, ...]:
        """The quaternion of R(x, a) R(y, b) R(z, c), about the axes as they are in the last joint's frame at zero."""
        R = np.eye(3)
        for axis, angle in zip(self.axes, angles, strict=True):
            R = R @ rotation(self.oMj[2].rotation.T @ axis, angle)
        return tuple(pin.Quaternion(R).coeffs().tolist())

    def angular(self, angles: Any) -> Any:
        """Columns: the angular velocity, seen from the hand, for unit velocity of each of the three joints."""
        w = [self.oMj[2].rotation.T @ axis for axis in self.axes]
        after_z = rotation(w[2], angles[2]).T
        return np.array([after_z @ rotation(w[1], angles[1]).T @ w[0], after_z @ w[1], w[2]]).T


@st.composite
def wrists(draw: st.DrawFn) -> Wrist:
    """Orthogonal or skew axes through one point, each joint's origin anywhere on its axis, its frame turned anyhow."""
    numbers = st.floats(-1.0, 1.0).map(lambda x: round(x, 3))
    vectors = st.tuples(numbers, numbers, numbers).map(np.array)
    turn = pin.exp3(2.0 * draw(vectors))
    axes = list(turn.T)
    if draw(st.booleans()):
        axes = [axis + 0.4 * draw(vectors) for axis in axes]
        units = [axis / np.linalg.norm(axis) for axis in axes]
        assume(all(np.linalg.norm(np.cross(units[i], units[j])) > 0.1 for i, j in ((0, 1), (0, 2), (1, 2))))
    point = draw(vectors)
    usual = st.sampled_from([(0.0, 0.0, 0.0), (0.0, 0.0, 0.4), (0.2, -0.3, 0.0)])
    along = draw(usual | st.tuples(numbers, numbers, numbers))
    along = [distance if abs(distance) > 1e-2 else 0.0 for distance in along]
    order = draw(st.permutations(range(3)))
    return Wrist(
        [pin.SE3(pin.exp3(2.0 * draw(vectors)), point + along[k] * axes[order[k]]) for k in range(3)],
        [axes[order[k]] for k in range(3)],
    )


MERGE = "joints: {{{}: {{type: spherical, merges: [x, y, z]}}}}\n"


@settings(max_examples=80, deadline=None)
@given(
    wrists(),
    st.tuples(ANGLES, ANGLES, ANGLES),
    ANGLES,
    st.sampled_from([MERGE.format("ball"), MERGE.format("z"), "note: version 1\n"]),
    st.sampled_from(["fixed", "floating"]),
)
def test_merged_ball_moves_descendants_as_three_revolutes(
    wrist: Wrist, angles: Any, grip: float, yaml: str, root: Any
) -> None:
    plain, merged = load(wrist.urdf, root=root), load(wrist.urdf, yaml, root=root)
    name = "ball" if "ball" in yaml else "z"
    assert at(merged.model, name)[1::2] == (4, 3)
    q_plain = q_of(plain, {**{k: (v,) for k, v in zip("xyz", angles, strict=True)}, "grip": (grip,)})
    q = q_of(merged, {name: wrist.quaternion(angles), "grip": (grip,)})
    before, after = frame_poses(plain.model, q_plain), frame_poses(merged.model, q)
    zero = frame_poses(plain.model, pin.neutral(plain.model))
    for frame in (("hand", "link"), ("z", "other"), ("finger", "link"), ("grip", "other")):
        np.testing.assert_allclose(after[frame], before[frame], atol=1e-9)
    np.testing.assert_allclose(after[name, "other"], before["z", "other"], atol=1e-9)
    for frame in (("base", "link"), ("one", "link"), ("x", "other"), ("two", "link"), ("y", "other")):
        np.testing.assert_allclose(after[frame], zero[frame], atol=1e-12)


@settings(max_examples=30, deadline=None)
@given(wrists(), st.tuples(ANGLES, ANGLES, ANGLES), ANGLES)
def test_merged_ball_carries_same_inertia(wrist: Wrist, angles: Any, grip: float) -> None:
    """M_plain = Tᵀ M T, where T takes the three joints' velocities to the angular velocity; all mass is kept."""
    # What weighs in between stays behind in one model, and moves in the other.
    urdf = wrist.urdf.replace('"9e-06"', '"0"')
    plain, merged = load(urdf), load(urdf, MERGE.format("ball"))
    q_plain = q_of(plain, {**{k: (v,) for k, v in zip("xyz", angles, strict=True)}, "grip": (grip,)})
    q = q_of(merged, {"ball": wrist.quaternion(angles), "grip": (grip,)})
    T = np.zeros((4, 4))
    T[:3, :3], T[3, 3] = wrist.angular(angles), 1.0
    np.testing.assert_allclose(T.T @ mass_matrix(merged.model, q) @ T, mass_matrix(plain.model, q_plain), atol=1e-8)
    heavy = [load(wrist.urdf, yaml, root="floating").model for yaml in ("", MERGE.format("ball"))]
    assert pin.computeTotalMass(heavy[1]) == pytest.approx(pin.computeTotalMass(heavy[0]), rel=1e-12)


# -- what a merged joint keeps ----------------------------------------------------------------------------------------


def _joint(name: str, parent: str, child: str, axis: str, number: int, kind: str = "revolute", origin: str = "") -> str:
    content = (
        f'<axis xyz="{axis}"/><limit lower="-1" upper="1" effort="{number}" velocity="{10 + number}"/>'
        f'<dynamics damping="{20 + number}" friction="{30 + number}"/>'
    )
    return joint_element(name, kind, parent, child, content, origin)


def _chain(
    *axes: str, between: str = "", kinds: tuple[str, ...] = (), origins: tuple[str, ...] = (), more: str = ""
) -> str:
    """base -(j1)- l1 -(j2)- l2 - … with one joint for each axis; the last link has mass, those in between are given."""
    n = len(axes)
    links = ["base", *(f"l{k}" for k in range(1, n + 1))]
    elements = [body("base"), *(link_element(link, between) for link in links[1:-1]), body(links[-1])]
    elements += [
        _joint(
            f"j{k + 1}",
            links[k],
            links[k + 1],
            axes[k],
            k + 1,
            kinds[k] if kinds else "revolute",
            origins[k] if origins else "",
        )
        for k in range(n)
    ]
    return robot(*elements, more)


X, Y, Z = "1 0 0", "0 1 0", "0 0 1"


@pytest.mark.parametrize(
    ("axes", "order"),
    [
        ((X, Y, Z), (1, 2, 3)),
        ((Z, X, Y), (2, 3, 1)),
        (("0 0 -2", Y, X), (3, 2, 1)),
        (("0.9 0.1 0.2", "0.1 0.2 -0.9", "0 3 0"), (1, 3, 2)),
        # The first two are both nearest to x; together, the second is nearer to y than the first is.
        (("1 0 0", "0.8 0.6 0", "0 0 1"), (1, 2, 3)),
        (("0.8 0.6 0", "1 0 0", "0 0 1"), (2, 1, 3)),
        (("0 0 -5e-324", "0 3e-170 0", "1e15 0 1e15"), (3, 2, 1)),
    ],
)
def test_ball_axes_keep_properties_of_nearest_revolutes(axes: Any, order: tuple[int, ...]) -> None:
    model = load(_chain(*axes), "joints: {ball: {type: spherical, merges: [j1, j2, j3]}}\n").model
    _, _, v, _ = at(model, "ball")
    assert model.upperEffortLimit[v : v + 3].tolist() == list(order)
    assert model.upperVelocityLimit[v : v + 3].tolist() == [10 + number for number in order]
    assert model.damping[v : v + 3].tolist() == [20 + number for number in order]
    assert model.upperDryFrictionLimit[v : v + 3].tolist() == [30 + number for number in order]


def test_axes_are_in_last_frame_at_zero() -> None:
    quarter = f'<origin rpy="0 0 {math.pi / 2}"/>'  # x of the last frame is y of the base
    urdf = _chain(X, Y, Z, origins=("", "", quarter))
    model = load(urdf, "joints: {ball: {type: spherical, merges: [j1, j2, j3]}}\n").model
    _, _, v, _ = at(model, "ball")
    assert model.upperEffortLimit[v : v + 3].tolist() == [2, 1, 3]


def test_stated_properties_replace_kept_ones() -> None:
    stated = "limits: {effort: 9, velocity: [1, 2, 3]}, damping: 0, armature: 0.1"
    yaml = f"joints: {{ball: {{type: spherical, merges: [j1, j2, j3], {stated}}}}}\n"
    model = load(_chain(X, Y, Z), yaml).model
    _, _, v, _ = at(model, "ball")
    assert model.upperEffortLimit[v : v + 3].tolist() == [9, 9, 9]
    assert model.upperVelocityLimit[v : v + 3].tolist() == [1, 2, 3]
    assert model.damping[v : v + 3].tolist() == [0, 0, 0]
    assert model.armature[v : v + 3].tolist() == [0.1, 0.1, 0.1]
    assert model.upperDryFrictionLimit[v : v + 3].tolist() == [31, 32, 33]


@pytest.mark.parametrize(
    "stated",
    ["damping: [0.1, 0.2]", "friction: [1]", "armature: [1, 2]", "limits: {effort: [1]}", "limits: {lower: 0}"],
)
@pytest.mark.parametrize("of", ["ball", "j3"])
@pytest.mark.parametrize("frame", ["base", "l3", "ball", "j3"])
def test_invalid_property_of_merged_ball_is_the_only_error(stated: str, of: str, frame: str) -> None:
    """What else names the ball, its links or the joints that it replaces is checked against the ball."""
    urdf = _chain(X, Y, Z)
    yaml = (
        f"joints: {{{of}: {{type: spherical, merges: [j1, j2, j3], {stated}}}}}\n"
        f"closures: [{{name: c, type: 3d, frames: [{frame}, {{link: l3, xyz: [0.1, 0.2, 0.3]}}]}}]\n"
        f"actuators: [{of}]\nconfigurations: {{bent: {{{of}: [0, 0, 0, 1]}}}}\n"
    )
    found = [code for code in codes(urdf, yaml) if not code.startswith("x-")]
    assert "joint-property" in found
    sound = yaml.replace(f", {stated}", "")
    assert set(found) - {"joint-property"} <= set(codes(urdf, sound))


def test_continuous_joints_merge_on_request() -> None:
    urdf = _chain(X, Y, Z, kinds=("continuous", "revolute", "continuous"))
    assert load(urdf, "joints: {j3: {type: spherical, merges: [j1, j2, j3]}}\n").model.nv == 3


def test_geometry_before_ball_stays_and_after_moves() -> None:
    wrist = Wrist([pin.SE3.Identity()] * 3, [np.eye(3)[k] for k in range(3)])
    merged = load(wrist.urdf, MERGE.format("ball"), geometry=True)
    assert merged.visual_model.getGeometryId("one_0") < merged.visual_model.ngeoms
    objects = {found.name: found for found in merged.visual_model.geometryObjects}
    assert objects["one_0"].parentJoint == 0
    assert objects["hand_0"].parentJoint == merged.model.getJointId("ball")


def test_merged_joints_and_links_are_found_by_name() -> None:
    model = load(_chain(X, Y, Z), "joints: {ball: {type: spherical, merges: [j1, j2, j3]}}\n").model
    names = [frame.name for frame in model.frames]
    for name in ("base", "l1", "l2", "l3", "j1", "j2", "j3", "ball"):
        assert names.count(name) == 1, name
    assert model.frames[model.getFrameId("ball")].type == pin.FrameType.JOINT


# -- what version 1 merges by itself ----------------------------------------------------------------------------------


def _joints(urdf: str, yaml: str = "note: version 1\n") -> dict[str, str]:
    model = load(urdf, yaml).model
    return {
        name: joint.shortname().removeprefix("JointModel")[:9]
        for name, joint in zip(model.names, model.joints, strict=True)
        if name != "universe"
    }


@pytest.mark.parametrize(
    ("axes", "joints"),
    [
        ((X, Y), {"j1": "RX", "j2": "RY"}),
        ((X, Y, Z), {"j3": "Spherical"}),
        ((X, Y, Z, X), {"j3": "Spherical", "j4": "RX"}),
        ((X, Y, Z, X, Y), {"j3": "Spherical", "j4": "RX", "j5": "RY"}),
        ((X, Y, Z, X, Y, Z), {"j3": "Spherical", "j6": "Spherical"}),
        ((X, X, Y, Z), {"j1": "RX", "j4": "Spherical"}),
        ((X, Y, X, Z), {"j1": "RX", "j4": "Spherical"}),
    ],
)
def test_version_1_merges_three_from_the_root(axes: Any, joints: dict[str, str]) -> None:
    assert _joints(_chain(*axes)) == joints


def test_version_2_merges_nothing_by_itself() -> None:
    assert load(_chain(X, Y, Z), "metadata: {}\n").model.nq == 3
    assert load(_chain(X, Y, Z)).model.nq == 3


def _moved(distance: float) -> tuple[str, ...]:
    return ("", "", f'<origin xyz="{distance} 0 0"/>')


_LIMIT = '<limit effort="1" velocity="1" lower="-1" upper="1"/>'
_MIMIC = '<mimic joint="{}"/>' + _LIMIT
_SIDE = body("side")

#: title: URDF, description of version 1
NOT_MERGED = {
    "one of them is continuous": (_chain(X, Y, Z, kinds=("revolute", "continuous", "revolute")), ""),
    "one of them is locked": (_chain(X, Y, Z), "joint_name: [j2]\njoint_type: [FIXED]\n"),
    "one of them is split": (_chain(X, Y, Z), "joint_name: [j2]\njoint_type: [UJOINT_XY]\n"),
    "a link between carries a frame of a closure": (
        _chain(X, Y, Z, more=_SIDE + joint_element("s", "continuous", "base", "side", "")),
        "closed_loop: [[l2, side]]\n",
    ),
    "a link between carries, as a joint, a frame of a closure": (
        _chain(X, Y, Z, more=_SIDE + joint_element("s", "continuous", "base", "side", "")),
        "closed_loop: [[side, j1]]\n",
    ),
    "a link between weighs 1e-5 kg": (_chain(X, Y, Z, between=inertial(1e-5)), ""),
    "a link between carries another joint": (
        _chain(X, Y, Z, more=_SIDE + joint_element("s", "fixed", "l1", "side", "")),
        "",
    ),
    "two axes are parallel": (_chain(X, Y, "-2 0 0"), ""),
    "the axes pass one another by more than 0.1 mm": (_chain(X, Y, Z, origins=_moved(4e-4)), ""),
}


@pytest.mark.parametrize("title", NOT_MERGED)
def test_version_1_keeps_three_revolutes_if(title: str) -> None:
    urdf, yaml = NOT_MERGED[title]
    joints = _joints(urdf, yaml or "note: none\n")
    assert "Spherical" not in joints.values()
    assert "j1" in joints
    assert "j3" in joints


#: title: URDF, description of version 1
MERGED = {
    "one of them mimics": (
        _chain(X, Y, Z).replace(
            _joint("j2", "l1", "l2", Y, 2),
            joint_element("j2", "revolute", "l1", "l2", f'<axis xyz="{Y}"/>' + _MIMIC.format("j1")),
        ),
        "",
    ),
    "one of them mimics a joint beside them": (
        _chain(X, Y, Z, more=_SIDE + joint_element("s", "revolute", "base", "side", _LIMIT)).replace(
            _joint("j2", "l1", "l2", Y, 2),
            joint_element("j2", "revolute", "l1", "l2", f'<axis xyz="{Y}"/>' + _MIMIC.format("s")),
        ),
        "",
    ),
    "one of them is mimicked": (
        _chain(X, Y, Z, more=_SIDE + joint_element("s", "revolute", "l3", "side", _MIMIC.format("j1"))),
        "",
    ),
    "a link between weighs less than 1e-5 kg": (_chain(X, Y, Z, between=inertial(0.99e-5)), ""),
    "the axes pass one another by less than 0.1 mm": (_chain(X, Y, Z, origins=_moved(1e-4)), ""),
    "the link beyond carries two joints and a frame of a closure": (
        _chain(
            X,
            Y,
            Z,
            more="".join(body(f"s{k}") + joint_element(f"k{k}", "continuous", "l3", f"s{k}", "") for k in (1, 2)),
        ),
        "closed_loop: [[base, l3]]\ntype: [3d]\n",
    ),
    "the body before carries other joints": (
        _chain(X, Y, Z, more=_SIDE + joint_element("s", "continuous", "base", "side", "")),
        "closed_loop: [[base, side]]\ntype: [3d]\n",
    ),
    "a joint that is not of the three is listed": (
        _chain(X, Y, Z, more=_SIDE + joint_element("s", "continuous", "l3", "side", "")),
        "joint_name: [s]\njoint_type: [SPHERICAL]\n",
    ),
}


@pytest.mark.parametrize("title", MERGED)
def test_version_1_merges_three_revolutes_even_if(title: str) -> None:
    urdf, yaml = MERGED[title]
    assert _joints(urdf, yaml or "note: none\n")["j3"] == "Spherical"


def test_merged_joint_cannot_be_actuated() -> None:
    assert codes(_chain(X, Y, Z), "name_mot: [j2]\n") == ["actuator-merged"]
    assert load(_chain(X, Y, Z), "name_mot: [j3]\n").actuation.idx_v.tolist() == [0, 1, 2]


# -- said twice, said wrongly -----------------------------------------------------------------------------------------

_BALL = "ball: {type: spherical, merges: [j1, j2, j3]}"


@pytest.mark.parametrize("joint", ["j1", "j2", "j3"])
@pytest.mark.parametrize("entry", ["fixed", "spherical", "{armature: 1}"])
@pytest.mark.parametrize("first", [True, False])
def test_merged_joint_cannot_be_changed(joint: str, entry: str, first: bool) -> None:
    entries = [f"  {joint}: {entry}\n", f"  {_BALL}\n"]
    yaml = "joints:\n" + "".join(entries if first else reversed(entries))
    assert codes(_chain(X, Y, Z), yaml) == ["duplicate-replacement"]


@pytest.mark.parametrize("last", ["j3", "ball"])
def test_joint_is_merged_once(last: str) -> None:
    entries = {last: "[j1, j2, j3]", "other": "[j3, j4, j5]"}
    yaml = "joints:\n" + "".join(f"  {name}: {{type: spherical, merges: {of}}}\n" for name, of in entries.items())
    assert codes(_chain(X, Y, Z, X, Y), yaml) == ["duplicate-replacement"]


@pytest.mark.parametrize(
    ("name", "root", "error"),
    [
        ("j3", "fixed", []),
        ("ball", "fixed", []),
        ("l3", "fixed", []),
        ("j1", "fixed", ["duplicate-joint-name"]),
        ("j4", "fixed", ["duplicate-joint-name"]),
        ("universe", "fixed", ["urdf-reserved-name"]),
        ("root_joint", "fixed", []),
        ("root_joint", "floating", ["urdf-reserved-name"]),
    ],
)
def test_merged_joint_can_have_any_free_name(name: str, root: str, error: list[str]) -> None:
    yaml = f"root: {root}\njoints: {{{name}: {{type: spherical, merges: [j1, j2, j3]}}}}\n"
    assert codes(_chain(X, Y, Z, X), yaml) == error


def test_links_around_offset_ball_match_plain_urdf() -> None:
    """The axes meet at (1, 0, 0); the origins are elsewhere on them, and the hand is 2 m along the last one."""
    urdf = _chain(
        X,
        Y,
        Z,
        origins=("", '<origin xyz="1 3 0"/>', '<origin xyz="0 -3 2"/>'),
    )
    merged = load(urdf, "joints: {ball: {type: spherical, merges: [j1, j2, j3]}}\n")
    half = math.sqrt(0.5)
    found = link_poses(merged.model, q_of(merged, {"ball": (half, 0, 0, half)}))  # a quarter turn about x
    np.testing.assert_allclose(found["l3"][:3, 3], (1, -2, 0), atol=1e-12)
    np.testing.assert_allclose(found["l3"][:3, :3], rotation((1, 0, 0), math.pi / 2), atol=1e-12)
    np.testing.assert_allclose(found["l2"][:3, 3], (1, 3, 0), atol=1e-12)
    assert merged.model.jointPlacements[1].translation == pytest.approx(np.array((1, 0, 0)), abs=1e-12)


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
def test_only_remaining_joints_need_ranges(yaml: str, without: list[str]) -> None:
    wrist = Wrist([pin.SE3.Identity()] * 3, [np.eye(3)[k] for k in range(3)])
    urdf = wrist.urdf.replace('lower="-3" upper="3" ', "")
    with tempfile.TemporaryDirectory() as folder:
        found = eurdf.check(written(Path(folder), urdf, yaml)).diagnostics
        told = [each.message for each in found if each.code == "urdf-no-range"]
    if not without:
        assert told == []
        return
    count = "1 joint has" if len(without) == 1 else f"{len(without)} joints have"
    named = ", ".join(f"'{name}'" for name in without[:3]) + (", ..." if len(without) > 3 else "")
    assert told == [f"{count} the position limits 0 and 0: {named}"]
