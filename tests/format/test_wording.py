"""Names that are near one another."""

from __future__ import annotations

import numpy as np
import pytest

from eurdf.format.wording import edits, near
from eurdf_conformance.oracle.near import is_near


@pytest.mark.parametrize(
    ("name", "known", "count"),
    [
        ("types", "type", 1),
        ("tpye", "type", 1),
        ("tipe", "type", 2),
        ("time", "type", 4),
        ("name_motor", "name_mot", 2),
        ("name_motors", "name_mot", 3),
        ("name_mtxo", "name_mot", 3),
        ("", "abc", 3),
    ],
)
def test_edit_inserts_deletes_or_swaps_letters(name: str, known: str, count: int) -> None:
    assert edits(name, known) == edits(known, name) == count


@pytest.mark.parametrize(
    ("name", "found"),
    [
        ("Types", "type"),
        ("time", None),
        ("limt", "limit"),
        ("l\u0131m\u0131t", None),  # without their dots these are two other letters, replaced
        ("\uff2cIMIT", "limit"),  # one other letter, which is no capital of ASCII: replaced
        ("", None),
    ],
)
def test_near_means_two_edits_or_one_if_short(name: str, found: str | None) -> None:
    assert near(name, ("type", "limit")) == found


def test_reference_and_oracle_agree_on_any_names() -> None:
    random = np.random.default_rng(1)
    names = ["".join(random.choice(list("abcA"), size=random.integers(0, 8))) for _ in range(300)]
    found = [(near(one, [other]) is not None, is_near(one, other)) for one in names for other in names[:60]]
    assert all(one == other for one, other in found)
    assert 0.01 < np.mean([one for one, _ in found]) < 0.5
