"""The comparison of answers: what is the same in another style is equal, what is not the same is not."""

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st

from canonical import READ, number_at, numbers_in, restyled, with_number
from eurdf_conformance.comparison.canonical import canonical_differences
from eurdf_conformance.comparison.coordinates import COORDINATES, neutral, same_coordinates
from eurdf_conformance.comparison.difference import ABSENT, Difference
from eurdf_conformance.comparison.half_turn import twin_residual, twin_rows
from eurdf_conformance.comparison.issues import error_differences, warning_differences
from eurdf_conformance.comparison.text import same_text
from eurdf_conformance.comparison.values import values_differences
from eurdf_conformance.corpus.case import CasePlace, ExpectedWarning
from eurdf_conformance.corpus.expected import Expected
from eurdf_conformance.oracle.logarithm import log6
from eurdf_conformance.protocol.message import CanonicalRobot, Issue, Values

slow = settings(suppress_health_check=[HealthCheck.too_slow], deadline=None, max_examples=200)


# Texts


@pytest.mark.parametrize(
    ("one", "other", "same"),
    [
        ("xyz='0.1 -2e-5 3'", "xyz='0.10000000001\n  -0.00002 3.'", True),
        ("[0, 1.5]", "[-1e-13, 1.5]", True),
        ("[0, 1.5]", "[1e-11, 1.5]", False),
        ("mass: 2.0", "mass: 2.00001", False),
        ("mass: 2.0", "weight: 2.0", False),
        ("rod_1 at 2", "rod_2 at 2", False),
        ("1 2", "1 2 3", False),
    ],
)
def test_texts_are_compared_up_to_rounding_and_white_space(one: str, other: str, same: bool) -> None:
    assert same_text(one, other, relative=1e-9, absolute=1e-12) is same
    assert same_text(other, one, relative=1e-9, absolute=1e-12) is same


# The canonical description


@slow
@given(st.data(), st.sampled_from(READ))
def test_a_description_is_equal_to_itself_in_another_style(data: st.DataObject, read: Expected) -> None:
    other = data.draw(restyled(read))
    assert canonical_differences(read.robot, other, read.bodies) == []
    assert canonical_differences(other, read.robot, read.bodies) == []


@slow
@given(st.data(), st.sampled_from(READ))
def test_a_changed_number_is_a_difference_with_its_pointer(data: st.DataObject, read: Expected) -> None:
    robot = read.robot.model_dump(mode="json")
    places = numbers_in(robot)
    assume(places)
    where = data.draw(st.sampled_from(places))
    number = number_at(robot, where)
    changed = CanonicalRobot.model_validate(with_number(robot, where, number + 1e-5 * max(1.0, abs(number))))
    found = canonical_differences(read.robot, changed, read.bodies)
    assert len(found) == 1
    pointed = found[0].pointer.split("/")[1:]
    assert [str(step).replace("~", "~0").replace("/", "~1") for step in where][: len(pointed)] == pointed


def joint(name: str, kind: str = "revolute", parent: str = "a", child: str = "b", **more: Any) -> dict[str, Any]:
    bounded = {"lower": [-1.0], "upper": [1.0]} if kind == "revolute" else {"lower": [None], "upper": [None]}
    zeros = {key: [0.0] for key in ("velocity", "effort", "damping", "friction", "armature")}
    return {"name": name, "type": kind, "parent": parent, "child": child, **bounded, **zeros, **more}


def universal_joint(**more: Any) -> dict[str, Any]:
    lists = {key: [0.0, 0.0] for key in ("velocity", "effort", "damping", "friction", "armature")}
    return joint("j", "universal", lower=[-1.0, -1.0], upper=[1.0, 1.0], **lists, **more)


def assert_same(one: CanonicalRobot, other: CanonicalRobot) -> None:
    assert canonical_differences(one, other, BODIES) == canonical_differences(other, one, BODIES) == []


def pointers(one: CanonicalRobot, other: CanonicalRobot) -> list[str]:
    return [found.pointer for found in canonical_differences(one, other, BODIES)]


def robot(joints: list[dict[str, Any]], **more: Any) -> CanonicalRobot:
    empty = {"closures": [], "actuators": [], "configurations": {}, "own": {}, "frames": []}
    whole = {"name": "r", "version": "2", "root": "fixed", "links": ["a", "b", "c"], "joints": joints}
    return CanonicalRobot.model_validate(whole | empty | more)


