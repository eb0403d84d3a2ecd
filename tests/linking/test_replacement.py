"""What a joint becomes where the description gives it another type, or other properties."""

from __future__ import annotations

import math
import re
from typing import Any

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import eurdf
from eurdf.mechanism.joint import Joint
from eurdf.mechanism.joint_types import JointType
from support.by_hand import quaternion_rotation, rotation, transform
from support.described import at, body, codes, frame_poses, free_names, link_poses, load, mass_matrix, q_of
from support.plain_urdf import Root, inertial, joint_element, link_element, mechanism_of, pinocchios_own, robot, trees

INF = math.inf
ROOTS: st.SearchStrategy[Root] = st.sampled_from(["fixed", "floating"])

XYZ, RPY = (0.3, -0.2, 0.5), (0.4, -0.7, 1.1)
AXIS = (0.6, 0.0, 0.8)


def _arm(kind: str) -> str:
    """base, joint j of a kind, arm, and what must stay as it is: a fixed tip on the arm and a joint behind it."""
    origin = f'<origin xyz="{XYZ[0]} {XYZ[1]} {XYZ[2]}" rpy="{RPY[0]} {RPY[1]} {RPY[2]}"/>'
    limit = "" if kind == "continuous" else 'lower="-0.4" upper="0.6" '
    content = (
        f'<axis xyz="{AXIS[0]} {AXIS[1]} {AXIS[2]}"/><limit {limit}effort="7" velocity="5"/>'
        '<dynamics damping="0.3" friction="0.2"/>'
    )
    return robot(
        link_element("base"),
        body("arm", "<visual><origin xyz='0 0 1'/><geometry><sphere radius='0.1'/></geometry></visual>"),
        link_element("tip"),
        body("hand"),
        joint_element("j", kind, "base", "arm", content, origin),
        joint_element("k", "fixed", "arm", "tip", "", '<origin xyz="0 0 1"/>'),
        joint_element(
            "wrist",
            "prismatic",
            "arm",
            "hand",
            '<axis xyz="0 1 0"/><limit lower="-1" upper="2" effort="3" velocity="4"/>'
            '<dynamics damping="8" friction="9"/>',
        ),
    )


def _placement() -> Any:
    """Of joint j: roll, pitch, yaw about fixed axes."""
    roll, pitch, yaw = RPY
    return transform(rotation((0, 0, 1), yaw) @ rotation((0, 1, 0), pitch) @ rotation((1, 0, 0), roll), XYZ)


def _yaml(entry: str) -> str:
    return f"joints:\n  j: {entry}\n"


QUATERNION = np.array((0.1, -0.5, 0.7, 0.4)) / np.linalg.norm((0.1, -0.5, 0.7, 0.4))
HERE: Any = np.zeros(3)
A: Any = np.array(AXIS)
SKEW = (0.0, 0.6, 0.8)

# kind in the URDF, entry, coordinates of j, its motion at them
MOTIONS = [
    ("revolute", "spherical", QUATERNION, transform(quaternion_rotation(QUATERNION), HERE)),
    ("continuous", "spherical", QUATERNION, transform(quaternion_rotation(QUATERNION), HERE)),
    (
        "revolute",
        "{type: universal, axes: zx}",
        (0.3, -0.2),
        transform(rotation((0, 0, 1), 0.3) @ rotation((1, 0, 0), -0.2), HERE),
    ),
    (
        "continuous",
        "{type: universal, axes: [[0, 3, 4], [0, 0, -2]]}",
        (2.3, -1.2),
        transform(rotation(SKEW, 2.3) @ rotation((0, 0, 1), 1.2), HERE),
    ),
    ("revolute", "cylindrical", (1.7, 0.5), transform(rotation(A, 0.5), 1.7 * A)),
    ("continuous", "cylindrical", (1.7, 2.5), transform(rotation(A, 2.5), 1.7 * A)),
    ("prismatic", "cylindrical", (0.5, 1.7), transform(rotation(A, 1.7), 0.5 * A)),
    ("revolute", "{type: helical, pitch: 0.2}", (0.5,), transform(rotation(A, 0.5), 0.5 / math.tau * 0.2 * A)),
    ("continuous", "{type: helical, pitch: -3}", (2.5,), transform(rotation(A, 2.5), 2.5 / math.tau * -3 * A)),
    ("prismatic", "{type: helical, pitch: 2}", (1.5,), transform(rotation(A, 1.5), 1.5 / math.tau * 2 * A)),
]


