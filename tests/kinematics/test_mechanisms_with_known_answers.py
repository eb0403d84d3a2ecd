"""Textbook mechanisms, read from files: their dimensions, and that they close from where they are disturbed."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

import eurdf
from eurdf.kinematics.residual import residual, residual_and_jacobian
from support.described import load
from support.linkage import (
    Linkage,
    ball_ended,
    bennett,
    described,
    loop,
    n_bar,
    sarrus,
    slider_crank,
    spherical_four_bar,
    stewart,
    three_rrr,
)
from support.wild import FACTS, WILD


def spatial_loop(n: int) -> Linkage:
    """One loop of n revolutes in general position: 6 of them make a structure."""
    random = np.random.default_rng(n)
    return loop([("R", random.uniform(-1.0, 1.0, 3), random.normal(size=3)) for _ in range(n)])


#: nv, nc, rank, uncontrolled
KNOWN: dict[str, tuple[Callable[[], Linkage], tuple[int, int, int, int]]] = {
    **{f"planar {n}-bar in 6d": (lambda n=n: n_bar(n), (n, 6, 3, max(n - 4, 0))) for n in range(3, 9)},
    **{f"planar {n}-bar in 3d": (lambda n=n: n_bar(n, "3d"), (n - 1, 3, 2, max(n - 4, 0))) for n in range(3, 9)},
    **{f"spatial {n}R": (lambda n=n: spatial_loop(n), (n, 6, min(n, 6), max(n - 7, 0))) for n in range(4, 10)},
    "slider-crank": (slider_crank, (4, 6, 3, 0)),
    "five-bar with two motors": (lambda: n_bar(5, actuated=["j0", "j4"]), (5, 6, 3, 0)),
    "five-bar with two motors, in 3d": (lambda: n_bar(5, "3d", actuated=["j0", "j3"]), (4, 3, 2, 0)),
    "3-RRR": (three_rrr, (9, 12, 6, 0)),
    "6-UPS": (stewart, (36, 30, 30, 0)),
    "Sarrus": (sarrus, (6, 6, 5, 0)),
    "Bennett": (bennett, (4, 6, 3, 0)),
    "spherical four-bar": (spherical_four_bar, (4, 6, 3, 0)),
    "ball in 3d": (lambda: ball_ended("3d"), (4, 3, 3, 0)),
    "ball in 6d": (lambda: ball_ended("6d"), (7, 6, 6, 0)),
}

MOVING = {name: build for name, (build, (nv, _, rank, _)) in KNOWN.items() if nv > rank}


def disturbed(robot: Any, closed: Any, seed: int, by: float = 0.5) -> Any:
    random = np.random.default_rng(seed)
    return pin.integrate(robot.model, closed, random.uniform(-by, by, robot.model.nv))


@pytest.mark.parametrize(("build", "known"), KNOWN.values(), ids=KNOWN.keys())
def test_dimensions_match_textbook(build: Callable[[], Linkage], known: tuple[int, ...]) -> None:
    robot = load(*described(build()))
    assert robot.diagnostics == ()
    nv, nc, rank, uncontrolled = known
    analysis = eurdf.analyze(robot)
    assert (analysis.nv, analysis.nc, analysis.rank, analysis.uncontrolled) == (nv, nc, rank, uncontrolled)
    assert (analysis.mobility, analysis.redundant) == (nv - rank, nc - rank)
    assert analysis.controlled == nv - rank - uncontrolled


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


@pytest.mark.parametrize("build", MOVING.values(), ids=MOVING.keys())
def test_disturbed_linkage_closes(build: Callable[[], Linkage]) -> None:
    robot = load(*described(build()))
    closed = eurdf.assemble(robot).q
    assemblies = [eurdf.assemble(robot, disturbed(robot, closed, seed)) for seed in range(15)]
    assert [assembly.converged for assembly in assemblies].count(False) == 0
    assert max(np.abs(residual(robot, assembly.q)).max() for assembly in assemblies) <= 1e-10
    assert np.median([assembly.iterations for assembly in assemblies]) <= 8


@pytest.mark.parametrize(
    "name", ["digit_leg", "four_bar", *(f"wild {name}" for name, facts in FACTS.items() if facts["closes"])]
)
def test_disturbed_robot_closes(name: str) -> None:
    robot = eurdf.load(WILD / name[5:] if name.startswith("wild ") else name, geometry=False)
    closed = eurdf.assemble(robot).q
    assemblies = [eurdf.assemble(robot, disturbed(robot, closed, seed)) for seed in range(40)]
    assert [assembly.converged for assembly in assemblies].count(False) == 0
    assert all(pin.isNormalized(robot.model, assembly.q, 1e-12) for assembly in assemblies)
    assert np.median([assembly.iterations for assembly in assemblies]) <= 8


def test_ball_in_6d_equals_no_ball_in_3d() -> None:
    three, six = load(*described(ball_ended("3d"))), load(*described(ball_ended("6d")))
    assert eurdf.analyze(three).mobility == eurdf.analyze(six).mobility == 1
    start = np.array([0.2, -0.1, 0.05, 0.1])
    for crank in (0.0, 0.05, 0.1, 0.2):
        start[0] = crank
        one = eurdf.assemble(three, start, hold=["j0"])
        other = eurdf.assemble(six, np.concatenate([start, [0.0, 0.0, 0.0, 1.0]]), hold=["j0"])
        assert one.converged
        assert other.converged
        np.testing.assert_allclose(other.q[:4], one.q, atol=1e-8)
        # And they move alike there.
        (v3,), (v6,) = null_space(three, one.q), null_space(six, other.q)
        np.testing.assert_allclose(v6[:4] / v6[0], v3 / v3[0], atol=1e-7)


def null_space(robot: Any, q: Any) -> Any:
    K = residual_and_jacobian(robot, q)[1]
    return np.linalg.svd(K)[2][np.linalg.matrix_rank(K, 1e-8) :]


def test_bennett_linkage_turns_fully() -> None:
    # The one motion that it has is no accident of one configuration: tan(θ₁/2) tan(θ₂/2) is the same all along it
    # (Bennett, 1903), for the angles between bars that follow one another.
    robot = load(*described(bennett()))
    q, products = eurdf.assemble(robot).q, []
    for _ in range(12):
        q = q + np.array([0.1, 0.0, 0.0, 0.0])
        assembly = eurdf.assemble(robot, q, hold=["j0"], restarts=0)
        assert assembly.converged
        q = assembly.q
        products.append(np.tan(q[0] / 2) * np.tan(q[1] / 2))
    np.testing.assert_allclose(products, products[0], rtol=1e-6)