BODIES = [["a"], ["c", "b"]]


def test_missing_entry_is_reported_after_other_errors() -> None:
    expected = robot([joint("j"), joint("k", parent="b", child="c")])
    found = canonical_differences(expected, robot([joint("j", damping=[7.0])]), [["a"], ["b"], ["c"]])
    assert [each.pointer for each in found] == ["/joints/0/damping/0", "/joints"]


def test_any_link_of_a_body_identifies_it() -> None:
    assert canonical_differences(robot([joint("j")]), robot([joint("j", child="c")]), BODIES) == []
    (found,) = canonical_differences(robot([joint("j")]), robot([joint("j", child="a")]), BODIES)
    assert (found.pointer, found.expected, found.given) == ("/joints/0/child", "b", "a")


def test_two_revolutes_around_a_massless_body_equal_a_universal_joint() -> None:
    universal = universal_joint()
    pair = [joint("j_X", child="between"), joint("j_Y", parent="between", child="c")]
    other_names = [pair[0] | {"name": "j"}, pair[1] | {"name": "other"}]
    for halves in (pair, pair[::-1], other_names):
        assert canonical_differences(robot([universal]), robot(halves), BODIES) == []
    # A body that is a link of the URDF is no body in between, whatever the parser lists.
    real = [joint("j_X", child="b"), joint("j_Y", parent="b", child="c")]
    assert canonical_differences(robot([universal]), robot(real), [["a"], ["b"], ["c"]])
    # Neither is one that carries a third joint.
    third = joint("k", parent="between", child="a")
    assert canonical_differences(robot([universal]), robot([*pair, third]), BODIES)


def test_properties_of_both_halves_belong_to_the_universal_joint() -> None:
    pair = [joint("j_X", child="between"), joint("j_Y", parent="between", child="c")]
    both = [{"joint": "j_X", "gear_ratio": [2.0]}, {"joint": "j_Y", "rotor_inertia": [3.0]}]
    one = robot(pair, actuators=both, configurations={"q": {"j_Y": [0.5]}})
    universal = universal_joint()
    motor = {"joint": "j", "gear_ratio": [2.0, 1.0], "rotor_inertia": [0.0, 3.0]}
    other = robot([universal], actuators=[motor], configurations={"q": {"j": [0.0, 0.5]}})
    assert_same(one, other)
    half = robot(pair, actuators=both[:1], configurations={"q": {"j_Y": [0.5]}})
    assert [found.why for found in canonical_differences(one, half, BODIES)] == [
        "actuator of joint 'j' is missing",
        "unexpected actuator of joint 'j_X'",
    ]


@pytest.mark.parametrize(
    "springs", [{"stiffness": [0.0]}, {"stiffness": [0.0], "rest": [0.5]}, {"stiffness": [], "rest": []}]
)
def test_no_springs_are_springs_without_stiffness(springs: dict[str, Any]) -> None:
    assert_same(robot([joint("j")]), robot([joint("j", **springs)]))


@pytest.mark.parametrize(
    ("given", "pointer"),
    [
        ({}, "/joints/0/stiffness"),
        ({"stiffness": [4.0], "rest": [0.5]}, "/joints/0/stiffness/0"),
        ({"stiffness": [3.0], "rest": [0.4]}, "/joints/0/rest/0"),
        ({"stiffness": [3.0]}, "/joints/0/rest/0"),
        ({"stiffness": [3.0, 3.0], "rest": [0.5, 0.5]}, "/joints/0/stiffness"),
    ],
)
def test_other_springs_are_a_difference(given: dict[str, Any], pointer: str) -> None:
    expected = robot([joint("j", stiffness=[3.0], rest=[0.5])])
    assert canonical_differences(expected, expected, BODIES) == []
    assert canonical_differences(expected, robot([joint("j", **given)]), BODIES)[0].pointer == pointer


def test_springs_of_two_revolutes_belong_to_the_universal_joint() -> None:
    universal = universal_joint(stiffness=[0.0, 3.0], rest=[7.0, 0.5])
    pair = [joint("j_X", child="between"), joint("j_Y", parent="between", child="c", stiffness=[3.0], rest=[0.5])]
    assert canonical_differences(robot([universal]), robot(pair), BODIES) == []


def test_actuator_without_name_has_that_of_its_joint() -> None:
    one, named, other = (robot([joint("j")], actuators=[{"joint": "j", "name": name}]) for name in (None, "j", "k"))
    assert_same(one, named)
    assert pointers(one, other) == ["/actuators/0/name"]