@pytest.mark.parametrize(("kind", "entry", "coordinates", "motion"), MOTIONS)
@pytest.mark.parametrize("root", ["fixed", "floating"])
def test_replaced_joint_moves_as_its_new_type(kind: str, entry: str, coordinates: Any, motion: Any, root: str) -> None:
    loaded = load(_arm(kind), _yaml(entry), root=root)
    found = frame_poses(loaded.model, q_of(loaded, {"j": coordinates, "wrist": (0.4,)}))
    arm = _placement() @ motion
    np.testing.assert_allclose(found["arm", "link"], arm, atol=1e-12)
    np.testing.assert_allclose(found["j", "other"], arm, atol=1e-12)
    np.testing.assert_allclose(found["tip", "link"], arm @ transform(np.eye(3), (0, 0, 1)), atol=1e-12)
    np.testing.assert_allclose(found["k", "other"], arm @ transform(np.eye(3), (0, 0, 1)), atol=1e-12)
    np.testing.assert_allclose(found["hand", "link"], arm @ transform(np.eye(3), (0, 0.4, 0)), atol=1e-12)


@pytest.mark.parametrize(("kind", "entry", "coordinates", "motion"), MOTIONS)
def test_geometry_moves_with_replaced_joint(kind: str, entry: str, coordinates: Any, motion: Any) -> None:
    loaded = load(_arm(kind), _yaml(entry), geometry=True)
    data = loaded.visual_model.createData()
    pin.updateGeometryPlacements(loaded.model, loaded.data, loaded.visual_model, data, q_of(loaded, {"j": coordinates}))
    sphere = _placement() @ motion @ transform(np.eye(3), (0, 0, 1))
    np.testing.assert_allclose(data.oMg[0].homogeneous, sphere, atol=1e-12)


#: kind in the URDF, entry, (lower, upper) by coordinate, and by velocity: velocity, effort, damping, friction.
KEPT = [
    ("revolute", "spherical", [], [(5, 7, 0.3, 0.2)] * 3),
    ("revolute", "{type: universal, axes: yx}", [(-0.4, 0.6)] * 2, [(5, 7, 0.3, 0.2)] * 2),
    ("continuous", "{type: universal, axes: yx}", [(-INF, INF)] * 2, [(5, 7, 0.3, 0.2)] * 2),
    ("revolute", "cylindrical", [(-INF, INF), (-0.4, 0.6)], [(5, 7, 0.3, 0.2)] * 2),
    ("prismatic", "cylindrical", [(-0.4, 0.6), (-INF, INF)], [(5, 7, 0.3, 0.2)] * 2),
    ("continuous", "cylindrical", [(-INF, INF), (-INF, INF)], [(5, 7, 0.3, 0.2)] * 2),
    ("revolute", "{type: helical, pitch: 0.1}", [(-0.4, 0.6)], [(5, 7, 0.3, 0.2)]),
    ("continuous", "{type: helical, pitch: 0.1}", [(-INF, INF)], [(5, 7, 0.3, 0.2)]),
    # 6.283185307179586 m a revolution are 1 m a radian; half of it, and left-handed, are -1/2 m a radian.
    ("prismatic", "{type: helical, pitch: 6.283185307179586}", [(-0.4, 0.6)], [(5, 7, 0.3, 0.2)]),
    ("prismatic", "{type: helical, pitch: -3.141592653589793}", [(-1.2, 0.8)], [(10, 3.5, 0.075, 0.1)]),
    # overrides
    ("revolute", "{limits: {upper: 0.1, effort: 2}, damping: 4}", [(-0.4, 0.1)], [(5, 2, 4, 0.2)]),
    ("revolute", "{limits: {lower: -9, velocity: 0}, friction: 4}", [(-9, 0.6)], [(0, 7, 0.3, 4)]),
    ("revolute", "{type: spherical, limits: {effort: [1, 2, 3]}}", [], [(5, n, 0.3, 0.2) for n in (1, 2, 3)]),
    (
        "revolute",
        "{type: universal, axes: xy, limits: {lower: [-1, -2], upper: 3, velocity: [8, 9]}, friction: [0, 6]}",
        [(-1, 3), (-2, 3)],
        [(8, 7, 0.3, 0), (9, 7, 0.3, 6)],
    ),
    (
        "prismatic",
        "{type: cylindrical, limits: {lower: [0, -1], upper: [0.1, 1]}}",
        [(0, 0.1), (-1, 1)],
        [(5, 7, 0.3, 0.2)] * 2,
    ),
    # The description speaks of the joint as it becomes: an angle.
    (
        "prismatic",
        "{type: helical, pitch: 6.283185307179586, limits: {upper: 9, velocity: 1}}",
        [(-0.4, 9)],
        [(1, 7, 0.3, 0.2)],
    ),
]


