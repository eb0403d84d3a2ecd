"""The reference and the examples behind the protocol: what they say of robots, in the terms of the specification."""

from __future__ import annotations

import json
import re
import shutil
from collections.abc import Callable, Sequence
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import pytest

from eurdf_conformance import adapters
from eurdf_conformance.adapters import example
from eurdf_conformance.adapters.reference import Reference
from eurdf_conformance.certificate.certificate import read_certificate
from eurdf_conformance.comparison.canonical import canonical_differences
from eurdf_conformance.level import Level
from eurdf_conformance.oracle import read
from eurdf_conformance.protocol.message import (
    REQUEST,
    Accepted,
    AnyAnswer,
    CanonicalJoint,
    CanonicalRobot,
    Errored,
    Evaluated,
    Quantity,
    Rejected,
    Unsupported,
    Values,
)
from eurdf_conformance.runner.answer import read_answer
from eurdf_conformance.runner.outcome import Answered, Malformed, Misplaced, Outcome
from eurdf_conformance.runner.session import Session
from support.every_joint import ARMATURES, CONFIGURATION, MASSES, VELOCITIES, moved, write_every_joint
from support.plain_urdf import inertial, joint_element, link_element
from support.plain_urdf import robot as urdf_of
from support.processes import MODULES, why_not_installed
from support.session import SharedRun

ROOT = Path(__file__).parents[2]
ROBOTS = ROOT / "robots"
REFERENCE = "eurdf_conformance.adapters.reference:PARSER"
EXAMPLE = "eurdf_conformance.adapters.example:Example"
JAVASCRIPT = Path(example.__file__).with_name("example.mjs")
NO_JAVASCRIPT = why_not_installed("yaml", "@xmldom/xmldom")

LIMITED = '<axis xyz="0 0 1"/><limit lower="-1" upper="2" effort="3" velocity="4"/>'

#: A closure that no configuration closes.
FAR = "closures:\n  - {name: c, type: 3d, frames: [{link: base, xyz: [9, 0, 0]}, hand]}\n"

NEGATIVE = (
    '<link name="a"><inertial><mass value="-1"/>'
    '<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>'
)


def answer_of(outcome: Outcome) -> AnyAnswer:
    assert isinstance(outcome, Answered), str(outcome)
    return outcome.answer


def load(
    folder: Path, description: str, urdf: str | None = None, parser: Reference | None = None
) -> Accepted | Rejected:
    """What the reference makes of two files; by default the URDF is a plain arm of two links."""
    if urdf is None:
        weight = inertial(1.0, '<origin xyz="0.1 0 0"/>')
        links = [link_element(name, weight) for name in ("base", "arm", "hand")]
        joints = [
            joint_element("a", "revolute", "base", "arm", LIMITED),
            joint_element("b", "revolute", "arm", "hand", LIMITED),
        ]
        urdf = urdf_of(*links, *joints)
    (folder / "robot.yaml").write_text(description, encoding="utf-8")
    (folder / "robot.urdf").write_text(urdf, encoding="utf-8")
    return (parser or Reference()).load(folder / "robot.yaml", folder / "robot.urdf")


def canonical(answer: Any) -> CanonicalRobot:
    assert isinstance(answer, Accepted), answer
    assert answer.robot is not None
    return answer.robot


def joint_named(robot: CanonicalRobot, name: str) -> CanonicalJoint:
    return next(joint for joint in robot.joints if joint.name == name)


# -- the canonical description ---------------------------------------------------------------------------------------


def test_the_reference_gives_its_name_and_claims_every_level() -> None:
    with Session(REFERENCE) as session:
        assert session.started.claims == {"1": list(Level), "2": list(Level), "2.1": list(Level)}
        assert session.started.parser.name == "eurdf"


def test_answers_are_independent_of_style(tmp_path: Path) -> None:
    robot = canonical(Reference().load(*write_every_joint(tmp_path)))
    assert (robot.name, robot.version, robot.root) == ("every joint", "2", "floating")
    assert sorted(robot.links) == sorted(f"link_{index}" for index in range(15))
    assert robot.frames == ["tip"]
    types = {joint.name: joint.type for joint in robot.joints}
    assert types == {
        "turn": "revolute", "spin": "continuous", "slide": "prismatic", "plane": "planar", "fly": "floating",
        "ball": "spherical", "cardan": "universal", "skew_cardan": "universal", "cylinder": "cylindrical",
        "screw": "helical", "merged": "spherical", "follower": "revolute",
    }  # fmt: skip
    assert [(each.name, each.type, each.a, each.b) for each in robot.closures] == [
        ("far", "6d", "link_14", "link_0"),
        ("near", "3d", "link_4", "link_14"),
    ]
    assert [(each.joint, each.gear_ratio, each.rotor_inertia) for each in robot.actuators] == [
        ("turn", [1.0], [0.0]),
        ("slide", [50.0], [1e-4]),
    ]
    assert robot.configurations == {"ready": {"turn": [0.3], "ball": [0.0, 0.0, 0.6, 0.8], "screw": [0.5]}}
    assert robot.own == {"/x-note": {"series": 7}}


