"""Calibration against samples of robots with known offsets and rod ends; each of these is built from its mechanism."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import eurdf
from eurdf.kinematics import calibrate
from eurdf.pinocchio.robot import build_robot

ANKLE = ("motor_a", "motor_b", "free_pitch", "free_roll")
PLANAR = ("motor_crank", "free_rocker", "free_coupler")
TELLO = ("left_motor_hip_1", "left_motor_hip_2", "left_free_hip_x", "left_free_hip_y")
SUSPENSION = ("motor_rack", "free_lower_arm", "spring_strut")


class Bench:
    """A robot whose rod ends are moved by vectors in their links, and exact readings of its encoders with offsets."""

    def __init__(
        self, name: str, encoders: Any, offsets: dict[str, float], moved: dict[str, Any], n: int = 20, spread: Any = 0.2
    ) -> None:
        self.nominal = eurdf.load(name, geometry=False)
        closures = {each.name: each for each in self.nominal.mechanism.closures}
        self.ends = {}
        for end, by in moved.items():
            closure, side = end.split("/")
            anchor = getattr(closures[closure], side)
            self.ends[end] = np.add(anchor.pose.xyz, by)
            pose = replace(anchor.pose, xyz=tuple(self.ends[end].tolist()))
            closures[closure] = replace(closures[closure], **{side: replace(anchor, pose=pose)})
        self.true = build_robot(replace(self.nominal.mechanism, closures=tuple(closures.values())), geometry=False)
        q = eurdf.assemble(self.true, eurdf.assemble(self.nominal).q).q
        random, motors = np.random.default_rng(1), self.true.actuation.idx_q
        held = q[motors] + spread * random.uniform(-1.0, 1.0, (n, len(motors)))
        self.q = eurdf.batch.forward_kinematics(self.true, held, q, tolerance=1e-12).q
        self.samples = {
            joint: np.array([self.true.joint_positions(each)[joint][0] for each in self.q]) + offsets.get(joint, 0.0)
            for joint in encoders
        }
        self.offsets, self.unknown = offsets, [*offsets, *moved]

    def noisy(self, seed: int, deviation: float) -> dict[str, Any]:
        random = np.random.default_rng(seed)
        return {name: each + deviation * random.normal(size=each.shape) for name, each in self.samples.items()}


RECOVERED = {
    "motors": ("unitree_g1_ankle", ANKLE, {"motor_a": 0.05, "motor_b": -0.03}, {}, 0.2),
    "rod end": (
        "unitree_g1_ankle", ANKLE, {"motor_b": -0.03, "free_pitch": 0.02}, {"rod_a/b": (1e-3, -2e-3, 1.5e-3)}, 0.2,
    ),
    "planar": ("four_bar", PLANAR, {"free_rocker": 0.05}, {"rocker_pin/a": (2e-3, 0.0, 3e-3)}, 0.2),
    "distance": ("tello", TELLO, {"left_motor_hip_1": 0.02}, {"left_hip_rod_1/b": (2e-3, 1e-3, -1e-3)}, 0.15),
    "hinge": ("double_wishbone", SUSPENSION, {"free_lower_arm": 0.01}, {}, 0.01),
}  # fmt: skip


@pytest.mark.parametrize("case", RECOVERED)
def test_recovers_offsets_and_rod_ends(case: str) -> None:
    name, encoders, offsets, moved, spread = RECOVERED[case]
    bench = Bench(name, encoders, offsets, moved, spread=spread)
    found = calibrate(bench.nominal, bench.samples, bench.unknown)
    assert found.unidentifiable == ()
    for joint, offset in offsets.items():
        assert found.offsets[joint] == pytest.approx(offset, abs=1e-8)
    for end, position in bench.ends.items():
        assert found.ends[end] == pytest.approx(position, abs=1e-8)
    for q in found.q:
        assert np.abs(eurdf.residual(bench.true, q)).max() < 1e-8
        assert np.abs(eurdf.residual(found.robot, q)).max() < 1e-9


def test_errors_have_the_stated_covariance() -> None:
    bench, deviation, runs = Bench(*RECOVERED["rod end"][:4], n=12), 1e-5, 200
    truth = np.array([*bench.offsets.values(), *bench.ends["rod_a/b"]])
    stated = dict.fromkeys(ANKLE, deviation)
    errors, squares, scales = [], [], []
    for seed in range(runs):
        found = calibrate(bench.nominal, bench.noisy(seed, deviation), bench.unknown, deviations=stated)
        error = np.array([*found.offsets.values(), *found.ends["rod_a/b"]]) - truth
        errors.append(error)
        squares.append(error @ np.linalg.solve(found.covariance, error))
        scales.append(found.deviation**2)
    p, freedom = len(truth), 12 * (4 - 2) - len(truth)
    # The squares have a χ² distribution of p, those of the deviation one of so many degrees of freedom.
    assert np.mean(squares) == pytest.approx(p, abs=5.0 * np.sqrt(2.0 * p / runs))
    assert np.mean(scales) == pytest.approx(1.0, abs=5.0 * np.sqrt(2.0 / freedom / runs))
    spread = np.var(errors, axis=0, ddof=1) / np.diag(found.covariance)
    assert spread == pytest.approx(np.ones(p), abs=5.0 * np.sqrt(2.0 / runs))


def test_estimates_the_deviation_of_readings() -> None:
    bench = Bench(*RECOVERED["motors"][:4], n=100)
    given = calibrate(bench.nominal, bench.noisy(0, 1e-3), bench.unknown, deviations=dict.fromkeys(ANKLE, 1e-3))
    found = calibrate(bench.nominal, bench.noisy(0, 1e-3), bench.unknown)
    assert found.deviation == pytest.approx(1e-3, rel=5.0 / np.sqrt(2.0 * 198))
    assert found.covariance == pytest.approx(given.covariance * given.deviation**2, rel=1e-4)


def test_motor_encoders_alone_show_nothing() -> None:
    bench = Bench("unitree_g1_ankle", ANKLE[:2], {"motor_a": 0.05, "motor_b": -0.03}, {})
    found = calibrate(bench.nominal, bench.samples, bench.unknown)
    assert found.unidentifiable == ("motor_a", "motor_b")
    assert np.isnan([*found.covariance.ravel(), found.deviation]).all()
    assert found.offsets == {"motor_a": 0.0, "motor_b": 0.0}


def test_names_what_an_offset_hides() -> None:
    """The offset of a crank and the direction in which it moves its rod end: only their sum is shown."""
    bench = Bench("unitree_g1_ankle", ANKLE, {"motor_a": 0.05}, {"rod_a/b": (1e-3, -2e-3, 1.5e-3)})
    found = calibrate(bench.nominal, bench.samples, bench.unknown)
    assert found.unidentifiable == ("motor_a", "rod_a/b y", "rod_a/b z")
    assert np.isfinite(found.covariance).sum() == 1
    assert found.ends["rod_a/b"][0] == pytest.approx(bench.ends["rod_a/b"][0], abs=1e-8)
    assert np.abs(found.remaining).max() < 1e-9


@pytest.mark.parametrize(
    ("samples", "unknown", "options", "message"),
    [
        ({}, ["motor_a"], {}, "at least one joint"),
        ({"motor_c": [0.0]}, ["motor_c"], {}, "no joint 'motor_c'"),
        ({"universal_rod_a": [0.0]}, [], {}, "has 2 velocities"),
        ({"motor_a": [0.0], "motor_b": [0.0, 0.1]}, ["motor_a"], {}, r"samples\['motor_b'\] has the shape \(2,\)"),
        ({"motor_a": []}, ["motor_a"], {}, r"has the shape \(0,\)"),
        ({"motor_a": [0.0]}, [], {}, "unknown is empty"),
        ({"motor_a": [0.0]}, ["rod_a"], {}, "there is no 'rod_a'"),
        ({"motor_a": [0.0]}, ["motor_a"], {"deviations": {"motor_a": 0.0}}, "expected positive numbers"),
        ({"motor_a": [3.0], "motor_b": [3.0]}, ["motor_a"], {}, "sample 0 cannot be reached from q0"),
    ],
)
def test_refuses_what_does_not_fit(samples: Any, unknown: Any, options: Any, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        calibrate("unitree_g1_ankle", samples, unknown, **options)
