"""Exploring: a search beyond the frozen examples, that makes what it finds small and writes it as a case."""

from __future__ import annotations

import shlex
from collections import Counter
from collections.abc import Iterator
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from eurdf_conformance.adapters.reference import PARSER
from eurdf_conformance.corpus.lint import lint
from eurdf_conformance.corpus.read import CASES, CorpusCase, read_cases
from eurdf_conformance.judging.conversation import Conversation
from eurdf_conformance.judging.judge import Judgement, judge
from eurdf_conformance.judging.verdict import Verdict
from eurdf_conformance.level import VERSIONS, Level, Version
from eurdf_conformance.properties.catalogue import property_of
from eurdf_conformance.properties.document import configuration
from eurdf_conformance.properties.example import frozen_examples
from eurdf_conformance.properties.explore import Trial, explore, search, try_fresh, try_property
from eurdf_conformance.properties.harness import Harness
from eurdf_conformance.properties.mechanism import Mechanism
from eurdf_conformance.properties.smaller import smaller
from eurdf_conformance.properties.strategies.mechanisms import mechanisms
from eurdf_conformance.properties.truth import truth
from eurdf_conformance.runner.in_process import InProcess
from eurdf_conformance.runner.outcome import Crashed, Outcome
from parsers.oracle import OracleParser
from parsers.relations import ForgetsInlineAngles, UniversalBackwards

pytestmark = pytest.mark.slow

#: What is drawn from a seed depends on the version of Hypothesis too: as many are drawn as find it from any.
SEED, COUNT = 1, 400


