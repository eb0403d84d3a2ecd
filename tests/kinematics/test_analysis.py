"""Rank, mobility, redundant rows and uncontrolled mobility of mechanisms."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import eurdf
from eurdf.commands.robot_info import robot_info
from eurdf.kinematics.analysis import analyze
from eurdf.kinematics.loop_analysis import sparse_basis
from eurdf.kinematics.residual import residual, residual_and_jacobian
from support.described import load
from support.linkage import (
    Linkage,
    X,
    Y,
    Z,
    ball_ended,
    bennett,
    closure,
    described,
    flat_sarrus,
    loop,
    n_bar,
    pulled_apart,
    sarrus,
    scissors,
    slider_crank,
    spherical_four_bar,
    stewart,
    three_rrr,
    translation,
)
from support.wild import FACTS, WILD, needs_wild


def rod_between_balls() -> Linkage:
    """A rod on two balls between crank and ground: it spins about itself, whatever the crank does."""
    pairs = [("R", (0, 0, 0), Z), ("S", (1, 0.2, 0.1), Z), ("S", (2, 1.0, 0.4), Z), ("R", (2, 1.0, 0.4), X)]
    return loop([*pairs[:3], ("R", (2.5, 0, 0), Y)])


def folded_parallelogram() -> Linkage:
    return loop([("R", (x, 0, 0), Z) for x in (0, 1, 3, 2)])


def side_by_side(*linkages: Linkage) -> Linkage:
    """Linkages that share nothing but the ground; their joints are called a0, a1, …, b0, b1, …"""
    model, constraints, actuated = pin.Model(), [], []
    for letter, linkage in zip("abcdef", linkages, strict=False):
        known = {0: 0}
        for joint in range(1, linkage.model.njoints):
            name = letter + linkage.model.names[joint][1:]
            parent, placement = known[linkage.model.parents[joint]], linkage.model.jointPlacements[joint]
            known[joint] = model.addJoint(parent, linkage.model.joints[joint], placement, name)
        names = {linkage.model.names[old]: model.names[new] for old, new in known.items()}
        for found in linkage.constraints:
            a, b = (replace(frame, body=names[frame.body]) for frame in found.anchors)
            constraints.append(replace(found, name=f"{letter}_{found.name}", a=a, b=b))
        actuated += [letter + name[1:] for name in linkage.actuated]
    return Linkage(model, constraints, actuated)


def welded_to_the_ground() -> Any:
    return closure(pin.Model(), 0, translation(1, 2, 3), 0, translation(1, 2, 3))


# nv, nc, rank, uncontrolled with the first joint actuated
KNOWN: dict[str, tuple[Callable[[], Linkage], tuple[int, int, int, int]]] = {
    "triangle in 6d": (lambda: n_bar(3), (3, 6, 3, 0)),
    "triangle in 3d": (lambda: n_bar(3, "3d"), (2, 3, 2, 0)),
    "four-bar in 6d": (lambda: n_bar(4), (4, 6, 3, 0)),
    "four-bar in 3d": (lambda: n_bar(4, "3d"), (3, 3, 2, 0)),
    "five-bar in 6d": (lambda: n_bar(5), (5, 6, 3, 1)),
    "five-bar in 3d": (lambda: n_bar(5, "3d"), (4, 3, 2, 1)),
    "five-bar with two motors": (lambda: n_bar(5, actuated=["j0", "j4"]), (5, 6, 3, 0)),
    "four-bar with a motor at every pin": (
        lambda: n_bar(4, actuated=["j0", "j1", "j2", "j3"]),
        (4, 6, 3, 0),
    ),
    "weld that holds nothing back": (lambda: Linkage(pin.Model(), [welded_to_the_ground()]), (0, 6, 0, 0)),
    "nine-bar in 6d": (lambda: n_bar(9), (9, 6, 3, 5)),
    "slider-crank": (slider_crank, (4, 6, 3, 0)),
    "spherical four-bar": (spherical_four_bar, (4, 6, 3, 0)),
    "Sarrus": (sarrus, (6, 6, 5, 0)),
    "Sarrus pressed flat": (flat_sarrus, (6, 6, 5, 0)),
    "Bennett": (bennett, (4, 6, 3, 0)),
    "parallelogram folded onto a line": (folded_parallelogram, (4, 6, 3, 0)),
    "rod between two balls": (rod_between_balls, (8, 6, 6, 1)),
    "Stewart platform": (stewart, (36, 30, 30, 0)),
    "3-RRR": (three_rrr, (9, 12, 6, 0)),
    "chain with two motors": (lambda: Linkage(n_bar(5).model, actuated=["j0", "j3"]), (5, 0, 0, 3)),
    "ball in 3d": (lambda: ball_ended("3d"), (4, 3, 3, 0)),
    "ball in 6d": (lambda: ball_ended("6d"), (7, 6, 6, 0)),
}


@pytest.mark.parametrize(("build", "known"), KNOWN.values(), ids=KNOWN.keys())
def test_dimensions_of_known_mechanisms(build: Callable[[], Linkage], known: tuple[int, ...]) -> None:
    linkage = build()
    nv, nc, rank, uncontrolled = known
    analysis = analyze(linkage)
    assert analysis.closes
    assert (analysis.nv, analysis.nc, analysis.rank) == (nv, nc, rank)
    assert (analysis.mobility, analysis.redundant) == (nv - rank, nc - rank)
    assert analysis.uncontrolled == uncontrolled
    assert analysis.actuated == len(linkage.actuated)
    assert analysis.nq == linkage.model.nq
    assert analysis.residual <= 1e-9
    assert np.abs(residual(linkage, analysis.q)).max(initial=0.0) <= 1e-10


@given(n=st.integers(1, 9), seed=st.integers(0, 2**32 - 1))
@settings(max_examples=40, deadline=None)
def test_loop_of_n_revolutes_has_rank_at_most_six(n: int, seed: int) -> None:
    random = np.random.default_rng(seed)
    pairs = [("R", random.uniform(-1.0, 1.0, 3), random.normal(size=3)) for _ in range(n)]
    linkage = loop(pairs)
    analysis = analyze(linkage)
    assert analysis.rank == min(n, 6)
    assert analysis.mobility == max(n - 6, 0)


def test_open_loops_have_no_rank() -> None:
    linkage = pulled_apart(n_bar(4), translation(50.0, 0.0, 0.0))
    analysis = analyze(linkage)
    assert not analysis.closes
    counts = ("rank", "mobility", "redundant", "uncontrolled", "controlled", "dependent", "finite_mobility")
    unknown = (*counts, "singularity", "actuation_singularity", "rounded_mobility", "rounded_tolerance")
    assert [name for name in unknown if getattr(analysis, name) is not None] == []
    assert (analysis.dependent_actuators, analysis.motions, analysis.loops) == ((), (), ())
    assert (analysis.nv, analysis.nc, analysis.actuated) == (4, 6, 1)
    assert analysis.residual == pytest.approx(np.linalg.norm(residual(linkage, analysis.q)))
    assert analysis.residual > 40.0


def test_closure_of_rounding_noise_has_rank_zero() -> None:
    centre = np.array([0.3, 0.2, 0.1])
    axes = [(1, 0.2, 0.3), (0.1, 1, 0.2), (0.3, 0.1, 1)]
    points = [centre + distance * np.array(axis) for distance, axis in zip((0.7, 0.9, 1.1), axes, strict=True)]
    linkage = loop([("R", point, axis) for point, axis in zip(points, axes, strict=True)], "3d", tuple(centre))
    found = analyze(linkage)
    assert (found.nv, found.nc, found.rank, found.mobility) == (3, 3, 0, 3)


def test_small_levers_count_among_long_ones() -> None:
    # A crank of 2 mm on a linkage of 4 m.
    linkage = loop([("R", (0, 0, 0), Z), ("R", (0.002, 0, 0), Z), ("R", (2, 2, 0), Z), ("R", (4, 0, 0), Z)])
    assert analyze(linkage).rank == 3
    assert analyze(linkage).uncontrolled == 0


@pytest.mark.parametrize("decimals", [6, 8, 10])
@pytest.mark.parametrize("build", [slider_crank, sarrus, n_bar])
def test_rounding_in_files_adds_no_constraint(build: Callable[..., Linkage], decimals: int) -> None:
    options: dict[str, Any] = {"decimals": decimals, "away": 0.3}
    rounded = n_bar(5, **options) if build is n_bar else build(**options)
    exact = n_bar(5) if build is n_bar else build()
    assert analyze(rounded).rank == analyze(exact).rank


def test_mimic_joint_removes_one_velocity() -> None:
    for mimic, expected in ((True, (2, 1, 1)), (False, (3, 2, 1))):
        analysis = analyze(scissors(mimic), np.array([0.8, 1.3] if mimic else [0.8, -1.6, 1.3]))
        assert (analysis.nv, analysis.rank, analysis.mobility) == expected


def test_whole_is_sum_of_independent_loop_groups() -> None:
    parts = [n_bar(5), slider_crank(), n_bar(4, "3d", actuated=[]), stewart()]
    robot = side_by_side(*parts)
    robot.model.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), "float")
    whole = analyze(robot)
    assert [loops.closures for loops in whole.loops] == [
        ("a_end",),
        ("b_end",),
        ("c_end",),
        tuple(f"d_leg{leg}" for leg in range(1, 6)),
    ]
    for part, loops in zip(parts, whole.loops, strict=True):
        alone = analyze(part)
        for key in ("nv", "nc", "rank", "mobility", "redundant", "uncontrolled", "actuated", "controlled"):
            assert getattr(loops, key) == getattr(alone, key), key
        assert len(loops.joints) == part.model.njoints - 1
    for key in ("nc", "rank", "redundant", "actuated", "controlled"):
        assert getattr(whole, key) == sum(getattr(loops, key) for loops in whole.loops), key
    assert whole.mobility == sum(loops.mobility for loops in whole.loops) + 6
    assert whole.uncontrolled == sum(loops.uncontrolled for loops in whole.loops) + 6 == len(whole.motions)
    assert whole.motions[-1].joints == ("float",)


@pytest.mark.parametrize(
    ("build", "uncontrolled", "dependent", "dependent_actuators"),
    [
        (lambda: n_bar(4), 0, 0, ()),
        (lambda: n_bar(4, actuated=["j0", "j2"]), 0, 1, (("j0", "j2"),)),
        (lambda: n_bar(5, actuated=["j0", "j1", "j4"]), 0, 1, (("j0", "j1", "j4"),)),
        (lambda: n_bar(7, actuated=["j0", "j1", "j4"]), 1, 0, ()),
        # As many motors as motions, and yet one motion is nobody's.
        (lambda: side_by_side(n_bar(4, actuated=["j0", "j1"]), n_bar(4, actuated=[])), 1, 1, (("a0", "a1"),)),
        (
            lambda: side_by_side(n_bar(4, actuated=["j3", "j0"]), n_bar(4, actuated=["j0", "j1", "j2"])),
            0,
            3,
            (("a0", "a3"), ("b0", "b1", "b2")),
        ),
        # A triangle does not move: each of its motors fights the closure.
        (lambda: n_bar(3, actuated=["j1", "j2"]), 0, 2, (("j1",), ("j2",))),
        (lambda: Linkage(n_bar(5).model, actuated=["j0", "j3"]), 3, 0, ()),
    ],
)
def test_actuation_is_sufficient_redundant_or_dependent(
    build: Callable[[], Linkage], uncontrolled: int, dependent: int, dependent_actuators: tuple[tuple[str, ...], ...]
) -> None:
    analysis = analyze(build())
    assert (analysis.uncontrolled, analysis.dependent, analysis.dependent_actuators) == (
        uncontrolled,
        dependent,
        dependent_actuators,
    )
    assert analysis.mobility is not None
    assert analysis.controlled == analysis.actuated - dependent == analysis.mobility - uncontrolled


def test_dependent_actuators_are_separated_from_independent_ones() -> None:
    # A four-bar whose coupler carries a five-bar: two groups of motors in one group of loops, through a shared pin.
    linkage = n_bar(4, "3d", actuated=["j0", "j2", "wheel"])
    model = linkage.model
    wheel = model.addJoint(2, pin.JointModelRZ(), translation(0.3, 0.2, 0.0), "wheel")
    rod = model.addJoint(wheel, pin.JointModelRZ(), translation(0.4, 0.0, 0.0), "rod")
    arm = model.addJoint(rod, pin.JointModelRZ(), translation(1.0, 0.3, 0.0), "arm")
    # Ends on the body before: the loop wheel-rod-arm goes around pin j2 too.
    end = translation(0.2, 0.1, 0.0)
    data = model.createData()
    pin.forwardKinematics(model, data, pin.neutral(model))
    on_rocker = (data.oMi[3].inverse() * data.oMi[arm]) * end
    other = closure(model, 3, on_rocker, arm, end, "3d", "other")
    linkage = replace(linkage, constraints=[*linkage.constraints, other])
    analysis = analyze(linkage)
    assert [loops.closures for loops in analysis.loops] == [("end", "other")]
    assert analysis.mobility == 2
    assert analysis.dependent == 1
    assert analysis.dependent_actuators == (("j0", "j2"),)


def test_uncontrolled_motion_keeps_loops_closed_and_actuators_fixed() -> None:
    for linkage in (rod_between_balls(), n_bar(8), n_bar(7, "3d", actuated=["j2", "j5"]), slider_crank(actuated=[])):
        analysis = analyze(linkage)
        K = residual_and_jacobian(linkage, analysis.q)[1]
        basis = np.zeros((len(analysis.motions), linkage.model.nv))
        for row, motion in zip(basis, analysis.motions, strict=True):
            row[motion.velocities] = motion.values
            names = {linkage.model.names[1 + j] for j in range(linkage.model.njoints - 1) if moves(linkage, j + 1, row)}
            assert set(motion.joints) == names
        np.testing.assert_allclose(K @ basis.T, 0.0, atol=1e-9)
        np.testing.assert_array_equal(basis @ linkage.actuation.selection, 0.0)
        assert np.linalg.matrix_rank(basis) == analysis.uncontrolled == len(analysis.motions)


def moves(linkage: Linkage, joint: int, v: Any) -> bool:
    first, width = linkage.model.idx_vs[joint], linkage.model.nvs[joint]
    return bool(np.any(v[first : first + width]))


@given(seed=st.integers(0, 2**32 - 1), sizes=st.lists(st.integers(1, 4), min_size=1, max_size=4))
@settings(max_examples=50, deadline=None)
def test_sparse_basis_separates_sum_of_spaces(seed: int, sizes: list[int]) -> None:
    random = np.random.default_rng(seed)
    blocks = [random.normal(size=(size, size + 2)) for size in sizes]
    n, k = sum(block.shape[1] for block in blocks), sum(sizes)
    whole, row, column = np.zeros((k, n)), 0, 0
    owner = np.zeros(n, dtype=int)
    for index, block in enumerate(blocks):
        whole[row : row + block.shape[0], column : column + block.shape[1]] = block
        owner[column : column + block.shape[1]] = index
        row, column = row + block.shape[0], column + block.shape[1]
    mixed, _ = np.linalg.qr(whole.T @ random.normal(size=(k, k)))
    basis = sparse_basis(mixed.T)
    assert all(len(set(owner[np.flatnonzero(vector)])) == 1 for vector in basis)
    assert np.linalg.matrix_rank(basis) == k
    assert np.linalg.matrix_rank(np.vstack([basis, mixed.T]), 1e-3) == k
    assert (basis == 1.0).any(axis=1).all()
    assert np.abs(basis).max() <= 1.0011


def test_singularity_distance_vanishes_where_linkage_folds() -> None:
    assert analyze(folded_parallelogram()).singularity == pytest.approx(0.0, abs=1e-12)
    lifted = [analyze(folded_parallelogram(), np.array([a, -a, a, -a])).singularity for a in (0.02, 0.8)]
    assert 0.0 < lifted[0] < 0.1 < lifted[1]


def test_singularity_distance_is_distance_to_lower_rank() -> None:
    linkage = n_bar(4)
    analysis = analyze(linkage)
    assert analysis.singularity is not None
    K = residual_and_jacobian(linkage, analysis.q)[1]
    (end,) = linkage.constraints
    around = [linkage.model.jointPlacements[j].translation for j in range(1, 5)]
    around += [np.array(frame.pose.xyz) for frame in end.anchors]
    K[:3] /= sum(np.linalg.norm(step) for step in around) / 2.0
    U, values, V = np.linalg.svd(K, full_matrices=False)
    values[2] = 0.0
    nearest = U @ np.diag(values) @ V
    assert analysis.singularity == pytest.approx(np.linalg.norm(nearest - K, 2), rel=1e-9)


@pytest.mark.parametrize("size", [1e-3, 1e-2, 1e2, 1e3])
@pytest.mark.parametrize("build", [slider_crank, spherical_four_bar, lambda size=1.0: n_bar(5, size=size)])
def test_scaling_keeps_dimensions_and_singularity_distance(build: Callable[..., Linkage], size: float) -> None:
    one, other = analyze(build()), analyze(build(size=size))
    assert (one.rank, one.uncontrolled) == (other.rank, other.uncontrolled)
    assert other.singularity == pytest.approx(one.singularity, rel=1e-6)
    assert other.actuation_singularity == pytest.approx(one.actuation_singularity, rel=1e-6)


def test_driven_slider_is_singular_at_dead_points_only() -> None:
    dead = loop([("R", (0, 0, 0), Z), ("R", (1, 0, 0), Z), ("R", (3, 0, 0), Z), ("P", (3, 0, 0), X)], actuated=["j3"])
    analysis = analyze(dead)
    assert analysis.uncontrolled == 0
    assert analysis.singularity is not None
    assert analysis.singularity > 0.1
    assert analysis.actuation_singularity == pytest.approx(0.0, abs=1e-12)
    turned = analyze(slider_crank(actuated=["j3"]))
    assert turned.actuation_singularity is not None
    assert turned.actuation_singularity > 0.05


def test_info_shows_uncontrolled_motions_and_dependent_actuators() -> None:
    robot = load(*described(side_by_side(n_bar(6, actuated=["j1"]), n_bar(4, actuated=["j0", "j2"]))))
    analysis = eurdf.analyze(robot)
    info = robot_info(robot, analysis)
    assert (info.controlled, info.dependent, info.uncontrolled) == (2, 1, 2)
    assert [motion.joints for motion in info.motion_list] == [motion.joints for motion in analysis.motions]
    assert info.dependent_list == (("b0", "b2"),)
    assert [(loops.closures, loops.mobility, loops.uncontrolled) for loops in info.loop_list] == [
        (("a_end",), 3, 2),
        (("b_end",), 1, 0),
    ]
    assert info.singularity == analysis.singularity == min(loops.singularity for loops in analysis.loops)


@needs_wild
@pytest.mark.parametrize("name", FACTS)
def test_published_robots_have_known_dimensions(name: str) -> None:
    facts = FACTS[name]
    analysis = analyze(eurdf.load(WILD / name, geometry=False))
    for key in ("nq", "nv", "nc", "rank", "mobility", "actuated", "uncontrolled", "closes"):
        assert getattr(analysis, key) == facts[key], key
    if facts["closes"]:
        assert analysis.redundant == facts["nc"] - facts["rank"]
        assert analysis.finite_mobility == analysis.mobility


def test_digit_leg_has_nine_motions_with_three_spins() -> None:
    analysis = eurdf.analyze(eurdf.load("digit_leg", geometry=False))
    assert (analysis.nv, analysis.rank, analysis.mobility, analysis.uncontrolled) == (27, 18, 9, 3)
    assert [set(motion.joints) for motion in analysis.motions] == [
        {"ball_achilles_start", "ball_achilles_end"},
        {"ball_rod1_start", "ball_rod1_end"},
        {"ball_rod2_start", "ball_rod2_end"},
    ]
    assert [(loops.closures, loops.mobility, loops.uncontrolled) for loops in analysis.loops] == [
        (("achilles",), 2, 1),
        (("rod1", "rod2"), 4, 2),
    ]
