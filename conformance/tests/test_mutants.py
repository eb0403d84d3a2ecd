"""Mutants test the suite: in each version, a case that cites the clause they violate catches each of them."""

from __future__ import annotations

from functools import cache

import pytest

from eurdf_conformance.adapters.reference import Reference
from eurdf_conformance.corpus.clause import read_clauses
from eurdf_conformance.corpus.coverage import said_in
from eurdf_conformance.corpus.protocol_rule import RULES
from eurdf_conformance.corpus.read import CorpusCase, all_cases
from eurdf_conformance.judging.conversation import Conversation
from eurdf_conformance.judging.judge import judge
from eurdf_conformance.judging.verdict import Verdict
from eurdf_conformance.level import VERSIONS, Level, Version
from eurdf_conformance.runner.in_process import InProcess
from eurdf_conformance.runner.session import Session
from eurdf_conformance.suite.protocol_check import Setup, check
from eurdf_conformance.suite.smoke import SMOKE, smoke_case
from mutants import MUTANTS, PROTOCOL_MUTANTS, UNBROKEN, Mutant
from parsers.oracle import OracleParser


def catching(mutant: Mutant, version: Version) -> CorpusCase | None:
    """The first case of a version that cites the mutant's clause and that the mutant fails at its level."""
    conversation = Conversation(InProcess(mutant.parser()))
    for case in _citing().get((mutant.clause, version), ()):
        if mutant.level in case.levels and judge(case, mutant.level, conversation).verdict in mutant.verdicts:
            return case
    return None


@cache
def _citing() -> dict[tuple[str, Version], list[CorpusCase]]:
    """The cases by clause and version. First those that cite few clauses: a mutant of a clause fails them soonest."""
    found: dict[tuple[str, Version], list[CorpusCase]] = {}
    for case in sorted(all_cases(), key=lambda case: len(case.case.clauses)):
        for clause in case.case.clauses:
            found.setdefault((clause, case.case.version), []).append(case)
    return found


@pytest.mark.parametrize("breaks", MUTANTS)
def test_a_case_that_cites_its_clause_catches_the_mutant(breaks: str) -> None:
    mutant = MUTANTS[breaks]
    # A case of version 2.1 may also catch what those of version 2 must.
    versions = dict.fromkeys((*said_in(read_clauses()[mutant.clause]), *mutant.versions))
    caught = tuple(version for version in versions if catching(mutant, version))
    assert caught == mutant.versions, f"{mutant.clause}, {mutant.level}"


@pytest.mark.parametrize("parser", [Reference, OracleParser])
@pytest.mark.parametrize("version", VERSIONS)
def test_a_correct_parser_is_not_caught(parser: type, version: Version) -> None:
    every = frozenset(Verdict) - {Verdict.PASSED}
    mutant = Mutant("EU-CLO-010", "Nothing is wrong.", parser, Level.KINEMATICS, VERSIONS, every)
    assert catching(mutant, version) is None


@pytest.mark.slow
@pytest.mark.parametrize("name", PROTOCOL_MUTANTS)
def test_a_protocol_rule_catches_the_wrong_program(name: str) -> None:
    mutant = PROTOCOL_MUTANTS[name]
    three = SMOKE["2"]
    valid, invalid = (smoke_case(all_cases(), case_id) for case_id in (three.valid, three.invalid))
    with Session(mutant.parser) as session:
        asked = Setup(session, lambda: Session(mutant.parser), valid, invalid)
        found = {check(rule, asked).verdict for rule in RULES if mutant.clause in rule.clauses}
    assert found & mutant.verdicts, found


@pytest.mark.parametrize("version", VERSIONS)
def test_each_must_has_a_mutant_or_a_reason(version: Version) -> None:
    broken = {mutant.clause for mutant in MUTANTS.values() if version in mutant.versions}
    broken |= {mutant.clause for mutant in PROTOCOL_MUTANTS.values()}
    musts = {clause.id for clause in read_clauses().values() if clause.must and version in said_in(clause)}
    assert musts - broken == UNBROKEN.keys() & musts
    assert not broken & UNBROKEN.keys()


def test_each_clause_without_a_mutant_is_a_must() -> None:
    assert [name for name in UNBROKEN if name not in read_clauses() or not read_clauses()[name].must] == []


def test_each_mutant_has_a_one_sentence_docstring() -> None:
    assert [breaks for breaks in MUTANTS if not breaks.endswith(".")] == []