def test_each_coordinate_has_a_limit_or_null(tmp_path: Path) -> None:
    robot = canonical(Reference().load(*write_every_joint(tmp_path)))
    turn, spin, ball, cylinder = (joint_named(robot, name) for name in ("turn", "spin", "ball", "cylinder"))
    assert (turn.lower, turn.upper, turn.velocity, turn.effort) == ([-3.0], [3.0], [5.0], [10.0])
    assert (spin.lower, spin.upper, spin.velocity) == ([None], [None], [None])
    assert (ball.lower, ball.upper, ball.velocity, ball.armature) == ([], [], [5.0] * 3, [0.1] * 3)
    assert (cylinder.lower, cylinder.upper, cylinder.effort) == ([None, -3.0], [None, 3.0], [10.0] * 2)
    for name in ("plane", "fly"):
        joint = joint_named(robot, name)
        assert (joint.lower, joint.upper) == ([], [])
        assert joint.effort == [None] * VELOCITIES[name][1]
    follower = joint_named(robot, "follower").mimic
    assert follower is not None
    assert (follower.joint, follower.multiplier, follower.offset) == ("turn", -0.5, 0.2)


def test_version_1_universal_joint_has_a_virtual_body(tmp_path: Path) -> None:
    robot = canonical(load(tmp_path, "joint_name: [a]\njoint_type: [UJOINT_XZ]\nname_mot: [a_X]\nmine: {deep: [1]}\n"))
    assert robot.version == "1"
    first, second = joint_named(robot, "a_X"), joint_named(robot, "a_Z")
    assert (first.parent, second.child) == ("base", "arm")
    assert first.child == second.parent
    assert first.child not in robot.links
    assert robot.frames == []
    assert robot.own == {"/mine": {"deep": [1]}}


def test_a_locked_joint_is_not_listed(tmp_path: Path) -> None:
    robot = canonical(load(tmp_path, 'extended_urdf: "2.0"\njoints: {b: fixed}\n'))
    assert [joint.name for joint in robot.joints] == ["a"]


# -- right and wrong -------------------------------------------------------------------------------------------------


def test_an_invalid_description_is_rejected_with_code_and_place(tmp_path: Path) -> None:
    answer = load(tmp_path, 'extended_urdf: "2.0"\nactuators:\n  - elbow\n')
    assert isinstance(answer, Rejected)
    (issue,) = answer.issues
    assert (issue.code, issue.severity, issue.file) == ("unknown-actuator", "error", "robot.yaml")
    assert (issue.line, issue.column) == (3, 5)
    assert "elbow" in issue.message


def test_urdf_error_is_reported_in_the_urdf(tmp_path: Path) -> None:
    answer = load(tmp_path, 'extended_urdf: "2.0"\n', urdf_of('<link name="a"/>', '<link name="b"/>'))
    assert isinstance(answer, Rejected)
    assert [(issue.code, issue.file) for issue in answer.issues] == [("urdf-two-roots", "robot.urdf")]


@pytest.mark.parametrize(
    ("description", "urdf", "code"),
    [
        ("", NEGATIVE, "negative-mass"),
        (FAR, None, "closure-cannot-close"),
        (FAR + "configurations: {assembled: {}}\n", None, "assembled-open"),
    ],
)
def test_inertia_or_closure_error_accompanies_the_robot(
    tmp_path: Path, description: str, urdf: str | None, code: str
) -> None:
    answer = load(tmp_path, f'extended_urdf: "2.0"\n{description}', None if urdf is None else urdf_of(urdf))
    assert isinstance(answer, Accepted)
    assert answer.robot is not None
    assert [(issue.code, issue.severity) for issue in answer.issues] == [(code, "error")]


def test_warning_accompanies_the_robot(tmp_path: Path) -> None:
    answer = load(tmp_path, "name_motor: [a]\n")
    assert isinstance(answer, Accepted)
    assert [(issue.code, issue.severity) for issue in answer.issues] == [("near-miss-key", "warning")]