@pytest.mark.parametrize("control", [[-1.0, 3.0], None])
def test_another_control_range_is_a_difference(control: Any) -> None:
    one, other = (robot([joint("j")], actuators=[{"joint": "j", "control": each}]) for each in ([-1.0, 2.0], control))
    (pointer,) = pointers(one, other)
    assert pointer.startswith("/actuators/0/control")


def test_closure_without_compliance_is_rigid() -> None:
    closure = {"name": "c", "type": "6d", "a": "a", "b": "b"}
    stated = ({}, {"compliance": {"linear": 0.0}}, {"compliance": {"angular": 0.1}})
    one, rigid, soft = (robot([joint("j")], closures=[closure | each]) for each in stated)
    assert_same(one, rigid)
    assert pointers(one, soft) == ["/closures/0/compliance"]


def test_senseless_joints_are_differences() -> None:
    ring = robot([joint("j_1", child="x", parent="x"), joint("j_2", parent="x", child="x")])
    chain = robot([joint("j", child="x"), joint("k", parent="x", child="y"), joint("l", parent="y", child="x")])
    for nonsense in (ring, chain, robot([joint("j", lower=[]), joint("j")])):
        assert canonical_differences(robot([joint("j")]), nonsense, BODIES)


def test_a_revolute_joint_without_limits_equals_a_continuous_one() -> None:
    continuous = robot([joint("j", "continuous")])
    assert canonical_differences(continuous, robot([joint("j", lower=[None], upper=[None])]), BODIES) == []
    assert canonical_differences(continuous, robot([joint("j", lower=[None])]), BODIES)


@pytest.mark.parametrize(
    ("kind", "one", "other", "same"),
    [
        ("continuous", [0.1], [0.1 - 4 * math.pi], True),
        ("continuous", [math.pi], [-math.pi], True),
        ("continuous", [0.1], [0.2], False),
        ("revolute", [0.1], [0.1 + 2 * math.pi], False),
        ("revolute", None, [0.0], True),
        ("revolute", None, [1e-3], False),
        ("revolute", [1e-3], None, False),
        ("revolute", [0.1], [0.1, 0.1], False),
        ("spherical", [0.6, 0.0, 0.0, 0.8], [-0.6, 0.0, 0.0, -0.8], True),
        ("spherical", [0.6, 0.0, 0.0, 0.8], [0.8, 0.6, 0.0, 0.0], False),
        ("spherical", None, [0.0, 0.0, 0.0, -1.0], True),
        ("floating", [1.0, 2.0, 3.0, 0.0, 0.6, 0.0, 0.8], [1.0, 2.0, 3.0, 0.0, -0.6, 0.0, -0.8], True),
        ("floating", [1.0, 2.0, 3.0, 0.0, 0.6, 0.0, 0.8], [-1.0, 2.0, 3.0, 0.0, -0.6, 0.0, -0.8], False),
    ],
)
def test_coordinates_of_a_configuration(kind: str, one: Any, other: Any, same: bool) -> None:
    def at(coordinates: Any) -> CanonicalRobot:
        return robot([joint("j", kind)], configurations={"q": {} if coordinates is None else {"j": coordinates}})

    found = canonical_differences(at(one), at(other), BODIES)
    assert (found == []) == same
    assert all(difference.pointer == "/configurations/q/j" for difference in found)


@pytest.mark.parametrize("kind", COORDINATES)
def test_a_wrong_number_of_coordinates_is_a_difference(kind: str) -> None:
    assert same_coordinates(kind, neutral(kind), neutral(kind))
    for wrong in ([], neutral(kind)[1:], [*neutral(kind), 0.0]):
        assert not same_coordinates(kind, wrong, wrong)
        assert not same_coordinates(kind, neutral(kind), wrong)


def test_missing_neutral_configuration_is_reported() -> None:
    (found,) = canonical_differences(robot([], configurations={"q": {}}), robot([]), BODIES)
    assert (found.pointer, found.expected, found.given) == ("/configurations/q", {}, ABSENT)


def test_user_data_is_compared_by_type_and_order() -> None:
    def own(value: Any) -> CanonicalRobot:
        return robot([], own={"/x-a": value})

    assert canonical_differences(own({"k": [1, 2.0]}), own({"k": [1.0, 2]}), BODIES) == []
    for other in ({"k": [True, 2]}, {"k": [2, 1]}, {"k": [1]}, {"k": [1, 2], "l": None}, None, "12", math.inf, 10**400):
        assert canonical_differences(own({"k": [1, 2]}), own(other), BODIES)
    assert canonical_differences(own(1), own(10**400), BODIES)


