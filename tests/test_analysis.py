"""Rank, mobility, redundant rows and uncontrolled mobility of mechanisms."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import eurdf
from eurdf.kinematics.analysis import analyze
from eurdf.kinematics.residual import residual
from linkage import (
    Linkage,
    X,
    Y,
    Z,
    bennett,
    closure,
    flat_sarrus,
    loop,
    n_bar,
    sarrus,
    slider_crank,
    spherical_four_bar,
    stewart,
    swapped,
    translation,
)

WILD = Path(__file__).parents[2] / "shared" / "wild"
FACTS: dict[str, Any] = json.loads((WILD / "facts.json").read_text()) if (WILD / "facts.json").is_file() else {}
needs_wild = pytest.mark.skipif(not FACTS, reason="the folder of published robots, ../shared/wild, is not there")


def rod_between_balls() -> Linkage:
    """A rod on two balls between crank and ground: it spins about itself, whatever the crank does."""
    pairs = [("R", (0, 0, 0), Z), ("S", (1, 0.2, 0.1), Z), ("S", (2, 1.0, 0.4), Z), ("R", (2, 1.0, 0.4), X)]
    return loop([*pairs[:3], ("R", (2.5, 0, 0), Y)])


def folded_parallelogram() -> Linkage:
    return loop([("R", (0, 0, 0), Z), ("R", (1, 0, 0), Z), ("R", (3, 0, 0), Z), ("R", (2, 0, 0), Z)])


def flat_truss() -> Linkage:
    """Two bars stretched out between two pins: it cannot move, though K loses rank where it is."""
    return loop([("R", (0, 0, 0), Z), ("R", (1, 0, 0), Z)], "3d", (3, 0, 0))


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
}


@pytest.mark.parametrize(("build", "known"), KNOWN.values(), ids=KNOWN.keys())
def test_the_dimensions_of_a_known_mechanism(build: Callable[[], Linkage], known: tuple[int, ...]) -> None:
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
    assert np.abs(residual(linkage, analysis.q)).max() <= 1e-10


@pytest.mark.parametrize("build", [build for build, _ in KNOWN.values()], ids=KNOWN.keys())
def test_exchanging_a_and_b_changes_no_dimension(build: Callable[[], Linkage]) -> None:
    linkage = build()
    one, other = analyze(linkage), analyze(swapped(linkage))
    assert (one.rank, one.mobility, one.uncontrolled) == (other.rank, other.mobility, other.uncontrolled)


@pytest.mark.parametrize("size", [1e-3, 1e-2, 1e2, 1e3])
@pytest.mark.parametrize("build", [slider_crank, sarrus, n_bar, spherical_four_bar])
def test_size_changes_no_dimension(build: Callable[..., Linkage], size: float) -> None:
    linkage = n_bar(5, size=size, away=0.4) if build is n_bar else build(size=size)
    same = n_bar(5) if build is n_bar else build()
    one, other = analyze(linkage), analyze(same)
    assert (one.rank, one.uncontrolled) == (other.rank, other.uncontrolled)


@given(n=st.integers(1, 9), seed=st.integers(0, 2**32 - 1))
@settings(max_examples=40, deadline=None)
def test_a_general_loop_of_n_revolutes_has_rank_n_up_to_six(n: int, seed: int) -> None:
    random = np.random.default_rng(seed)
    pairs = [("R", random.uniform(-1.0, 1.0, 3), random.normal(size=3)) for _ in range(n)]
    linkage = loop(pairs)
    analysis = analyze(linkage)
    assert analysis.rank == min(n, 6)
    assert analysis.mobility == max(n - 6, 0)


def test_the_mobility_is_that_of_the_velocities_which_keep_the_loops_closed() -> None:
    # Independent of K: the closed configurations around one of a five-bar, found by closing from random places, spread
    # in as many directions as the mobility says.
    linkage = n_bar(5)
    random = np.random.default_rng(0)
    around = np.array([eurdf.assemble(linkage, random.uniform(-1e-4, 1e-4, 5)).q for _ in range(20)])
    spread = np.linalg.svd(around, compute_uv=False)
    assert int((spread > 1e-3 * spread[0]).sum()) == analyze(linkage).mobility == 2


def test_a_robot_without_closures_moves_with_all_its_velocities() -> None:
    linkage = Linkage(n_bar(5).model, actuated=["j0", "j3"])
    analysis = analyze(linkage)
    assert (analysis.nc, analysis.rank, analysis.mobility, analysis.redundant) == (0, 0, 5, 0)
    assert (analysis.actuated, analysis.uncontrolled) == (2, 3)
    assert analysis.closes
    assert analysis.residual == 0.0


def test_joints_outside_the_loops_add_to_the_mobility() -> None:
    linkage = n_bar(4)
    linkage.model.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), "float")
    linkage.model.addJoint(2, pin.JointModelRX(), pin.SE3.Identity(), "gripper")
    linkage.actuated = ["j0", "gripper"]
    analysis = analyze(linkage)
    assert (analysis.nv, analysis.rank, analysis.mobility, analysis.uncontrolled) == (11, 3, 8, 6)


def test_loops_that_do_not_close_have_no_rank() -> None:
    linkage = n_bar(4)
    (end,) = linkage.constraint_models
    end.joint1_placement = translation(50.0, 0.0, 0.0)
    analysis = analyze(linkage)
    assert not analysis.closes
    assert (analysis.rank, analysis.mobility, analysis.redundant, analysis.uncontrolled) == (None, None, None, None)
    assert (analysis.nv, analysis.nc, analysis.actuated) == (4, 6, 1)
    assert analysis.residual == pytest.approx(np.linalg.norm(residual(linkage, analysis.q)))
    assert analysis.residual > 40.0


def test_a_truss_at_its_dead_point_counts_the_motion_it_has_there() -> None:
    # The only closed configuration: the loop has no other at which K could have its full rank.
    assert analyze(flat_truss()).rank == 1


def test_the_configuration_given_is_where_the_search_starts() -> None:
    linkage = n_bar(4, away=0.7)
    linkage.configurations["assembled"] = np.full(4, 0.7)
    np.testing.assert_array_equal(analyze(linkage).q, np.full(4, 0.7))
    elsewhere = analyze(linkage, np.array([0.2, 0.9, 0.8, 0.9]))
    assert elsewhere.closes
    assert not np.allclose(elsewhere.q, 0.7)
    with pytest.raises(ValueError, match="shape"):
        analyze(linkage, np.zeros(7))


def test_small_levers_among_long_ones_count() -> None:
    # A crank of 2 mm on a linkage of 4 m.
    linkage = loop([("R", (0, 0, 0), Z), ("R", (0.002, 0, 0), Z), ("R", (2, 2, 0), Z), ("R", (4, 0, 0), Z)])
    assert analyze(linkage).rank == 3
    assert analyze(linkage).uncontrolled == 0


@pytest.mark.parametrize("decimals", [6, 8, 10])
@pytest.mark.parametrize("build", [slider_crank, sarrus, n_bar])
def test_the_rounding_of_files_is_no_constraint(build: Callable[..., Linkage], decimals: int) -> None:
    options: dict[str, Any] = {"decimals": decimals, "away": 0.3}
    rounded = n_bar(5, **options) if build is n_bar else build(**options)
    exact = n_bar(5) if build is n_bar else build()
    assert analyze(rounded).rank == analyze(exact).rank


def test_a_mimic_joint_takes_a_velocity_away() -> None:
    text = """<robot name="scissors"><link name="g"/><link name="a"/><link name="b"/><link name="c"/>
      <joint name="lead" type="revolute"><parent link="g"/><child link="a"/><axis xyz="0 0 1"/>
        <limit lower="-3" upper="3" effort="1" velocity="1"/></joint>
      <joint name="fold" type="revolute"><parent link="a"/><child link="b"/><origin xyz="1 0 0"/><axis xyz="0 0 1"/>
        <limit lower="-3" upper="3" effort="1" velocity="1"/><mimic joint="lead" multiplier="-2"/></joint>
      <joint name="slide" type="prismatic"><parent link="g"/><child link="c"/><axis xyz="1 0 0"/>
        <limit lower="-3" upper="3" effort="1" velocity="1"/></joint></robot>"""
    for mimic, expected in ((True, (2, 1, 1)), (False, (3, 2, 1))):
        model = pin.buildModelFromXML(text, mimic=mimic)
        fold, slide = model.getJointId("fold"), model.getJointId("slide")
        linkage = Linkage(model, [closure(model, slide, pin.SE3.Identity(), fold, translation(1.0, 0.0, 0.0), "3d")])
        analysis = analyze(linkage, np.array([0.8, 1.3] if mimic else [0.8, -1.6, 1.3]))
        assert (analysis.nv, analysis.rank, analysis.mobility) == expected


@needs_wild
@pytest.mark.parametrize("name", FACTS)
def test_published_robots_have_their_known_dimensions(name: str) -> None:
    facts = FACTS[name]
    analysis = analyze(eurdf.load(WILD / name, geometry=False))
    for key in ("nq", "nv", "nc", "rank", "mobility", "actuated", "uncontrolled", "closes"):
        assert getattr(analysis, key) == facts[key], key
    if facts["closes"]:
        assert analysis.redundant == facts["nc"] - facts["rank"]


@needs_wild
def test_a_floating_root_adds_six_to_the_mobility() -> None:
    analysis = analyze(eurdf.load(WILD / "digit_like", root="floating", geometry=False))
    assert (analysis.nv, analysis.rank, analysis.mobility, analysis.uncontrolled) == (33, 18, 15, 9)
