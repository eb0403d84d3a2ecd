"""Robots of thousands of joints: what we make of them grows as their number does, and no `pin.Data` is made."""

from __future__ import annotations

import tracemalloc
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest

import eurdf
from eurdf.commands.robot_info import robot_info
from eurdf.format.urdf.read import JOINT_LIMIT
from eurdf.kinematics.evaluate import frames
from eurdf.kinematics.loop import Loop, find_loops, independent_groups, joints_of_loops
from eurdf.kinematics.problem import Problem
from eurdf.linking.link import ROW_LIMIT
from eurdf.pinocchio.ancestry import Ancestry
from support.hostile import VERSION2, chain, four_bars, joint, numbered, robot, shared


def write(folder: Path, description: str | None, urdf: str) -> Path:
    folder.mkdir(exist_ok=True)
    (folder / "robot.urdf").write_text(urdf, encoding="utf-8")
    if description is None:
        return folder / "robot.urdf"
    (folder / "robot.yaml").write_text(description, encoding="utf-8")
    return folder


def peak(function: Callable[[], object]) -> int:
    """Bytes that Python and NumPy hold at most while a function runs, beyond those before it."""
    tracemalloc.start()
    try:
        function()
        return tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()


@pytest.mark.slow
@pytest.mark.parametrize("in_series", [False, True], ids=["side by side", "in series"])
def test_memory_grows_linearly_with_four_bars(tmp_path: Path, in_series: bool) -> None:
    peaks = []
    for count in (25, 25, 200):  # twice the first, since modules are loaded with it
        path = write(tmp_path / str(count), *four_bars(count, in_series))

        def work(path: Path = path) -> None:
            loaded = eurdf.load(path, geometry=False)
            assert eurdf.assemble(loaded).converged
            robot_info(loaded, eurdf.analyze(loaded))

        peaks.append(peak(work))
    assert peaks[2] < 16 * peaks[1]  # 8 where it is linear, 64 where it is quadratic