def test_missing_urdf_is_reported_in_the_description(tmp_path: Path) -> None:
    (tmp_path / "robot.yaml").write_text('extended_urdf: "2.0"\nurdf: other.urdf\n', encoding="utf-8")
    answer = Reference().load(tmp_path / "robot.yaml", tmp_path / "other.urdf")
    assert isinstance(answer, Rejected)
    assert [(issue.code, issue.line) for issue in answer.issues] == [("urdf-not-found", 2)]


def test_a_missing_description_is_rejected(tmp_path: Path) -> None:
    answer = Reference().load(tmp_path / "robot.yaml", tmp_path / "robot.urdf")
    assert isinstance(answer, Rejected)
    assert [issue.code for issue in answer.issues] == ["file-unreadable"]


def test_the_urdf_may_have_another_name_than_the_description_gives(tmp_path: Path) -> None:
    load(tmp_path, "name_mot: [a]\n")
    (tmp_path / "robot.urdf").rename(tmp_path / "arm.urdf")
    assert isinstance(Reference().load(tmp_path / "robot.yaml", tmp_path / "arm.urdf"), Accepted)


# -- values ----------------------------------------------------------------------------------------------------------


@cache
def every_joint() -> Reference:
    parser = Reference()
    with TemporaryDirectory() as folder:
        assert isinstance(parser.load(*write_every_joint(Path(folder))), Accepted)
    return parser


def value_at(configuration: Any, quantities: Sequence[Quantity], frames: Sequence[str] = ()) -> Values:
    (values,) = every_joint().evaluate([configuration], frames, quantities)
    return values


def derivatives(quantity: Any, step: float = 1e-5) -> dict[tuple[str, int], Any]:
    """Central differences of a function of the configuration, along each velocity of the specification's table."""
    return {
        (joint, index): (
            quantity(moved(CONFIGURATION, joint, index, step)) - quantity(moved(CONFIGURATION, joint, index, -step))
        )
        / (2.0 * step)
        for joint, (_, nv) in VELOCITIES.items()
        for index in range(nv)
    }


def test_columns_name_every_velocity_once() -> None:
    values = value_at(CONFIGURATION, ["jacobian", "mass_matrix"])
    assert values.jacobian is not None
    assert values.mass_matrix is not None
    expected = {(joint, index) for joint, (_, nv) in VELOCITIES.items() for index in range(nv)}
    for columns in (values.jacobian.columns, values.mass_matrix.columns):
        assert len(columns) == len(expected)
        assert set(columns) == expected


def test_the_jacobian_is_the_derivative_of_the_residuals() -> None:
    def residuals(configuration: Any) -> Any:
        given = value_at(configuration, ["residuals"]).residuals
        assert given is not None
        return np.concatenate([given["far"], given["near"]])

    jacobian = value_at(CONFIGURATION, ["jacobian"]).jacobian
    assert jacobian is not None
    assert [len(jacobian.rows[name]) for name in ("far", "near")] == [6, 3]
    K = np.array(jacobian.rows["far"] + jacobian.rows["near"])
    for (joint, index), expected in derivatives(residuals).items():
        column = K[:, jacobian.columns.index((joint, index))]
        np.testing.assert_allclose(column, expected, atol=1e-8, err_msg=f"{joint} {index}")


def test_the_mass_matrix_gives_the_kinetic_energy_with_armatures() -> None:
    links = list(MASSES)

    def poses(configuration: Any) -> Any:
        given = value_at(configuration, ["poses"], links).poses
        assert given is not None
        return np.array([np.column_stack([given[link].rotation, given[link].translation]) for link in links])

    here = poses(CONFIGURATION)
    twists = {}
    for velocity, rates in derivatives(poses).items():
        spins = rates[:, :, :3] @ here[:, :, :3].transpose(0, 2, 1)
        turning = np.column_stack([spins[:, 2, 1], spins[:, 0, 2], spins[:, 1, 0]])
        centers = np.array([MASSES[link][1] for link in links])
        twists[velocity] = np.einsum("lij,lj->li", rates[:, :, :3], centers) + rates[:, :, 3], turning
    mass_matrix = value_at(CONFIGURATION, ["mass_matrix"]).mass_matrix
    assert mass_matrix is not None
    M = np.array(mass_matrix.matrix)
    masses = np.array([MASSES[link][0] for link in links])
    inertias = (
        here[:, :, :3] @ np.array([np.diag(MASSES[link][2]) for link in links]) @ here[:, :, :3].transpose(0, 2, 1)
    )
    for i, one in enumerate(mass_matrix.columns):
        for j, other in enumerate(mass_matrix.columns):
            linear = (masses[:, None] * twists[one][0] * twists[other][0]).sum()
            angular = np.einsum("li,lij,lj->", twists[one][1], inertias, twists[other][1])
            armature = ARMATURES.get(one, 0.0) if i == j else 0.0
            assert M[i, j] == pytest.approx(linear + angular + armature, abs=1e-6), (one, other)


