"""What the answers of a parser come to: verdicts, level_results, known failures."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any, get_args

import jsonschema
import pytest
import yaml

from eurdf_conformance.corpus.clause import read_clauses
from eurdf_conformance.judging import known_failures
from eurdf_conformance.judging.known_failures import (
    KnownFailures,
    WrongKnownFailures,
    known_failures_schema,
    read_known_failures,
)
from eurdf_conformance.judging.level_result import LevelResult, is_certified, level_results
from eurdf_conformance.judging.result import Result
from eurdf_conformance.judging.run import Run
from eurdf_conformance.judging.verdict import NO_FAILURE, Verdict
from eurdf_conformance.level import Level
from eurdf_conformance.level_spec import LEVELS
from eurdf_conformance.protocol.message import Quantity
from suite_runs import INVALID, PLANNED, VALID, item, result, run

KNOWN = """\
- id: closures/bbbbb2
  level: accept
  verdict: failed
  reason: It does not look at names yet.
"""


def level_result(of: Run, level: Level = Level.ACCEPT) -> LevelResult:
    return next(each for each in level_results(of) if (each.version, each.level) == ("2", level))


def known(text: str, folder: Path) -> KnownFailures:
    file = folder / "known.yaml"
    file.write_text(text, encoding="utf-8")
    return read_known_failures(file)


# --- levels ----------------------------------------------------------------------------------------------------------


def test_a_level_is_certified_if_every_item_passed() -> None:
    assert level_result(run()).certified
    assert is_certified(run())


@pytest.mark.parametrize("verdict", [verdict for verdict in Verdict if verdict not in NO_FAILURE])
def test_an_item_that_did_not_pass_fails_only_its_level(verdict: Verdict) -> None:
    done = run({(INVALID, Level.ACCEPT): verdict})
    assert not level_result(done).certified
    assert level_result(done, Level.STRUCTURE).certified
    assert not is_certified(done)


def test_unclaimed_level_does_not_prevent_certification() -> None:
    done = run()
    assert not level_result(done, Level.DIAGNOSE).claimed
    assert not level_result(done, Level.DIAGNOSE).certified
    assert is_certified(done)


def test_a_level_without_an_item_is_not_certified() -> None:
    done = run(claims={"2": [Level.ACCEPT, Level.DYNAMICS]})
    assert level_result(done, Level.DYNAMICS).items == 0
    assert not level_result(done, Level.DYNAMICS).certified
    assert not is_certified(done)


def test_an_item_without_a_result_counts_as_not_run() -> None:
    done = run(results=tuple(each for each in run().results if each.item.id != INVALID))
    assert level_result(done).counts == {Verdict.PASSED: 1, Verdict.NOT_RUN: 1}
    assert not level_result(done).certified


def test_a_parser_that_claims_nothing_is_not_certified() -> None:
    assert not is_certified(run(claims={}))
    assert not is_certified(run(started=None, results=()))


def test_versions_are_certified_separately() -> None:
    old = item("version1/ccccc3", Level.ACCEPT, "1")
    claims = {"1": [Level.ACCEPT], "2": [Level.ACCEPT]}
    done = run(claims=claims, planned=(*PLANNED, old), results=(*run().results, result(old, Verdict.CRASHED)))
    assert [each.certified for each in level_results(done) if each.claimed] == [False, True]


def test_requested_levels_are_certified_on_their_own() -> None:
    done = run({(VALID, Level.STRUCTURE): Verdict.FAILED})
    assert is_certified(Run(**(vars(done) | {"levels": (Level.ACCEPT,)})))
    assert not is_certified(Run(**(vars(done) | {"levels": (Level.ACCEPT, Level.DYNAMICS)})))


def test_a_smoke_run_certifies_nothing() -> None:
    assert not is_certified(run(smoke=True))
    assert not any(each.certified for each in level_results(run(smoke=True)))


def test_accept_all_and_reject_all_are_not_certified() -> None:
    accepts = run({(INVALID, Level.ACCEPT): Verdict.FAILED}, claims={"2": [Level.ACCEPT]})
    rejects = run({(VALID, Level.ACCEPT): Verdict.FAILED}, claims={"2": [Level.ACCEPT]})
    for done in (accepts, rejects):
        assert level_result(done).counts == {Verdict.PASSED: 1, Verdict.FAILED: 1}
        assert not is_certified(done)


# --- results ---------------------------------------------------------------------------------------------------------


def test_a_result_survives_conversion_to_json() -> None:
    given = result(PLANNED[0], Verdict.TIMED_OUT, "no answer in 10 s")
    assert Result.from_json(json.loads(json.dumps(given.to_json()))) == given


def test_a_lone_surrogate_from_a_parser_is_escaped() -> None:
    given = result(PLANNED[0], Verdict.MALFORMED, "it wrote \ud83e")
    assert given.differences == ("it wrote \\ud83e",)
    assert json.dumps(given.to_json(), ensure_ascii=False).encode()


# --- known failures --------------------------------------------------------------------------------------------------


def test_a_level_with_a_known_failure_is_not_certified(tmp_path: Path) -> None:
    file = known(KNOWN, tmp_path)
    done = run({(INVALID, Level.ACCEPT): Verdict.FAILED}, known_failures=file)
    assert level_result(done).known_failures == 1
    assert not level_result(done).certified
    assert not is_certified(done)
    assert file.unexpected(done.results, done.planned) == []


@pytest.mark.parametrize(
    ("id_", "verdict", "says"),
    [
        (
            "bbbbb2",
            Verdict.PASSED,
            "listed as 'failed' but passes; remove it from the known failures",
        ),
        ("bbbbb2", Verdict.CRASHED, "listed as 'failed', but the verdict is 'crashed'"),
        ("bbbbb3", Verdict.PASSED, "the suite has no such item"),
        (
            "bbbbb2/accept",
            Verdict.PASSED,
            "the suite has no such item; write the id without its level: 'closures/bbbbb2'",
        ),
    ],
)
def test_other_known_failure_is_unexpected(id_: str, verdict: Verdict, says: str, tmp_path: Path) -> None:
    file = known(KNOWN.replace("bbbbb2", id_), tmp_path)
    done = run({(INVALID, Level.ACCEPT): verdict}, known_failures=file)
    assert file.unexpected(done.results, PLANNED) == [f"closures/{id_}/accept: {says}"]
    assert not any(map(file.expects, done.results))


def test_known_failure_of_an_item_not_run_is_kept(tmp_path: Path) -> None:
    assert known(KNOWN, tmp_path).unexpected([], PLANNED) == []


def test_an_empty_file_lists_no_known_failures(tmp_path: Path) -> None:
    assert known("# none yet\n", tmp_path) == KnownFailures()


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (KNOWN.replace("  reason: It does not look at names yet.\n", ""), "[0].reason"),
        (KNOWN.replace("It does not look at names yet.", "' '"), "[0].reason"),
        (KNOWN.replace("level: accept", "level: accepts"), "[0].level"),
        (KNOWN.replace("verdict: failed", "verdict: passed"), "'passed'"),
        (KNOWN.replace("verdict: failed", "verdict: not run"), "'not run'"),
        (KNOWN + "  since: 2025\n", "[0].since"),
        (KNOWN + "  level: diagnose\n", "duplicate key"),
        (KNOWN + KNOWN, "closures/bbbbb2/accept is listed 2 times"),
        ("closures/bbbbb2: failed\n", "list"),
        ("- [\n", "expected"),
    ],
)
def test_a_wrong_file_of_known_failures_is_refused_with_reason(text: str, said: str, tmp_path: Path) -> None:
    with pytest.raises(WrongKnownFailures) as refused:
        known(text, tmp_path)
    assert said in str(refused.value)
    assert str(tmp_path / "known.yaml") in str(refused.value)


def test_a_missing_file_is_refused(tmp_path: Path) -> None:
    with pytest.raises(WrongKnownFailures, match="No such file"):
        read_known_failures(tmp_path / "nowhere.yaml")


def test_the_schema_of_known_failures_is_current() -> None:
    file = Path(known_failures.__file__).with_name("known_failures.schema.json")
    schema: dict[str, Any] = json.loads(file.read_text(encoding="utf-8"))
    assert schema == known_failures_schema()
    validator = jsonschema.Draft202012Validator(schema)
    validator.check_schema(schema)
    validator.validate(yaml.safe_load(KNOWN))
    for wrong in ("verdict: passed", "verdict: not run", "verdict: unknown"):
        assert not validator.is_valid(yaml.safe_load(KNOWN.replace("verdict: failed", wrong)))
    assert not validator.is_valid(yaml.safe_load(KNOWN.replace("It does not look at names yet.", "' '")))


# --- levels ----------------------------------------------------------------------------------------------------------


def test_every_level_is_defined_by_existing_clauses() -> None:
    assert list(LEVELS) == list(Level)
    named = {spec.clause for spec in LEVELS.values()}
    named |= {clause for spec in LEVELS.values() for clauses in spec.defining.values() for clause in clauses}
    assert named <= read_clauses().keys()


def test_every_quantity_is_asked_for_at_one_level() -> None:
    asked = [quantity for spec in LEVELS.values() for quantity in spec.quantities]
    assert sorted(asked) == sorted(get_args(Quantity))
