"""The suite is tested by broken readers: each is caught by a case or property that cites the clause that it breaks."""

import pytest

from eurdf.diagnostics.registry import REGISTRY
from eurdf_conformance.corpus.clause import read_clauses
from eurdf_conformance.mutants import MUTANTS, matrix
from eurdf_conformance.mutants.accepting import ACCEPTING
from eurdf_conformance.mutants.kills import kills
from eurdf_conformance.mutants.silent import SILENT
from eurdf_conformance.mutants.unbroken import UNBROKEN
from eurdf_conformance.protocol.serve import find_object

ROWS = matrix.PAGE.read_text(encoding="utf-8").splitlines()
NOT_CURRENT = f"{matrix.PAGE.name} is not current: python -m eurdf_conformance.mutants.matrix"


@pytest.mark.parametrize("name", MUTANTS)
def test_a_mutant_is_caught_by_what_cites_its_clause_and_the_matrix_says_so(name: str) -> None:
    mutant = MUTANTS[name]
    caught = kills(mutant)
    assert caught, f"{mutant.clause}: {name} survives: {mutant.breaks}"
    assert matrix.row(mutant, caught) in ROWS, NOT_CURRENT


def test_the_matrix_has_a_row_for_each_mutant_and_no_other() -> None:
    # What catches them takes long to find: the test above compares it, row by row.
    empty = matrix.page(dict.fromkeys(MUTANTS, ())).splitlines()
    assert [row.split("|")[:4] for row in ROWS if row.startswith("| ")] == [
        row.split("|")[:4] for row in empty if row.startswith("| ")
    ], NOT_CURRENT
    assert f"{len(MUTANTS)} mutants, 0 of which survive." in ROWS, NOT_CURRENT


def test_each_clause_with_a_must_is_broken_by_a_mutant_or_it_is_said_why_none_can() -> None:
    broken = {mutant.clause for mutant in MUTANTS.values()}
    musts = {clause.id for clause in read_clauses().values() if clause.must}
    assert musts - broken == set(UNBROKEN)
    assert broken <= {clause.id for clause in read_clauses().values() if clause.testable}


def test_each_diagnostic_but_that_of_meshes_has_a_reader_that_does_not_tell_it() -> None:
    names = {mutant.name for mutant in (*ACCEPTING, *SILENT)}
    told = {code.replace("-", "_") for code in REGISTRY}
    assert told - {name.removeprefix("accepts_").removeprefix("silent_of_") for name in names} == {
        "urdf_mesh_unreadable"
    }


def test_a_mutant_says_in_one_sentence_what_is_broken() -> None:
    assert [m.name for m in MUTANTS.values() if not (m.breaks[:1].isupper() and m.breaks.endswith("."))] == []


def test_a_mutant_is_found_by_the_name_of_a_parser() -> None:
    assert find_object("eurdf_conformance.mutants:angular_rows_first") is MUTANTS["angular_rows_first"]


def test_a_mutant_leaves_the_reference_as_it_was() -> None:
    from eurdf.kinematics import residual

    before = residual.rows_of_twist, residual.residual_rows
    kills(MUTANTS["derivative_of_the_logarithm_forgotten"])
    assert (residual.rows_of_twist, residual.residual_rows) == before
