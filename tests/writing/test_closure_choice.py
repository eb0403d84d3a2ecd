"""3d or 6d, where a name does not state it: by the motion that is left."""

from __future__ import annotations

from typing import Literal

import pytest

from eurdf.collection import collection_names
from eurdf.diagnostics import Diagnostics
from eurdf.format.urdf.read import read_urdf
from eurdf.kinematics.analysis import analyze
from eurdf.linking.robot_files import read_robot
from eurdf.mechanism.mechanism import Mechanism
from eurdf.pinocchio.robot import build_robot
from eurdf.reading.source import Source
from eurdf.reading.xml_reader import read_xml
from eurdf.writing.closure_choice import choose_types
from eurdf.writing.generation import generate
from eurdf.writing.naming_conventions import conventions
from support.places import ROOT

TUTORIAL = ROOT / "spec" / "examples" / "tutorial" / "robot.urdf"


def mechanism_of(name: str) -> Mechanism:
    mechanism = read_robot(name).mechanism
    assert mechanism is not None
    return mechanism


@pytest.mark.parametrize(
    "name",
    [name for name in collection_names() if {each.type for each in mechanism_of(name).constraints} <= {"3d", "6d"}],
)
def test_collection_robots_get_their_types(name: str) -> None:
    mechanism = mechanism_of(name)
    types = {closure.name: closure.type for closure in mechanism.closures}
    choice = choose_types(mechanism, types, list(types))
    assert choice.types == types
    assert len(choice.notes) == len(analyze(build_robot(mechanism, geometry=False)).loops)


def test_only_undecided_closures_are_chosen() -> None:
    mechanism = mechanism_of("five_bar_3d")
    (name,) = [closure.name for closure in mechanism.closures]
    choice = choose_types(mechanism, [name], ["the pin"])
    assert choice.types == {name: "3d"}
    (note,) = choice.notes
    assert note.startswith("'the pin' is 3d: the loops close and keep 2 motions; with 6d ")
    assert choose_types(mechanism, [], ["the pin"]).notes == ()


def four_bar(*edits: tuple[str, str]) -> str:
    text = TUTORIAL.read_text(encoding="utf-8")
    for old, new in edits:
        assert old in text
        text = text.replace(old, new)
    return text


def notes_of(text: str, version: Literal["1", "2"] = "2") -> tuple[list[str | None], tuple[str, ...]]:
    urdf = read_urdf(read_xml(Source("robot.urdf", text, text.encode())), Diagnostics())
    assert urdf is not None
    generation = generate(urdf, conventions(), version)
    assert generation.mechanism is not None
    assert [closure.type for closure in generation.mechanism.closures] == [
        closure.type for closure in generation.found.closures
    ]
    return [closure.type for closure in generation.found.closures], generation.notes


@pytest.mark.parametrize("version", ["1", "2"])
def test_pin_that_cannot_close_in_6d_is_3d(version: Literal["1", "2"]) -> None:
    types, (note,) = notes_of(four_bar(), version)
    assert types == ["3d"]
    assert note == (
        "'closing_rocker_pin' is 3d: the loops close and keep 1 motion; with 6d no configuration closes the loops"
    )


def test_impossible_loop_is_6d_with_note() -> None:
    types, (note,) = notes_of(four_bar(("0.42 0 0", "4.2 0 0")))
    assert types == ["6d"]
    assert note.startswith("'closing_rocker_pin' is 6d, though no configuration closes the loops: with 3d no config")


def test_note_says_where_motion_was_not_computed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("eurdf.kinematics.analysis._MOST_WORK", 1.0)
    weld = mechanism_of("five_bar_6d")
    (name,) = [closure.name for closure in weld.closures]
    choice = choose_types(weld, [name], [name])
    assert choice.types == {name: "6d"}
    (note,) = choice.notes
    assert note.startswith(f"'{name}' is 6d: ranks were not computed: the loops that share joints with that")


def test_types_in_names_are_final() -> None:
    welded = four_bar(("closing_rocker_pin_1", "closedloop6D_1A"), ("closing_rocker_pin_2", "closedloop6D_1B"))
    assert notes_of(welded) == (["6d"], ())
