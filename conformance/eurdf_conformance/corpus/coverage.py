"""Which clauses have no case that tests them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

from eurdf_conformance.corpus.case import Case, InvalidCase, ValidCase
from eurdf_conformance.corpus.clause import Clause


def missing(cases: Iterable[Case], clauses: Mapping[str, Clause], elsewhere: Iterable[str] = ()) -> Iterator[str]:
    """What is missing, one line a clause.

    A MUST that a diagnostic stands for needs a case that breaks it and one that does not; a SHOULD, one that earns the
    warning; any other MUST, a case. Where a code stands for a clause, a case that breaks it has that code.

    Args:
        cases: The cases.
        clauses: All clauses.
        elsewhere: Ids of clauses that are tested by something other than a case.
    """
    cases, elsewhere = list(cases), set(elsewhere)
    for clause in clauses.values():
        if not clause.testable or clause.id in elsewhere:
            continue
        citing = [case for case in cases if clause.id in case.clauses]
        valid = [case for case in citing if isinstance(case, ValidCase)]
        broken = {case.code for case in citing if isinstance(case, InvalidCase)}
        warned = {warning.code for case in valid for warning in case.warnings}
        lacks = []
        if not clause.codes:
            lacks += ["a case"] * (clause.must and not citing)
        elif clause.must:
            lacks += ["a valid case"] * (not valid)
            lacks += [f"an invalid case ({code})" for code in sorted(clause.codes - broken)]
        else:
            lacks += [f"a valid case with the warning {code}" for code in sorted(clause.codes - warned)]
        if lacks:
            yield f"{clause.id} ({', '.join(f'version {version}' for version in clause.versions)}): {', '.join(lacks)}"
