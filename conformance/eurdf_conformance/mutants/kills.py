"""By which cases and properties a mutant is caught."""

from __future__ import annotations

import shlex
import sys
from collections.abc import Collection, Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

from eurdf_conformance.adapters.reference import Reference
from eurdf_conformance.corpus.clause import read_clauses
from eurdf_conformance.corpus.protocol_rule import RULES, ProtocolRule
from eurdf_conformance.corpus.read import CorpusCase, all_cases
from eurdf_conformance.level import VERSIONS, Level, Version
from eurdf_conformance.mutants.mutant import Mutant
from eurdf_conformance.properties import LAWS
from eurdf_conformance.properties.bench import Bench
from eurdf_conformance.properties.law import Law
from eurdf_conformance.properties.trying import try_example
from eurdf_conformance.protocol.serve import ReaderObject
from eurdf_conformance.runner.session import Session
from eurdf_conformance.suite.conversation import Conversation
from eurdf_conformance.suite.in_process import InProcess
from eurdf_conformance.suite.item import ProtocolItem, protocol_items
from eurdf_conformance.suite.judge import judge
from eurdf_conformance.suite.protocol_check import Asked, check
from eurdf_conformance.suite.smoke import SMOKE, smoke_case
from eurdf_conformance.verdict.verdict import Verdict

#: How many of the frozen examples of a property are tried on a mutant; the suite tries all of them.
EXAMPLES = 3

#: The items that catch a mutant, as they are found: the version that each counts for, and its name.
Catches = Iterator[tuple[Version, str]]


def kills(mutant: Mutant) -> dict[Version, str]:
    """The first item of the suite, in each version, that catches a mutant; a version in which none does is left out.

    An item catches a mutant if it cites the clause that the mutant breaks, is asked at the mutant's level, does not
    pass, and passes for the reference (an item that the reference fails would catch anything). Each version is
    certified apart, so the search goes on until there is an item in each.
    """
    found: dict[Version, str] = {}
    for version, name in _by_protocol(mutant):
        found.setdefault(version, name)
    if not mutant.as_process:
        for search in (_by_cases, _by_properties):
            for version, name in search(mutant, found):
                found.setdefault(version, name)
    return found


def _by_cases(mutant: Mutant, found: Collection[Version]) -> Catches:
    conversation, level = Conversation(InProcess(mutant)), mutant.level
    for case in _soonest_first():
        version = case.case.version
        if version in found or mutant.clause not in case.case.clauses or level not in case.levels:
            continue
        if judge(case, level, conversation).verdict in mutant.caught_by and _REFERENCE.passes_case(case, level):
            yield version, f"{case.path}/{level}"


@cache
def _soonest_first() -> tuple[CorpusCase, ...]:
    """The cases, first those that cite the fewest clauses, and of these the smallest: they catch a mutant soonest."""
    return tuple(sorted(all_cases(), key=lambda case: (len(case.case.clauses), _size(case))))


def _size(case: CorpusCase) -> int:
    return sum(path.stat().st_size for path in (case.description, case.urdf) if path.is_file())


def _by_properties(mutant: Mutant, found: Collection[Version]) -> Catches:
    level, cited_in = mutant.level, read_clauses()[mutant.clause].versions
    for law in LAWS:
        if mutant.clause not in law.clauses or level not in law.levels:
            continue
        for version in (each for each in law.versions if each in cited_in and each not in found):
            if _try(law, level, version, mutant) in mutant.caught_by and _REFERENCE.passes_law(law, level, version):
                yield version, f"properties/{law.name}-{version}/{level}"


def _by_protocol(mutant: Mutant) -> Catches:
    """Rules of the protocol, asked of a process as the suite does.

    A rule does not depend on the version: it is asked in one, because a process takes time, and counts for all.
    """
    asked_for = [found for found in _protocol_items() if mutant.clause in found.rule.clauses]
    if not asked_for:
        return
    with _asking(_parser(mutant)) as asked:
        for found in asked_for:
            if check(found.rule, asked).verdict in mutant.caught_by and _REFERENCE.passes_rule(found.rule):
                yield from ((version, f"{found.item.id}/{found.item.level}") for version in mutant.versions)


def _protocol_items() -> list[ProtocolItem]:
    return [found for found in protocol_items() if found.item.version == VERSIONS[-1]]


@contextmanager
def _asking(parser: str) -> Iterator[Asked]:
    """A session with a reader, and the cases that the rules of the protocol are about."""
    three = SMOKE[VERSIONS[-1]]
    valid, invalid = (smoke_case(all_cases(), case_id) for case_id in (three.valid, three.invalid))
    with Session(parser) as session:
        yield Asked(session, lambda: Session(parser), valid, invalid)


def _parser(mutant: Mutant) -> str:
    if mutant.as_process:
        return "cmd:" + shlex.join([sys.executable, "-m", "eurdf_conformance.mutants", mutant.name])
    return f"eurdf_conformance.mutants:{mutant.name}"


def _try(law: Law, level: Level, version: Version, reader: ReaderObject) -> Verdict:
    """What becomes of a property on the first examples."""
    with TemporaryDirectory() as folder:
        bench = Bench(InProcess(reader), Path(folder))
        for example in law.frozen(version)[:EXAMPLES]:
            verdict = try_example(law, level, version, bench, example).verdict
            if verdict != Verdict.PASSED:
                return verdict
    return Verdict.PASSED


class _Reference:
    """What the reference passes, each asked once."""

    def __init__(self) -> None:
        self._conversation = Conversation(InProcess(Reference()))
        self._known: dict[tuple[str, ...], bool] = {}
        self._kept: set[ProtocolRule] | None = None

    def passes_case(self, case: CorpusCase, level: Level) -> bool:
        key = case.path, level
        if key not in self._known:
            self._known[key] = judge(case, level, self._conversation).verdict == Verdict.PASSED
        return self._known[key]

    def passes_rule(self, rule: ProtocolRule) -> bool:
        if self._kept is None:
            with _asking("eurdf_conformance.adapters.reference:READER") as asked:
                self._kept = {each for each in RULES if check(each, asked).verdict == Verdict.PASSED}
        return rule in self._kept

    def passes_law(self, law: Law, level: Level, version: Version) -> bool:
        key = law.name, level, version
        if key not in self._known:
            self._known[key] = _try(law, level, version, Reference()) == Verdict.PASSED
        return self._known[key]


_REFERENCE = _Reference()
