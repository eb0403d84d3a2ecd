"""Definitions, references, symbols and renaming in the files of robots of the collection and of random ones."""

from __future__ import annotations

import re
from collections import Counter
from pathlib import Path

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

pytest.importorskip("pygls", reason="pygls is not installed: pip install -e '.[test]'")


from eurdf.editor.navigation import CannotRename, definition, references, rename, symbols, to_rename
from eurdf.editor.open_robots import OpenRobots
from eurdf.linking.robot_files import read_robot
from eurdf.mechanism.mechanism import Mechanism
from eurdf.reading.source import Texts
from eurdf.writing.description import describe_mechanism
from support.described import ARM, ARM_DESCRIPTION
from support.mechanisms import closed_tree
from support.places import ROBOTS
from support.typed import edited, opened, place_of

NAMES = sorted(path.parent.name for path in ROBOTS.glob("*/robot.yaml"))


def parts(mechanism: Mechanism) -> Counter[str]:
    """All that a mechanism consists of, in no order."""
    fields = (mechanism.bodies, mechanism.joints, mechanism.frames, mechanism.constraints, mechanism.motors.items())
    of_all = [repr(each) for field in fields for each in field]
    positions = [repr((name, item)) for name, of in mechanism.configurations.items() for item in of.items()]
    return Counter(of_all + [repr((each,)) for each in mechanism.actuators] + positions)


def assert_renamed(robots: OpenRobots, path: str, kind: str, old: str, new: str) -> None:
    """That something is renamed in all descriptions of a URDF, and nothing else differs."""
    defined = robots.names(path).of(kind)[old]
    at = robots.documents.position(defined.lines, defined.start)
    after = edited(robots, rename(robots, defined.file, at, new))
    for each in robots.descriptions_of(robots.urdf_of(path)):
        before = parts(read_robot(Path(each), texts=robots.snapshot()).mechanism)
        renamed = parts(read_robot(Path(each), texts=Texts(after)).mechanism)
        word = re.compile(rf"'{re.escape(old)}(_[XYZ])?'")
        assert renamed == Counter(word.sub(rf"'{new}\1'", part) for part in before.elements()), (each, old)


def named_once(robots: OpenRobots, path: str) -> list[tuple[str, str]]:
    """What is defined under a name that nothing else has."""
    defined = robots.names(path).defined
    count = Counter(name for of in defined.values() for name in of)
    return [(kind, name) for kind, of in defined.items() for name in of if count[name] == 1]


@pytest.mark.parametrize("name", NAMES)
def test_renaming_changes_a_name_of_a_robot_and_nothing_else(name: str) -> None:
    folder = ROBOTS / name
    robots = opened(folder / "robot.yaml", folder / "robot.urdf")
    path = str(folder / "robot.yaml")
    found = named_once(robots, path)
    for kind in dict.fromkeys(kind for kind, _ in found):
        of_kind = [name for each, name in found if each == kind]
        for old in of_kind[:: max(1, len(of_kind) // 3)]:
            assert_renamed(robots, path, kind, old, "renamed")


@settings(max_examples=15)
@given(seed=st.integers(0, 2**32 - 1), data=st.data())
def test_renaming_changes_a_name_of_a_random_robot(
    seed: int, data: st.DataObject, tmp_path_factory: pytest.TempPathFactory
) -> None:
    robot, _ = closed_tree(np.random.default_rng(seed))
    folder, files = tmp_path_factory.mktemp("robot"), describe_mechanism(robot.mechanism)
    robots = opened(folder / "robot.yaml", folder / "robot.urdf", robot_yaml=files.yaml, robot_urdf=files.urdf.decode())
    assume(read_robot(folder / "robot.yaml", texts=robots.snapshot()).linked is not None)
    kind, old = data.draw(st.sampled_from(named_once(robots, str(folder / "robot.yaml"))))
    assert_renamed(robots, str(folder / "robot.yaml"), kind, old, "renamed")


def test_definitions_and_references_are_in_both_files() -> None:
    folder = ROBOTS / "digit_leg"
    robots = opened(folder / "robot.yaml", folder / "robot.urdf")
    description = robots.documents.text(str(folder / "robot.yaml"))
    at = place_of(description, "motor_knee")
    found = definition(robots, str(folder / "robot.yaml"), at)
    assert found is not None
    assert found.uri.endswith("robot.urdf")
    urdf = robots.documents.text(str(folder / "robot.urdf"))
    assert found.range.start == place_of(urdf, 'motor_knee"')
    others = references(robots, str(folder / "robot.yaml"), at, declared=False)
    assert {each.uri.rsplit("/", 1)[1] for each in others} == {"robot.yaml"}
    assert len(references(robots, str(folder / "robot.yaml"), at, declared=True)) == len(others) + 1


def test_symbols_are_what_a_file_defines() -> None:
    folder = ROBOTS / "four_bar"
    robots = opened(folder / "robot.yaml", folder / "robot.urdf")
    mechanism = read_robot(folder).mechanism
    in_urdf = {each.name for each in symbols(robots, str(folder / "robot.urdf"))}
    assert in_urdf == {each.name for each in (*mechanism.bodies, *mechanism.joints)}
    assert {each.name for each in mechanism.closures} <= {
        each.name for each in symbols(robots, str(folder / "robot.yaml"))
    }


@pytest.mark.parametrize(
    ("word", "name", "reason"),
    [
        ("base", "upper", "'upper'"),
        ("base", "universe", "name of the world"),
        ("base", "", "empty"),
        ("robot", "base", "no name of a part"),
    ],
)
def test_a_name_that_makes_an_error_is_refused(tmp_path: Path, word: str, name: str, reason: str) -> None:
    robots = opened(tmp_path / "robot.yaml", tmp_path / "robot.urdf", robot_yaml=ARM_DESCRIPTION, robot_urdf=ARM)
    with pytest.raises(CannotRename, match=reason):
        rename(robots, str(tmp_path / "robot.urdf"), place_of(ARM, word), name)


def test_nothing_is_renamed_in_a_robot_with_errors(tmp_path: Path) -> None:
    wrong = ARM_DESCRIPTION + "root: sinking\n"
    robots = opened(tmp_path / "robot.yaml", tmp_path / "robot.urdf", robot_yaml=wrong, robot_urdf=ARM)
    at = place_of(ARM, "base")
    assert to_rename(robots, str(tmp_path / "robot.urdf"), at)
    with pytest.raises(CannotRename, match=r"correct this first.*sinking"):
        rename(robots, str(tmp_path / "robot.urdf"), at, "ground")


def test_a_name_is_quoted_where_it_must_be(tmp_path: Path) -> None:
    robots = opened(tmp_path / "robot.yaml", tmp_path / "robot.urdf", robot_yaml=ARM_DESCRIPTION, robot_urdf=ARM)
    assert_renamed(robots, str(tmp_path / "robot.yaml"), "joint", "shoulder", "no: [1] & <x>")
