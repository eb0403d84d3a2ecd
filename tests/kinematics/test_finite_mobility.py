"""Infinitesimal and finite mobility, and the mobility of loops that are closed only to rounding."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any, Literal

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import eurdf
from eurdf.closures.hinge import HingeClosure
from eurdf.commands.main import main
from eurdf.commands.robot_info import robot_info
from eurdf.kinematics.analysis import Analysis, analyze
from eurdf.kinematics.quadratic_forms import common_roots
from support.described import load, written
from support.hostile import four_bars
from support.linkage import (
    Linkage,
    Pair,
    Z,
    anchor,
    bennett,
    closure,
    described,
    flat_sarrus,
    loop,
    n_bar,
    pulled_apart,
    rounded,
    translation,
)

Closed = Literal["6d", "hinge"]


def collinear(*pins: float, size: float = 1.0) -> Linkage:
    """A planar loop of revolutes whose pins are on one line, at these distances along it."""
    return loop([("R", (x, 0.0, 0.0), Z) for x in pins], size=size)


def cut(pairs: list[Pair], kind: Closed, decimals: int | None = None) -> Linkage:
    """A loop of revolutes, closed in 6d behind the last one, or cut at it and closed by a hinge."""
    if kind == "6d":
        return loop(pairs, decimals=decimals)
    *others, (_, point, axis) = pairs
    linkage = loop(others, decimals=decimals)
    model = linkage.model
    data = model.createData()
    pin.forwardKinematics(model, data, pin.neutral(model))
    turn = pin.Quaternion.FromTwoVectors(np.array(Z), np.array(axis, dtype=float)).matrix()
    oMc, last = pin.SE3(turn, np.array(point, dtype=float)), model.njoints - 1
    a = anchor(model, 0, rounded(oMc, decimals))
    b = anchor(model, last, rounded(data.oMi[last].actInv(oMc), decimals))
    return replace(linkage, constraints=[HingeClosure("end", a, b, (Z, Z))])


def bennett_pairs(twist: float = 0.6) -> list[Pair]:
    """The four revolutes of a Bennett linkage where it is closed."""
    linkage = bennett(twist)
    data = linkage.model.createData()
    pin.forwardKinematics(linkage.model, data, eurdf.assemble(linkage).q)
    return [("R", data.oMi[joint].translation, data.oMi[joint].rotation[:, 2]) for joint in range(1, 5)]


def watt_with_slider(point: float) -> Linkage:
    """Watt's linkage whose coupler carries a pin that a straight slot guides; `point` is where along the coupler.

    The pin at the middle (0) leaves the line by a multiple of t⁵, other points leave it by one of t².
    """
    model = pin.Model()
    crank = model.addJoint(0, pin.JointModelRZ(), translation(-2.0, 1.0, 0.0), "crank")
    coupler = model.addJoint(crank, pin.JointModelRZ(), translation(2.0, 0.0, 0.0), "coupler")
    rocker = model.addJoint(coupler, pin.JointModelRZ(), translation(0.0, -2.0, 0.0), "rocker")
    turn = pin.SE3(pin.utils.rotate("x", -np.pi / 2.0), np.zeros(3))
    slot = model.addJoint(0, pin.JointModelPZ(), turn, "slot")
    up = turn.inverse() * translation(0.0, point, 0.0)
    return Linkage(
        model,
        [
            closure(model, 0, translation(2.0, -1.0, 0.0), rocker, translation(2.0, 0.0, 0.0), "3d", "ground"),
            closure(model, slot, up, coupler, translation(0.0, point - 1.0, 0.0), "3d", "pin"),
        ],
        ["crank"],
    )


def mobilities(analysis: Analysis) -> tuple[Any, Any, Any]:
    return analysis.mobility, analysis.infinitesimal_mobility, analysis.finite_mobility


def decided(analysis: Analysis) -> Any:
    (loops,) = analysis.loops
    return loops.evidence, loops.branches, loops.rigid_order


# -- shaky structures -------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("size", [1e-2, 1.0, 1e2])
@pytest.mark.parametrize("pins", [(0.0, 1.0, 3.0), (0.0, 2.0, 1.0)], ids=["stretched", "folded"])
def test_collinear_triangle_is_rigid_to_second_order(pins: tuple[float, ...], size: float) -> None:
    analysis = analyze(collinear(*pins, size=size))
    assert mobilities(analysis)[1:] == (1, 0)
    assert decided(analysis) == ("second order", (), 2)


def test_triangle_that_is_not_flat_is_rigid_to_first_order() -> None:
    analysis = analyze(n_bar(3))
    assert mobilities(analysis) == (0, 0, 0)
    assert decided(analysis) == ("constant rank", (), 1)


def test_continuation_finds_order_that_second_derivatives_do_not() -> None:
    # The middle of Watt's coupler touches its line to fifth order.
    analysis = analyze(watt_with_slider(0.0))
    assert mobilities(analysis) == (1, 1, 0)
    assert decided(analysis) == ("continuation", (), 5)
    assert decided(analyze(watt_with_slider(0.4))) == ("second order", (), 2)


# -- motions that continue --------------------------------------------------------------------------------------------


@pytest.mark.parametrize("twist", [0.2, 0.6])
@pytest.mark.parametrize("kind", ["6d", "hinge"])
def test_bennett_linkage_moves(kind: Closed, twist: float) -> None:
    analysis = analyze(cut(bennett_pairs(twist), kind))
    assert mobilities(analysis) == (1, 1, 1)
    assert decided(analysis) == ("continuation", (1,), None)


def test_folded_parallelogram_has_two_branches() -> None:
    analysis = analyze(collinear(0.0, 1.0, 3.0, 2.0))
    assert mobilities(analysis) == (1, 2, 1)
    assert decided(analysis) == ("continuation", (1, 1), None)


def test_branch_of_largest_dimension_counts() -> None:
    # Pressed flat, the pins of foot and top coincide in each leg: both legs swing while the top is at rest.
    analysis = analyze(flat_sarrus())
    assert mobilities(analysis) == (1, 3, 2)
    evidence, branches, _ = decided(analysis)
    assert evidence == "continuation"
    assert branches[0] == 2


def test_one_branch_is_counted_once() -> None:
    analysis = analyze(collinear(0.0, 1.0, 3.0, 2.0, 0.0, 1.0, 3.0, 2.0))
    assert mobilities(analysis) == (5, 6, 5)
    assert decided(analysis) == ("continuation", (5,), None)


def test_groups_and_joints_outside_are_summed() -> None:
    linkage = collinear(0.0, 1.0, 3.0)
    model = linkage.model
    ends = list(linkage.constraints)
    first = model.addJoint(0, pin.JointModelRZ(), translation(0.0, 9.0, 0.0), "k0")
    second = model.addJoint(first, pin.JointModelRZ(), translation(1.0, 0.5, 0.0), "k1")
    third = model.addJoint(second, pin.JointModelRZ(), translation(1.0, -1.5, 0.0), "k2")
    ends.append(closure(model, 0, translation(3.0, 9.0, 0.0), third, translation(1.0, 1.0, 0.0), "3d", "other"))
    model.addJoint(0, pin.JointModelRX(), pin.SE3.Identity(), "gripper")
    analysis = analyze(replace(linkage, constraints=ends))
    assert [loops.finite_mobility for loops in analysis.loops] == [0, 1]
    assert mobilities(analysis) == (3, 3, 2)


def test_tree_has_finite_mobility_of_its_velocities() -> None:
    assert mobilities(analyze(Linkage(n_bar(5).model))) == (5, 5, 5)


@pytest.mark.parametrize("name", eurdf.collection_names())
def test_collection_is_regular_where_assembled(name: str) -> None:
    analysis = analyze(eurdf.load(name, geometry=False))
    assert analysis.mobility == analysis.infinitesimal_mobility == analysis.finite_mobility
    assert (analysis.rounded_mobility, analysis.rounded_tolerance) == (None, None)


# -- identities -------------------------------------------------------------------------------------------------------


@given(seed=st.integers(0, 2**32 - 1), count=st.integers(3, 6))
@settings(max_examples=20, deadline=None)
def test_moved_in_space_chain_stays_rigid(seed: int, count: int) -> None:
    random = np.random.default_rng(seed)
    turn = pin.exp3(random.normal(size=3))
    offset, pins = random.normal(size=3), np.cumsum(random.uniform(0.5, 2.0, count))
    pairs = [("R", offset + turn @ np.array([x, 0.0, 0.0]), turn @ np.array(Z)) for x in pins]
    analysis = analyze(loop(pairs))
    assert mobilities(analysis)[1:] == (count - 2, 0)
    assert decided(analysis) == ("second order", (), 2)


@given(seed=st.integers(0, 2**32 - 1), count=st.integers(4, 7))
@settings(max_examples=20, deadline=None)
def test_drawn_loop_of_free_pins_is_regular(seed: int, count: int) -> None:
    random = np.random.default_rng(seed)
    angles = np.sort(random.uniform(0.0, 2.0 * np.pi / count, count)) + 2.0 * np.pi * np.arange(count) / count
    analysis = analyze(loop([("R", (np.cos(a), 1.3 * np.sin(a), 0.0), Z) for a in angles]))
    assert mobilities(analysis) == (count - 3,) * 3


# -- roots of quadratic forms -----------------------------------------------------------------------------------------


@given(seed=st.integers(0, 2**32 - 1), m=st.integers(2, 5), count=st.integers(1, 3))
@settings(max_examples=60, deadline=None)
def test_forms_with_planted_root_have_roots(seed: int, m: int, count: int) -> None:
    random = np.random.default_rng(seed)
    forms = random.normal(size=(count, m, m))
    forms += np.swapaxes(forms, 1, 2)
    z = random.normal(size=m)
    z /= np.linalg.norm(z)
    forms -= np.einsum("kij,i,j->k", forms, z, z)[:, None, None] * np.outer(z, z)
    roots = common_roots(forms)
    assert not roots.none
    if m == 2:
        assert max(abs(float(root @ z)) for root in roots.directions) > 0.999
    for root in roots.directions:
        assert np.abs(np.einsum("kij,i,j->k", forms, root, root)).max() < 0.1


@given(seed=st.integers(0, 2**32 - 1), m=st.integers(1, 5), count=st.integers(1, 3))
@settings(max_examples=60, deadline=None)
def test_definite_combination_proves_no_roots(seed: int, m: int, count: int) -> None:
    random = np.random.default_rng(seed)
    forms = random.normal(size=(count, m, m))
    forms += np.swapaxes(forms, 1, 2)
    half = random.normal(size=(m, m))
    weights = random.normal(size=count - 1)
    definite = half @ half.T + 0.5 * np.eye(m)  # = Q_1 + Σ weight Q_k
    forms[0] = definite - np.tensordot(weights, forms[1:], 1)
    roots = common_roots(forms)
    assert len(roots.directions) == 0
    if count == 1 or m <= 2:
        assert roots.none


def test_forms_of_zero_leave_all_directions() -> None:
    roots = common_roots(np.zeros((2, 3, 3)))
    assert (roots.count, len(roots.directions), roots.complete, roots.none) == (0, 1, True, False)


# -- loops closed to rounding -----------------------------------------------------------------------------------------


@pytest.mark.parametrize("twist", [0.4, 0.6])
@pytest.mark.parametrize("decimals", [4, 5])
@pytest.mark.parametrize("kind", ["6d", "hinge"])
def test_rounded_bennett_linkage_moves_at_tolerance(kind: Closed, decimals: int, twist: float) -> None:
    analysis = analyze(cut(bennett_pairs(twist), kind, decimals))
    assert not analysis.closes
    assert mobilities(analysis) == (None, None, None)
    assert analysis.rounded_mobility == 1
    assert analysis.rounded_tolerance is not None
    assert 1e-6 < analysis.rounded_tolerance < 10.0 ** (2 - decimals)


def test_bennett_linkage_rounded_to_seven_decimals_closes() -> None:
    analysis = analyze(cut(bennett_pairs(), "6d", 7))
    assert mobilities(analysis) == (1, 1, 1)
    assert analysis.rounded_mobility is None


def test_short_bar_is_not_rounding_that_moves() -> None:
    # The bars of a flat triangle are too short by 1e-5: no motion keeps it closed to ten times that.
    analysis = analyze(pulled_apart(collinear(0.0, 1.0, 3.0), translation(2e-5, 0.0, 0.0)))
    assert not analysis.closes
    assert analysis.rounded_mobility is None


# -- what is left undecided -------------------------------------------------------------------------------------------


def test_work_is_bounded(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("eurdf.kinematics.finite_mobility._MOST_WORK", 1.0)
    analysis = analyze(cut(bennett_pairs(), "6d"))
    assert mobilities(analysis) == (1, 1, "unknown")
    assert decided(analysis) == (None, (), None)
    assert analyze(cut(bennett_pairs(), "6d", 5)).rounded_mobility is None
    assert analyze(n_bar(4)).finite_mobility == 1  # constant rank needs no steps


def test_many_free_velocities_are_undecided() -> None:
    analysis = analyze(collinear(*range(24)))
    assert analysis.infinitesimal_mobility == 22
    assert analysis.finite_mobility == "unknown"


def test_large_regular_robot_is_decided_by_its_rank(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("eurdf.kinematics.finite_mobility._MOST_WORK", 0.0)
    description, urdf = four_bars(100, in_series=True)
    assert analyze(eurdf.load(written(tmp_path, urdf, description), geometry=False)).finite_mobility == 100


# -- info -------------------------------------------------------------------------------------------------------------


def shown(linkage: Linkage, folder: Path, capsys: pytest.CaptureFixture[str]) -> str:
    main(["info", str(written(folder, *described(linkage)))])
    return capsys.readouterr().out


def test_info_warns_of_shaky_structure(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = shown(collinear(0.0, 1.0, 3.0), tmp_path, capsys)
    assert "shaky: rigid to order 2 only" in text
    assert "finite" in text


def test_info_shows_mobility_of_rounded_loops(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert "by rounded numbers" in shown(cut(bennett_pairs(), "6d", 5), tmp_path, capsys)


def test_json_states_each_mobility() -> None:
    robot = load(*described(collinear(0.0, 1.0, 3.0, 2.0)))
    info = robot_info(robot, eurdf.analyze(robot))
    assert (info.mobility, info.infinitesimal_mobility, info.finite_mobility) == (1, 2, 1)
    (loops,) = info.loop_list
    assert (loops.evidence, loops.branches, loops.rigid_order) == ("continuation", (1, 1), None)