def test_duplicate_joint_is_a_difference() -> None:
    (found,) = canonical_differences(robot([joint("j")]), robot([joint("j"), joint("j")]), BODIES)
    assert found.pointer == "/joints/1"


# Values


def values(**quantities: Any) -> Values:
    return Values.model_validate(quantities, strict=False)


def test_the_tolerance_of_poses_scales_with_the_robots_size() -> None:
    eye = np.eye(3).tolist()

    def at(x: float) -> Values:
        return values(poses={"tip": {"rotation": eye, "translation": [x, 0.0, 0.0]}})

    assert values_differences(at(0.0), at(0.9e-8), size=0.1) == []
    (found,) = values_differences(at(0.0), at(1.1e-8), size=0.1)
    assert found.pointer == "/poses/tip/translation"
    assert values_differences(at(0.0), at(1.1e-8), size=2.0) == []


def test_the_tolerance_of_rotations_is_independent_of_size() -> None:
    def at(angle: float, x: float) -> Values:
        turned = [[math.cos(angle), -math.sin(angle), 0.0], [math.sin(angle), math.cos(angle), 0.0], [0.0, 0.0, 1.0]]
        pose = {"tip": {"rotation": turned, "translation": [x, 0.0, 0.0]}}
        rows = [[x], [x], [x], [angle], [angle], [angle]]
        K = {"columns": [("j", 0)], "rows": {"pin": rows}}
        return values(poses=pose, residuals={"pin": [x, x, x, angle, angle, angle]}, jacobian=K)

    assert values_differences(at(0.0, 0.0), at(0.9e-8, 0.9e-5), size=1000.0) == []
    found = values_differences(at(0.0, 0.0), at(1.1e-8, 0.9e-5), size=1000.0)
    assert [each.pointer for each in found] == ["/poses/tip/rotation", "/residuals/pin", "/jacobian/rows/pin/3/0"]
    assert all("off by 1.1e-08, allowed 1.0e-08" in each.why for each in found)


def test_a_missing_or_surplus_quantity_is_a_difference() -> None:
    expected = values(mass=1.0, residuals={"pin": [0.0, 0.0, 0.0]})
    assert [found.pointer for found in values_differences(expected, values(mass=1.0), 1.0)] == ["/residuals"]
    both = values(mass=1.0, residuals={"other": [0.0, 0.0, 0.0]})
    assert [found.why for found in values_differences(expected, both, 1.0)] == [
        "closure 'pin' is missing",
        "closure 'other' was not requested",
    ]


K = np.arange(12.0).reshape(3, 4)
COLUMNS = [("ball", 0), ("ball", 1), ("ball", 2), ("slide", 0)]


def jacobian(columns: Any, matrix: Any) -> Values:
    return values(jacobian={"columns": columns, "rows": {"pin": np.asarray(matrix).tolist()}})


def test_columns_of_k_can_have_any_order() -> None:
    order = [2, 3, 0, 1]
    shuffled = jacobian([COLUMNS[k] for k in order], K[:, order])
    assert values_differences(jacobian(COLUMNS, K), shuffled, 1.0) == []
    wrong = K[:, order].copy()
    wrong[1, 2] += 0.5
    (found,) = values_differences(jacobian(COLUMNS, K), jacobian([COLUMNS[k] for k in order], wrong), 1.0)
    assert (found.pointer, found.expected, found.given) == ("/jacobian/rows/pin/1/2", 4.0, 4.5)
    assert "velocity 0 of joint 'ball'" in found.why


@pytest.mark.parametrize(
    ("columns", "matrix", "pointer"),
    [
        (COLUMNS[:3], K[:, :3], "/jacobian/columns"),
        ([*COLUMNS, ("more", 0)], np.zeros((3, 5)), "/jacobian/columns/4"),
        ([*COLUMNS[:3], ("ball", 2)], K, "/jacobian/columns"),
        (COLUMNS, K[:2], "/jacobian/rows/pin"),
        (COLUMNS, K[:, :3], "/jacobian/rows/pin"),
    ],
)
def test_missing_and_surplus_columns_and_rows_are_differences(columns: Any, matrix: Any, pointer: str) -> None:
    found = values_differences(jacobian(COLUMNS, K), jacobian(columns, matrix), 1.0)
    assert pointer in [difference.pointer for difference in found]


