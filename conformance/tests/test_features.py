"""Parsers that lack features of the format: what excuses them, and what does not."""

from __future__ import annotations

import re
from dataclasses import replace
from functools import cache
from pathlib import Path

import pytest

from eurdf_conformance.certificate.badge import badge_texts
from eurdf_conformance.certificate.issue import issue
from eurdf_conformance.certificate.summary import headline
from eurdf_conformance.corpus.case import ValidCase
from eurdf_conformance.corpus.read import CorpusCase, all_cases
from eurdf_conformance.feature import Feature
from eurdf_conformance.judging.conversation import Conversation
from eurdf_conformance.judging.judge import Judgement, judge
from eurdf_conformance.judging.level_result import is_certified
from eurdf_conformance.judging.result import Result
from eurdf_conformance.judging.run import Run
from eurdf_conformance.judging.verdict import Verdict
from eurdf_conformance.level import Level
from eurdf_conformance.properties import PROPERTIES
from eurdf_conformance.properties.harness import Harness
from eurdf_conformance.properties.trying import try_frozen
from eurdf_conformance.protocol.message import Accepted, Rejected, Skipped, Unsupported
from eurdf_conformance.protocol.python_parser import parser_error
from eurdf_conformance.protocol.reply import accepted, unsupported
from eurdf_conformance.runner.in_process import InProcess
from eurdf_conformance.suite.item import case_items
from parsers.case_parser import Right, case_of
from parsers.oracle import OracleParser
from suite_runs import started

ROOT = Path(__file__).parents[2]
PLANAR = re.compile(rb"type\s*=\s*[\"']planar")
LEVELS = (Level.ACCEPT, Level.STRUCTURE, Level.DIAGNOSE)


class WithoutPlanar(Right):
    """A parser without planar joints."""

    lacks = (Feature.PLANAR,)

    def load(self, description: Path, urdf: Path) -> Accepted | Rejected | Unsupported | Skipped:
        if urdf.is_file() and PLANAR.search(urdf.read_bytes()):
            return unsupported("planar")
        return super().load(description, urdf)


class Undeclared(WithoutPlanar):
    lacks = ()


class RefusesMore(WithoutPlanar):
    """Answers as if a robot with spherical joints had planar ones."""

    def load(self, description: Path, urdf: Path) -> Accepted | Rejected | Unsupported | Skipped:
        answer = super().load(description, urdf)
        robot = answer.robot if isinstance(answer, Accepted) else None
        if robot and any(joint.type == "spherical" for joint in robot.joints):
            return unsupported("planar")
        return answer


class Guesses(WithoutPlanar):
    """Accepts what it lacks."""

    def load(self, description: Path, urdf: Path) -> Accepted | Rejected | Unsupported | Skipped:
        answer = super().load(description, urdf)
        if isinstance(answer, Unsupported) and isinstance(case_of(description).case, ValidCase):
            return accepted(case_of(description).expected.robot)
        return answer


@cache
def cases() -> tuple[CorpusCase, ...]:
    """Some cases of version 1: with planar joints, with spherical ones, and with neither; valid and invalid."""
    found = [case for case in all_cases() if case.case.version == "1" and case.topic in ("urdf", "joints", "version1")]
    planar = [case for case in found if PLANAR.search(case.files.get(case.case.urdf, b""))]
    balls = [case for case in found if b"SPHERICAL" in case.files.get(case.case.description, b"")]
    return tuple({case.name: case for part in (planar, balls, found) for case in part[:12] + part[-12:]}.values())


def certified(parser: WithoutPlanar) -> tuple[Run, dict[str, Judgement]]:
    """A run of some cases on a parser, and the judgements by item."""
    conversation = Conversation(InProcess(parser))
    conversation.lacks = frozenset(parser.lacks)
    items = [each for each in case_items(cases()) if each.item.level in LEVELS]
    judged = {f"{each.item.id}/{each.item.level}": judge(each.case, each.item.level, conversation) for each in items}
    results = tuple(Result(each.item, judged[f"{each.item.id}/{each.item.level}"].verdict) for each in items)
    say = started({"1": list(LEVELS)}).model_copy(update={"lacks": list(parser.lacks)})
    planned = tuple(each.item for each in items)
    return Run("tests:Parser", say, planned, results, levels=LEVELS, versions=("1",)), judged


