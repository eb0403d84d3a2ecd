"""The page of measurements."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pinocchio as pin

import eurdf
from benchmarks import page
from benchmarks.__main__ import MEASUREMENTS
from benchmarks.interleaved import least_times
from benchmarks.load import ROOT
from benchmarks.reading import read_unchecked
from benchmarks.table import Goal, Table, duration, ratio

TABLE = Table(("robot", "time", "ratio"), [("four_bar", "1.0 ms", "2.00"), ("a", "30.0 µs", "0.50")], "Both")


def test_table_is_markdown_on_page() -> None:
    assert TABLE.markdown().splitlines() == [
        "Both:",
        "",
        "| robot | time | ratio |",
        "| --- | ---: | ---: |",
        "| four_bar | 1.0 ms | 2.00 |",
        "| a | 30.0 µs | 0.50 |",
    ]


def test_page_states_versions_and_sections(tmp_path: Path) -> None:
    path = tmp_path / "page.md"
    page.write(path, measure=lambda name: f"What {name} found.")
    text = path.read_text(encoding="utf-8")
    assert all(name in text for name in ("Python 3.", "pin ", "mujoco ", "numpy "))
    assert "## Dynamics\n\nWhat dynamics found.\n" in text
    page.write(path, ["dynamics"], lambda name: f"What {name} found again.")
    assert path.read_text(encoding="utf-8") == text.replace("dynamics found.", "dynamics found again.")


def test_page_shows_every_measurement_with_tables() -> None:
    with_tables = {name for name, module in MEASUREMENTS.items() if hasattr(module, "tables")}
    assert set(page.SECTIONS.values()) == with_tables


def test_unchecked_reading_makes_the_model_of_the_urdf() -> None:
    for name in ("unitree_g1", "digit_leg"):
        model, description = read_unchecked(ROOT / "robots" / name)
        expected = pin.buildModelFromUrdf(str(ROOT / "robots" / name / "robot.urdf"))
        assert list(model.names) == list(expected.names)
        assert [frame.name for frame in model.frames] == [frame.name for frame in expected.frames]
        for frame, other in zip(model.frames, expected.frames, strict=True):
            assert frame.placement.isApprox(other.placement, 1e-12)
        for inertia, other in zip(model.inertias, expected.inertias, strict=True):
            assert inertia.isApprox(other, 1e-9)
        for limits in ("lowerPositionLimit", "upperPositionLimit", "upperVelocityLimit", "lowerEffortLimit", "damping"):
            assert np.array_equal(getattr(model, limits), getattr(expected, limits))
        mechanism = eurdf.load(ROOT / "robots" / name, geometry=False).mechanism
        assert [closure["name"] for closure in description["closures"]] == [each.name for each in mechanism.closures]


def test_functions_take_turns() -> None:
    order: list[int] = []
    least_times([lambda: order.append(0), lambda: order.append(1)], 2)
    assert order == [0, 1] * 3


def test_table_is_aligned_in_terminal() -> None:
    assert TABLE.text().splitlines() == [
        "Both",
        "robot        time  ratio",
        "four_bar   1.0 ms   2.00",
        "a         30.0 µs   0.50",
    ]


def test_durations_have_fitting_units() -> None:
    assert [duration(seconds) for seconds in (12.0, 0.0125, 12.5e-6)] == ["12.00 s", "12.50 ms", "12.5 µs"]
    assert ratio(3.0, 2.0) == "1.50"


def test_goal_that_is_missed_is_named() -> None:
    goal = Goal(2.0, 25e-6)
    rows = [("a", goal.cell(100e-6, 40e-6)), ("b", goal.cell(110e-6, 40e-6)), ("c", goal.cell(1.0, None))]
    table = Table(("robot", goal.of("to pin")), rows)
    assert [row[1] for row in rows] == ["2.50 ✓", "2.75 ✗", "-"]
    summary = "to pin, ≤ 2 × + 25 µs: met by 1 of 2, median 2.62; not by b (2.75)"
    assert table.text().splitlines()[-1] == summary
    assert table.markdown().splitlines()[0] == f"- {summary}"