def test_a_massless_robot_has_no_centre_of_mass() -> None:
    nothing = Values(mass=0.0)
    assert values_differences(nothing, Values(mass=0.0), 1.0) == []
    (found,) = values_differences(nothing, Values(mass=0.0, center_of_mass=[0.0, 0.0, 0.0]), 1.0)
    assert (found.pointer, found.given) == ("/center_of_mass", [0.0, 0.0, 0.0])
    assert values_differences(Values(poses={}), Values(poses={}, center_of_mass=[0.0, 0.0, 0.0]), 1.0) == []


def test_the_mass_matrix_is_compared_relative_to_its_largest_entry() -> None:
    M = np.diag([1e-6, 1.0, 100.0, 2.0])
    order = [3, 1, 0, 2]

    def given_as(matrix: Any) -> Values:
        columns = [COLUMNS[k] for k in order]
        return values(mass_matrix={"columns": columns, "matrix": matrix[np.ix_(order, order)].tolist()})

    expected = values(mass_matrix={"columns": COLUMNS, "matrix": M.tolist()})
    assert values_differences(expected, given_as(M + 0.9e-6), 1.0) == []
    (found,) = values_differences(expected, given_as(M + np.diag([2e-6, 0, 0, 0])), 1.0)
    assert found.pointer == "/mass_matrix/matrix/2/2"


def exp6(v: Any, w: Any) -> Any:
    """The pose (4, 4) of a twist for one second, by its power series."""
    twist = np.zeros((4, 4))
    twist[:3, :3] = [[0, -w[2], w[1]], [w[2], 0, -w[0]], [-w[1], w[0], 0]]
    twist[:3, 3] = v
    term = total = np.eye(4)
    for n in range(1, 60):
        term = term @ twist / n
        total = total + term
    return total


AXIS = np.array([0.6, 0.0, 0.8])
HALF_TURN = np.concatenate([[0.3, -0.2, 0.5], math.pi * AXIS])


def twin_of_half_turn() -> Any:
    """Found by the logarithm just beyond the half turn, where there is one value only."""
    return log6(exp6(HALF_TURN[:3], HALF_TURN[3:] * (1 + 1e-9)))


def test_at_a_half_turn_both_residuals_are_right() -> None:
    def at(residual: Any) -> Values:
        return values(residuals={"pin": list(residual)})

    twin = twin_of_half_turn()
    assert np.allclose(twin[3:], -HALF_TURN[3:], atol=1e-7)
    assert not np.allclose(twin[:3], HALF_TURN[:3], atol=1e-2)
    exact = np.concatenate([log6(exp6(HALF_TURN[:3], HALF_TURN[3:] * (1 + 1e-13)))[:3], -HALF_TURN[3:]])
    assert values_differences(at(HALF_TURN), at(exact), 1.0) == []
    assert values_differences(at(exact), at(HALF_TURN), 1.0) == []
    mixed = np.concatenate([HALF_TURN[:3], -HALF_TURN[3:]])
    assert values_differences(at(HALF_TURN), at(mixed), 1.0)
    near = np.concatenate([HALF_TURN[:3], 0.99 * HALF_TURN[3:]])
    assert values_differences(at(near), at(-near), 1.0)


def derivative(residual: Any, velocity: Any) -> Any:
    """Of log6 of a pose that moves with a velocity (6,) seen from itself, by central differences."""
    h = 1e-6
    M = exp6(residual[:3], residual[3:])
    forward, back = (log6(M @ exp6(sign * h * velocity[:3], sign * h * velocity[3:])) for sign in (1, -1))
    return (forward - back) / (2 * h)


def test_at_a_half_turn_each_residual_has_its_own_k() -> None:
    beyond = log6(exp6(HALF_TURN[:3], HALF_TURN[3:] * (1 + 1e-5)))
    before = np.concatenate([HALF_TURN[:3], HALF_TURN[3:] * (1 - 1e-5)])
    K, K_twin = (np.array([derivative(at, each) for each in np.eye(6)]).T for at in (before, beyond))
    assert not np.allclose(K, K_twin, atol=1e-2)
    assert np.allclose(twin_residual(HALF_TURN), beyond, atol=1e-4)
    assert np.allclose(twin_rows(HALF_TURN, K), K_twin, atol=1e-3)