@pytest.mark.parametrize(("kind", "entry", "positions", "rates"), KEPT)
@pytest.mark.parametrize("root", ["fixed", "floating"])
def test_changed_joint_keeps_its_properties(
    kind: str, entry: str, positions: list[Any], rates: list[Any], root: str
) -> None:
    model = load(_arm(kind), _yaml(entry), root=root).model
    idx_q, nq, idx_v, nv = at(model, "j")
    assert nv == len(rates)
    assert nq == (len(positions) or 4)
    for index, (lower, upper) in enumerate(positions, idx_q):
        assert model.lowerPositionLimit[index] == pytest.approx(lower, rel=1e-12)
        assert model.upperPositionLimit[index] == pytest.approx(upper, rel=1e-12)
    for index, (velocity, effort, damping, friction) in enumerate(rates, idx_v):
        assert model.upperVelocityLimit[index] == pytest.approx(velocity, rel=1e-12)
        assert model.upperEffortLimit[index] == pytest.approx(effort, rel=1e-12)
        assert model.lowerEffortLimit[index] == pytest.approx(-effort, rel=1e-12)
        assert model.damping[index] == pytest.approx(damping, rel=1e-12)
        assert model.upperDryFrictionLimit[index] == pytest.approx(friction, rel=1e-12)
    idx_q, _, idx_v, _ = at(model, "wrist")  # the next joint is not changed
    assert (model.lowerPositionLimit[idx_q], model.upperPositionLimit[idx_q]) == (-1, 2)
    assert (model.upperVelocityLimit[idx_v], model.upperEffortLimit[idx_v]) == (4, 3)
    assert (model.damping[idx_v], model.upperDryFrictionLimit[idx_v]) == (8, 9)


@pytest.mark.parametrize(
    ("entry", "armature"),
    [
        ("{armature: 0.5}", [0.5]),
        ("{type: spherical, armature: 0.5}", [0.5, 0.5, 0.5]),
        ("{type: universal, axes: xz, armature: [0.1, 0.2]}", [0.1, 0.2]),
    ],
)
def test_armature_is_on_mass_matrix_diagonal(entry: str, armature: list[float]) -> None:
    with_armature = load(_arm("revolute"), _yaml(entry)).model
    without = load(_arm("revolute"), _yaml(re.sub(r"armature: [^\]}]*\]?", "damping: 1", entry))).model
    _, _, idx_v, nv = at(with_armature, "j")
    assert with_armature.armature[idx_v : idx_v + nv].tolist() == armature
    q = pin.randomConfiguration(with_armature, -np.ones(with_armature.nq), np.ones(with_armature.nq))
    more = np.diag(mass_matrix(with_armature, q) - mass_matrix(without, q))
    np.testing.assert_allclose(more[idx_v : idx_v + nv], armature, atol=1e-12)
    np.testing.assert_allclose(np.delete(more, range(idx_v, idx_v + nv)), 0, atol=1e-12)


