"""What the server of the viewer sends: the bodies are where forward kinematics has them, whatever the user does."""

from __future__ import annotations

import re
import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

import eurdf
from eurdf.viewing import playback
from support.places import ROBOTS
from support.viewer_client import ViewerClient, differ

pytest.importorskip("viser", reason="viser is not installed: pip install -e '.[view]'")

# Error of a pose, m or of a quaternion.
_EXACT = 1e-6
_MOVED = 1e-4


def copied(robot: str, folder: Path) -> Path:
    for name in ("robot.urdf", "robot.yaml"):
        (folder / name).write_text((ROBOTS / robot / name).read_text())
    return folder


def expected(robot: eurdf.Robot, q: np.ndarray) -> list[tuple[float, ...]]:
    """Poses of the bodies by Pinocchio alone."""
    model = robot.model.copy()
    data = model.createData()
    pin.framesForwardKinematics(model, data, q)
    ids = [model.getFrameId(body.name, pin.FrameType.BODY) for body in robot.mechanism.bodies]
    poses = [pin.SE3ToXYZQUAT(data.oMf[frame]) for frame in ids]
    return [(*pose[:3], pose[6], *pose[3:6]) for pose in poses]


class Watched:
    """A viewer, and a page of it that is compared after each step."""

    def __init__(self, viewer: eurdf.viewing.Viewer, page: ViewerClient) -> None:
        self.viewer, self.page = viewer, page
        self.before = page.bodies(1)

    def step(self, act: Callable[[], Any], *, moves: bool = True, until: Callable[[], Any] = lambda: True) -> None:
        """Do something; then the page has each body where it is, and elsewhere than before if the step moves it."""
        self.before = self.page.bodies(1)
        act()

        def arrived() -> bool:
            now = self.page.bodies(1)
            is_there = differ(now, expected(self.viewer.robot, self.viewer.q)) < _EXACT
            return bool(until()) and is_there and (not moves or differ(now, self.before) > _MOVED)

        self.page.wait_for(arrived)

    def play(self, label: str) -> None:
        """Play something until the robot has moved, and pause."""
        before = self.page.bodies(1)
        self.page.click(label)
        self.page.wait_for(lambda: differ(self.page.bodies(1), before) > _MOVED)
        self.step(lambda: self.page.click("pause"), moves=False, until=lambda: self.page.control("continue"))


@pytest.mark.parametrize(
    ("robot", "root"),
    [
        ("four_bar", None),
        ("stewart_platform", None),
        ("unitree_g1_ankle", None),
        ("kangaroo_leg", None),
        ("digit_leg", "floating"),
        ("double_wishbone", None),  # with springs
    ],
)
def test_bodies_are_sent_where_they_are(robot: str, root: str | None, tmp_path: Path) -> None:
    folder = copied(robot, tmp_path)
    with (
        eurdf.view(folder, port=0, options={"root": root, "geometry": False}) as viewer,
        ViewerClient(viewer.url) as page,
    ):
        times_collapsed = [0]

        def watch(page: ViewerClient) -> None:
            times_collapsed[0] += page.without_place(1)

        page.on_message = watch
        watched = Watched(viewer, page)
        step, session = watched.step, viewer._first.session
        step(lambda: None, moves=False)
        first = page.bodies(1)

        slider = next(each for each in session.sliders if each.upper > each.lower)
        index = session.sliders.index(slider)
        label = f"{slider.label} ({slider.unit})"
        part = 0.05 * (slider.upper - slider.lower)
        other = session.value(index) + (part if session.value(index) + part < slider.upper else -part)
        step(lambda: page.set(label, other))
        step(lambda: page.click("reset"))
        assert differ(page.bodies(1), first) < _EXACT

        step(lambda: page.set(label, other))
        most = int(np.argmax(np.abs(np.array(page.bodies(1)) - first)[:, :3].max(axis=1)))
        frame = viewer.robot.mechanism.bodies[most].name
        page.set("drag frame", frame)
        step(lambda: page.drag(first[most][:3]))

        csv = tmp_path / "walk.csv"
        begin = session.value(index)
        csv.write_text(f"time,{slider.joint}\n0,{begin}\n0.02,{0.5 * (begin + other)}\n0.04,{other}\n")
        step(lambda: viewer.replay(csv), until=lambda: page.says("trajectory: 0.040 s"))

        watched.play("sweep")
        watched.play("gravity")
        step(lambda: page.click("reset"))

        step(lambda: viewer.show(viewer.robot.tree.integrate(viewer.q, np.full(viewer.robot.tree.nv, 0.01))))
        step(lambda: page.click("assemble"), until=lambda: page.says("loops are closed"))

        page.set("name", "mine")
        step(lambda: page.click("save as configuration"), moves=False, until=lambda: page.says("saved configuration"))
        page.wait_for(lambda: page.value("configuration") == "mine")
        saved = page.bodies(1)
        step(lambda: page.set(label, other))
        step(lambda: page.click("go to configuration"))
        assert differ(page.bodies(1), saved) < _EXACT

        urdf, yaml = folder / "robot.urdf", folder / "robot.yaml"
        heavier = re.sub(r'mass value="([^"]*)"', r'mass value="1\1"', urdf.read_text(), count=1)
        before = viewer.robot
        step(lambda: urdf.write_text(heavier), moves=False, until=lambda: page.says("this is the robot now"))
        assert viewer.robot is not before
        assert page.value("drag frame") == frame
        assert page.value("configuration") == "mine"
        session = viewer._first.session
        page.wait_for(lambda: np.allclose(page.nodes["/gizmo"]["position"], page.bodies(1)[most][:3], atol=1e-5))
        step(lambda: page.set(label, other))

        good = yaml.read_text()
        step(lambda: yaml.write_text(good + "unknown: 1\n"), moves=False, until=lambda: page.says("have errors"))
        step(lambda: page.click("reset"))
        step(lambda: yaml.write_text(good), moves=False, until=lambda: page.says("this is the robot now"))
        step(lambda: page.set(label, other))

        second = viewer.add(eurdf.load("bennett", geometry=False), xyz=(0.0, 1.0, 0.0))
        for angle in (0.1, 0.4):
            second.show(eurdf.forward_kinematics(second.robot, {"motor_a": angle}))
            page.wait_for(lambda: differ(page.bodies(2), expected(second.robot, second.q)) < _EXACT)
        step(lambda: None, moves=False)
        assert times_collapsed == [0]


