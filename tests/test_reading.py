"""Bad input never hurts: damaged and hostile files give diagnostics or a robot, and nothing else, in bounded time."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

import pytest

import eurdf
from benchmarks.fuzz.case import Case
from benchmarks.fuzz.robots import Seed, seeds
from benchmarks.fuzz.robots import case_of as robot_case
from benchmarks.fuzz.watched import Watched
from eurdf.diagnostics import Diagnostics, Place, did_you_mean
from eurdf.diagnostics.diagnostic import LISTED, LONGEST
from eurdf.format.urdf import read
from support.hostile import HOSTILE, INERTIAL, MEMORY, chain, joint, numbered, robot, star
from support.places import DATA, ROOT, WILD
from support.wild import FACTS, needs_wild

#: Processes that the damaged robots are divided among.
BATCHES = 4

#: Parts that the hostile files are divided into.
PARTS = 4


def load_changed(folder: Path, old: str, new: str, *, assembled: bool = True) -> eurdf.Robot:
    """The workbench with one place of its URDF changed, with or without its assembled configuration."""
    text = (DATA / "workbench.urdf").read_text(encoding="utf-8")
    assert old in text
    (folder / "workbench.urdf").write_text(text.replace(old, new, 1), encoding="utf-8")
    description = (DATA / "workbench.yaml").read_text(encoding="utf-8")
    changed = description if assembled else description.replace("  assembled:", "  another:")
    (folder / "robot.yaml").write_text(changed, encoding="utf-8")
    report = eurdf.check(folder)
    robot = eurdf.load(folder, check_loops=True)
    of_clauses = [found for found in report.diagnostics if found.clause is not None]  # not advice
    # Only `check` tries fixes.
    assert [(each.message, each.place) for each in robot.diagnostics] == [(e.message, e.place) for e in of_clauses]
    return robot


def outcomes(seed: int, robots: Sequence[Seed] | None, numbers: range, folder: Path) -> list[str]:
    """What becomes of damaged robots, those of the project or others; fails with those that do harm."""
    found, harm = [], []
    with Watched() as worker:
        for number in numbers:
            if robots is None:
                outcome = worker.try_number(seed, number, "robot")
            else:
                robot = robot_case(seed, number, robots)
                described = {} if robot.description is None else {"robot.yaml": robot.description}
                files = {"robot.urdf": robot.urdf, **described}
                Case("robot", robot.title, files, list(files)[-1]).write(folder / str(number))
                outcome = worker.try_folder(folder / str(number))
            found.append(outcome.word)
            if outcome.trouble:
                harm.append(f"seed {seed}, case {number}: {outcome.word}: {outcome.trouble}")
    assert harm == []
    return found


@pytest.mark.slow
@pytest.mark.parametrize("batch", range(BATCHES))
def test_damaged_robot_gives_diagnostics_or_robot(request: pytest.FixtureRequest, batch: int, tmp_path: Path) -> None:
    count, seed = request.config.getoption("--mutations"), request.config.getoption("--mutation-seed")
    words = outcomes(seed, None, range(count * batch // BATCHES, count * (batch + 1) // BATCHES), tmp_path)
    if len(words) >= 200:  # both outcomes of the parser were tried
        assert min(words.count("refused"), words.count("robot")) > len(words) // 20


@pytest.mark.slow
@needs_wild
def test_damaged_published_robot_gives_diagnostics_or_robot(request: pytest.FixtureRequest, tmp_path: Path) -> None:
    count, seed = request.config.getoption("--mutations") // 20, request.config.getoption("--mutation-seed")
    robots = seeds([WILD / name for name in FACTS])
    assert outcomes(seed, robots, range(count), tmp_path)


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="memory is measured and bounded as Linux does it")
@pytest.mark.slow
@pytest.mark.parametrize("part", range(PARTS))
def test_hostile_file_is_judged_within_bounds(part: int) -> None:
    names = list(HOSTILE)[part::PARTS]
    # One thread, so that processor time is time, also beside other tests.
    threads = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")
    own = str(Path(eurdf.__file__).parents[1]), str(ROOT), os.environ.get("PYTHONPATH")
    environment = {**os.environ, **threads, "PYTHONPATH": os.pathsep.join(filter(None, own))}
    command = [sys.executable, "support/hostile.py", *names]
    done = subprocess.run(
        command, cwd=ROOT / "tests", env=environment, capture_output=True, text=True, timeout=300, check=False
    )
    lines = [json.loads(line) for line in done.stdout.splitlines()]
    assert (done.returncode, [line["name"] for line in lines]) == (0, names), done.stderr
    assert done.stderr == ""
    for line in lines:
        code = HOSTILE[line["name"]].code
        assert line["status"] == 0, line
        assert line.get("codes") == ([code] if code else []), line
        assert bool(line["loaded"]) == (code == ""), line
        assert line["memory"] < MEMORY, line
        assert line["told"] < 200_000, line


# -- what bounds diagnostics ----------------------------------------------------------------------------------------


def test_repeated_error_is_listed_a_hundred_times() -> None:
    diagnostics = Diagnostics()
    for index in range(LISTED + 1234):
        diagnostics.report("unknown-frame", f"'x{index}' is no frame", Place("robot.yaml", index + 1), "name one")
    diagnostics.report("unknown-joint", "'y' is no joint", Place("robot.yaml", 1))
    listed = list(diagnostics)
    assert len(listed) == LISTED + 1
    assert [found.hint for found in listed[-3:]] == ["name one", "name one; 1,234 more like it are not listed", None]
    assert (len(diagnostics), diagnostics.error_count) == (LISTED + 1235, LISTED + 1235)
    assert diagnostics.refused


def test_hint_of_unlisted_diagnostic_is_not_computed() -> None:
    asked: list[int] = []
    diagnostics = Diagnostics()
    for index in range(LISTED + 50):
        diagnostics.report("unknown-frame", "no frame", Place("robot.yaml"), lambda at=index: asked.append(at))  # type: ignore[misc]
    assert asked == list(range(LISTED))


def test_message_with_endless_name_stays_readable() -> None:
    diagnostics = Diagnostics()
    diagnostics.report("unknown-joint", f"'{'n' * 100_000}' is not a joint of the robot", Place("robot.yaml"))
    (found,) = diagnostics
    assert len(found.message) < LONGEST
    assert found.message.startswith("'nnnn")
    assert found.message.endswith("nnnn' is not a joint of the robot")


def test_intended_name_is_found_among_many() -> None:
    known = [f"joint_number_{index}" for index in range(20_000)]
    assert did_you_mean("joint_nmber_12345", [*known[:5000], *known[12_345:]]) == "did you mean 'joint_number_12345'?"
    assert did_you_mean("Joint_Number_19999", known) == "did you mean 'joint_number_19999'?"
    assert did_you_mean("elbow", known) is None


def test_impossible_loops_are_given_up_in_time(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    robot = load_changed(tmp_path, '<origin xyz="0.6 -0.3 0.1"/>', '<origin xyz="60 -0.3 0.1"/>', assembled=False)
    whole = eurdf.assemble(robot)
    assert not whole.closes
    monkeypatch.setattr("eurdf.kinematics.closing.MOST_WORK", 1e6)
    cut = eurdf.assemble(robot)
    assert not cut.closes
    assert cut.iterations < whole.iterations / 4
    assert (whole.reason, cut.reason) == ("not closed", "not decided")


# -- what damaged robots did once -----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ('xyz="0 0.15 0"/><mass', 'xyz="0 1e15 0"/><mass'),
        ('ixx="0.006"', 'ixx="1e15"'),
        ('ixx="0.006" ixy="0" ixz="0" iyy="0.001"', 'ixx="1e15" ixy="1e15" ixz="-1e15" iyy="1e15"'),
        ('rgba="0.5 0.5 0.5 1"', 'rgba="1e15 0.5 1e-320 1"'),
        ('<origin xyz="0.2 0 0"/><parent', '<origin xyz="1e15 -1e15 1e15" rpy="1e15 0 1"/><parent'),
        ('<mass value="0.7"/>', '<mass value="1e15"/>'),
        ('multiplier="-1"', 'multiplier="1e15"'),
    ],
)
def test_numbers_at_the_bounds_print_nothing(tmp_path: Path, old: str, new: str) -> None:
    assert load_changed(tmp_path, old, new).model.njoints > 1


@pytest.mark.parametrize(
    ("relation", "of"),
    [
        ('multiplier="1e10"', "multiplier"),
        ('multiplier="-1e10" offset="1e7"', "multiplier"),
        ('multiplier="1e-9"', "multiplier"),
        ('multiplier="1e7" offset="1e10"', "offset"),
    ],
)
def test_chained_mimics_out_of_bounds_are_an_error(tmp_path: Path, relation: str, of: str) -> None:
    """EU-FIL-005: multiplier and offset with respect to the leader at the end."""
    mimics = [f'<mimic joint="j{index + 1}" {relation}/>' for index in range(2)] + [""]
    joints = [joint(f"j{index}", "l0", f"l{index + 1}", content=each) for index, each in enumerate(mimics)]
    (tmp_path / "robot.urdf").write_text(robot(numbered(4), joints, INERTIAL), encoding="utf-8")
    (found,) = eurdf.check(tmp_path).errors
    assert (found.code, found.pointer) == ("number-out-of-bounds", f"/robot/joint[1]/mimic/@{of}")
    assert eurdf.load(tmp_path, mimic=False).model.nv == 3


def test_mimic_cycle_is_reported_alone_and_shortened(tmp_path: Path) -> None:
    links = "".join(f'<link name="l{index}"/>' for index in range(21))
    joints = "".join(
        f'<joint name="j{i}" type="continuous"><parent link="l0"/><child link="l{i + 1}"/>'
        f'<mimic joint="j{i + 1 if i < 19 else 2}"/></joint>'
        for i in range(20)
    )
    (tmp_path / "robot.urdf").write_text(f'<robot name="r">{links}{joints}</robot>', encoding="utf-8")
    (found,) = eurdf.check(tmp_path).errors
    assert found.code == "urdf-mimic-cycle"
    assert found.message.endswith("in a cycle: 'j2' -> 'j3' -> 'j4' -> 'j5' -> 'j6' -> '...' -> 'j2'")


# -- The work and the memory that a file takes are bounded, however it is made


def test_joints_of_too_large_robot_are_not_read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(read, "JOINT_LIMIT", 5)
    path = tmp_path / "robot.urdf"
    path.write_text(star(5), encoding="utf-8")
    assert {found.code for found in eurdf.check(path).errors} == {"leaf-without-inertia"}
    path.write_text(chain(6), encoding="utf-8")
    monkeypatch.setattr(read, "read_link", None)
    (found,) = eurdf.check(path).diagnostics
    assert (found.code, found.line, found.column, found.pointer) == ("file-too-large", 1, 1, "/robot")
    assert found.message == "the robot has 6 joints; the maximum is 5"


def test_merging_leaves_number_of_joints(tmp_path: Path) -> None:
    axes = ("1 0 0", "0 1 0", "0 0 1")
    joints = [joint(f"j{i}", f"l{i}", f"l{i + 1}", content=f'<axis xyz="{axis}"/>') for i, axis in enumerate(axes)]
    (tmp_path / "robot.urdf").write_text(robot(numbered(4), joints), encoding="utf-8")
    (tmp_path / "robot.yaml").write_text(
        'extended_urdf: "2.0"\njoints: {ball: {type: spherical, merges: [j0, j1, j2]}}\n', encoding="utf-8"
    )
    mechanism = eurdf.load(tmp_path, geometry=False).mechanism
    assert [(joint.name, joint.type) for joint in mechanism.joints] == [
        ("ball", "spherical"),
        ("j0", "fixed"),
        ("j1", "fixed"),
    ]


def test_file_is_opened_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "robot.urdf").write_text(star(1), encoding="utf-8")
    (tmp_path / "robot.yaml").write_text('extended_urdf: "2.0"\nclosurs: []\n', encoding="utf-8")
    opened: list[str] = []
    original = os.open

    def counted(path: str, *rest: int) -> int:
        opened.append(Path(path).name)
        return original(path, *rest)

    monkeypatch.setattr(os, "open", counted)
    report = eurdf.check(tmp_path)
    assert "closurs" in str(report.diagnostics[0])
    assert sorted(opened) == ["robot.urdf", "robot.yaml"]
