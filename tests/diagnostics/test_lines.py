"""Lines and columns of a text, against a list of all its lines."""

from __future__ import annotations

import re
from bisect import bisect_right

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from eurdf.diagnostics import lines
from eurdf.diagnostics.lines import Lines

TEXTS = st.text(st.sampled_from("ab\n\r\u2028\x85"), max_size=40)


@pytest.fixture(autouse=True)
def small_steps(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(lines, "_STEP", 4)


@settings(deadline=None, max_examples=500)
@given(TEXTS)
def test_position_is_that_in_list_of_lines(text: str) -> None:
    starts = [0, *(found.end() for found in re.finditer("\r\n?|\n", text))]
    found = Lines(text)
    for index in range(len(text) + 1):
        line = bisect_right(starts, index)
        assert found.position(index) == (line, index - starts[line - 1] + 1)


@settings(deadline=None, max_examples=500)
@given(TEXTS)
def test_line_is_that_in_list_of_lines(text: str) -> None:
    expected = re.split("\r\n?|\n", text)
    found = Lines(text)
    assert [found.line(number) for number in range(1, len(expected) + 2)] == [*expected, None]
    assert [found.first(count) for count in (1, 2, 50)] == [expected[:1], expected[:2], expected]


def test_few_numbers_are_kept_for_millions_of_lines(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.undo()
    found = Lines("\n" * 4_000_000 + "end")
    assert found.position(4_000_001) == (4_000_001, 2)
    assert found.line(4_000_001) == "end"
    assert len(found._before) < 1_000
