"""The suite is tested by broken readers: each is caught, in each version, by what cites the clause that it breaks."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from eurdf.diagnostics.registry import REGISTRY
from eurdf_conformance.corpus.clause import read_clauses
from eurdf_conformance.corpus.coverage import said_in
from eurdf_conformance.level import VERSIONS, Version
from eurdf_conformance.mutants import MUTANTS, matrix
from eurdf_conformance.mutants.accepting import ACCEPTING
from eurdf_conformance.mutants.kills import by_version, kills
from eurdf_conformance.mutants.silent import SILENT
from eurdf_conformance.mutants.unbroken import UNBROKEN
from eurdf_conformance.protocol.message import Accepted, CanonicalRobot, Rejected
from eurdf_conformance.protocol.reply import accepted
from eurdf_conformance.protocol.serve import find_object
from eurdf_conformance.suite.asking import all_cases
from eurdf_conformance.suite.smoke import smoke_case

ROWS = matrix.PAGE.read_text(encoding="utf-8").splitlines()
INERTIA = '<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/>'
#: Of b, 1 kg, which carries c, 2 kg, both r and a are the parent.
TWO_PARENTS = f"""
<robot name="two">
  <link name="r"/>
  <link name="a"><inertial><mass value="1"/>{INERTIA}</inertial></link>
  <link name="b"><inertial><mass value="1"/>{INERTIA}</inertial></link>
  <link name="c"><inertial><mass value="2"/>{INERTIA}</inertial></link>
  <joint name="b_on_r" type="continuous"><parent link="r"/><child link="b"/></joint>
  <joint name="b_on_a" type="continuous"><parent link="a"/><child link="b"/></joint>
  <joint name="c_on_b" type="continuous"><parent link="b"/><child link="c"/></joint>
  <joint name="first" type="continuous"><parent link="r"/><child link="a"/></joint>
