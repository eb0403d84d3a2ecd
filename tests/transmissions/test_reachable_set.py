"""The reachable set of serial joints."""

from __future__ import annotations

import numpy as np
import pytest

import eurdf
from eurdf.transmissions.grid_search import outlines
from support.transmissions import slider_crank

ANKLE = ("free_pitch", "free_roll")


def inside(polygon: np.ndarray, point: np.ndarray) -> bool:
    """Whether a ray from the point crosses the polygon an odd number of times."""
    x, y = polygon.T
    x1, y1 = np.roll(x, -1), np.roll(y, -1)
    with np.errstate(divide="ignore", invalid="ignore"):
        crossed = ((y > point[1]) != (y1 > point[1])) & (point[0] < x + (point[1] - y) / (y1 - y) * (x1 - x))
    return bool(crossed.sum() % 2)


@pytest.fixture(scope="module")
def ankle() -> eurdf.Robot:
    return eurdf.load("unitree_g1_ankle", geometry=False)


@pytest.fixture(scope="module")
def found(ankle: eurdf.Robot) -> eurdf.transmissions.Workspace:
    return eurdf.transmissions.workspace(ankle, ANKLE, grid=13)


@pytest.mark.slow
def test_polygon_separates_reachable_poses_from_others(
    ankle: eurdf.Robot, found: eurdf.transmissions.Workspace
) -> None:
    lower, upper = ankle.model.lowerPositionLimit, ankle.model.upperPositionLimit
    limited = upper < 1e3
    random = np.random.default_rng(0)
    # Chords cut off less than this of the curved sides.
    margin = 2e-3
    seen = set()
    for point in random.uniform([-0.95, -0.3], [0.6, 0.3], (14, 2)):
        around = [inside(found.polygon, point + margin * np.array(step)) for step in ((1, 0), (-1, 0), (0, 1), (0, -1))]
        if len(set(around)) == 2:
            continue
        try:
            q = eurdf.forward_kinematics(ankle, dict(zip(ANKLE, point, strict=True)))
            reachable = bool(((q >= lower) & (q <= upper))[limited].all())
        except eurdf.errors.NotClosable:
            reachable = False
        assert reachable is around[0]
        seen.add(reachable)
    assert seen == {True, False}


@pytest.mark.slow
def test_every_boundary_point_is_at_its_stop(ankle: eurdf.Robot, found: eurdf.transmissions.Workspace) -> None:
    limits = ankle.model.lowerPositionLimit, ankle.model.upperPositionLimit
    assert {str(stop) for stop in found.stops} >= {
        "lower limit of 'motor_a'",
        "upper limit of 'motor_b'",
        "upper limit of 'free_roll'",
        "lower limit of 'free_pitch'",
    }
    for point in found.boundary:
        slot = ankle.slots[point.stop.joint]
        assert point.q[slot.idx_q] == pytest.approx(limits[point.stop.side == "upper"][slot.idx_q], abs=1e-6)
        assert np.abs(eurdf.residual(ankle, point.q)).max() < 1e-9
        assert point.q[:2] == pytest.approx(point.position, abs=1e-12)


def test_fields_are_on_the_grid(found: eurdf.transmissions.Workspace) -> None:
    condition = found.on_grid(found.transmissions.condition)
    assert condition.shape == (13, 13)
    assert np.isfinite(condition).sum() == len(found.q) < 169
    i, j = found.index[5]
    assert (found.axes[0][i], found.axes[1][j]) == pytest.approx(found.positions[5], abs=1e-12)
    assert found.q[5][:2] == pytest.approx(found.positions[5], abs=1e-9)


@pytest.mark.slow
def test_slider_ends_at_the_dead_points_of_its_crank() -> None:
    robot, q = slider_crank(0.3, 0.8, 1.1)
    ends = [0.5, 1.1]
    found = eurdf.transmissions.workspace(robot, "slide", q, grid=9, ranges={"slide": (0.0, 2.0)})
    reached = sorted((float(point.position[0]), point.stop.kind) for point in found.boundary)
    assert [position for position, _ in reached] == pytest.approx(ends, abs=1e-6)
    assert {kind for _, kind in reached} <= {"singular", "not closed"}


def test_three_joints_have_samples() -> None:
    robot = eurdf.load("kangaroo_leg", geometry=False)
    joints = ("free_knee", "free_ankle_y", "free_ankle_x")
    near = {"free_knee": 0.05, "free_ankle_y": 0.05, "free_ankle_x": 0.05}
    at = robot.joint_positions(robot.configurations["assembled"])
    ranges = {name: (at[name][0] - half, at[name][0] + half) for name, half in near.items()}
    found = eurdf.transmissions.workspace(robot, joints, grid=3, ranges=ranges)
    assert found.positions.shape == (len(found.q), 3)
    assert {point.stop.kind for point in found.boundary} <= {"range", "joint", "passive", "motor"}
    with pytest.raises(ValueError, match="no polygon"):
        _ = found.polygon


def test_outlines_go_around_sets_and_holes() -> None:
    mask = np.ones((5, 5), dtype=bool)
    mask[2, 2] = False
    around, hole = sorted(outlines(mask), key=len, reverse=True)
    assert len(around) == 20
    assert {outer for _, outer in hole} == {(2, 2)}


@pytest.mark.parametrize(
    ("joints", "options", "message"),
    [
        (ANKLE, {"grid": 2}, "at least 3 points"),
        (ANKLE, {"ranges": {"pitch": (0, 1)}}, "'pitch', which is none of the joints"),
        (ANKLE, {"ranges": {"free_roll": (0.1, 0.2)}}, "outside its range"),
        ("free_pitch", {}, "add 'free_roll' to the joints"),
    ],
)
def test_wrong_arguments_are_errors(
    ankle: eurdf.Robot, joints: object, options: dict[str, object], message: str
) -> None:
    with pytest.raises(ValueError, match=message):
        eurdf.transmissions.workspace(ankle, joints, **options)
