"""Properties on any parser: the oracle keeps each of them, and each is broken by a parser with one error."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from eurdf_conformance.comparison.coordinates import COORDINATES
from eurdf_conformance.corpus.clause import read_clauses
from eurdf_conformance.judging.judge import Judgement
from eurdf_conformance.judging.verdict import Verdict
from eurdf_conformance.level import VERSIONS, Level, Version
from eurdf_conformance.properties.catalogue import PROPERTIES, property_of
from eurdf_conformance.properties.conditioning import has_clear_ranks, is_well_conditioned
from eurdf_conformance.properties.counts import Counts, counts_of
from eurdf_conformance.properties.document import configuration
from eurdf_conformance.properties.example import FROZEN, frozen_examples, frozen_text
from eurdf_conformance.properties.explore import Trial, try_property
from eurdf_conformance.properties.features import features
from eurdf_conformance.properties.harness import Harness
from eurdf_conformance.properties.mechanism import Mechanism
from eurdf_conformance.properties.property import LARGEST, Property
from eurdf_conformance.properties.truth import truth
from eurdf_conformance.properties.trying import try_example, try_frozen
from eurdf_conformance.protocol.message import Accepted, Evaluated, Unsupported
from eurdf_conformance.protocol.reply import unsupported
from eurdf_conformance.protocol.serve import PythonParser
from eurdf_conformance.runner.in_process import InProcess
from eurdf_conformance.runner.outcome import Crashed, Outcome
from eurdf_conformance.suite.item import PropertyItem, property_items
from mutants import MUTANTS
from parsers import relations as wrong
from parsers.oracle import OracleParser
from parsers.spoilt import Remembering, Spoiling, spoils

KINEMATICS, DYNAMICS, STRUCTURE = Level.KINEMATICS, Level.DYNAMICS, Level.STRUCTURE

FAMILIES = [prop for prop in PROPERTIES if prop.family is not None]

#: For each property and level a parser that violates it: a mutant, by what it breaks, or one of `relations`.
BROKEN: list[tuple[str, Level, str | type[wrong.WrongParser]]] = [
    ("accepted", Level.ACCEPT, "A continuous joint must have a limit."),
    ("redundant-rows", Level.ACCEPT, "More rows of closures than velocities are refused."),
    ("structure-agreement", STRUCTURE, "Damping is not read."),
    ("agreement", KINEMATICS, "Poses are rounded to six decimals."),
    ("inertia-agreement", DYNAMICS, "M is computed in single precision."),
    ("columns", KINEMATICS, wrong.ForgetsAColumn),
    ("columns", DYNAMICS, wrong.ForgetsAColumn),
    ("inertia", DYNAMICS, "The mass does not count the root."),
    ("inertia", DYNAMICS, wrong.Weightless),
    ("derivative", KINEMATICS, "K of a 6d closure is the twist of B relative to A, as if the closure were closed."),
    ("mobility", KINEMATICS, "K leaves out the joints that move A."),
    ("planar-polygon", KINEMATICS, "An axis is a direction in the frame of the parent link."),
    ("planar-polygon-6d", KINEMATICS, "An axis is a direction in the frame of the parent link."),
    ("parallelograms", KINEMATICS, "K leaves out the joints that move A."),
    ("spherical-polygon", KINEMATICS, "An axis is a direction in the frame of the parent link."),
    ("ball-ring", KINEMATICS, "K leaves out the joints that move A."),
    ("ball-chain", KINEMATICS, wrong.ForgetsAColumn),
    ("platform-ups", KINEMATICS, "K leaves out the joints that move A."),
    ("platform-sps", KINEMATICS, "K leaves out the joints that move A."),
    ("sarrus", KINEMATICS, "An axis is a direction in the frame of the parent link."),
    ("bennett", KINEMATICS, "An axis is a direction in the frame of the parent link."),
    ("renaming", STRUCTURE, "A name may not have slashes, which are for namespaces of ROS."),
    ("renaming", KINEMATICS, wrong.OrderOfNames),
    ("renaming", DYNAMICS, wrong.OrderOfNames),
    ("reordering", STRUCTURE, wrong.OrderOfFile),
    ("reordering", KINEMATICS, wrong.OrderOfFile),
    ("reordering", DYNAMICS, wrong.OrderOfFile),
    ("yaml-style", STRUCTURE, "The description is read by PyYAML's `safe_load`, which is YAML 1.1."),
    ("yaml-style", KINEMATICS, "The description is read by PyYAML's `safe_load`, which is YAML 1.1."),
    ("versions", STRUCTURE, "Where the types are left out, closures are 3d."),
    ("versions", KINEMATICS, "Where the types are left out, closures are 3d."),
    ("versions", DYNAMICS, wrong.OffWhereLocked1),
    ("frames", KINEMATICS, wrong.ForgetsInlineAngles),
    ("frames", DYNAMICS, wrong.OffByLinks),
    ("swapping", KINEMATICS, "The rows of K are along the axes of the world, Pinocchio's LOCAL_WORLD_ALIGNED."),
    ("ball-closure", KINEMATICS, wrong.LosesARowOf3d),
    ("moving-base", KINEMATICS, wrong.SeenFromTheWorld),
    ("moving-base", DYNAMICS, wrong.SeenFromTheWorld),
    ("floating-base", KINEMATICS, wrong.HoldsTheRoot),
    ("floating-base", DYNAMICS, wrong.HoldsTheRoot),
    ("length-unit", KINEMATICS, wrong.InMillimetres),
    ("length-unit", DYNAMICS, wrong.InMillimetres),
    ("mass-unit", DYNAMICS, wrong.InMillimetres),
    ("locking", STRUCTURE, wrong.OffWhereLocked),
    ("locking", KINEMATICS, wrong.OffWhereLocked),
    ("locking", DYNAMICS, wrong.OffWhereLocked),
    ("elementary-joints", KINEMATICS, wrong.UniversalBackwards),
    ("elementary-joints", DYNAMICS, wrong.UniversalBackwards),
    ("merging", KINEMATICS, "Merged joints turn about the origin of the last one, wherever their axes meet."),
    ("merging", DYNAMICS, "Merged joints turn about the origin of the last one, wherever their axes meet."),
    ("following", KINEMATICS, "A mimic joint is at multiplier · q."),
    ("following", DYNAMICS, "A mimic joint is at (q − offset) / multiplier."),
    ("mimics-ignored", STRUCTURE, "In version 1 a mimic joint depends on its leader, as in version 2."),
    ("mimics-ignored", KINEMATICS, "In version 1 a mimic joint depends on its leader, as in version 2."),
    ("mimics-ignored", DYNAMICS, "In version 1 a mimic joint depends on its leader, as in version 2."),
    ("freeing", STRUCTURE, "A joint that the description frees mimics its leader all the same."),
    ("freeing", KINEMATICS, "A joint that the description frees mimics its leader all the same."),
    ("freeing", DYNAMICS, "A joint that the description frees mimics its leader all the same."),
    ("hinges", KINEMATICS, "The angular rows of a hinge are components of a cross product, zero at opposite axes too."),
    ("distances", KINEMATICS, "The residual of a distance is a difference of squares."),
    ("couplings", KINEMATICS, "The offset of a coupling is left out."),
    ("springs", STRUCTURE, "The rest position of a spring is 0, whatever the description states."),
    ("springs", KINEMATICS, wrong.OffWhereSprung),
    ("springs", DYNAMICS, wrong.OffWhereSprung),
    ("lumping", DYNAMICS, "A link behind a fixed joint weighs nothing."),
    ("leaving-out", KINEMATICS, wrong.OffWhereLeftOut),
    ("leaving-out", DYNAMICS, wrong.OffWhereLeftOut),
    ("turning", KINEMATICS, wrong.MindsTheSign),
    ("turning", DYNAMICS, wrong.MindsTheSign),
]


def tried(prop: Property, level: Level, version: Version, parser: PythonParser, folder: Path) -> Judgement:
    return try_frozen(prop, level, version, Harness(InProcess(parser), folder))


@pytest.mark.parametrize("item", list(property_items()), ids=lambda item: f"{item.item.id}-{item.item.level}")
def test_the_oracle_satisfies_every_property(
    item: PropertyItem, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("eurdf_conformance.properties.property.MOST", 8)
    trial = Trial(InProcess(OracleParser()), item.item.version, 0, tmp_path)
    judgement = try_property(item.property, item.item.level, trial)
    assert (judgement.verdict, judgement.differences) == (Verdict.PASSED, ())


@pytest.mark.parametrize(
    ("name", "level", "parser"), BROKEN, ids=lambda value: value if isinstance(value, str) else value.__name__
)
def test_each_property_is_broken_by_a_wrong_parser(
    name: str, level: Level, parser: str | type[wrong.WrongParser], tmp_path: Path
) -> None:
    prop = property_of(name)
    made = MUTANTS[parser].parser() if isinstance(parser, str) else parser()
    judgement = tried(prop, level, prop.versions[-1], made, tmp_path)
    # One that cannot read what it should is no better than one that reads it wrong.
    assert judgement.verdict in (Verdict.FAILED, Verdict.ERRORED)
    assert judgement.differences or judgement.issues or judgement.verdict == Verdict.ERRORED


def test_every_property_and_level_has_a_wrong_parser() -> None:
    assert {(name, level) for name, level, _ in BROKEN} == {
        (prop.name, level) for prop in PROPERTIES for level in prop.levels
    }


def test_a_relation_loads_two_robots(tmp_path: Path) -> None:
    harness = Harness(InProcess(OracleParser()), tmp_path)
    prop = property_of("renaming")
    (example,) = prop.frozen("2")[:1]
    prop.check(harness, example, "2", KINEMATICS)
    assert len({asked.files for asked, _ in harness.queries}) == 2


def test_every_property_cites_clauses_and_has_unique_items() -> None:
    clauses = read_clauses()
    items = [found.item for found in property_items()]
    assert max(Counter(item.key for item in items).values()) == 1
    for item in items:
        assert item.clauses, item.id
        assert all(item.version in clauses[name].versions for name in item.clauses), item.id
    assert len({prop.title for prop in PROPERTIES}) == len(PROPERTIES)


def test_a_parser_of_version_1_alone_passes_the_versions_property(tmp_path: Path) -> None:
    class Old(OracleParser):
        def load(self, description: Path, urdf: Path) -> Unsupported:  # type: ignore[override]
            if "extended_urdf" in description.read_text():
                return unsupported("version 2")
            return super().load(description, urdf)  # type: ignore[return-value]

    for level in (STRUCTURE, KINEMATICS, DYNAMICS):
        (tmp_path / level).mkdir()
        assert tried(property_of("versions"), level, "1", Old(), tmp_path / level).verdict == Verdict.PASSED


def test_answer_of_another_kind_is_a_difference(tmp_path: Path) -> None:
    parser = MUTANTS["A continuous joint must have a limit."].parser()
    (wrong_answer,) = tried(property_of("accepted"), Level.ACCEPT, "2", parser, tmp_path).differences
    assert (wrong_answer.pointer, wrong_answer.expected, wrong_answer.given) == ("/outcome", "accepted", "rejected")


def test_a_crash_is_reported_as_a_crash(tmp_path: Path) -> None:
    class Crashing(InProcess):
        def evaluate(self, *_: object) -> Outcome:  # type: ignore[override]
            return Crashed(None, "SIGSEGV", "")

    judgement = try_frozen(property_of("agreement"), KINEMATICS, "2", Harness(Crashing(OracleParser()), tmp_path))
    assert judgement.verdict == Verdict.CRASHED
    assert judgement.reason.startswith("example 1: ")


def test_a_broken_property_names_the_files(tmp_path: Path) -> None:
    judgement = tried(property_of("frames"), KINEMATICS, "2", wrong.ForgetsInlineAngles(), tmp_path)
    lines = judgement.log.splitlines()
    paths = [Path(line) for line in lines if not line.startswith("  ")]
    assert all(line.startswith("  at configuration 0: {") for line in lines if line.startswith("  "))
    assert [path.name for path in paths] == ["robot.yaml", "robot.urdf"] * 2
    assert all(path.is_file() for path in paths)


def has_both_kinds_of_closure(mechanism: Mechanism) -> bool:
    return {closure.type for closure in mechanism.closures} == {"3d", "6d"}


def test_an_open_3d_closure_hides_no_wrong_6d_jacobian(tmp_path: Path) -> None:
    prop = replace(property_of("swapping"), applies=has_both_kinds_of_closure)
    assert len(prop.frozen("2")) >= 3
    assert tried(prop, KINEMATICS, "2", OracleParser(), tmp_path).verdict == Verdict.PASSED
    (tmp_path / "twist").mkdir()
    judgement = tried(
        prop,
        KINEMATICS,
        "2",
        MUTANTS["K of a 6d closure is the twist of B relative to A, as if the closure were closed."].parser(),
        tmp_path / "twist",
    )
    assert judgement.verdict == Verdict.FAILED
    assert {each.pointer.split("/")[3] for each in judgement.differences} == {"jacobian"}


# -- answers of any shape ---------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("prop", "level"),
    [(prop, level) for prop in PROPERTIES for level in prop.levels if level is not Level.ACCEPT],
    ids=lambda value: value.name if isinstance(value, Property) else value,
)
def test_any_answer_that_fits_the_schema_passes_or_fails(prop: Property, level: Level, tmp_path: Path) -> None:
    version = prop.versions[-1]  # answers to version 2 have more to spoil
    kind = Accepted if level is STRUCTURE else Evaluated
    examples = prop.frozen(version)
    example = max(examples, key=lambda each: len(features(each.mechanism))) if kind is Accepted else examples[0]
    right = Remembering()
    assert try_example(prop, level, version, Harness(right, tmp_path), example).verdict == Verdict.PASSED
    verdicts = []
    # Every eighth, another one for each property: to try all takes a minute.
    for spoil in spoils([answer for answer in right.said if isinstance(answer, kind)], len(prop.name), 8):
        for which in (None, 1):  # all of its answers, or the second, so that it does not fit the first
            folder = tmp_path / f"spoiled {len(verdicts)}"
            folder.mkdir()
            parser = Spoiling(right, kind, spoil, which)
            judgement = try_example(prop, level, version, Harness(parser, folder), example)
            assert judgement.verdict in (Verdict.PASSED, Verdict.FAILED), judgement
            assert all(str(each) for each in judgement.differences)
            verdicts.append(judgement.verdict)
    assert Verdict.FAILED in verdicts


# -- families ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("prop", FAMILIES, ids=lambda prop: prop.name)
def test_a_family_has_its_known_counts_at_any_size(prop: Property) -> None:
    assert prop.family is not None
    for size in range(prop.smallest, LARGEST + 1):
        example = prop.family(size)
        robot, q = truth(example.mechanism), example.mechanism.configurations["assembled"]
        assert example.known is not None
        assert counts_of(robot.jacobian(q), robot, q) == Counts(*example.known), size
        assert has_clear_ranks(robot, q), size
        assert np.abs(robot.residual(q)).max(initial=0.0) < 1e-12 * max(size, 1.0), size


def test_the_counts_equal_the_dimensions_of_the_oracle() -> None:
    for prop in FAMILIES:
        for example in prop.frozen("2"):
            robot, q = truth(example.mechanism), example.mechanism.configurations["assembled"]
            counts, found = counts_of(robot.jacobian(q), robot, q), robot.dimensions(q)
            assert vars(counts) == {**vars(found), "redundant": found.nc - found.rank}


# -- the frozen examples ----------------------------------------------------------------------------------------------


def test_writing_the_frozen_examples_reproduces_their_file() -> None:
    text = FROZEN.read_text(encoding="utf-8")
    assert text == frozen_text({version: frozen_examples(version) for version in VERSIONS})


@pytest.mark.parametrize("version", VERSIONS)
def test_the_frozen_examples_are_well_conditioned_and_closed(version: Version) -> None:
    for example in frozen_examples(version):
        mechanism = example.mechanism
        robot = truth(mechanism, version)
        q = configuration(mechanism, mechanism.configurations["assembled"], version)
        assert is_well_conditioned(mechanism, version)
        assert np.abs(robot.residual(q)).max(initial=0.0) < 1e-12


def test_the_frozen_examples_use_what_the_format_has() -> None:
    used = {version: [features(example.mechanism) for example in frozen_examples(version)] for version in VERSIONS}
    of_either = [found for version in VERSIONS for found in used[version]]
    count = Counter(feature for found in of_either for feature in found)
    words = {feature.split(" from ")[0] for feature in count}
    assert set(COORDINATES) | {"fixed", "merged", "mimic", "mimic of a mimic", "rotor"} <= words
    for feature in ("3d closure", "6d closure", "frame by name", "frame on a joint", "frame on a link"):
        assert count[feature] >= 5
    for name in ("lower", "upper", "velocity", "effort", "damping", "friction", "armature"):
        assert {f"{name} each", f"{name} for all"} <= count.keys()
    assert {"axes as letters", "axes as vectors", "root floating", "3 closures"} <= count.keys()
    added = Counter(feature for found in used["2.1"] for feature in found)
    for feature in ("hinge closure", "distance closure", "compliance of a closure", "stiffness each", "rest for all"):
        assert added[feature] >= 3
    assert {"axis of a closure", "axes of a closure", "coupling of 2", "coupling of 3", "freed mimic"} <= added.keys()
    assert {"mimic with a property", "named motor", "control", "coupled helical", "coupled continuous"} <= added.keys()


@pytest.mark.parametrize("version", VERSIONS)
def test_every_property_has_examples(version: Version) -> None:
    few = {
        prop.name: len(prop.frozen(version)) for prop in PROPERTIES if version in prop.versions and prop.family is None
    }
    assert min(few.values()) >= 3, few
