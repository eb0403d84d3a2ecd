"""From version 1 of the format to version 2: the same model, the comments and user data kept."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
import pytest
import yaml
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import eurdf
from eurdf.commands.main import main
from eurdf.diagnostics import Diagnostics, FileError
from eurdf.errors import CannotMigrate
from eurdf.format.read import read_description
from eurdf.format.urdf.data import Urdf
from eurdf.format.urdf.read import read_urdf
from eurdf.kinematics.residual import residual
from eurdf.linking.link import link
from eurdf.linking.robot_files import ReadRobot, read_robot
from eurdf.mechanism.mechanism import Mechanism
from eurdf.mechanism.same_model import differences
from eurdf.pinocchio.configuration import configuration_vector
from eurdf.pinocchio.robot import Robot, build_robot
from eurdf.reading.source import Source
from eurdf.reading.xml_reader import read_xml
from eurdf.reading.yaml_node import json_pointer
from eurdf.reading.yaml_reader import read_yaml
from eurdf.writing.comments import comments_of
from eurdf.writing.migrated_text import NotMigratable, own_keys, schema_named
from eurdf.writing.migration import Migration, migrate
from robots.quality.files import comparable
from support.places import DATA, ROBOTS, WILD
from support.wild import FACTS, needs_wild

WORKBENCH = DATA / "workbench.urdf"
#: The workbench without its mimic joint, which version 1 ignores and version 2 does not.
PLAIN_WORKBENCH = re.sub(r"<mimic [^>]*/>", "", WORKBENCH.read_text(encoding="utf-8"))


def workbench(text: str = PLAIN_WORKBENCH) -> Urdf:
    urdf = read_urdf(read_xml(Source("robot.urdf", text, text.encode())), Diagnostics())
    assert urdf is not None
    return urdf


URDF = workbench()


def read(text: str) -> ReadRobot | None:
    """The workbench with a description; None if that has an error."""
    diagnostics = Diagnostics()
    extension = read_description(read_yaml(Source("robot.yaml", text, text.encode())), diagnostics)
    mechanism = None if extension is None else link(URDF, extension, diagnostics)
    if extension is None or mechanism is None:
        return None
    return ReadRobot("robot.yaml", diagnostics, URDF, mechanism, extension)


def described(text: str) -> ReadRobot:
    description = read(text)
    assert description is not None
    return description


def migrated(text: str) -> Migration:
    return migrate(described(text))


def linked(text: str) -> Mechanism:
    return described(text).mechanism


def but_for_the_version(mechanism: Mechanism) -> Mechanism:
    """Own keys have another name in version 2, which is tested apart."""
    return replace(mechanism, version="", own_data={})


def randomly_posed(before: Robot, after: Robot, seed: int) -> tuple[Any, Any]:
    """One configuration of both, in which universal joints of the one are two revolutes of the other."""
    rng = np.random.default_rng(seed)
    one: dict[str, list[float]] = {}
    other: dict[str, list[float]] = {}
    names = {joint.name for joint in before.mechanism.joints}
    for joint in after.mechanism.joints:
        values = [float(value) for value in rng.uniform(-1.5, 1.5, len(joint.type.coordinates))]
        if joint.type.quaternion is not None:
            values = list(np.array(values) / np.linalg.norm(values))
        if not values or joint.mimic is not None:
            continue
        other[joint.name] = values
        if joint.name in names:
            one[joint.name] = values
        else:
            one |= {name: [value] for name, value in zip(halves(before, joint.name), values, strict=True)}
    return (
        configuration_vector(before.mechanism, before.model, one),
        configuration_vector(after.mechanism, after.model, other),
    )


def halves(robot: Robot, joint: str) -> list[str]:
    """The two revolutes that a universal joint is in version 1, the first first."""
    pair = [name for name in robot.model.names if name[:-2] == joint and name[-2] == "_" and name[-1] in "XYZ"]
    assert len(pair) == 2
    return pair


def velocities(robot: Robot, names: list[str]) -> list[int]:
    """Indices in v of the joints."""
    return [row for name in names for row in robot.tree.velocities_of(name)]


def assert_same_motion(before: Mechanism, after: Mechanism) -> None:
    """The Pinocchio models move alike: bodies, residuals, inertia, limits, actuation."""
    one, other = build_robot(before, geometry=False), build_robot(after, geometry=False)
    assert one.model.nv == other.model.nv
    assert pin.computeTotalMass(one.model) == pytest.approx(pin.computeTotalMass(other.model), rel=1e-12)
    moving = [joint.name for joint in after.joints if joint.type.nv and joint.mimic is None]
    parts = [[name] if one.model.existJointName(name) else halves(one, name) for name in moving]
    rows_one, rows_other = velocities(one, [name for part in parts for name in part]), velocities(other, moving)
    for attribute in ("velocityLimit", "damping", "friction", "armature", "upperEffortLimit"):
        values = getattr(one.model, attribute)[rows_one], getattr(other.model, attribute)[rows_other]
        np.testing.assert_array_equal(*values)
    np.testing.assert_array_equal(one.actuation.selection[rows_one, :], other.actuation.selection[rows_other, :])
    for seed in range(3):
        q_one, q_other = randomly_posed(one, other, seed)
        np.testing.assert_allclose(residual(one, q_one), residual(other, q_other), atol=1e-12)
        M_one, M_other = pin.crba(one.model, one.data, q_one), pin.crba(other.model, other.data, q_other)
        np.testing.assert_allclose(
            M_one[np.ix_(rows_one, rows_one)], M_other[np.ix_(rows_other, rows_other)], atol=1e-12
        )
        for robot, q in ((one, q_one), (other, q_other)):
            pin.framesForwardKinematics(robot.model, robot.data, q)
        for body in after.bodies:
            placements = [
                robot.data.oMf[robot.model.getFrameId(body.name, pin.FrameType.BODY)].homogeneous
                for robot in (one, other)
            ]
            np.testing.assert_allclose(placements[0], placements[1], atol=1e-12)


# -- published robots ---------------------------------------------------------------------------------------------


@needs_wild
@pytest.mark.parametrize("name", FACTS)
def test_published_robot_keeps_its_model(name: str) -> None:
    description = read_robot(WILD / name)
    before = description.mechanism
    assert before is not None
    after = migrate(description).mechanism
    assert after.version == "2.0"
    assert differences(before, after) == []
    if not any(body.virtual for body in before.bodies):
        assert but_for_the_version(after) == but_for_the_version(before)
        one, other = build_robot(before, geometry=False), build_robot(after, geometry=False)
        assert list(one.model.names) == list(other.model.names)
        assert one.model.idx_vs.tolist() == other.model.idx_vs.tolist()
        assert one.model.idx_qs.tolist() == other.model.idx_qs.tolist()
    assert_same_motion(before, after)


@pytest.mark.parametrize("name", sorted(path.parent.name for path in ROBOTS.glob("*/robot.v1.yaml")))
def test_collection_robot_migrates_to_its_version_2(name: str) -> None:
    two = read_robot(ROBOTS / name).mechanism
    assert two is not None
    after = migrate(read_robot(ROBOTS / name / "robot.v1.yaml")).mechanism
    # Version 1 has no root, and names no closure.
    one, other = comparable(replace(after, root=two.root), two)
    assert differences(one, other) == []


# -- any document -------------------------------------------------------------------------------------------------

ROTARY = ["motor", "elbow", "pivot", "wrist_x", "wrist_y", "wrist_z"]
FRAMES = [*URDF.links, *URDF.joints]
TYPES = ["SPHERICAL", "FIXED", *(f"UJOINT_{a}{b}" for a in "XYZ" for b in "XYZ" if a != b)]

#: JSON writes a character beyond the first plane in two escapes, which YAML does not read as one.
texts = st.text(st.characters(max_codepoint=0xD7FF), max_size=8)
own_values = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False, allow_infinity=False) | texts,
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(texts, inner, max_size=3),
    max_leaves=6,
)
own = st.dictionaries(st.sampled_from(["note", "x-note", "x-x-note", "urdf", "mass", "root", "on"]), own_values)


@st.composite
def documents(draw: st.DrawFn) -> dict[str, Any]:
    """Documents of version 1, most of them sound."""
    replaced = draw(st.dictionaries(st.sampled_from(ROTARY), st.sampled_from(TYPES), max_size=3))
    halves = [f"{name}_{letter}" for name, kind in replaced.items() if "_" in kind for letter in kind[-2:]]
    frames = st.sampled_from([*FRAMES, *halves, *halves])
    pairs = draw(st.lists(st.lists(frames, min_size=2, max_size=2), max_size=3))
    motors = ["stage", "grip", "wrist_z", *halves, *(name for name in ROTARY[:3] if name not in replaced)]
    document: dict[str, Any] = {
        "closed_loop": pairs,
        "type": draw(st.lists(st.sampled_from(["3d", "3D", "6d", "6D"]), min_size=len(pairs), max_size=len(pairs))),
        "name_mot": draw(st.lists(st.sampled_from(motors), unique=True, max_size=4)),
        "joint_name": list(replaced),
        "joint_type": list(replaced.values()),
    }
    if draw(st.booleans()):
        del document["type"]
    document |= draw(own)
    return dict(draw(st.permutations(list(document.items()))))


@st.composite
def written(draw: st.DrawFn, document: dict[str, Any]) -> str:
    """A document as text: in one of several styles, with numbered comments where there may be some."""
    style = draw(st.sampled_from(["json", "flow", "block", "one line"]))
    if style == "one line":
        return json.dumps(document) + "\n"
    if style == "json":
        text = json.dumps(document, indent=draw(st.sampled_from([1, 4])))
    else:
        text = yaml.safe_dump(document, sort_keys=False, default_flow_style=None if style == "flow" else False)
    places = draw(st.binary(min_size=20, max_size=20))
    lines = []
    for number, line in enumerate(text.split("\n")):
        place = places[number % len(places)] % 4
        if place == 0:
            lines.append(f"# note {number}:")
        lines.append(line + (f"  # note {number};" if place == 1 and line.strip() else ""))
    # In a text of several lines a comment would be part of it, and PyYAML quotes by the rules of YAML 1.1.
    return next(form for form in ("\n".join(lines), text, json.dumps(document)) if reads_as(form, document))


def reads_as(text: str, document: dict[str, Any]) -> bool:
    try:
        return bool(read_yaml(Source("", text, text.encode())).data == document)
    except FileError:
        return False


def says_half_of_a_universal_joint(document: dict[str, Any]) -> bool:
    """Whether version 1 speaks of one axis of a universal joint, which version 2 cannot."""
    ends = ("_X", "_Y", "_Z")
    names = [*document["name_mot"], *(name for pair in document["closed_loop"] for name in pair)]
    return any(name.endswith(ends) for name in names)


@pytest.mark.slow
@settings(max_examples=120, deadline=None, derandomize=True)
@given(st.data())
def test_any_document_keeps_its_model(data: st.DataObject) -> None:
    document = data.draw(documents())
    description = read(data.draw(written(document)))
    assume(description is not None)
    assert description is not None
    before = description.mechanism
    try:
        migration = migrate(description)
    except NotMigratable:
        assert says_half_of_a_universal_joint(document)
        return
    after = linked(migration.text)
    assert after == migration.mechanism
    assert differences(before, after) == []
    if not any(body.virtual for body in before.bodies):
        assert but_for_the_version(after) == but_for_the_version(before)
    keys = {json_pointer([key]): key for key in document}
    own = {keys[pointer]: value for pointer, value in before.own_data.items()}
    expected = {json_pointer([name]): own[key] for key, name in own_keys(own).items()}
    assert repr(dict(after.own_data)) == repr(expected)


@settings(max_examples=25, deadline=None, derandomize=True)
@given(st.data())
def test_any_document_keeps_its_kinematics(data: st.DataObject) -> None:
    document = data.draw(documents())
    description = read(json.dumps(document))
    assume(description is not None and not says_half_of_a_universal_joint(document))
    assert description is not None
    assert_same_motion(description.mechanism, migrate(description).mechanism)


@pytest.mark.slow
@settings(max_examples=100, deadline=None, derandomize=True)
@given(st.data())
def test_no_comment_is_lost_or_duplicated(data: st.DataObject) -> None:
    text = data.draw(written(data.draw(documents())))
    description = read(text)
    assume(description is not None)
    assert description is not None
    try:
        migration = migrate(description)
    except NotMigratable:
        return
    before = sorted(comment.text for comment in comments_of(description.description.document.source))
    source = Source("", migration.text, migration.text.encode())
    after = [comment.text for comment in comments_of(source)]
    assert sorted(piece for comment in after for piece in pieces(comment)) == before


def pieces(comment: str) -> Iterator[str]:
    """Comments beside one entry that was several share its line."""
    for piece in comment.split(" # "):
        yield piece if piece.startswith("#") else f"# {piece}"


# -- what is said -------------------------------------------------------------------------------------------------

COMMENTED = """\
# yaml-language-server: $schema=../schema/extended-urdf-1.schema.json
# The workbench of test hall 3.
# SPDX-License-Identifier: CC0-1.0