def test_mass_and_center_of_mass_include_the_root() -> None:
    links = list(MASSES)
    values = value_at(CONFIGURATION, ["mass", "center_of_mass", "poses"], links)
    assert values.poses is not None
    assert values.mass == pytest.approx(sum(mass for mass, _, _ in MASSES.values()))
    moment = sum(
        MASSES[link][0] * (np.array(values.poses[link].rotation) @ MASSES[link][1] + values.poses[link].translation)
        for link in links
    )
    np.testing.assert_allclose(values.center_of_mass, moment / values.mass, atol=1e-12)


def test_a_merged_joint_still_names_the_frame_of_its_link() -> None:
    pairs = {"turn": "link_1", "merged": "link_13", "m3": "link_13", "m1": "link_11", "follower": "link_14"}
    poses = value_at(CONFIGURATION, ["poses"], [*pairs, *pairs.values(), "tip"]).poses
    assert poses is not None
    for joint, link in pairs.items():
        assert poses[joint] == poses[link]


def test_answer_has_only_requested_quantities() -> None:
    values = value_at({}, ["mass"])
    assert values.mass is not None
    assert values.model_dump(exclude_none=True).keys() == {"mass"}


def test_a_mimic_joint_has_no_column(tmp_path: Path) -> None:
    """Also where it comes before its leader, in the order of the tree."""
    mimic = LIMITED + '<mimic joint="z_leader" multiplier="2" offset="0.1"/>'
    weight = inertial(1.5, '<origin xyz="0.1 0.2 0"/>')
    links = [link_element(name, weight) for name in ("base", "a", "z")]
    joints = [
        joint_element("a_follower", "revolute", "base", "a", mimic),
        joint_element("z_leader", "revolute", "base", "z", LIMITED, '<origin xyz="0.3 0 0"/>'),
    ]
    closure = "closures:\n  - {name: c, type: 3d, frames: [{link: a, xyz: [0.2, 0, 0]}, {link: z, xyz: [0, 0.2, 0]}]}\n"
    parser = Reference()
    load(tmp_path, f'extended_urdf: "2.0"\n{closure}', urdf_of(*links, *joints), parser)
    step = 1e-6
    here, ahead, back = parser.evaluate(
        [{"z_leader": [0.4]}, {"z_leader": [0.4 + step]}, {"z_leader": [0.4 - step]}],
        ["a", "z"],
        ["poses", "residuals", "jacobian", "mass_matrix"],
    )
    assert here.jacobian is not None
    assert here.mass_matrix is not None
    assert here.poses is not None
    assert here.jacobian.columns == here.mass_matrix.columns == [("z_leader", 0)]
    for link, angle in (("a", 0.9), ("z", 0.4)):
        assert here.poses[link].rotation[0][0] == pytest.approx(np.cos(angle))
    assert ahead.residuals is not None
    assert back.residuals is not None
    expected = (np.array(ahead.residuals["c"]) - back.residuals["c"]) / (2.0 * step)
    np.testing.assert_allclose(np.array(here.jacobian.rows["c"])[:, 0], expected, atol=1e-8)
    about_the_joint = 0.25 + 1.5 * (0.1**2 + 0.2**2)  # kg m², of either link; the follower turns twice as fast
    assert here.mass_matrix.matrix == [[pytest.approx((1.0 + 2.0**2) * about_the_joint)]]


def test_a_universal_joint_of_version_1_has_two_columns(tmp_path: Path) -> None:
    parser = Reference()
    load(tmp_path, "joint_name: [a]\njoint_type: [UJOINT_XZ]\nclosed_loop: [[base, hand]]\n", parser=parser)
    (values,) = parser.evaluate([{"a_X": [0.1], "a_Z": [0.2]}], ["a"], ["poses", "jacobian"])
    assert values.jacobian is not None
    assert sorted(values.jacobian.columns) == [("a_X", 0), ("a_Z", 0), ("b", 0)]
    assert len(values.jacobian.rows["closure_1"]) == 6
    assert values.poses is not None
    expected = [
        np.cos(0.2),
        np.cos(0.1) * np.sin(0.2),
        np.sin(0.1) * np.sin(0.2),
    ]  # the first column of Rx(0.1) Rz(0.2)
    np.testing.assert_allclose(np.array(values.poses["a"].rotation)[:, 0], expected, atol=1e-12)


