"""Parsers that lack one rule: they accept what violates it, or do not report it. One a code of the specification."""

from __future__ import annotations

from eurdf_conformance.corpus.clause import read_clauses
from eurdf_conformance.level import Level
from mutants.mutant import accepting, silent

_TESTABLE = [clause for clause in read_clauses().values() if clause.testable]

ANSWERS = {
    clause.id: {f"Accepts what must be rejected with `{code}`.": accepting(code) for code in sorted(clause.codes)}
    for clause in _TESTABLE
    if clause.level == Level.ACCEPT
}

REPORTS = {
    clause.id: {f"Does not report `{code}`.": silent(code) for code in sorted(clause.codes)}
    for clause in _TESTABLE
    if clause.level != Level.ACCEPT
}