closed_loop: # the loops
  # from the rod
  - [rod_tip, slider] # pinned
type: [3D] # a pin
name_mot: [
  motor, # of the crank
  # the gripper
  grip]
note: 'kept' # by hand
joint_name: [elbow, # cardan
  pivot]
joint_type:
  # crosses
  - UJOINT_ZX
  - SPHERICAL
masses:
  # weighed
  hand: 0x10   # hexadecimal
  list: [1, 2,
    3]
# the end
"""

MIGRATED = """\
# yaml-language-server: $schema=../schema/extended-urdf-2.0.schema.json
# The workbench of test hall 3.
# SPDX-License-Identifier: CC0-1.0
extended_urdf: "2.0"
urdf: robot.urdf
closures:  # the loops # a pin
  # from the rod
  - name: closure_1  # pinned
    type: 3d
    frames: [rod_tip, slider]
joints:
  # crosses
  elbow: {type: universal, axes: zx}  # cardan
  pivot: spherical
  wrist_z: {type: spherical, merges: [wrist_x, wrist_y, wrist_z]}
actuators:
  - motor  # of the crank
  # the gripper
  - grip
x-note: 'kept' # by hand
x-masses:
  # weighed
  hand: 0x10   # hexadecimal
  list: [1, 2,
    3]