@pytest.mark.parametrize(
    ("configuration", "frames", "words"),
    [
        ({"elbow": [0.0]}, [], "'elbow' is not a joint with coordinates"),
        ({"cardan": [0.0]}, [], "joint 'cardan' is given 1 coordinates; it has 2"),
        ({}, ["elbow"], "'elbow' is not a link, joint or frame"),
    ],
)
def test_a_senseless_request_is_errored(configuration: Any, frames: Sequence[str], words: str) -> None:
    with TemporaryDirectory() as folder, Session(REFERENCE) as session:
        assert isinstance(answer_of(session.load(*write_every_joint(Path(folder)))), Accepted)
        answer = answer_of(session.evaluate([configuration], frames, ["poses"]))
        assert isinstance(answer, Errored)
        assert words in answer.message
        assert isinstance(answer_of(session.evaluate([CONFIGURATION], ["tip"], ["poses"])), Evaluated)


def test_evaluating_without_an_accepted_robot_is_errored(tmp_path: Path) -> None:
    robot, missing = write_every_joint(tmp_path), tmp_path / "missing.yaml"
    with Session(REFERENCE) as session:
        for load, outcome in ((None, Errored), (robot, Evaluated), ((missing, robot[1]), Errored), (robot, Evaluated)):
            if load:
                session.load(*load)
            answer = answer_of(session.evaluate([CONFIGURATION], ["tip"], ["poses"]))
            assert isinstance(answer, outcome)
            assert outcome is Evaluated or "the last load did not accept a robot" in answer.message


def test_a_massless_robot_has_no_center_of_mass(tmp_path: Path) -> None:
    parser = Reference()
    load(tmp_path, 'extended_urdf: "2.0"\n', urdf_of('<link name="a"/>'), parser)
    (values,) = parser.evaluate([{}], [], ["mass", "center_of_mass"])
    assert (values.mass, values.center_of_mass) == (0.0, None)


def test_robots_of_the_collection_are_closed_at_assembled() -> None:
    with Session(REFERENCE, timeout=60.0) as session:
        for name in ("four_bar", "digit_leg", "delta"):
            for version in ("robot.yaml", "robot.v1.yaml"):
                files = ROBOTS / name / version, ROBOTS / name / "robot.urdf"
                robot = canonical(answer_of(session.load(*files)))
                if robot.version == "1":
                    continue
                answer = answer_of(session.evaluate([robot.configurations["assembled"]], robot.links, ["residuals"]))
                assert isinstance(answer, Evaluated)
                residuals = answer.values[0].residuals
                assert residuals is not None
                assert residuals.keys() == {closure.name for closure in robot.closures}
                assert max(abs(value) for rows in residuals.values() for value in rows) < 1e-9


# -- the examples ----------------------------------------------------------------------------------------------------


@pytest.fixture
def javascript(tmp_path: Path) -> str:
    """The example, beside the libraries that it imports, as whoever follows the page has it."""
    folder = tmp_path / "adapter"
    folder.mkdir()
    shutil.copy(JAVASCRIPT, folder)
    (folder / "node_modules").symlink_to(MODULES)
    return f"cmd:node {folder / JAVASCRIPT.name}"


def examples() -> Any:
    skip = pytest.mark.skipif(bool(NO_JAVASCRIPT), reason=NO_JAVASCRIPT)
    return pytest.mark.parametrize("example", [EXAMPLE, pytest.param("javascript", marks=skip)])


def parser_of(example: str, request: pytest.FixtureRequest) -> str:
    return str(request.getfixturevalue("javascript")) if example == "javascript" else example


@examples()
def test_an_example_and_the_reference_agree_on_plain_robots(example: str, request: pytest.FixtureRequest) -> None:
    names = sorted(path.parent.name for path in ROBOTS.glob("*/robot.v1.yaml") if "joint_name" not in path.read_text())
    assert len(names) >= 5
    with Session(parser_of(example, request)) as session:
        assert session.started.claims == {"1": ["accept", "structure"]}
        for name in names:
            files = ROBOTS / name / "robot.v1.yaml", ROBOTS / name / "robot.urdf"
            given, expected = canonical(answer_of(session.load(*files))), canonical(Reference().load(*files))
            assert canonical_differences(expected, given, read(*files).bodies) == [], name
    assert isinstance(session.ended, Answered)