def test_parser_without_planar_joints_is_certified_but_for_planar() -> None:
    run, judged = certified(WithoutPlanar())
    verdicts = {name: judgement.verdict for name, judgement in judged.items()}
    assert set(verdicts.values()) == {Verdict.PASSED, Verdict.EXCUSED}
    certificate = issue(run)
    assert certificate.certified
    assert certificate.failures == ()
    assert headline(certificate) == "Certified for version 1: accept, structure, diagnose, but for planar"
    assert badge_texts(certificate)[1].endswith("but for planar")
    accept = next(each for each in certificate.levels if (each.version, each.level) == ("1", Level.ACCEPT))
    excused = accept.counts[Verdict.EXCUSED]
    assert 0 < excused < accept.items
    assert accept.valid.items + accept.invalid.items == accept.items
    assert accept.valid.passed + accept.invalid.passed == accept.items - excused


@pytest.mark.slow
@pytest.mark.parametrize(
    ("parser", "verdict", "why"),
    [
        (Undeclared(), Verdict.UNSUPPORTED, "planar; the parser does not name it in `lacks`"),
        (RefusesMore(), Verdict.UNSUPPORTED, "planar; the files do not use it"),
        (Guesses(), Verdict.FAILED, "the parser names planar in `lacks`, but accepts a description that uses it"),
    ],
    ids=lambda value: type(value).__name__ if isinstance(value, Right) else "",
)
def test_parser_that_cheats_is_not_certified(parser: WithoutPlanar, verdict: Verdict, why: str) -> None:
    run, judged = certified(parser)
    assert not is_certified(run)
    wrong = {(each.verdict, each.reason) for each in judged.values() if each.verdict not in ("passed", "excused")}
    assert wrong == {(verdict, why)}


def test_level_of_which_everything_is_excused_is_not_certified() -> None:
    run, _ = certified(WithoutPlanar())
    all_excused = tuple(replace(each, verdict=Verdict.EXCUSED) for each in run.results)
    assert not is_certified(replace(run, results=all_excused))


class OracleWithoutPlanar(OracleParser):
    def load(self, description: Path, urdf: Path) -> Accepted | Rejected | Unsupported | Skipped:
        found = PLANAR.search(urdf.read_bytes())
        return unsupported("planar") if found else super().load(description, urdf)


def test_properties_pass_on_examples_without_the_missing_feature(tmp_path: Path) -> None:
    prop = next(each for each in PROPERTIES if each.name == "agreement")
    planar = frozenset({Feature.PLANAR})
    parser = InProcess(OracleWithoutPlanar())
    assert try_frozen(prop, Level.STRUCTURE, "2", Harness(parser, tmp_path, planar)).verdict == Verdict.PASSED
    assert try_frozen(prop, Level.STRUCTURE, "2", Harness(parser, tmp_path)).verdict == Verdict.UNSUPPORTED
    only = [each for each in prop.frozen("2") if any(joint.type == "planar" for joint in each.mechanism.joints)]
    assert only
    few = replace(prop, examples=lambda _: only)
    assert try_frozen(few, Level.STRUCTURE, "2", Harness(parser, tmp_path, planar)).verdict == Verdict.EXCUSED


def test_each_feature_has_cases_of_its_own() -> None:
    valid = [case for case in all_cases() if isinstance(case.case, ValidCase)]
    first = [case for case in valid if case.case.version == "1" and b"\n" in case.files[case.case.urdf]]
    stated = re.compile(rb"planar|floating|<mesh")
    some = [case for case in first if stated.search(case.files[case.case.urdf])]
    added = [case for case in valid if case.case.version == "2.1"]
    using = {feature: {case.name for case in (*some, *added) if feature in case.features} for feature in Feature}
    assert all(using.values())
    assert len(set(map(frozenset, using.values()))) == len(Feature)


def test_table_of_the_specification_lists_the_features() -> None:
    text = (ROOT / "spec" / "conformance.md").read_text(encoding="utf-8")
    table = text.partition("| feature |")[2].partition("\n\n")[0]
    names = [name for line in table.splitlines()[2:] for name in re.findall(r"`([^`]+)`", line.split("|")[1])]
    assert names == list(Feature)


def test_unknown_missing_feature_is_refused() -> None:
    parser = WithoutPlanar()
    parser.lacks = ("wheels",)  # type: ignore[assignment]
    assert parser_error(parser).startswith("it lacks 'wheels'; features are floating-root, planar")
    parser.lacks = "planar"  # type: ignore[assignment]
    assert "expected a list of features" in parser_error(parser)
