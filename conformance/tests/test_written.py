"""The files of a mechanism: in whatever style, they read back as what they were written from."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st
from lxml import etree

from eurdf_conformance.level import VERSIONS
from eurdf_conformance.oracle.spatial import from_rpy
from eurdf_conformance.oracle.yaml_text import value_of
from eurdf_conformance.properties.chance import Chance
from eurdf_conformance.properties.document import document
from eurdf_conformance.properties.example import frozen_examples
from eurdf_conformance.properties.files import files_of
from eurdf_conformance.properties.mechanism import Mechanism, Pose
from eurdf_conformance.properties.names import CURIOUS, new_names, renamed
from eurdf_conformance.properties.placement import matrix_of, pose_of, quaternion_of, rotation_of
from eurdf_conformance.properties.strategies.mechanisms import mechanisms
from eurdf_conformance.properties.strategies.numbers import quaternions
from eurdf_conformance.properties.urdf import urdf_text
from eurdf_conformance.properties.yaml_text import yaml_text

LETTERS = st.characters(min_codepoint=32, max_codepoint=0x2FFF, categories=["L", "N", "P", "S", "Zs"])
WORDS = st.sampled_from(CURIOUS) | st.text(LETTERS).filter(str.isprintable)
NUMBERS = st.floats(allow_nan=False, allow_infinity=False) | st.integers(-(10**9), 10**9)
SCALARS = WORDS | NUMBERS | st.booleans() | st.none()
VALUES = st.recursive(
    SCALARS, lambda inner: st.lists(inner, max_size=4) | st.dictionaries(WORDS, inner, max_size=4), max_leaves=12
)
DOCUMENTS = st.dictionaries(WORDS, VALUES, min_size=1, max_size=5)


def plain(value: Any) -> Any:
    """Numbers are one kind: 2 and 2.0 are the same, as in JSON."""
    if isinstance(value, dict):
        return {key: plain(item) for key, item in value.items()}
    if isinstance(value, list):
        return [plain(item) for item in value]
    return float(value) if type(value) is int else value


@settings(max_examples=150, deadline=None)
@given(DOCUMENTS, st.integers(0, 10**6))
def test_yaml_written_in_any_style_keeps_its_value(value: dict[str, Any], seed: int) -> None:
    text = yaml_text(value, Chance(seed)).decode("utf-8-sig")
    found = value_of(text)
    assert json.dumps(plain(found)) == json.dumps(plain(value))


@settings(max_examples=50, deadline=None)
@given(DOCUMENTS)
def test_yaml_written_in_plain_style_keeps_its_value(value: dict[str, Any]) -> None:
    assert json.dumps(plain(value_of(yaml_text(value).decode()))) == json.dumps(plain(value))


def test_styles_differ() -> None:
    example = frozen_examples("2")[0]
    value = document(example.mechanism, "2")
    texts = {yaml_text(value, Chance(seed)) for seed in range(20)}
    assert len(texts) == 20
    whole = b"".join(texts)
    for token in (b"&a0", b"*a0", b"? ", b"\r\n", b"\xef\xbb\xbf", b"# what follows", b"{", b"- ", b"!!float", b"'"):
        assert token in whole, token


def test_other_libraries_read_the_written_files() -> None:
    for version in VERSIONS:
        for example in frozen_examples(version):
            files = files_of(example.mechanism, version)
            # 1e-05 is a string in YAML 1.1; else the two agree on what is written here.
            numbers = files.description.replace(b"e-", b"")
            assert yaml.safe_load(numbers) is not None
            robot = etree.fromstring(files.urdf)
            assert len(robot) == len(example.mechanism.links) + len(example.mechanism.joints)


def test_a_urdf_written_backwards_has_the_same_elements() -> None:
    for example in frozen_examples("2")[:8]:
        one, other = (etree.fromstring(urdf_text(example.mechanism, backwards=each).encode()) for each in (False, True))
        assert canonical(one) == canonical(other)
        assert [element.tag for element in one] != [element.tag for element in other]


def canonical(element: Any) -> Any:
    return element.tag, sorted(element.attrib.items()), sorted(map(canonical, element))


@given(st.tuples(*[st.floats(-7, 7)] * 2), st.sampled_from([0.3, np.pi / 2, -np.pi / 2, np.pi / 2 - 1e-9, 2.0]))
def test_a_pose_survives_conversion_at_a_quarter_turn_of_pitch(others: tuple[float, float], pitch: float) -> None:
    M = np.eye(4)
    M[:3, :3] = from_rpy(np.array([others[0], pitch, others[1]]))
    M[:3, 3] = 1.0, 2.0, 3.0
    again = matrix_of(pose_of(M))
    np.testing.assert_allclose(again, M, atol=4e-16 * 4)
    rpy = pose_of(M).rpy
    np.testing.assert_allclose(matrix_of(Pose(rpy=rpy))[:3, :3], from_rpy(np.array(rpy)), atol=1e-12)


@given(quaternions())
def test_a_rotation_matches_its_quaternion(q: tuple[float, float, float, float]) -> None:
    again = np.array(quaternion_of(rotation_of(q)))
    assert min(np.abs(again - q).max(), np.abs(again + q).max()) < 1e-12


@settings(max_examples=20, deadline=None)
@given(mechanisms("2"), st.integers(0, 100))
def test_new_names_are_unused_and_distinct(mechanism: Mechanism, seed: int) -> None:
    other = renamed(mechanism, new_names(mechanism, Chance(seed), "2"))
    before, after = (named(each) for each in (mechanism, other))
    assert len(set(after)) == len(after) == len(before)
    assert not set(before) & set(after)
    assert all(name.strip() for name in after)


def named(mechanism: Mechanism) -> list[str]:
    names = [link.name for link in mechanism.links] + [joint.name for joint in mechanism.joints]
    return names + [frame.name for frame in mechanism.frames] + [closure.name for closure in mechanism.closures]


def test_chance_is_the_same_on_every_machine() -> None:
    chance = Chance(7)
    assert [chance.between(-1, 1) for _ in range(3)] == [-0.352, -0.698, 0.302]
    assert chance.shuffled("abcdef") == ["f", "d", "a", "c", "e", "b"]
