"""Fresh cases: drawn for each run, right by the oracle and by construction, and unknown to any parser."""

from __future__ import annotations

import os
import subprocess
import sys
from collections import Counter
from itertools import product
from pathlib import Path

import pytest

import eurdf
from eurdf_conformance.adapters.reference import PARSER
from eurdf_conformance.certificate.issue import issue
from eurdf_conformance.command.replay import replay_differences
from eurdf_conformance.corpus.read import all_cases
from eurdf_conformance.fresh import draw
from eurdf_conformance.fresh.case import FRESH, FreshCase, drawn_hash, fresh_cases
from eurdf_conformance.fresh.fault import Fault, with_fault
from eurdf_conformance.fresh.faults import FAULTS
from eurdf_conformance.fresh.kind import COUNTS, FreshKind
from eurdf_conformance.judging.conversation import Conversation
from eurdf_conformance.judging.judge import judge
from eurdf_conformance.judging.verdict import Verdict
from eurdf_conformance.level import VERSIONS, Level, Version
from eurdf_conformance.properties.chance import Chance
from eurdf_conformance.properties.example import frozen_examples
from eurdf_conformance.properties.files import DESCRIPTION, URDF
from eurdf_conformance.properties.query import query_of
from eurdf_conformance.protocol.message import Accepted, Rejected
from eurdf_conformance.protocol.reply import accepted, rejected
from eurdf_conformance.runner.in_process import InProcess
from eurdf_conformance.suite.item import fresh_items, planned_items
from eurdf_conformance.suite.reproduce import Setting, command_line
from parsers.case_parser import content, index
from suite_runs import run

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def cases() -> dict[str, FreshCase]:
    return fresh_cases(0)


def test_seed_decides_the_fresh_cases(cases: dict[str, FreshCase]) -> None:
    program = "from eurdf_conformance.fresh.case import drawn_hash; print(drawn_hash(0))"
    # In another process, which has imported other modules.
    again = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, env=os.environ, check=True)
    assert again.stdout.strip() == drawn_hash(0)
    assert drawn_hash(1) != drawn_hash(0)


def test_every_version_has_fresh_cases_of_every_kind(cases: dict[str, FreshCase]) -> None:
    kinds = Counter((case.drawn.version, case.drawn.kind) for case in cases.values())
    assert kinds == {(version, kind): count for version, (kind, count) in product(VERSIONS, COUNTS.items())}
    assert len({tuple(case.files.items()) for case in cases.values()}) == len(cases)
    subjects = {fault.name: fault.subject for fault in FAULTS}
    for version in VERSIONS:
        drawn = [case.drawn for case in cases.values() if case.drawn.version == version]
        wanted = {fault.subject for fault in FAULTS if version in fault.versions}
        assert {subjects[each.error] for each in drawn if each.error} == wanted
        errors = [each.error for each in drawn if each.kind is FreshKind.INVALID]
        assert len(set(errors)) == len(errors)  # different errors before the same one again


def test_mechanism_without_inertia_gets_no_error_of_one(monkeypatch: pytest.MonkeyPatch) -> None:
    examples = list(frozen_examples("1")[: sum(COUNTS.values())])
    first = COUNTS[FreshKind.VALID]  # of those with a warning
    mechanism = examples[first].mechanism
    massless = mechanism.replace(links=tuple(link.model_copy(update={"inertia": None}) for link in mechanism.links))
    examples[first] = examples[first].model_copy(update={"mechanism": massless})
    monkeypatch.setattr(draw, "VERSIONS", ("1",))
    monkeypatch.setattr(draw, "drawn_examples", lambda *_: examples)
    drawn = list(draw.draw(0))
    assert Counter(each.kind for each in drawn) == COUNTS
    assert [each.kind for each in drawn if each.example.mechanism == massless] == [FreshKind.INVALID]


def test_items_are_those_of_the_cases_whatever_is_drawn(cases: dict[str, FreshCase]) -> None:
    items = {(found.item.id, found.item.level) for found in fresh_items()}
    assert items == {(case.name, level) for case in cases.values() for level in case.levels}
    assert items <= {item.key for item in planned_items(())}


