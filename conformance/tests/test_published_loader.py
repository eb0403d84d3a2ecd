"""The adapter of the published loader; most tests need a checkout of that loader."""

from __future__ import annotations

import os
import sys
from pathlib import Path

import pytest

from eurdf_conformance.adapters import published_loader
from eurdf_conformance.adapters.published_loader import FOLDERS, LoaderMissing
from eurdf_conformance.comparison.canonical import canonical_differences
from eurdf_conformance.corpus.read import CorpusCase, all_cases
from eurdf_conformance.protocol.message import Accepted, Rejected
from eurdf_conformance.runner.outcome import Answered, Crashed
from eurdf_conformance.runner.session import Session

ADAPTER = published_loader.__name__
needs_loader = pytest.mark.skipif(
    FOLDERS not in os.environ,
    reason=f"set {FOLDERS} to the folders of checkouts of example-parallel-robots and toolbox-parallel-robots",
)


def answer(adapter: str, files: tuple[Path, Path]) -> Accepted | Rejected:
    for _ in range(10):
        with Session(f"{ADAPTER}:{adapter}") as session:
            outcome = session.load(*files)
        if not isinstance(outcome, Crashed):  # the loader leaves indices of frames that do not exist, and may crash
            break
    assert isinstance(outcome, Answered), outcome
    assert isinstance(outcome.answer, Accepted | Rejected)
    return outcome.answer


def case(name: str) -> CorpusCase:
    return next(each for each in all_cases() if each.name == name)


def test_a_missing_loader_is_reported_with_what_to_do(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(FOLDERS, "")
    monkeypatch.setitem(sys.modules, "example_parallel_robots", None)
    published_loader.published_loader.cache_clear()
    with pytest.raises(LoaderMissing, match=f"set {FOLDERS} to the folders"):
        published_loader.published_loader()


@needs_loader
def test_lost_limits_and_moved_shapes_are_found() -> None:
    found = case("version1/shapes-on-ujoint-xz")
    given = answer("Lenient", (found.description, found.urdf))
    assert isinstance(given, Accepted)
    assert given.robot is not None
    differences = canonical_differences(found.expected.robot, given.robot, found.expected.bodies)
    why = {each.why for each in differences}
    assert any(text == "number of visual shapes of link 'foot'" for text in why), why
    assert any(text.endswith(", effort") for text in why), why


@needs_loader
def test_only_the_strict_adapter_rejects_what_the_loader_drops(tmp_path: Path) -> None:
    urdf = tmp_path / "robot.urdf"
    link = '<link name="{}"/>'
    joint = '<joint name="{0}" type="continuous"><parent link="a"/><child link="{0}_end"/><axis xyz="0 0 1"/></joint>'
    text = "".join(map(link.format, ("a", "x_end", "y_end"))) + "".join(map(joint.format, ("x", "y")))
    urdf.write_text(f'<robot name="r">{text}</robot>', encoding="utf-8")
    description = tmp_path / "robot.yaml"
    for wrong in (
        "closed_loop: [[x_end, y_end]]\ntype: [4d]\nname_mot: [x]\n",
        "closed_loop: [[x_end, y_end], [x, y]]\ntype: [6d]\nname_mot: [x]\n",
        "closed_loop: []\ntype: []\nname_mot: [nowhere]\n",
        "closed_loop: []\ntype: []\nname_mot: [x]\njoint_name: [nowhere]\njoint_type: [SPHERICAL]\n",
    ):
        description.write_text(wrong, encoding="utf-8")
        assert isinstance(answer("Lenient", (description, urdf)), Accepted), wrong
        assert isinstance(answer("Strict", (description, urdf)), Rejected), wrong
