"""Parsers that lack one rule: they accept what violates it, or do not report it. One a code of the specification."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from eurdf_conformance.corpus.clause import Clause, read_clauses
from eurdf_conformance.level import Level
from eurdf_conformance.protocol.message import Rejected
from eurdf_conformance.protocol.reply import accepted
from mutants.mutant import Answer, _Answering, add


def _accepting(code: str) -> Callable[[], _Answering]:
    def answer(right: Answer, *_: Path) -> Answer:
        errors = {issue.code for issue in right.issues if issue.severity == "error"}
        return accepted() if isinstance(right, Rejected) and errors == {code} else right

    return lambda: _Answering(answer)


def _silent(code: str) -> Callable[[], _Answering]:
    def answer(right: Answer, *_: Path) -> Answer:
        return right.model_copy(update={"issues": [issue for issue in right.issues if issue.code != code]})

    return lambda: _Answering(answer)


def _add(clause: Clause, code: str) -> None:
    if clause.level == Level.ACCEPT:
        add(clause.id, f"Accepts what must be rejected with `{code}`.", _accepting(code))
    else:
        add(clause.id, f"Does not report `{code}`.", _silent(code))


for _clause in read_clauses().values():
    for _code in sorted(_clause.codes if _clause.testable else ()):
        _add(_clause, _code)