def test_small_motions_are_sent_too(tmp_path: Path) -> None:
    """Far from the origin, too, where a step is a small part of a coordinate."""
    with (
        eurdf.view(copied("four_bar", tmp_path), port=0, options={"root": "floating"}) as viewer,
        ViewerClient(viewer.url) as page,
    ):
        q = viewer.q
        for position in (100.0, 100.0005, 100.0001):
            q[0] = position
            viewer.show(q)
            page.wait_for(lambda: differ(page.bodies(1), expected(viewer.robot, viewer.q)) < _EXACT)


def test_saving_is_no_foreign_change_and_asks_before_it_replaces(tmp_path: Path) -> None:
    folder = copied("digit_leg", tmp_path)
    yaml = folder / "robot.yaml"
    with (
        eurdf.view(folder, port=0, options={"geometry": False}) as viewer,
        ViewerClient(viewer.url) as page,
    ):
        before, robot = yaml.read_text(), viewer.robot
        page.set("drag frame", "foot")
        page.wait_for(lambda: "/gizmo" in page.nodes)
        slider = viewer._first.session.sliders[0]
        page.set(f"{slider.label} ({slider.unit})", 0.1)
        page.wait_for(lambda: np.abs(viewer.q - viewer._first.session.first).max() > 1e-3)
        assert page.value("name") == "pose_1"
        page.set("name", "assembled")
        page.click("save as configuration")
        page.wait_for(lambda: page.says("already has a different configuration &#x27;assembled&#x27;"))
        assert yaml.read_text() == before
        page.click("replace 'assembled'")
        page.wait_for(lambda: page.says("saved configuration &#x27;assembled&#x27;"))
        assert yaml.read_text() != before
        page.click("save as configuration")
        page.wait_for(lambda: page.says("saved configuration &#x27;pose_1&#x27;"))
        page.wait_for(lambda: page.value("name") == "pose_2")
        assert not viewer._page.files.has_changed
        assert viewer.robot is robot
        assert page.value("drag frame") == "foot"
        assert "/gizmo" in page.nodes


def test_gravity_goes_on_when_the_files_change(tmp_path: Path) -> None:
    folder = copied("four_bar", tmp_path)
    with eurdf.view(folder, port=0) as viewer, ViewerClient(viewer.url) as page:
        page.click("gravity")
        page.wait_for(lambda: page.says("gravity: 0."))
        before = viewer.robot
        urdf = folder / "robot.urdf"
        urdf.write_text(urdf.read_text().replace('mass value="', 'mass value="1'))
        page.wait_for(lambda: viewer.robot is not before)
        page.wait_for(lambda: page.says("gravity: 0."))
        assert page.control("pause")


def test_pause_is_served_while_a_step_is_computed(monkeypatch: pytest.MonkeyPatch) -> None:
    begun, ends = threading.Event(), threading.Event()
    simulate = playback.simulate

    def endless(*arguments: Any, **options: Any) -> Any:
        begun.set()
        assert ends.wait(60.0)
        return simulate(*arguments, **options)

    monkeypatch.setattr(playback, "simulate", endless)
    with eurdf.view("four_bar", port=0) as viewer, ViewerClient(viewer.url) as page:
        page.click("gravity")
        assert begun.wait(60.0)
        page.click("pause")
        page.wait_for(lambda: page.control("continue"))
        slider = viewer._first.session.sliders[0]
        page.set(f"{slider.label} ({slider.unit})", 0.2)
        page.wait_for(lambda: viewer._first.session.value(0) == pytest.approx(0.2))
        ends.set()


def test_gravity_that_diverges_ends_with_a_reason(monkeypatch: pytest.MonkeyPatch) -> None:
    def diverges(*_: Any, **options: Any) -> Any:
        raise eurdf.errors.SimulationDiverged(0.0, options["step"])

    with eurdf.view("four_bar", port=0) as viewer, ViewerClient(viewer.url) as page:
        page.click("gravity")
        page.wait_for(lambda: page.says("gravity: 0."))
        monkeypatch.setattr(playback, "simulate", diverges)
        page.wait_for(lambda: page.says("gravity ends after"))
        pause = page.control("pause")
        assert pause is not None
        page.wait_for(lambda: page.controls[pause]["disabled"])
        assert not viewer._worker.is_playing
