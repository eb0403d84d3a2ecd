"""The suite is tested by broken readers: each is caught, in each version, by what cites the clause that it breaks."""

from collections.abc import Callable
from contextlib import nullcontext
from pathlib import Path
from typing import Any

import pytest

from eurdf.diagnostics.registry import REGISTRY
from eurdf_conformance.corpus.clause import read_clauses
from eurdf_conformance.corpus.coverage import said_in
from eurdf_conformance.corpus.read import all_cases
from eurdf_conformance.level import VERSIONS, Version
from eurdf_conformance.mutants import MUTANTS
from eurdf_conformance.mutants.accepting import ACCEPTING
from eurdf_conformance.mutants.kills import kills
from eurdf_conformance.mutants.mutant import Mutant
from eurdf_conformance.mutants.silent import SILENT
from eurdf_conformance.mutants.unbroken import UNBROKEN
from eurdf_conformance.protocol.message import Accepted, CanonicalRobot, Rejected
from eurdf_conformance.protocol.reply import accepted
from eurdf_conformance.protocol.serve import find_object
from eurdf_conformance.suite.smoke import smoke_case

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


@pytest.mark.parametrize("name", MUTANTS)
def test_a_mutant_is_caught_in_each_of_its_versions_and_in_no_other(name: str) -> None:
    mutant = MUTANTS[name]
    caught = kills(mutant)
    survives = set(mutant.versions) - set(caught)
    assert not survives, f"{mutant.clause}: {name} survives in version {', '.join(sorted(survives))}: {mutant.breaks}"
    assert set(caught) == set(mutant.versions), f"{name} is caught in a version that it does not state: {caught}"


def test_a_reader_that_is_not_broken_is_not_caught() -> None:
    assert kills(Mutant("unbroken", "EU-CLO-001", "Nothing is broken.", nullcontext)) == {}


def test_a_mutant_survives_in_the_version_in_which_nothing_catches_it() -> None:
    caught = kills(MUTANTS["frames_are_not_said"])
    assert set(caught) == {"2"}
    assert caught["2"].endswith("/structure")


def test_a_rule_of_the_protocol_counts_for_both_versions() -> None:
    caught = kills(MUTANTS["gone_after_a_rejection"])
    assert caught["1"] == caught["2"]
    assert caught["1"].startswith("protocol/")


def test_what_a_version_cannot_say_does_not_survive_in_it() -> None:
    versions = {name: MUTANTS[name].versions for name in ("frames_are_not_said", "second_axis_first", "lines_from_0")}
    assert versions == {"frames_are_not_said": ("2",), "second_axis_first": ("1",), "lines_from_0": ("1", "2")}
    # By its clause, of which version 1 can say nothing.
    assert MUTANTS["accepts_joint_axes_parallel"].versions == ("2",)
    assert all(set(each.versions) <= set(read_clauses()[each.clause].versions) for each in MUTANTS.values())


@pytest.mark.parametrize("version", VERSIONS)
def test_each_clause_with_a_must_is_broken_by_a_mutant_or_it_is_said_why_none_can(version: Version) -> None:
    broken = {mutant.clause for mutant in MUTANTS.values() if version in mutant.versions}
    musts = {clause.id for clause in read_clauses().values() if clause.must and version in said_in(clause)}
    assert musts - broken == set(UNBROKEN) & musts
    assert broken <= {clause.id for clause in read_clauses().values() if clause.testable}


def test_each_diagnostic_but_that_of_meshes_has_a_reader_that_does_not_tell_it() -> None:
    names = {mutant.name for mutant in (*ACCEPTING, *SILENT)}
    told = {code.replace("-", "_") for code, rule in REGISTRY.items() if rule.clause is not None}
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