@pytest.mark.parametrize("kind", ["revolute", "continuous", "prismatic", "planar", "floating"])
def test_any_joint_can_be_locked_at_zero(kind: str) -> None:
    loaded = load(_arm(kind), _yaml("fixed"))
    plain = load(_arm(kind))
    assert (loaded.model.nq, loaded.model.nv) == (1, 1)
    assert loaded.model.names.tolist() == ["universe", "wrist"]
    assert loaded.model.frames[loaded.model.getFrameId("j")].type == pin.FrameType.FIXED_JOINT
    before, after = frame_poses(plain.model, pin.neutral(plain.model)), frame_poses(loaded.model, np.zeros(1))
    assert before.keys() == {name for name in after if not name[0].endswith("/1")}  # the first of two joints in series
    for name, pose in before.items():
        np.testing.assert_allclose(after[name], pose, atol=1e-12)


def test_locked_joint_accepts_no_properties() -> None:
    assert codes(_arm("revolute"), _yaml("{type: fixed, damping: 1}")) == ["joint-property"]


def test_leader_keeps_type_but_accepts_properties() -> None:
    law = '<mimic joint="j" multiplier="2"/><limit effort="1" velocity="1" lower="-1" upper="1"/>'
    follow = joint_element("f", "revolute", "base", "tail", law)
    urdf = _arm("revolute").replace("</robot>", body("tail") + follow + "</robot>")
    assert codes(urdf, _yaml("{limits: {effort: 2}}")) == []
    model = load(urdf, _yaml("{limits: {effort: 2}}")).model
    assert model.upperEffortLimit[at(model, "j")[2]] == 2
    assert codes(urdf, _yaml("spherical")) == ["joint-mimics"]
    assert codes(urdf, "joints: {f: {limits: {effort: 2}}}") == ["joint-mimics"]


# -- on random trees --------------------------------------------------------------------------------------------------

_NEW_TYPES = {
    JointType.REVOLUTE: ("spherical", "universal", "cylindrical", "helical", "fixed"),
    JointType.CONTINUOUS: ("spherical", "universal", "cylindrical", "helical", "fixed"),
    JointType.PRISMATIC: ("cylindrical", "helical", "fixed"),
    JointType.PLANAR: ("fixed",),
    JointType.FLOATING: ("fixed",),
}


@st.composite
def _replacements(draw: st.DrawFn, urdf: str) -> dict[str, str]:
    """A new type for some of the joints that may have one, of those of a robot."""
    mechanism = mechanism_of(urdf)
    chosen = draw(st.sets(st.sampled_from(free_names(mechanism) or [""]))) - {""}
    kinds = {joint.name: joint.type for joint in mechanism.joints}
    return {name: draw(st.sampled_from(_NEW_TYPES[kinds[name]])) for name in sorted(chosen)}


def _second_axis(first: Any) -> Any:
    """An axis that is neither parallel nor perpendicular to another."""
    off = np.eye(3)[np.argmin(np.abs(first))]
    return first / np.linalg.norm(first) + 2.0 * off


def _entries(replacements: dict[str, str], plain: dict[str, Joint]) -> str:
    lines = ["joints:"] if replacements else ["joints: {}"]
    for name, kind in replacements.items():
        entry = kind
        if kind == "universal":
            axes = (plain[name].axes[0], _second_axis(np.array(plain[name].axes[0])))
            entry = f"{{type: universal, axes: {[[float(value) for value in axis] for axis in axes]}}}"
        elif kind == "helical":
            entry = "{type: helical, pitch: 0.7}"
        lines.append(f"  {name}: {entry}")
    return "\n".join(lines) + "\n"