def test_reference_passes_the_fresh_cases(cases: dict[str, FreshCase]) -> None:
    conversation = Conversation(InProcess(PARSER))
    failed = [
        (case.name, level, case.drawn.error, judgement.reason, judgement.differences)
        for case in cases.values()
        for level in case.levels
        if (judgement := judge(case, level, conversation)).verdict != Verdict.PASSED
    ]
    assert failed == []


class KnowsTheCorpus:
    """Answers every stored case as expected, and accepts everything else."""

    name, version, language, claims = "knowing", "1", "Python", {key: [Level.ACCEPT] for key in ("1", "2")}

    def load(self, description: Path, urdf: Path) -> Accepted | Rejected:
        known = index().get(content(description))
        return rejected("known") if known and not known[0].case.valid else accepted()


def test_parser_that_knows_all_stored_cases_is_not_certified(cases: dict[str, FreshCase]) -> None:
    conversation = Conversation(InProcess(KnowsTheCorpus()))  # type: ignore[arg-type]
    stored = [case for case in all_cases() if case.case.version in VERSIONS]
    assert {judge(case, Level.ACCEPT, conversation).verdict for case in stored} == {Verdict.PASSED}
    invalid = [case for case in cases.values() if case.drawn.kind is FreshKind.INVALID]
    assert {judge(case, Level.ACCEPT, conversation).verdict for case in invalid} == {Verdict.FAILED}


@pytest.mark.parametrize("version", VERSIONS)
def test_reference_reports_each_fault_alone_and_at_its_place(version: Version, tmp_path: Path) -> None:
    # What version 2.1 shares with version 2 is seen there.
    faults = [
        fault for fault in FAULTS if version in fault.versions and (version != "2.1" or "2" not in fault.versions)
    ]
    seen = Counter[Fault]()
    for number, example in enumerate(frozen_examples(version)):
        files = query_of(example.mechanism, version).files
        texts = {DESCRIPTION: files.description.decode(), URDF: files.urdf.decode()}
        for fault in faults:
            if seen[fault] == 3 or (faulty := with_fault(fault, texts[fault.file], Chance(number))) is None:
                continue
            seen[fault] += 1
            for name, text in {**texts, fault.file: faulty.text}.items():
                (tmp_path / name).write_text(text, encoding="utf-8")
            found = [
                (each.code, Path(each.file or "").name, each.line, each.column)
                for each in eurdf.check(tmp_path / DESCRIPTION).diagnostics
                if not each.code.startswith("x-")
            ]
            expected = (fault.code, fault.file, faulty.line, faulty.column)
            if fault.code in ("yaml-syntax", "xml-syntax"):  # EU-DIA-013: each parser has its own place
                found, expected = [(code, file, 0, 0) for code, file, *_ in found], (fault.code, fault.file, 0, 0)
            assert found == [expected], (fault, texts[fault.file])
    assert seen.keys() == set(faults)


def test_reproduce_command_of_a_fresh_case_has_its_seed() -> None:
    line = command_line(Setting("cmd:./mine", seed=7), f"{FRESH}/valid-2-1", "accept")
    assert line == "pytest conformance/ --parser=cmd:./mine --seed=7 -n0 -k fresh/valid-2-1/accept"
    assert "--seed" not in command_line(Setting("cmd:./mine", seed=7), "urdf/gantry", "accept")


def test_certificate_states_seed_and_fresh_cases_and_is_compared_with_them() -> None:
    drawn = "sha256:" + "0" * 64
    one = issue(run(seed=5, fresh=drawn))
    assert (one.scope.seed, one.scope.fresh) == (5, drawn)
    other = one.model_copy(update={"scope": one.scope.model_copy(update={"fresh": "sha256:" + "1" * 64})})
    assert replay_differences(one, one) == []
    (found,) = replay_differences(one, other)
    assert found.startswith("fresh cases: ")
