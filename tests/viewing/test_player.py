"""Playing and pausing, as a page asks for it."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import eurdf
from eurdf.viewing import playback
from support.places import ROBOTS
from support.viewer_client import ViewerClient

pytest.importorskip("websockets", reason="websockets is not installed: pip install -e '.[view]'")


@pytest.fixture
def viewer() -> Iterator[eurdf.viewing.Viewer]:
    with eurdf.view("four_bar", port=0) as viewer:
        yield viewer


def playing(page: ViewerClient, **expected: Any) -> bool:
    """Whether what is played is as expected."""
    found = page.last("playing") or {}
    return all(found.get(name) == value for name, value in expected.items())


def test_trajectory_plays_pauses_steps_and_is_scrubbed(viewer: eurdf.viewing.Viewer) -> None:
    def angle() -> float:
        return viewer.robot.joint_positions(viewer.q)["motor_crank"][0]

    rows = "".join(f"{time / 100},{0.001 * time}\n" for time in range(1001))
    with ViewerClient(viewer.url) as page:
        page.send("follow", name="walk.csv", text=f"time,motor_crank\n{rows}")
        page.wait_for(lambda: playing(page, what="trajectory", paused=False) and page.last("playing")["time"] > 0.05)
        page.send("pause", paused=True)
        page.wait_for(lambda: playing(page, paused=True))
        for time in (3.0, 8.0, 2.0):
            page.send("seek", time=time, speed=4)
            page.wait_for(lambda time=time: playing(page, time=time, speed=4))
            assert angle() == pytest.approx(0.1 * time)
        page.said.clear()
        page.send("pause", paused=False, step=True)
        page.wait_for(lambda: playing(page, paused=True))
        after = page.last("playing")["time"]
        assert 2.0 < after == pytest.approx(2.0 + 4 * playback.FRAME)
        page.send("seek", time=9.9, speed=4)
        page.send("pause", paused=False)
        page.wait_for(lambda: playing(page, paused=True, time=10.0))
        assert angle() == pytest.approx(1.0)
        page.send("seek", time=1.0, speed=-1)
        page.wait_for(lambda: page.says("the speed is -1"))
        page.send("follow", name="bad.csv", text="time,moto\n0,0\n")
        page.wait_for(lambda: page.says("'bad.csv': line 1: there is no joint 'moto'"))


def test_user_who_moves_the_robot_pauses_what_plays(viewer: eurdf.viewing.Viewer) -> None:
    with ViewerClient(viewer.url) as page:
        page.send("gravity", dissipation=True, held=True)
        page.wait_for(lambda: playing(page, what="gravity") and page.last("playing")["time"] > 0.0)
        there = eurdf.forward_kinematics(viewer.robot, {"motor_crank": 0.3})
        page.send("moved", version=0, q=viewer.robot.joint_positions(there))
        page.wait_for(lambda: playing(page, what="gravity", paused=True))
        page.wait_for(lambda: np.allclose(viewer.q, there, atol=1e-9))
        page.said.clear()
        page.send("pause", paused=False)  # it falls from there
        page.wait_for(lambda: page.last("show", 0))
        first = next(each["q"] for each in page.said if each["type"] == "show")
        assert np.abs(viewer.robot.configuration(first) - there).max() < 0.1
        page.send("end")
        page.wait_for(lambda: playing(page, what=None))


def test_pause_is_served_while_a_step_is_computed(
    viewer: eurdf.viewing.Viewer, monkeypatch: pytest.MonkeyPatch
) -> None:
    begun, ends = threading.Event(), threading.Event()
    simulate = playback.simulate

    def endless(*arguments: Any, **options: Any) -> Any:
        begun.set()
        assert ends.wait(60.0)
        return simulate(*arguments, **options)

    monkeypatch.setattr(playback, "simulate", endless)
    with ViewerClient(viewer.url) as page:
        page.send("gravity", dissipation=True, held=False)
        assert begun.wait(60.0)
        page.send("pause", paused=True)
        page.wait_for(lambda: playing(page, what="gravity", paused=True))
        there = eurdf.forward_kinematics(viewer.robot, {"motor_crank": 0.2})
        page.send("moved", version=0, q=viewer.robot.joint_positions(there))
        page.wait_for(lambda: np.allclose(viewer.q, there, atol=1e-9))
        ends.set()


def test_gravity_that_diverges_ends_with_a_reason(
    viewer: eurdf.viewing.Viewer, monkeypatch: pytest.MonkeyPatch
) -> None:
    def diverges(*_: Any, **options: Any) -> Any:
        raise eurdf.errors.SimulationDiverged(0.0, options["step"])

    with ViewerClient(viewer.url) as page:
        page.send("gravity", dissipation=True, held=False)
        page.wait_for(lambda: playing(page, what="gravity"))
        monkeypatch.setattr(playback, "simulate", diverges)
        page.wait_for(lambda: page.says("gravity ends after"))
        page.wait_for(lambda: playing(page, what=None))


def test_gravity_goes_on_when_the_files_change(tmp_path: Path) -> None:
    for name in ("robot.urdf", "robot.yaml"):
        (tmp_path / name).write_text((ROBOTS / "four_bar" / name).read_text())
    with eurdf.view(tmp_path, port=0) as viewer, ViewerClient(viewer.url) as page:
        page.send("gravity", dissipation=True, held=False)
        page.wait_for(lambda: playing(page, what="gravity"))
        urdf = tmp_path / "robot.urdf"
        urdf.write_text(urdf.read_text().replace('mass value="', 'mass value="1'))
        page.wait_for(lambda: page.says("this is the robot now"))
        page.said.clear()
        page.wait_for(lambda: playing(page, what="gravity", paused=False) and page.last("show", 0))
