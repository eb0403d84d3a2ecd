"""Robots at the bounds of EU-FIL-002: each has the count in its name, counted here by other means."""

import re
from pathlib import Path

import yaml

from eurdf_conformance.bounds import ALL, BoundCase, bound_cases
from eurdf_conformance.judging.conversation import Conversation
from eurdf_conformance.judging.judge import judge
from eurdf_conformance.judging.verdict import Verdict
from eurdf_conformance.level import Level
from eurdf_conformance.protocol.message import Accepted, Rejected
from eurdf_conformance.protocol.reply import accepted, rejected
from eurdf_conformance.runner.in_process import InProcess
from eurdf_conformance.suite.item import bound_items, planned_items

_VELOCITIES = {"fixed": 0, "continuous": 1, "floating": 6}


def counted(case: BoundCase) -> int:
    """What the name of a case counts."""
    description, urdf = (case.files[name].decode() for name in (case.case.description, case.case.urdf))
    types = re.findall(r'<joint name="\w+" type="(\w+)"', urdf)
    match case.bound.name:
        case "description-bytes":
            return len(description.encode())
        case "urdf-bytes":
            return len(urdf.encode())
        case "nodes":
            events = (yaml.ScalarEvent, yaml.MappingStartEvent, yaml.SequenceStartEvent, yaml.AliasEvent)
            return sum(isinstance(event, events) for event in yaml.parse(description, yaml.CSafeLoader))
        case "tags-and-attributes":
            return urdf.count("<") + urdf.count("=")
        case "attribute-bytes":
            return max(map(len, re.findall(rb'"([^"]*)"', urdf.encode())))
        case "joints" | "joints-with-merged-ones":
            return len(types)
        case "joints-with-split-ones":
            return len(types) + description.count("UJOINT")
        case "velocities" | "velocities-with-mimic-joints":
            return sum(_VELOCITIES[each] for each in types)
        case _:
            return 6 * description.count("type: 6d") + 3 * description.count("type: 3d")


def test_each_robot_has_the_stated_count() -> None:
    assert {case.name: counted(case) for case in bound_cases()} == {case.name: case.count for case in bound_cases()}


def test_a_robot_is_valid_up_to_the_bound() -> None:
    assert [
        (case.name, case.case.valid) for case in bound_cases() if case.case.valid != (case.count == case.bound.most)
    ] == []
    assert {case.bound for case in bound_cases()} == set(ALL)
    assert {found.item.key for found in bound_items()} <= {item.key for item in planned_items(())}


class Hundred:
    """Reads robots of up to a hundred joints, and whatever else they say."""

    name, version, language, claims = "hundred", "1", "Python", {"2": [Level.ACCEPT]}

    def load(self, description: Path, urdf: Path) -> Accepted | Rejected:
        return accepted() if urdf.read_text().count("<joint") <= 100 else rejected("too many")


def test_a_parser_with_other_bounds_fails() -> None:
    conversation = Conversation(InProcess(Hundred()))  # type: ignore[arg-type]
    cases = [case for case in bound_cases() if case.bound.name == "joints"]
    verdicts = {case.count: judge(case, Level.ACCEPT, conversation).verdict for case in cases}
    assert verdicts == {10_000: Verdict.FAILED, 10_001: Verdict.PASSED}