# the end
"""


def test_changes_are_listed() -> None:
    notes = "\n".join(migrated(COMMENTED).notes)
    for said in ("'closure_1'", "spherical joint 'wrist_z'", "universal joint 'elbow'", "'note'", "'x-note'"):
        assert said in notes


def test_user_data_with_format_alias_keep_values() -> None:
    migration = migrated("name_mot: &motors [motor]\nbackup: *motors\nalso: &a {k: [1]}\ntoo: *a\n")
    values = {"/x-backup": ["motor"], "/x-also": {"k": [1]}, "/x-too": {"k": [1]}}
    assert migration.mechanism.own_data == values


def test_user_keys_never_collide() -> None:
    assert own_keys(["x-a", "a", "x-x-a", "type", "b"]) == {"x-a": "x-a", "a": "x-x-x-a", "x-x-a": "x-x-a", "b": "x-b"}


def test_two_actuated_axes_become_universal_actuator() -> None:
    text = "joint_name: [elbow]\njoint_type: [UJOINT_XY]\nname_mot: [motor, elbow_X, elbow_Y, grip]\n"
    migration = migrated(text)
    assert migration.mechanism.actuators == ("motor", "elbow", "grip")
    assert_same_motion(linked(text), migration.mechanism)


@pytest.mark.parametrize("motors", ["[elbow_X]", "[elbow_Y, elbow_X]", "[elbow_X, motor, elbow_Y]"])
def test_single_actuated_axis_is_refused(motors: str) -> None:
    with pytest.raises(NotMigratable, match="one of the two axes of universal joint 'elbow'") as reason:
        migrated(f"joint_name: [elbow]\njoint_type: [UJOINT_XY]\nname_mot: {motors}\n")
    assert reason.value.pointer[0] == "name_mot"


def test_far_side_of_universal_joint_stays_a_frame() -> None:
    text = "joint_name: [elbow]\njoint_type: [UJOINT_XY]\nclosed_loop: [[elbow_Y, slider]]\n"
    migration = migrated(text)
    assert migration.mechanism.closures[0].a.frame == "elbow"
    assert_same_motion(linked(text), migration.mechanism)


def test_frame_between_universal_axes_is_refused() -> None:
    with pytest.raises(NotMigratable, match="'elbow_X' lies between the two axes"):
        migrated("joint_name: [elbow]\njoint_type: [UJOINT_XY]\nclosed_loop: [[elbow_X, slider]]\n")


# -- whether it is the same model ---------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("other", "said"),
    [
        ("closed_loop: [[rod_tip, finger]]\ntype: [6d]\n", "closure 'closure_1' differs"),
        ("closed_loop: []\n", "closure 'closure_1' is missing"),
        ("closed_loop: [[rod_tip, slider]]\nname_mot: [motor]\n", "the actuators or their order differ"),
        ("closed_loop: [[rod_tip, slider]]\njoint_name: [pivot]\njoint_type: [FIXED]\n", "joint 'pivot' differs"),
        ("closed_loop: [[rod_tip, slider]]\njoint_name: [pivot]\njoint_type: [UJOINT_XY]\n", "joint 'pivot' differs"),
    ],
)
def test_different_model_is_detected(other: str, said: str) -> None:
    assert differences(linked("closed_loop: [[rod_tip, slider]]\n"), linked(other)) == [said]


@pytest.mark.parametrize("axes", ["UJOINT_YX", "UJOINT_XZ"])
def test_different_axes_are_a_different_model(axes: str) -> None:
    text = "joint_name: [pivot]\njoint_type: [{}]\n"
    found = differences(linked(text.format("UJOINT_XY")), linked(text.format(axes)))
    assert found == ["joint 'pivot' differs"]


# -- the command --------------------------------------------------------------------------------------------------


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "robot.urdf").write_text(PLAIN_WORKBENCH, encoding="utf-8")
    (tmp_path / "robot.yaml").write_text(COMMENTED, encoding="utf-8")
    return tmp_path


def test_command_writes_to_standard_output(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["migrate", str(folder)]) == 0
    out, err = capsys.readouterr()
    assert out == MIGRATED
    assert "wrist_z" in err


def test_new_file_names_urdf_relatively(folder: Path) -> None:
    (folder / "new").mkdir()
    out = folder / "new" / "bench.yaml"
    assert main(["migrate", str(folder), "-o", str(out)]) == 0
    assert "urdf: ../robot.urdf\n" in out.read_text(encoding="utf-8")
    assert read_robot(out).mechanism is not None


def test_version_2_file_is_unchanged(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / "robot.yaml").write_text(MIGRATED, encoding="utf-8")
    assert main(["migrate", str(folder)]) == 0
    out, err = capsys.readouterr()
    assert out == MIGRATED
    assert "nothing to do" in err
    assert main(["migrate", str(folder), "-o", str(folder / "other.yaml")]) == 0
    assert not (folder / "other.yaml").exists()


def test_robot_with_errors_is_refused(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / "robot.yaml").write_text("name_mot: [mottor]\n", encoding="utf-8")
    assert main(["migrate", str(folder), "-o", str(folder / "two.yaml")]) == 1
    out, err = capsys.readouterr()
    assert out == ""
    assert "did you mean 'motor'" in err
    assert not (folder / "two.yaml").exists()


def test_inexpressible_value_is_reported_with_line(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = "joint_name: [elbow]\njoint_type: [UJOINT_XY]\nname_mot: [elbow_X]\n"
    (folder / "robot.yaml").write_text(text, encoding="utf-8")
    assert main(["migrate", str(folder), "-o", str(folder / "two.yaml")]) == 2
    assert "robot.yaml:3: actuator 'elbow_X'" in capsys.readouterr().err
    assert not (folder / "two.yaml").exists()


@pytest.mark.parametrize("mark", ["\x85", "\u2028", "\u2029"])
@pytest.mark.parametrize(
    "text",
    [
        "note: a{}b\n",
        "note: {}\n",
        "note: 'a{}b'\n",
        'note: "a{}b"\n',
        "note: |\n  a{}b\n",
        "note: {{a: b{}c}}\n",
        "a{}b: 1\n",
        "? a{}b\n: c\n",
        "# c{} note: [\n",
        "note: c # d{}e: [\n",
    ],
)
def test_line_breaks_of_yaml_1_1_are_ordinary_characters(tmp_path: Path, text: str, mark: str) -> None:
    (tmp_path / "robot.urdf").write_text(PLAIN_WORKBENCH, encoding="utf-8")
    (tmp_path / "robot.yaml").write_text(f"closed_loop: []\n{text.format(mark)}", encoding="utf-8", newline="")
    assert main(["migrate", str(tmp_path), "-o", str(tmp_path / "new.yaml")]) == 0
    new = (tmp_path / "new.yaml").read_text(encoding="utf-8")
    if "#" in text:
        assert text.format(mark).split("#")[1].strip("\n") in new
    else:
        old = read_yaml(Source("robot.yaml", text.format(mark), text.format(mark).encode())).data
        data = read_yaml(Source("new.yaml", new, new.encode())).data
        assert {key.removeprefix("x-"): data[key] for key in data if key.startswith("x-")} == old


# -- mimic joints, which version 1 ignores -----------------------------------------------------------------------------

MIMICKING = WORKBENCH.read_text(encoding="utf-8")


def with_mimics(text: str, urdf: str = MIMICKING) -> ReadRobot:
    diagnostics = Diagnostics()
    given = read_urdf(
        read_xml(Source("robot.urdf", urdf, urdf.encode())), Diagnostics(), mimic_diagnostics=Diagnostics()
    )
    extension = read_description(read_yaml(Source("robot.yaml", text, text.encode())), diagnostics)
    assert given is not None
    assert extension is not None
    mechanism = link(given, extension, diagnostics)
    assert mechanism is not None
    return ReadRobot("robot.yaml", diagnostics, given, mechanism, extension)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("name_mot: [motor, follow]\n", "  follow: {mimic: false}\n"),
        ("joint_name: [follow]\njoint_type: [FIXED]\n", "  follow: {type: fixed, mimic: false}\n"),
        ("joint_name: [grip]\njoint_type: [FIXED]\n", "  follow: {mimic: false}\n"),
    ],
)
def test_mimic_joints_are_freed_in_version_2_1(text: str, said: str) -> None:
    description = with_mimics(text)
    migration = migrate(description)
    assert migration.text.startswith('extended_urdf: "2.1"\n')
    assert said in migration.text
    assert any("'mimic: false'" in note and "joint 'follow'" in note for note in migration.notes)
    assert migration.mechanism.version == "2.1"
    assert_same_motion(description.mechanism, migration.mechanism)


def test_merged_joints_that_mimic_are_freed_in_their_entry() -> None:
    urdf = MIMICKING.replace('<child link="wrist_2"/>', '<child link="wrist_2"/><mimic joint="motor"/>')
    migration = migrate(with_mimics("closed_loop: []\n", urdf))
    assert "merges: [wrist_x, wrist_y, wrist_z], mimic: false}" in migration.text
    assert {joint.name: joint.type.value for joint in migration.mechanism.joints}["wrist_z"] == "spherical"


def test_mimic_joint_without_leader_is_not_migrated() -> None:
    urdf = MIMICKING.replace('mimic joint="grip"', 'mimic joint="nobody"')
    with pytest.raises(NotMigratable, match="'follow' mimics 'nobody', which does not exist") as found:
        migrate(with_mimics("name_mot: [follow]\n", urdf))
    assert "remove it from the URDF (line 65)" in str(found.value)


def test_first_line_names_the_schema_of_the_version_written() -> None:
    text = "# yaml-language-server: $schema=../schema/extended-urdf-1.schema.json\nname_mot: [follow]\n"
    description = with_mimics(text)
    named = schema_named(description.description.document, description.urdf)
    assert named == "../schema/extended-urdf-2.1.schema.json"
    assert schema_named(description.description.document, URDF) == "../schema/extended-urdf-2.0.schema.json"


def test_windows_line_ends_change_nothing() -> None:
    description = described(COMMENTED.replace("\n", "\r\n"))
    assert (
        migrate(description, schema=schema_named(description.description.document, description.urdf)).text == MIGRATED
    )


def test_plain_urdf_has_nothing_to_migrate(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["migrate", str(WORKBENCH)]) == 2
    assert "eurdf generate" in capsys.readouterr().err


def test_json_contains_text_and_changes(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["migrate", str(folder), "--json"]) == 0
    answer = json.loads(capsys.readouterr().out)
    assert (answer["from"], answer["to"], answer["output"]) == ("1", "2.0", None)
    assert answer["text"] == MIGRATED
    assert any("wrist_z" in note for note in answer["notes"])


def test_python_migrates_as_the_command(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text, urdf = (ROBOTS / "four_bar" / "robot.v1.yaml"), ROBOTS / "four_bar" / "robot.urdf"
    assert main(["migrate", str(text), "--schema", "none"]) == 0
    made = eurdf.migrate(text)
    assert made.text == capsys.readouterr().out
    assert differences(eurdf.load(made.text, urdf).mechanism, eurdf.load(text).mechanism) == []
    assert "urdf: ../a.urdf" in eurdf.migrate(text, urdf_path="../a.urdf").text.splitlines()
    assert repr(made).startswith("<Migration to version 2.0: ")
    again = eurdf.migrate(made.text, urdf)
    assert (again.text, again.mechanism) == (made.text, made.mechanism)
    assert again.notes == ("'<description>' already has version 2.0: nothing to do",)


def test_python_says_why_nothing_is_migrated() -> None:
    with pytest.raises(CannotMigrate, match="is a plain URDF"):
        eurdf.migrate(ROBOTS / "four_bar" / "robot.urdf")
    elbow = "joint_name: [elbow]\njoint_type: [UJOINT_XY]\nname_mot: [elbow_X]\n"
    with pytest.raises(CannotMigrate, match=r"cannot migrate: <description>:3: actuator 'elbow_X' is one of"):
        eurdf.migrate(elbow, PLAIN_WORKBENCH)
