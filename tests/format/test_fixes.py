"""Fixes of mistakes of the text: of the cases of the suite, and of names with a wrong letter."""

from __future__ import annotations

import re
import shutil
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import eurdf
from eurdf.advice.trial import is_of_the_text
from eurdf.diagnostics import Phase
from eurdf.linking.robot_files import read_robot
from eurdf.mechanism.same_model import differences
from eurdf_conformance.adapters.reference_canonical import canonical_robot
from eurdf_conformance.comparison.canonical import canonical_differences
from eurdf_conformance.corpus.case import InvalidCase
from eurdf_conformance.corpus.expected import Expected
from eurdf_conformance.corpus.read import CorpusCase, all_cases
from eurdf_conformance.protocol.message import CanonicalRobot
from support.places import ROBOTS

#: Mistakes of which many cases have a certain fix. Others are decided by what a person means.
FIXED = {
    *("actuator-duplicate", "configuration-joint", "configuration-limits", "configuration-quaternion"),
    *("duplicate-actuator-name", "duplicate-coupling-name", "joint-property", "merge-not-chain", "missing-key"),
    *("unknown-actuator", "unknown-frame", "unknown-joint", "unknown-key", "unsupported-version", "urdf-not-found"),
    *("wrong-type", "wrong-value", "yaml-duplicate-key", "yaml-key-not-string", "yaml-not-finite"),
    *("yaml-several-documents", "yaml-syntax", "yaml-version", "yaml-alias", "yaml-unknown-tag"),
    *("actuator-mimic", "ambiguous-frame", "assembled-open", "closure-duplicate", "conflicting-keys"),
    *("configuration-length", "coupling-joint", "duplicate-closure-name", "duplicate-frame", "duplicate-joint-name"),
    *("duplicate-replacement", "file-not-utf8", "file-too-large", "out-of-range", "yaml-empty"),
    *("urdf-joint-type", "urdf-reserved-name", "urdf-unknown-link", "xml-syntax"),
}


def invalid_cases() -> list[CorpusCase]:
    cases = (case for case in all_cases() if isinstance(case.case, InvalidCase))
    return [case for case in cases if case.case.code in FIXED]


def test_fixes_make_cases_of_the_suite_valid(tmp_path: Path) -> None:
    fixed, same = set(), set()
    for case in invalid_cases():
        report = eurdf.check(case.description)
        found = next((each for each in report.diagnostics if each.fix is not None), None)
        if found is None or found.fix is None:
            continue
        fixed.add(found.code)
        folder = tmp_path / case.name
        shutil.copytree(case.folder, folder)
        for file, text in found.fix.texts().items():
            (folder / Path(file).relative_to(case.folder)).write_bytes(text.encode())
        left = eurdf.check(folder / case.case.description).errors
        hidden = [error for error in left if error.phase not in (Phase.YAML, Phase.SCHEMA, Phase.URDF)]
        assert list(left) == (hidden if is_of_the_text(found.code) else []), case.name
        linked = read_robot(folder / case.case.description).linked
        if linked is not None and case.origin and is_that_of(case.origin.expected, canonical_robot(linked)):
            same.add(found.code)
    assert fixed >= FIXED
    cases = [case.case for case in all_cases() if isinstance(case.case, InvalidCase)]
    in_yaml = {case.code for case in cases if case.place.file.endswith(".yaml")}
    assert len(same & in_yaml) >= 0.6 * len(in_yaml)


def is_that_of(twin: Expected, fixed: CanonicalRobot) -> bool:
    """Whether a robot after a fix has the mechanism of the valid twin, by EU-CAN-005.

    Not compared is what an invalid case does not say: user data, which is no part of the mechanism; one new name, in
    place of one that is taken or missing; and digits of coordinates beyond the 1e-6 to which loops are closed.
    """
    configurations = {
        name: {joint: _near(q, twin.robot.configurations.get(name, {}).get(joint, [])) for joint, q in stated.items()}
        for name, stated in fixed.configurations.items()
    }
    text = fixed.model_copy(update={"configurations": configurations, "own": twin.robot.own}).model_dump_json()
    names, new = _names(twin.robot), _names(fixed) - _names(twin.robot)
    texts = [text.replace(f'"{each}"', f'"{name}"') for each in new for name in names] if len(new) == 1 else [text]
    robots = map(CanonicalRobot.model_validate_json, texts)
    return any(not canonical_differences(twin.robot, robot, twin.bodies) for robot in robots)


def _near(q: list[float], other: list[float]) -> list[float]:
    return other if len(q) == len(other) and np.allclose(q, other, rtol=0.0, atol=1e-6) else q


def _names(robot: CanonicalRobot) -> set[str]:
    return {*robot.frames, *re.findall(r'"name":"([^"]*)"', robot.model_dump_json())}


@settings(max_examples=40)
@given(data=st.data(), name=st.sampled_from(["four_bar", "delta", "digit_leg", "double_wishbone", "unitree_g1_ankle"]))
def test_fix_of_a_wrong_letter_gives_the_robot_back(
    data: st.DataObject, name: str, tmp_path_factory: pytest.TempPathFactory
) -> None:
    right = (ROBOTS / name / "robot.yaml").read_text(encoding="utf-8").partition("metadata:")[0]
    words = re.finditer(r"(?m)(?<=[ \[{,])[a-z]\w{3,}", right)
    word = data.draw(st.sampled_from([each.span() for each in words if not right.startswith("#", each.start())]))
    at = data.draw(st.integers(word[0], word[1] - 1))
    wrong = right[:at] + data.draw(st.sampled_from("aqz_")) + right[at + data.draw(st.integers(0, 1)) :]
    folder = tmp_path_factory.mktemp("robot")
    shutil.copy(ROBOTS / name / "robot.urdf", folder)
    file = folder / "robot.yaml"
    file.write_text(wrong, encoding="utf-8")
    for fix in eurdf.check(folder).fixes:
        texts = fix.texts()
        for path, text in texts.items():
            Path(path).write_text(text, encoding="utf-8")
        fixed = read_robot(folder)
        if fixed.linked is None:  # a name that is declared wrong is wrong in several places
            assert fixed.diagnostics.error_count
        else:
            assert not differences(read_robot(ROBOTS / name).mechanism, fixed.linked)
        file.write_text(wrong, encoding="utf-8")