</robot>
"""
NOT_CURRENT = f"{matrix.PAGE.name} is not current: python -m eurdf_conformance.mutants.matrix"


@pytest.mark.parametrize("name", MUTANTS)
def test_a_mutant_is_caught_in_each_version_by_what_cites_its_clause_and_the_matrix_says_so(name: str) -> None:
    """And in no version in which it is said that files cannot show what is broken."""
    mutant = MUTANTS[name]
    caught = kills(mutant)
    found = {version: len(items) for version, items in by_version(mutant, caught).items()}
    assert all(found.values()), f"{mutant.clause}: {name} survives: {mutant.breaks} By version: {found}"
    assert set(found) == set(mutant.versions), f"{name} is caught in a version that it is not of: {found}"
    assert matrix.row(mutant, caught) in ROWS, NOT_CURRENT


def test_a_mutant_that_is_caught_in_one_version_alone_survives_in_the_other() -> None:
    mutant = MUTANTS["tilde_is_text"]
    items = ["yaml/w6p1cd/structure", "properties/yaml-style-2/structure"]
    assert by_version(mutant, items) == {"1": [], "2": items}
    assert f"| 0 | 2 | `{items[0]}`, `{items[1]}` |" in matrix.row(mutant, items)
    caught = {**dict.fromkeys(MUTANTS, ("protocol/start-2/accept",)), mutant.name: items}
    assert [matrix.survivors(caught, version) for version in VERSIONS] == [[mutant], []]


def test_a_rule_of_the_protocol_counts_for_both_versions() -> None:
    item = "protocol/start-2/accept"
    assert by_version(MUTANTS["gone_after_a_rejection"], [item]) == {"1": [item], "2": [item]}


def test_what_a_version_cannot_say_does_not_survive_in_it() -> None:
    versions = {name: MUTANTS[name].versions for name in ("frames_are_not_said", "second_axis_first", "lines_from_0")}
    assert versions == {"frames_are_not_said": ("2",), "second_axis_first": ("1",), "lines_from_0": ("1", "2")}
    # By its clause, of which version 1 can say nothing.
    assert MUTANTS["accepts_joint_axes_parallel"].versions == ("2",)
    assert all(set(each.versions) <= set(read_clauses()[each.clause].versions) for each in MUTANTS.values())
    items = ["frames/8eydqr/structure"]
    assert f"| - | 1 | `{items[0]}` |" in matrix.row(MUTANTS["frames_are_not_said"], items)


def test_the_matrix_has_a_row_for_each_mutant_and_no_other() -> None:
    # What catches them takes long to find: the test above compares it, row by row.
    empty = matrix.page(dict.fromkeys(MUTANTS, ())).splitlines()
    assert [row.split("|")[:4] for row in ROWS if row.startswith("| ")] == [
        row.split("|")[:4] for row in empty if row.startswith("| ")
    ], NOT_CURRENT
    only_accept = sum(mutant.only_accepts for mutant in MUTANTS.values())
    assert f"There are {len(MUTANTS)} mutants." in ROWS, NOT_CURRENT
    for version in VERSIONS:
        of_it = sum(version in mutant.versions for mutant in MUTANTS.values())
        assert f"{of_it} are to be caught in version {version}, 0 of which survive." in ROWS, NOT_CURRENT
    assert f"{only_accept} only accept what they should reject, and build no robot of it." in ROWS, NOT_CURRENT


@pytest.mark.parametrize("version", VERSIONS)
def test_each_clause_with_a_must_is_broken_by_a_mutant_or_it_is_said_why_none_can(version: Version) -> None:
    broken = {mutant.clause for mutant in MUTANTS.values() if version in mutant.versions}
    musts = {clause.id for clause in read_clauses().values() if clause.must and version in said_in(clause)}
    assert musts - broken == set(UNBROKEN) & musts
    assert broken <= {clause.id for clause in read_clauses().values() if clause.testable}


def test_each_diagnostic_but_that_of_meshes_has_a_reader_that_does_not_tell_it() -> None:
    names = {mutant.name for mutant in (*ACCEPTING, *SILENT)}
    told = {code.replace("-", "_") for code in REGISTRY}
    assert told - {name.removeprefix("accepts_").removeprefix("silent_of_") for name in names} == {
        "urdf_mesh_unreadable"
    }


def load(name: str, case_id: str) -> Accepted | Rejected:
    case = smoke_case(all_cases(), case_id)
    return MUTANTS[name].load(case.description, case.urdf)


def test_a_mutant_that_only_accepts_has_no_robot() -> None:
    assert load("accepts_urdf_two_parents", "hi2g80") == accepted()


@pytest.mark.parametrize(
    ("name", "case_id", "kept"),
    [
        (
            "changes_of_unknown_joints_dropped",
            "bc0ino",
            lambda robot: [joint for joint in robot.joints if joint.name.startswith("ankle_")],
        ),
        ("actuators_of_unknown_joints_dropped", "g2u5wi", lambda robot: robot.actuators),
        ("closures_of_unknown_frames_dropped", "k9b2yf", lambda robot: robot.closures),
        ("coordinates_of_unknown_joints_dropped", "htx5kx", lambda robot: robot.configurations["half"]),
    ],
)
def test_a_reader_that_goes_on_has_a_robot_that_lacks_what_was_wrong(
    name: str, case_id: str, kept: Callable[[CanonicalRobot], Any]
) -> None:
    answer = load(name, case_id)
    assert isinstance(answer, Accepted)
    assert answer.robot is not None
    assert not answer.issues
    assert list(kept(answer.robot)) == []


def test_a_link_with_two_parents_is_doubled_as_in_pinocchio(tmp_path: Path) -> None:
    pin = pytest.importorskip("pinocchio")
    (tmp_path / "robot.urdf").write_text(TWO_PARENTS, encoding="utf-8")
    (tmp_path / "robot.yaml").write_text('extended_urdf: "2.0"\n', encoding="utf-8")
    model = pin.buildModelFromUrdf(str(tmp_path / "robot.urdf"))
    mutant = MUTANTS["link_with_two_parents_doubled"]
    answer = mutant.load(tmp_path / "robot.yaml", tmp_path / "robot.urdf")
    assert isinstance(answer, Accepted)
    assert answer.robot is not None
    assert sorted(joint.name.rstrip("'") for joint in answer.robot.joints) == sorted(model.names)[:-1]
    assert mutant.evaluate([{}], [], ["mass"])[0].mass == pin.computeTotalMass(model) == 7.0


def test_a_mutant_says_in_one_sentence_what_is_broken() -> None:
    assert [m.name for m in MUTANTS.values() if not (m.breaks[:1].isupper() and m.breaks.endswith("."))] == []


def test_a_mutant_is_found_by_the_name_of_a_parser() -> None:
    assert find_object("eurdf_conformance.mutants:angular_rows_first") is MUTANTS["angular_rows_first"]


def test_a_mutant_leaves_the_reference_as_it_was() -> None:
    from eurdf.kinematics import residual

    before = residual.rows_of_twist, residual.residual_rows
    kills(MUTANTS["derivative_of_the_logarithm_forgotten"])
    assert (residual.rows_of_twist, residual.residual_rows) == before
