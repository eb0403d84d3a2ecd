"""The page about the published toolbox is made of rows, and states what is seen where that code is present."""

from __future__ import annotations

import ast
import os
import re
from collections.abc import Callable
from operator import attrgetter
from pathlib import Path

import pytest

import eurdf
from benchmarks.toolbox.calls import PYTHON, Version, folders, pythons
from benchmarks.toolbox.checks import CHECKS, nothing
from benchmarks.toolbox.outcome import Agrees, Fails, Found, Off, Outcome, judged, same
from benchmarks.toolbox.page import PAGE, written
from benchmarks.toolbox.robots import PUBLISHED
from benchmarks.toolbox.rows import ROWS
from benchmarks.toolbox.run import reruns
from eurdf_conformance.adapters.published_loader import FOLDERS
from support.places import ROOT

TEXT = PAGE.read_text(encoding="utf-8")
needs_checkouts = pytest.mark.skipif(
    FOLDERS not in os.environ,
    reason=f"set {FOLDERS} to the folders of checkouts of example-parallel-robots and toolbox-parallel-robots",
)


def test_page_has_the_tables_of_the_rows() -> None:
    assert written(TEXT) == TEXT, "run python -m benchmarks.toolbox.page"
    with pytest.raises(ValueError, match="has places for"):
        written(TEXT.replace("<!-- table: files", "<!-- table: filse"))


def test_each_check_belongs_to_a_row() -> None:
    assert CHECKS.keys() == {row.theirs for row in ROWS if not row.unrun}


def test_names_of_ours_exist() -> None:
    for page in (TEXT, (ROOT / "docs" / "from_toolbox.md").read_text(encoding="utf-8")):
        for name in set(re.findall(r"\beurdf\.([\w.]+\w)", page)) - {"yaml"}:
            attrgetter(name)(eurdf)
        for name in set(re.findall(r"\brobot\.((?:actuation|mechanism)\.\w+)", page)):
            attrgetter(name)(eurdf.load("four_bar", geometry=False))


def test_robots_of_ours_exist() -> None:
    assert {each.ours for each in PUBLISHED} <= set(eurdf.collection_names())


@pytest.mark.parametrize(
    ("expected", "found", "otherwise"),
    [
        (Agrees(1e-3), Found(1.0005), None),
        (Agrees(1e-3), Found(1.1), "differs by 1.0e-01"),
        (Agrees(1e-3), Found([1.0, 1.0]), "differs by inf"),
        (Agrees(1e-3), Found(error="ValueError: no"), "ValueError: no"),
        (Off(0.5), Found(2.0), None),
        (Off(0.5), Found(1.0), "differs only by 0.0e+00"),
        (Off(0.5), Found(signal=11), "signal 11"),
        (Fails("size"), Found(error="no size"), None),
        (Fails("size"), Found(error="other"), "other"),
        (Fails("size"), Found(2.0), "no error"),
    ],
)
def test_what_is_otherwise_is_said(expected: Outcome, found: Found, otherwise: str | None) -> None:
    compare: Callable[..., float] = nothing if isinstance(expected, Fails) else same(lambda _: 1.0)
    assert judged(expected, compare, None, found) == otherwise


@needs_checkouts
def test_rows_list_every_public_function() -> None:
    published = set()
    for folder in folders():
        for path in Path(folder).glob("*parallel_robots/**/*.py"):
            tree = ast.parse(path.read_text(encoding="utf-8"))
            published |= {node.name for node in tree.body if isinstance(node, ast.FunctionDef | ast.ClassDef)}
    assert len(published) > 60
    assert published - {name for row in ROWS for name in row.theirs.split()} == set()


@needs_checkouts
@pytest.mark.slow
@pytest.mark.parametrize("version", ["3.4", "4.1"])
def test_both_sides_do_what_the_page_states(version: Version) -> None:
    pytest.importorskip("casadi")
    if version not in pythons():
        pytest.skip(f"set {PYTHON}: see python -m benchmarks toolbox --help")
    seen = list(reruns(version))
    assert len(seen) > 100
    assert [each for each in seen if each.otherwise is not None] == []