@settings(max_examples=60, deadline=None)
@given(st.data(), trees(), ROOTS)
def test_neutral_poses_match_plain_urdf(data: st.DataObject, urdf: str, root: Root) -> None:
    plain = {joint.name: joint for joint in mechanism_of(urdf).joints}
    replacements = data.draw(_replacements(urdf))
    loaded = load(urdf, _entries(replacements, plain), root=root)
    model = pinocchios_own(urdf, root)
    before, after = frame_poses(model, pin.neutral(model)), frame_poses(loaded.model, pin.neutral(loaded.model))
    assert before.keys() == {name for name in after if not name[0].endswith("/1")}  # the first of two joints in series
    for name, pose in before.items():
        np.testing.assert_allclose(after[name], pose, atol=1e-12)
    fixed = "fixed" in replacements.values()  # to a fixed root, perhaps, whose mass is not in the model
    if root == "floating" or not fixed:
        assert pin.computeTotalMass(loaded.model) == pytest.approx(pin.computeTotalMass(model), rel=1e-12)


def _as_replaced(kind: str, joint: Joint, values: tuple[float, ...]) -> tuple[tuple[float, ...], Any]:
    """The coordinates at which a replaced joint does what the URDF's does; and how velocities map to the new ones."""
    if kind == "spherical":
        axis = np.array(joint.axes[0]) / np.linalg.norm(joint.axes[0])
        half = values[0] / 2
        return (*(math.sin(half) * axis).tolist(), math.cos(half)), axis[:, None]
    if kind == "universal":
        return (values[0], 0.0), np.array([[1.0], [0.0]])
    if kind == "cylindrical" and joint.type is JointType.PRISMATIC:
        return (values[0], 0.0), np.array([[1.0], [0.0]])
    if kind == "cylindrical":
        return (0.0, values[0]), np.array([[0.0], [1.0]])
    return values, np.eye(joint.type.nv)


@settings(max_examples=60, deadline=None)
@given(st.data(), trees(), st.integers(0, 2**32 - 1))
def test_replacement_contains_original_motion_and_inertia(data: st.DataObject, urdf: str, seed: int) -> None:
    """The plain model is the robot held on a submanifold: poses are equal, and M_plain = Tᵀ M T."""
    random = np.random.default_rng(seed)
    plain = load(urdf, mimic=False)
    joints = {joint.name: joint for joint in plain.mechanism.joints}
    replacements = data.draw(_replacements(urdf))
    loaded = load(urdf, _entries(replacements, joints), mimic=False)
    coordinates: dict[str, tuple[float, ...]] = {}
    wanted: dict[str, tuple[float, ...]] = {}
    T = np.zeros((loaded.model.nv, plain.model.nv))
    kept: list[int] = []
    for joint in plain.mechanism.joints:
        if joint.type is JointType.FIXED:
            continue
        kind = replacements.get(joint.name, "")
        values = random.uniform(-1, 1, len(joint.type.coordinates))
        if joint.type.quaternion is not None:
            values[joint.type.quaternion :] /= np.linalg.norm(values[joint.type.quaternion :])
        _, _, idx_v, nv = at(plain.model, joint.name)
        if kind in ("fixed", "helical"):  # at its zero; they do not move as the URDF's did
            continue
        coordinates[joint.name] = tuple(values.tolist())
        wanted[joint.name], block = _as_replaced(kind, joint, coordinates[joint.name])
        _, _, new_v, new_nv = at(loaded.model, joint.name)
        T[new_v : new_v + new_nv, idx_v : idx_v + nv] = block
        kept += range(idx_v, idx_v + nv)
    q_plain, q = q_of(plain, coordinates), q_of(loaded, wanted)
    before, after = frame_poses(plain.model, q_plain), frame_poses(loaded.model, q)
    for name, pose in before.items():
        np.testing.assert_allclose(after[name], pose, atol=1e-12)
    M_plain, M = mass_matrix(plain.model, q_plain), mass_matrix(loaded.model, q)
    projected = T.T @ M @ T
    scale = max(1.0, np.abs(M_plain).max(initial=0))
    np.testing.assert_allclose(projected[np.ix_(kept, kept)] / scale, M_plain[np.ix_(kept, kept)] / scale, atol=1e-11)


