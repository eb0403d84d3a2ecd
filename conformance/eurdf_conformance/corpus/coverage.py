"""Finds clauses that no case tests, for each version they belong to."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

from eurdf_conformance.corpus.case import Case, InvalidCase, ValidCase
from eurdf_conformance.corpus.clause import Clause
from eurdf_conformance.level import Version

#: For each clause the versions in which no files can show or violate it, with the reason.
UNSAID: Mapping[str, Mapping[Version, str]] = {
    "EU-CAN-004": {"1": "Version 1 has no configurations."},
    "EU-JNT-007": {"1": "UJOINT names two axes that differ; joints of parallel axes are not merged, by EU-ONE-007."},
}


def said_in(clause: Clause) -> tuple[Version, ...]:
    """The versions of a clause in which cases test it; what 2.1 shares with 2 is tested in 2."""
    own = (version for version in clause.versions if version != "2.1" or "2" not in clause.versions)
    return tuple(version for version in own if version not in UNSAID.get(clause.id, {}))


def missing(cases: Iterable[Case], clauses: Mapping[str, Clause], elsewhere: Iterable[str] = ()) -> Iterator[str]:
    """What is missing, one line per clause and version, since each version is certified separately.

    A MUST with a diagnostic needs a case that violates it and one that does not; a SHOULD, one with the warning; any
    other MUST, a case. If a clause has a code, the case that violates it has that code.

    Args:
        cases: The cases.
        clauses: All clauses.
        elsewhere: Ids of clauses that are tested by something other than a case.
    """
    cases, elsewhere = list(cases), set(elsewhere)
    for clause in clauses.values():
        if not clause.testable or clause.id in elsewhere:
            continue
        for version in said_in(clause):
            citing = [case for case in cases if clause.id in case.clauses and case.version == version]
            if lacks := _lacks(clause, citing):
                yield f"{clause.id} (version {version}): {', '.join(lacks)}"


def _lacks(clause: Clause, citing: list[Case]) -> list[str]:
    """What a clause lacks, given the cases of one version that cite it."""
    valid = [case for case in citing if isinstance(case, ValidCase)]
    broken = {case.code for case in citing if isinstance(case, InvalidCase)}
    warned = {warning.code for case in valid for warning in case.warnings}
    if not clause.codes:
        return ["a case"] * (clause.must and not citing)
    if clause.must:
        return ["a valid case"] * (not valid) + [f"an invalid case ({code})" for code in sorted(clause.codes - broken)]
    return [f"a valid case with the warning {code}" for code in sorted(clause.codes - warned)]