@pytest.mark.slow
def test_thousand_four_bars_need_small_data_only(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    made: list[int] = []
    create = pin.Model.createData
    monkeypatch.setattr(pin.Model, "createData", lambda model: (made.append(model.nv), create(model))[1])
    path = write(tmp_path, *four_bars(1000, in_series=True))
    loaded = eurdf.load(path, geometry=False)
    assert (loaded.model.nv, len(loaded.constraint_models)) == (3000, 1000)
    assembly = eurdf.assemble(loaded)
    assert assembly.converged
    assert eurdf.check(path).ok
    assert max(made) <= 60


def test_kinematics_of_hundred_four_bars_needs_small_data_only(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    loaded = eurdf.load(write(tmp_path, *four_bars(100, in_series=True)), geometry=False)
    made: list[int] = []
    create = pin.Model.createData
    monkeypatch.setattr(pin.Model, "createData", lambda model: (made.append(model.nv), create(model))[1])
    q = eurdf.assemble(loaded).q
    there = eurdf.forward_kinematics(loaded, q[loaded.actuation.idx_q] + 0.01, q)
    np.testing.assert_allclose(eurdf.residual(loaded, there), 0.0, atol=1e-10)
    frame = loaded.mechanism.bodies[-1].name
    target = frames(loaded, [frame], few=True).at(there[None]).position[0, 0]
    assert eurdf.inverse_kinematics(loaded, {frame: np.array(target)}, q).converged
    eurdf.actuated_jacobian(loaded, frame, there)
    assert max(made) <= 60


# -- groups that are alike --------------------------------------------------------------------------------------------


@pytest.mark.parametrize("limits", [False, True])
@pytest.mark.parametrize(("in_series", "spread"), [(True, 0.3), (False, 2.0)])
def test_alike_groups_together_equal_each_by_itself(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, in_series: bool, spread: float, limits: bool
) -> None:
    """From afar, some of them start again. Where a loop can move, rounding decides how far damped steps move it."""
    path = write(tmp_path, *four_bars(25, in_series))
    found = []
    for many in (3, 1000):
        monkeypatch.setattr("eurdf.kinematics.problem.MANY_ALIKE", many)
        loaded = eurdf.load(path, geometry=False)
        random = np.random.default_rng(0)
        away = np.tile([0.9, -0.7, 1.9], 25) + random.uniform(-spread, spread, loaded.model.nv)
        first = eurdf.assemble(loaded, loaded.tree.integrate(loaded.tree.neutral(), away), limits=limits)
        assert first.closes
        away = random.uniform(-0.05, 0.05, loaded.model.nv)
        given = loaded.tree.integrate(first.q, away)[loaded.actuation.idx_q]
        moved = eurdf.forward_kinematics(loaded, given, first.q)
        found.append((first.q, first.iterations, moved, eurdf.kinematics.dq_dq_actuated(loaded, moved)))
        assert len(Problem(loaded).stacks) == (many == 3)
    for one, other in zip(*found, strict=True):
        np.testing.assert_allclose(one, other, rtol=0.0, atol=1e-5)


# -- the bounds of EU-FIL-002 --------------------------------------------------------------------------------------


def test_mimic_joint_counts_toward_bound(tmp_path: Path) -> None:
    content = '<mimic joint="j0"/>'
    leader = joint("j0", "l0", "l1")
    joints = [leader, *(joint(f"j{i}", "l0", f"l{i + 1}", content=content) for i in range(1, 4001))]
    path = write(tmp_path, None, robot(numbered(4002), joints))
    assert refusal(path) == "the joints of the robot have 4,001 velocities; the maximum is 4,000"


def test_number_of_joints_is_bounded(tmp_path: Path) -> None:
    path = write(tmp_path, None, chain(JOINT_LIMIT + 1, "fixed"))
    assert refusal(path) == "the robot has 10,001 joints; the maximum is 10,000"


@pytest.mark.slow
def test_number_of_rows_is_bounded(tmp_path: Path) -> None:
    at, beyond = (write(tmp_path / str(count), *shared(count, 200)) for count in (6666, 6667))
    assert eurdf.load(at, geometry=False).mechanism.nc == ROW_LIMIT - 2
    assert refusal(beyond) == "the closures of the robot have 20,001 constraint rows; the maximum is 20,000"


def refusal(path: Path) -> str:
    """The one error of a robot that is too large; it has no other."""
    (error,) = eurdf.check(path).errors
    assert error.code == "file-too-large"
    with pytest.raises(eurdf.InvalidRobot):
        eurdf.load(path, geometry=False)
    return error.message


# -- what is left out -------------------------------------------------------------------------------------------------


def test_loops_sharing_too_many_joints_are_skipped(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("eurdf.kinematics.analysis._MOST_WORK", 50.0)
    loaded = eurdf.load(write(tmp_path, *four_bars(2, in_series=True)), geometry=False)
    analysis = eurdf.analyze(loaded)
    assert analysis.closes
    assert (analysis.rank, analysis.mobility, analysis.loops) == (None, None, ())
    assert analysis.left_out == (
        "ranks were not computed: the loops that share joints with that of 'loop0' have 3 constraint rows "
        "on 3 velocities"
    )
    assert robot_info(loaded, analysis).left_out == analysis.left_out


def test_skipped_check_is_no_error(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("eurdf.kinematics.closing.MOST_WORK", 100.0)
    path = write(tmp_path, *four_bars(2, in_series=True))
    assert [found.code for found in eurdf.check(path).diagnostics] == ["x-loops-not-checked"]
    loaded = eurdf.load(path, geometry=False)
    assert eurdf.assemble(loaded).reason == "not decided"
    assert eurdf.analyze(loaded).left_out.startswith("it was not computed whether the loops can be closed")


def test_large_group_does_not_keep_others_open(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("eurdf.kinematics.problem.MOST_VELOCITIES_AT_ONCE", 0)
    # The first three loops share their joints with one around them.
    description, urdf = four_bars(5, in_series=True)
    around = (
        "- {name: around, type: 3d, frames: [{link: ground, xyz: [0.5, 0, 0]}, {link: rocker2, xyz: [0.2, 0, 0]}]}\n"
    )
    loaded = eurdf.load(write(tmp_path, description + around, urdf), geometry=False)
    # A step of the large group exceeds the bound, and all steps of the small ones do not.
    monkeypatch.setattr("eurdf.kinematics.problem._WORK_OF_A_CLOSURE", 1.0)
    monkeypatch.setattr("eurdf.kinematics.closing.MOST_WORK", 900.0)
    assembly = eurdf.assemble(loaded)
    assert assembly.reason == "not decided"
    assert [opening.name for opening in assembly.open if not opening.is_open] == ["loop3", "loop4"]


# -- the tree ---------------------------------------------------------------------------------------------------------


def random_parents(seed: int, size: int) -> list[int]:
    random = np.random.default_rng(seed)
    return [0, *(int(random.integers(max(0, node - 5), node)) for node in range(1, size))]


def ancestors(node: int, parents: list[int]) -> list[int]:
    path = [node]
    while path[-1]:
        path.append(parents[path[-1]])
    return path


@pytest.mark.parametrize("seed", range(10))
def test_ancestors_and_sums_match_tree_walk(seed: int) -> None:
    parents = random_parents(seed, 200)
    ancestry, random = Ancestry(parents), np.random.default_rng(seed)
    weights = random.uniform(0.0, 1.0, 200).tolist()
    sums = ancestry.sums(weights)
    for a, b in random.integers(0, 200, (300, 2)).tolist():
        above_a, above_b = ancestors(a, parents), ancestors(b, parents)
        common = max(set(above_a) & set(above_b))
        assert ancestry.common(a, b) == common
        expected = sum(weights[node] for node in above_a[: above_a.index(common)])
        assert ancestry.sum_to(a, common, weights, sums) == pytest.approx(expected, rel=1e-12, abs=1e-12)


def path(loop: Loop, parents: Sequence[int]) -> set[int]:
    """The joints of a loop, one after the other."""
    found = set()
    for side in loop.chains:
        joint = side.joint
        while joint != side.above:
            found.add(joint)
            joint = parents[joint]
    return found


@pytest.mark.parametrize("seed", range(20))
def test_loop_groups_are_connected_by_shared_joints(tmp_path: Path, seed: int) -> None:
    random = np.random.default_rng(seed)
    parents = random_parents(seed, 60)
    joints = [joint(f"j{i}", f"l{parents[i]}", f"l{i}") for i in range(1, 60)]
    pairs = sorted({tuple(sorted(pair)) for pair in random.integers(0, 60, (12, 2)).tolist() if pair[0] != pair[1]})
    closures = "".join(f"- {{name: c{i}, type: 3d, frames: [l{a}, l{b}]}}\n" for i, (a, b) in enumerate(pairs))
    loaded = eurdf.load(
        write(tmp_path, f"{VERSION2}closures:\n{closures}", robot(numbered(60), joints)), geometry=False
    )
    held = set(random.choice(loaded.model.nv, 15, replace=False).tolist())
    loops = find_loops(loaded)
    tree = loaded.tree
    on_paths = [path(loop, tree.parents) for loop in loops]
    moving = [{v for joint in joints for v in tree.moving_velocities[joint]} - held for joints in on_paths]
    groups = independent_groups(loaded, held)
    assert sorted(index for group in groups for index in group.closures) == list(range(len(loops)))
    for group in groups:
        together = set().union(*(moving[index] for index in group.closures))
        assert group.velocities.tolist() == sorted(together)
        others = set(range(len(loops))) - set(group.closures)
        assert not any(together & moving[index] for index in others)
        reached, members = set(group.closures[:1]), set(group.closures)
        while more := {i for i in members - reached if any(moving[i] & moving[k] for k in reached)}:
            reached |= more
        assert reached == members
    assert joints_of_loops(loaded) == sorted(set().union(*on_paths))


def test_search_that_is_cut_short_decides_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    loaded = eurdf.load(write(tmp_path, *four_bars(3, in_series=True, ground=4.0)), geometry=False)
    whole = eurdf.assemble(loaded)
    assert whole.reason == "not closed"
    # Enough for the first descents, but not for all restarts.
    work = Problem(loaded).work
    monkeypatch.setattr("eurdf.kinematics.closing.MOST_WORK", 65 * work)
    cut = eurdf.assemble(loaded)
    assert 10 < cut.iterations < whole.iterations
    assert cut.reason == "not decided"
    assert [found.code for found in eurdf.check(tmp_path).diagnostics] == ["x-loops-not-checked"]