@examples()
@pytest.mark.parametrize(
    ("description", "urdf", "kind"),
    [
        ("name_mot: [motor]\nmine: 3\n", '<robot name="r"><link name="a"/></robot>', Accepted),
        ("closed_loop: [[a, nowhere]]\n", '<robot name="r"><link name="a"/></robot>', Rejected),
        ("closed_loop: [[a, a]]\ntype: [4d]\n", '<robot name="r"><link name="a"/></robot>', Rejected),
        ("closed_loop: [[a, a]]\ntype: []\n", '<robot name="r"><link name="a"/></robot>', Rejected),
        ("closed_loop: [[a, a]\n", '<robot name="r"><link name="a"/></robot>', Rejected),
        ("mine: \udcff\n", '<robot name="r"><link name="a"/></robot>', Rejected),
        ("mine: 3\n", '<robot name="r"><link name="a"></robot>', Rejected),
        ("joint_name: [a]\njoint_type: [SPHERICAL]\n", '<robot name="r"><link name="a"/></robot>', Unsupported),
        ('extended_urdf: "2.0"\n', '<robot name="r"><link name="a"/></robot>', Unsupported),
    ],
)
def test_an_example_distinguishes_invalid_from_unsupported(
    tmp_path: Path, example: str, description: str, urdf: str, kind: type[AnyAnswer], request: pytest.FixtureRequest
) -> None:
    (tmp_path / "robot.yaml").write_text(description, encoding="utf-8", errors="surrogateescape")
    (tmp_path / "robot.urdf").write_text(urdf, encoding="utf-8")
    with Session(parser_of(example, request)) as session:
        assert isinstance(answer_of(session.load(tmp_path / "robot.yaml", tmp_path / "robot.urdf")), kind)
        assert session.restarts == 0


# -- the page ----------------------------------------------------------------------------------------------------------


def blocks(language: str) -> list[str]:
    """The blocks of code of that language on the page."""
    text = (ROOT / "docs" / "write_an_adapter.md").read_text(encoding="utf-8")
    return re.findall(rf"^```{language}\n(.*?)^```$", text, re.DOTALL | re.MULTILINE)


def test_the_page_shows_the_examples_as_they_are() -> None:
    assert blocks("python") == [Path(example.__file__).read_text(encoding="utf-8")]
    assert blocks("js") == [JAVASCRIPT.read_text(encoding="utf-8")]


def test_the_conversation_on_the_page_keeps_the_protocol() -> None:
    (conversation,) = blocks("text")
    lines = conversation.splitlines()
    assert len(lines) >= 8
    for asked, answered in zip(lines[::2], lines[1::2], strict=True):
        request = REQUEST.validate_json(asked.removeprefix("→ "))
        found = read_answer(answered.removeprefix("← ").encode(), request)
        assert not isinstance(found, Malformed | Misplaced), str(found)


PARSER = Path(adapters.__file__).with_name("javascript")
MISSING = why_not_installed("yaml", "saxes")
LEVELS = ("accept", "structure", "kinematics", "dynamics")


def test_the_tests_install_what_the_parser_declares() -> None:
    declared = json.loads((PARSER / "package.json").read_text(encoding="utf-8"))["dependencies"]
    installed = json.loads((MODULES.parent / "package.json").read_text(encoding="utf-8"))["dependencies"]
    assert declared.items() <= installed.items()


@pytest.mark.slow
@pytest.mark.skipif(bool(MISSING), reason=MISSING)
def test_the_javascript_parser_is_certified_at_the_levels_it_claims(
    tmp_path: Path, shared_run: Callable[..., SharedRun]
) -> None:
    folder = tmp_path / "extended-urdf"
    shutil.copytree(PARSER, folder, ignore=shutil.ignore_patterns("node_modules"))
    (folder / "node_modules").symlink_to(MODULES)
    # The newest version, which has few cases; the workflow of the repository certifies it for all of them.
    done = shared_run("--parser", f"cmd:node {folder / 'main.mjs'}", "--seed", "0", "--format-version", "2.1")
    assert done.returncode == 0, done.stdout + done.stderr
    certificate = read_certificate(Path(done.certificate))
    assert certificate.failures == ()
    certified = {(level.version, level.level) for level in certificate.levels if level.certified}
    assert certified == {("2.1", level) for level in LEVELS}
