"""Names of the same part elsewhere, and frames that pair by their names."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from eurdf.linking.counterparts import changes_between, is_elsewhere, is_opposite, other_frame, renamed, unused_pairs

#: Names of words, separators and numbers.
WORDS = st.lists(st.sampled_from(["knee", "Rod", "left", "R", "x", "2", "10", "a"]), min_size=1, max_size=5)
NAMES = WORDS.map("_".join)


@given(NAMES, NAMES)
def test_changes_make_the_other_name_or_are_none(name: str, other: str) -> None:
    changes = changes_between(name, other)
    assert renamed(name, changes) == (other if changes else name)


@pytest.mark.parametrize(
    ("name", "other", "opposite", "elsewhere"),
    [
        ("left_knee", "right_knee", True, True),
        ("LKnee", "RKnee", True, True),
        ("FL_hip", "FR_hip", True, True),
        ("knee", "knee_left", True, False),
        ("rod1_end", "rod2_end", False, True),
        ("rod_a_a", "rod_b_a", False, True),
        ("rod_start", "rod_end", False, False),
        ("left_knee", "right_hip", False, False),
        ("knee", "knee_2", False, False),
    ],
)
def test_sides_and_numbers_are_elsewhere(name: str, other: str, opposite: bool, elsewhere: bool) -> None:
    assert is_opposite(name, other) is opposite
    assert is_elsewhere(changes_between(name, other)) is elsewhere


def test_unused_frames_pair_as_those_of_a_closure() -> None:
    names = ["rod_a_a", "rod_a_b", "rod_b_a", "rod_b_b", "brace_a", "brace_b", "foot_a"]
    pairs = unused_pairs([("rod_a_a", "rod_a_b")], names)
    assert [pair.frames for pair in pairs[:1]] == [("rod_b_a", "rod_b_b")]
    assert ("brace_a", "brace_b") in [pair.frames for pair in pairs]
    assert not any("foot_a" in pair.frames for pair in pairs)


def test_frame_on_the_other_side_of_a_cut_is_found() -> None:
    used = [("left_pin_1", "left_pin_2")]
    assert other_frame("right_pin_1", used, {"right_pin_1", "right_pin_2"}) == "right_pin_2"
    assert other_frame("right_pin_1", used, {"right_pin_1"}) is None