def test_k_at_a_half_turn_must_match_the_given_residual() -> None:
    columns = [("j", k) for k in range(6)]

    def at(residual: Any, rows: Any) -> Values:
        return values(residuals={"p": list(residual)}, jacobian={"columns": columns, "rows": {"p": rows.tolist()}})

    expected, twin = at(HALF_TURN, np.eye(6)), twin_residual(HALF_TURN)
    assert values_differences(expected, at(twin, twin_rows(HALF_TURN, np.eye(6))), 1.0) == []
    assert [found.pointer[:15] for found in values_differences(expected, at(twin, np.eye(6)), 1.0)] == [
        "/jacobian/rows/"
    ]


# Issues

PLACE = CasePlace(file="robot.yaml", line=3, column=5)
ERROR = ExpectedWarning(code="unknown-frame", place=PLACE)


def issue(code: str | None = "unknown-frame", **more: Any) -> Issue:
    place = {"file": "robot.yaml", "line": 3, "column": 5}
    return Issue.model_validate({"code": code, "message": "?", **place, **more})


@pytest.mark.parametrize(
    ("issues", "pointers"),
    [
        ([issue()], []),
        ([issue(), issue("x-mine", severity="warning")], []),
        ([issue(line=4)], ["/issues/0/line"]),
        ([issue(column=4, file="robot.urdf")], ["/issues/0/file", "/issues/0/column"]),
        ([issue(line=None, column=None)], ["/issues/0/line", "/issues/0/column"]),
        ([issue(severity="warning")], ["/issues/0/severity"]),
        ([issue(), issue(line=9)], ["/issues/1"]),
        ([issue(line=9), issue()], ["/issues/0"]),
        ([issue(), issue("x-mine")], ["/issues/1"]),
        ([issue(), issue("near-miss-key", severity="warning")], ["/issues/1"]),
        ([issue("wrong-type")], ["/issues"]),
        ([issue(None)], ["/issues"]),
        ([], ["/issues"]),
    ],
)
def test_one_mistake_gives_one_error_with_code_and_place(issues: list[Issue], pointers: list[str]) -> None:
    assert [found.pointer for found in error_differences(ERROR, issues)] == pointers


def test_warnings_of_the_valid_files_may_stand_beside_the_error() -> None:
    beside = [ExpectedWarning(code="near-miss-key", place=CasePlace(file="robot.yaml", line=9, column=1))]
    near = issue("near-miss-key", severity="warning")
    assert error_differences(ERROR, [near, issue()], beside) == []
    assert error_differences(ERROR, [issue()], beside) == []
    assert [found.pointer for found in error_differences(ERROR, [near, issue(line=4)], beside)] == ["/issues/1/line"]
    assert [found.pointer for found in error_differences(ERROR, [issue("near-miss-key"), issue()], beside)] == [
        "/issues/0"
    ]


def test_error_of_a_whole_file_has_no_line() -> None:
    whole = ExpectedWarning(code="file-not-utf8", place=CasePlace(file="robot.yaml"))
    assert error_differences(whole, [issue("file-not-utf8", line=None, column=None)]) == []
    assert error_differences(whole, [issue("file-not-utf8", line=1, column=1)])


def test_a_yaml_syntax_error_may_be_at_any_place() -> None:
    expected = ExpectedWarning(code="yaml-syntax", place=PLACE)
    assert error_differences(expected, [issue("yaml-syntax", line=9, column=1)]) == []
    assert error_differences(expected, [issue("yaml-syntax", file=None, line=None, column=None)]) == []
    assert error_differences(expected, [issue("yaml-syntax", file="robot.urdf")])


def test_only_warnings_of_a_valid_case_are_reported() -> None:
    two = [ERROR, ExpectedWarning(code="unknown-frame", place=CasePlace(file="robot.yaml", line=7, column=1))]
    told = [issue(line=7, column=1, severity="warning"), issue(severity="warning")]
    assert warning_differences(two, told) == []
    assert warning_differences([], []) == []
    assert [found.pointer for found in warning_differences([ERROR], told)] == ["/issues/0"]
    assert [found.pointer for found in warning_differences([], [issue()])] == ["/issues/0"]


def test_a_difference_reads_as_a_sentence() -> None:
    found = Difference("/joints/0/lower/0", -1.0, None, "joint 'knee', lower").within("/robot")
    assert str(found) == "/robot/joints/0/lower/0: joint 'knee', lower: expected -1.0, got null"
