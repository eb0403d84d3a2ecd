"""Which case catches a mutant."""

from __future__ import annotations

from functools import cache

from eurdf_conformance.corpus.read import CorpusCase, all_cases
from eurdf_conformance.judging.conversation import Conversation
from eurdf_conformance.judging.judge import judge
from eurdf_conformance.level import Version
from eurdf_conformance.runner.in_process import InProcess
from mutants.mutant import Mutant


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