@settings(max_examples=40, deadline=None)
@given(st.data(), trees(), st.integers(0, 2**16), ROOTS, st.booleans())
def test_mass_matrix_is_symmetric_positive_definite(
    data: st.DataObject, urdf: str, seed: int, root: Root, mimic: bool
) -> None:
    urdf = re.sub(r'<link name="(l\d+)">.*?</link>', lambda found: body(found[1]), urdf)
    plain = {joint.name: joint for joint in mechanism_of(urdf).joints}
    loaded = load(urdf, _entries(data.draw(_replacements(urdf)), plain), root=root, mimic=mimic)
    assert [found for found in loaded.diagnostics if found.severity == "error"] == []
    pin.seed(seed)
    for _ in range(3):
        q = pin.randomConfiguration(loaded.model, -2 * np.ones(loaded.model.nq), 2 * np.ones(loaded.model.nq))
        M = mass_matrix(loaded.model, q)
        np.testing.assert_allclose(M, M.T, atol=1e-10)
        assert np.linalg.eigvalsh(M).min(initial=1.0) > 0
        if not mimic:
            np.testing.assert_allclose(pin.crba(loaded.model, loaded.data, q), M, atol=1e-10)


# -- said twice, said wrongly -----------------------------------------------------------------------------------------


def test_order_of_joint_entries_does_not_matter() -> None:
    def in_order(*entries: str) -> list[Any]:
        with_entries = load(_arm("revolute"), "joints:\n" + "".join(f"  {entry}\n" for entry in entries))
        return list(with_entries.mechanism.joints)

    ball, slide = "j: spherical", "wrist: cylindrical"
    assert in_order(ball, slide) == in_order(slide, ball)


def test_link_poses_are_right_after_all_replacements() -> None:
    urdf = _arm("revolute")
    plain = pin.buildModelFromXML(urdf)
    expected = link_poses(plain, pin.neutral(plain))
    for entry in ("spherical", "{type: universal, axes: yz}", "cylindrical", "{type: helical, pitch: 1}", "fixed"):
        loaded = load(urdf, _yaml(entry))
        found = link_poses(loaded.model, pin.neutral(loaded.model))
        assert found.keys() == expected.keys()
        for name, pose in expected.items():
            np.testing.assert_allclose(found[name], pose, atol=1e-12)


def test_mimic_joints_follow_or_are_free() -> None:
    lead = '<axis xyz="0 1 0"/><limit lower="-1" upper="1" effort="1" velocity="1"/>'
    follow = lead.replace("0 1 0", "1 0 0") + '<mimic joint="a" multiplier="-2" offset="0.1"/>'
    urdf = robot(
        link_element("base", inertial()),
        body("one"),
        body("two"),
        joint_element("a", "revolute", "base", "one", lead),
        joint_element("b", "revolute", "one", "two", follow),
    )
    assert load(urdf).model == pin.buildModelFromXML(urdf, mimic=True)
    assert load(urdf, mimic=False).model == pin.buildModelFromXML(urdf, mimic=False)
    described = load(urdf, "actuators: [a]\n")
    assert (described.model.nq, described.model.nv) == (1, 1)
    pose = link_poses(described.model, np.array([0.3]))["two"]
    np.testing.assert_allclose(pose[:3, :3], rotation((0, 1, 0), 0.3) @ rotation((1, 0, 0), -0.5), atol=1e-12)
    assert (load(urdf, "actuators: [a]\n", mimic=False).model.nv, described.actuation.idx_v.tolist()) == (2, [0])


def test_robot_with_replacements_prints_and_unpacks() -> None:
    model, constraint_models, actuation, visual_model, collision_model = load(_arm("revolute"), _yaml("spherical"))
    assert (model.nq, constraint_models, actuation.joints, visual_model, collision_model) == (5, [], (), None, None)
    assert isinstance(load(_arm("revolute"), _yaml("spherical")), eurdf.Robot)
