"""Mistakes that people make, one at a time: the cause is named, and no fix gives another robot that is valid."""

from __future__ import annotations

import re
from pathlib import Path
from string import ascii_lowercase
from typing import Any, NamedTuple

import pinocchio as pin
import pytest

import eurdf
from mistakes.bases import ANKLE, BIPED
from support.places import ROOT
from support.same_mechanism import unlike

#: Fixes that are applied one after the other.
STEPS = 4


class Mistake(NamedTuple):
    """A row of `rows.txt`."""

    base: str
    name: str
    family: str
    mark: str
    edits: str
    cause: str

    def __str__(self) -> str:
        return f"{self.base}: {self.name}"


def rows() -> list[Mistake]:
    found, base = [], ""
    for line in Path(__file__).with_name("rows.txt").read_text(encoding="utf-8").splitlines():
        if line.startswith("["):
            base = line.strip("[]")
        elif line and not line.startswith("#"):
            name, family, edits, cause = line.split(" | ", 3)
            mark = family.lstrip(ascii_lowercase)
            found.append(Mistake(base, name, family.removesuffix(mark), mark, edits, cause))
    return found


MISTAKES = rows()
NAMED = [each for each in MISTAKES if each.mark in ("", "+")]
BASES = list(dict.fromkeys(each.base for each in MISTAKES))


def write(folder: Path, base: str, edits: str = "") -> Path:
    """The files of a robot in a folder, with a mistake made in them."""
    names = {"u": "robot.urdf", "y": "robot.yaml"}
    here = ROOT / "robots" / base
    own = {"biped": BIPED, "ankle": ANKLE}.get(base)
    texts = dict(zip("uy", own or ((here / name).read_text(encoding="utf-8") for name in names.values()), strict=True))
    for edit in filter(None, edits.split(" ;; ")):
        parts = re.fullmatch(r"([uy])(?:@(.*?))?: (.*?) =>(?: (.*))?", edit)
        assert parts, f"'{edit}' is no edit"
        file, place, old, new = parts.groups()
        text = texts[file]
        start = text.index(place) if place else 0
        pattern = old[1:-1] if re.fullmatch("/.*/", old) else re.escape(old.replace("\\n", "\n").replace("\\t", "\t"))
        changed, count = re.subn(pattern, new or "", text[start:], count=1)
        assert count, f"{edit}: '{old}' is not in {names[file]}"
        texts[file] = text[:start] + changed
    folder.mkdir()
    for file, name in names.items():
        (folder / name).write_text(texts[file], encoding="utf-8")
    return folder


def same(one: Path, other: Path) -> bool:
    """Whether two valid robots are the same, or weigh and move the same with the same actuators."""
    robots = [eurdf.load(folder, geometry=False) for folder in (one, other)]
    bodies = [robot.mechanism.bodies for robot in robots]
    joints = [{joint.name: joint.properties for joint in robot.mechanism.joints} for robot in robots]
    driven = [[*sorted(robot.actuation.joints), len(robot.actuation.idx_q)] for robot in robots]
    if unlike(*bodies, 1e-9) or unlike(*joints, 0.05) or unlike(*driven):
        return False
    return not unlike(*map(moved, robots), 1e-6)


def moved(robot: eurdf.Robot) -> dict[str, Any]:
    """The poses of all links with each actuator moved by 0.03 rad or m from zero, the others at zero."""
    poses, data, still = {}, robot.model.createData(), dict.fromkeys(robot.actuation.joints, 0.0)
    for joint in still:
        q = eurdf.forward_kinematics(robot, {**still, joint: 0.03})
        pin.framesForwardKinematics(robot.model, data, q)
        at = [data.oMf[robot.model.getFrameId(body.name, pin.BODY)] for body in robot.mechanism.bodies]
        poses[joint] = [oMf.homogeneous.ravel().tolist() for oMf in at]
    return poses


def wrong_robots(folder: Path, valid: Path, steps: int = STEPS) -> list[str]:
    """What fixes of the diagnostics make of a robot, one after the other, if it is valid and not the right one."""
    found = []
    for each in eurdf.check(folder).diagnostics:
        if each.fix is None or not steps:
            continue
        before = {name: Path(name).read_text(encoding="utf-8") for name in each.fix.texts()}
        for name, text in each.fix.texts().items():
            Path(name).write_text(text, encoding="utf-8")
        if not eurdf.check(folder).diagnostics:
            found += [] if same(folder, valid) else [each.fix.summary]
        else:
            found += wrong_robots(folder, valid, steps - 1)
        for name, text in before.items():
            Path(name).write_text(text, encoding="utf-8")
    return found


@pytest.mark.parametrize("base", BASES)
def test_a_robot_without_a_mistake_is_valid(tmp_path: Path, base: str) -> None:
    assert not eurdf.check(write(tmp_path / base, base)).diagnostics


@pytest.mark.parametrize("mistake", NAMED, ids=str)
def test_the_first_diagnostic_names_the_cause(tmp_path: Path, mistake: Mistake) -> None:
    first = eurdf.check(write(tmp_path / "robot", mistake.base, mistake.edits)).diagnostics[0]
    assert re.search(mistake.cause, f"{first.message} {first.hint}", re.IGNORECASE), first
    assert first.fix or not mistake.mark


@pytest.mark.parametrize("mistake", MISTAKES, ids=str)
def test_no_fix_gives_another_valid_robot(tmp_path: Path, mistake: Mistake) -> None:
    valid = write(tmp_path / "valid", mistake.base)
    assert not wrong_robots(write(tmp_path / "robot", mistake.base, mistake.edits), valid)


@pytest.mark.parametrize(("families", "least"), [(["text"], 0.98), (["geometry", "actuation"], 0.85)])
def test_few_causes_are_not_named(families: list[str], least: float) -> None:
    of_these = [each for each in MISTAKES if each.family in families]
    assert len({*NAMED}.intersection(of_these)) >= least * len(of_these)


def test_few_wrong_values_are_not_found() -> None:
    assert sum((each.family, each.mark) == ("values", "-") for each in MISTAKES) <= 4