@pytest.fixture(scope="module", autouse=True)
def _small() -> Iterator[None]:
    """Small to begin with, so that making it smaller is soon done."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("eurdf_conformance.properties.explore.mechanisms", partial(mechanisms, most=2))
        patch.setattr("eurdf_conformance.properties.explore.SHRINKING", 600.0)
        yield


def explored(name: str, parser: OracleParser, folder: Path, count: int = COUNT) -> Judgement:
    (folder / "files").mkdir()
    trial = Trial(InProcess(parser), "2", count, folder / "files", SEED)
    harness = Harness(trial.parser, trial.folder)
    return explore(property_of(name), Level.KINEMATICS, trial, harness, folder / "explored")


def the_case(folder: Path) -> CorpusCase:
    (case,) = read_cases(folder / "explored")
    return case


@pytest.fixture(scope="module")
def found(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Judgement]:
    """What is found of a parser that turns a universal joint about its second axis first."""
    folder = tmp_path_factory.mktemp("found")
    return folder, explored("agreement", UniversalBackwards(), folder)


def test_the_written_case_is_small(found: tuple[Path, Judgement]) -> None:
    robot = the_case(found[0]).expected.robot
    assert [joint.type for joint in robot.joints] == ["universal"]
    assert (robot.closures, robot.actuators, robot.frames) == ([], [], [])


def test_a_failure_is_written_as_a_case_without_lint_errors(found: tuple[Path, Judgement]) -> None:
    folder, judgement = found
    assert judgement.verdict == Verdict.FAILED
    assert lint(folder / "explored") == []
    case = the_case(folder)
    assert f"from seed {SEED}" in judgement.log
    assert str(case.path) in judgement.log
    assert case.topic == "joints"


def test_found_case_explains_how_to_keep_and_run_it(found: tuple[Path, Judgement]) -> None:
    folder, judgement = found
    case = the_case(folder)
    move, check = (line.strip() for line in judgement.log.splitlines() if line.startswith("  "))
    program, *sources, target = shlex.split(move)
    assert (program, sources) == ("mv", [str(case.path), str(case.expectation)])
    assert Path(target).resolve() == CASES / case.topic
    assert Path(target).is_dir()
    assert check == f"python -m {lint.__module__}"
    assert f"-k {case.name}" in judgement.log.splitlines()[-1]


def test_the_written_case_separates_wrong_parser_and_reference(found: tuple[Path, Judgement]) -> None:
    case = the_case(found[0])
    assert judge(case, Level.KINEMATICS, Conversation(InProcess(UniversalBackwards()))).verdict == Verdict.FAILED
    for level in case.levels:
        assert judge(case, level, Conversation(InProcess(PARSER))).verdict == Verdict.PASSED, level


def test_failure_on_a_fresh_example_is_reduced(tmp_path: Path) -> None:
    # The frozen examples in place of drawn ones: several have a universal joint.
    trial = Trial(InProcess(UniversalBackwards()), "2", 0, tmp_path, SEED, frozen_examples("2"))
    harness = Harness(trial.parser, trial.folder)
    judgement = try_fresh(property_of("agreement"), Level.KINEMATICS, trial, harness)
    assert (judgement.verdict, f"drawn from seed {SEED}: " in judgement.reason) == (Verdict.FAILED, True)
    urdf = next(Path(line) for line in judgement.log.splitlines() if line.endswith(".urdf"))
    assert urdf.read_text().count("<joint ") == 1
    right = Trial(InProcess(OracleParser()), "2", 0, tmp_path, SEED, frozen_examples("2")[:8])
    harness = Harness(right.parser, right.folder)
    assert try_fresh(property_of("agreement"), Level.KINEMATICS, right, harness).verdict == Verdict.PASSED


def test_of_two_differing_robots_the_misread_one_is_written(tmp_path: Path) -> None:
    # The property compares frames that are said in place, which this parser gets wrong, with others.
    explored("frames", ForgetsInlineAngles(), tmp_path)
    case = the_case(tmp_path)
    assert "rpy" in case.description.read_text("utf-8")
    assert judge(case, Level.KINEMATICS, Conversation(InProcess(ForgetsInlineAngles()))).verdict == Verdict.FAILED
    assert case.topic == "closures"


def test_no_case_is_written_without_a_failure(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    judgement = explored("moving-base", OracleParser(), tmp_path, 60)
    assert judgement.verdict == Verdict.PASSED
    assert (
        judgement.log == f"exploring found no error on 60 more mechanisms, drawn from seed {SEED}; no case is written"
    )
    assert [path.name for path in tmp_path.iterdir()] == ["files"]


def test_a_family_is_explored_by_its_size(tmp_path: Path) -> None:
    class LosesLarge(OracleParser):
        def evaluate(self, *asked: object) -> list:  # type: ignore[override, type-arg]
            found = super().evaluate(*asked)  # type: ignore[arg-type]
            assert self.robot is not None
            large = len(self.robot.urdf.joints) > 9
            return [values.model_copy(update={"jacobian": None}) if large else values for values in found]

    prop = property_of("spherical-polygon")
    found = search(prop, Level.KINEMATICS, "2", Harness(InProcess(LosesLarge()), tmp_path), COUNT, SEED)
    assert found is not None
    assert len(found[0].mechanism.joints) == 10


def test_a_crash_is_shrunk_to_a_smaller_crash(tmp_path: Path) -> None:
    class CrashesOnBalls(InProcess):
        def load(self, description: Path, urdf: Path) -> Outcome:
            if "spherical" in description.read_text("utf-8"):
                return Crashed(None, "SIGSEGV", "")
            return super().load(description, urdf)

    harness = Harness(CrashesOnBalls(OracleParser()), tmp_path)
    found = search(property_of("accepted"), Level.ACCEPT, "2", harness, COUNT, SEED)
    assert found is not None
    example, judgement = found
    assert judgement.verdict == Verdict.CRASHED
    assert [change.type for change in example.mechanism.changes.values()] == ["spherical"]
    assert len(example.mechanism.types()) == 1


@pytest.mark.parametrize("version", VERSIONS)
def test_a_reduced_mechanism_still_closes_its_loops(version: Version) -> None:
    lost = Counter[str]()
    examples = [example.mechanism for example in frozen_examples(version)[:12]]
    # What holds no loop together may go too.
    for mechanism in (*examples, *(each.replace(closures=(), couplings=()) for each in examples)):
        for less in smaller(mechanism):
            robot = truth(less, version)
            at = configuration(less, less.configurations["assembled"], version)
            assert all(np.abs(rows).max() < 1e-9 * max(1.0, robot.size(at)) for rows in robot.residuals(at).values())
            gone = Counter(kinds(mechanism)) - Counter(kinds(less))
            assert len(gone) == 1 or gone.keys() == {"joint", "actuator"}  # a motor goes with its joint
            lost += gone
    more = {"1": set(), "2": {"frame"}, "2.1": {"frame", "coupling"}}
    assert lost.keys() == {"closure", "actuator", "joint"} | more[version]


def kinds(mechanism: Mechanism) -> Iterator[str]:
    yield from ("closure" for _ in mechanism.closures)
    yield from ("coupling" for _ in mechanism.couplings)
    yield from ("actuator" for _ in mechanism.actuators)
    yield from ("frame" for _ in mechanism.frames)
    yield from ("joint" for _ in mechanism.joints)


def test_exploring_continues_after_a_frozen_example_failed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "files").mkdir()
    trial = Trial(InProcess(UniversalBackwards()), "2", COUNT, tmp_path / "files", SEED)
    judgement = try_property(property_of("agreement"), Level.KINEMATICS, trial)
    assert judgement.reason.startswith("example ")
    assert "written as a case: explored/joints/" in judgement.log


def test_the_log_says_when_only_a_frozen_example_fails(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "files").mkdir()
    # A single mechanism, the plainest, which has no universal joint.
    judgement = try_property(
        property_of("agreement"),
        Level.KINEMATICS,
        Trial(InProcess(UniversalBackwards()), "2", 1, tmp_path / "files", SEED),
    )
    assert judgement.reason.startswith("example ")
    assert judgement.verdict == Verdict.FAILED
    assert "exploring found no error on 1 more" in judgement.log
    assert "written as a case: " not in judgement.log
    assert not Path("explored").exists()
