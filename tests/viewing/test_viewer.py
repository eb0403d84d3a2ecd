"""The viewer in a real browser: what is drawn is where forward kinematics has it, whatever the user does."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

import eurdf
from support.browser import barriers, browser, errors_of, scrolls_sideways
from support.places import ROBOTS
from support.viewer_client import wait_for

pytestmark = pytest.mark.slow

# Error of an entry of a pose, m or of a rotation matrix: three.js has double precision until it draws.
_EXACT = 1e-9
_MOVED = 1e-4

# Matrices of the links as they are drawn, in rows.
_POSES = """(number) => {
  const scene = number ? page.robots.get(number).scene : page.view.scene;
  return [...scene.links].map(([name, { matrixWorld }]) => [name, matrixWorld.clone().transpose().elements]);
}"""


@pytest.fixture(scope="module")
def chromium() -> Iterator[Any]:
    pytest.importorskip("websockets", reason="websockets is not installed: pip install -e '.[view]'")
    with browser() as started:
        yield started


def copied(robot: str, folder: Path) -> Path:
    for name in ("robot.urdf", "robot.yaml"):
        (folder / name).write_text((ROBOTS / robot / name).read_text())
    return folder


class Watched:
    """A viewer, and a page of it whose links are compared after each step."""

    def __init__(self, viewer: eurdf.viewing.Viewer, page: Any) -> None:
        self.viewer, self.page = viewer, page
        page.goto(viewer.url)
        wait_for(lambda: page.evaluate("Boolean(globalThis.page?.view)"))

    def drawn(self, number: int = 0) -> dict[str, np.ndarray]:
        """The poses (4, 4) of the links of a robot."""
        return {name: np.reshape(matrix, (4, 4)) for name, matrix in self.page.evaluate(_POSES, number)}

    def error(self) -> float:
        """How far the links are from where Pinocchio alone has them."""
        robot, q = self.viewer.robot, self.viewer.q
        data = robot.model.createData()
        pin.framesForwardKinematics(robot.model, data, q)
        names = [body.name for body in robot.mechanism.bodies]
        frames = [data.oMf[robot.model.getFrameId(name, pin.FrameType.BODY)].homogeneous for name in names]
        return self.far(self.drawn(), dict(zip(names, frames, strict=True)))

    @staticmethod
    def far(a: dict[str, np.ndarray], b: dict[str, np.ndarray]) -> float:
        return max(float(np.abs(a[name] - b[name]).max()) for name in b) if a.keys() >= b.keys() else np.inf

    def step(self, act: Callable[[], Any], *, moves: bool = True, until: Callable[[], Any] = lambda: True) -> None:
        """Do something; then each link is drawn where it is, and elsewhere than before if the step moves it."""
        before = self.drawn()
        act()
        wait_for(lambda: until() and (not moves or self.far(self.drawn(), before) > _MOVED))
        wait_for(lambda: self.error() < _EXACT)

    def tab(self, name: str) -> None:
        self.page.get_by_role("tab", name=name, exact=True).click()

    def click(self, name: str) -> None:
        self.page.get_by_role("button", name=name, exact=True).click()

    def says(self, text: str) -> bool:
        return bool(self.page.get_by_text(text).filter(visible=True).count())

    def slide(self, number: int, part: float) -> None:
        """Bring a slider to a part of its range."""
        slider = self.page.get_by_role("slider").filter(visible=True).nth(number)
        low, high = (float(slider.get_attribute(name)) for name in ("min", "max"))
        slider.fill(str(low + part * (high - low)))

    def play(self, act: Callable[[], Any]) -> None:
        """Play something until the robot has moved, and pause."""
        before = self.drawn()
        act()
        wait_for(lambda: self.far(self.drawn(), before) > _MOVED)
        self.step(lambda: self.click("Pause"), moves=False, until=lambda: self.says("Continue"))

    def grab(self, links: list[str]) -> None:
        """Drag the first of some links that is seen by a point of it, to the right."""
        x, y = self.page.evaluate(_SEEN, links)
        self.page.mouse.move(x, y)
        self.page.mouse.down()
        self.page.mouse.move(x + 40, y - 10, steps=5)
        self.page.mouse.up()


# A point on the screen at which one of some links is in front, of the middles of its parts.
_SEEN = """(links) => {
  const { canvas, viewport, scene, grabbing } = page.view;
  const { left, top, width, height } = canvas.getBoundingClientRect();
  for (const { mesh, link } of scene.parts.filter(({ link }) => links.includes(link))) {
    mesh.geometry.computeBoundingSphere();
    const at = mesh.localToWorld(mesh.geometry.boundingSphere.center.clone()).project(viewport.camera);
    const [x, y] = [left + (width * (1 + at.x)) / 2, top + (height * (1 - at.y)) / 2];
    if (grabbing.under({ clientX: x, clientY: y })?.link === link) return [x, y];
  }
  throw new Error(`${links} are not seen`);
}"""


@contextmanager
def watched(chromium: Any, *robot: Any, **options: Any) -> Iterator[Watched]:
    page = chromium.new_page(viewport={"width": 1100, "height": 750})
    errors = errors_of(page)
    page.on("dialog", lambda dialog: (errors.append(f"dialog: {dialog.message}"), dialog.dismiss()))
    with eurdf.view(*robot, port=0, **options) as viewer:
        yield Watched(viewer, page)
        assert errors == []
        page.close()


@pytest.mark.parametrize(
    ("robot", "root"),
    [
        ("four_bar", None),
        ("stewart_platform", None),
        ("unitree_g1_ankle", None),
        ("digit_leg", "floating"),
        ("double_wishbone", None),  # with springs
    ],
)
def test_links_are_drawn_where_they_are(chromium: Any, robot: str, root: str | None, tmp_path: Path) -> None:
    folder = copied(robot, tmp_path)
    with watched(chromium, folder, options={"root": root}) as at:
        step, viewer, page = at.step, at.viewer, at.page
        step(lambda: None, moves=False)
        first = at.drawn()
        step(lambda: at.slide(0, 0.6))
        step(lambda: at.click("Reset"))
        assert at.far(at.drawn(), first) < _EXACT
        step(lambda: at.slide(0, 0.6))
        step(lambda: at.click("Undo"))
        step(lambda: at.click("Redo"))

        step(lambda: at.grab([name for name, pose in at.drawn().items() if np.abs(pose - first[name]).max() > _MOVED]))
        assert np.abs(eurdf.residual(viewer.robot, viewer.q)).max() < 1e-8

        step(lambda: viewer.show(viewer.robot.tree.integrate(viewer.q, np.full(viewer.robot.tree.nv, 0.01))))
        step(lambda: at.click("Assemble"), until=lambda: at.says("The loops are closed"))
        page.get_by_label("Name of the configuration").fill("mine")
        step(lambda: at.click("Save"), moves=False, until=lambda: at.says("saved configuration 'mine'"))
        saved, mine = at.drawn(), viewer.q
        step(lambda: at.slide(0, 0.35))
        step(lambda: at.click("mine"))
        assert at.far(at.drawn(), saved) < _EXACT

        at.tab("Play")
        at.play(lambda: at.click("Gravity"))
        if page.get_by_role("button", name="Sweep").count():
            at.play(lambda: at.click("Sweep"))
        step(lambda: at.click("End"), moves=False)

        page.locator("canvas").click(button="right", position={"x": 10, "y": 10})
        step(lambda: page.keyboard.press("r"))
        begin = viewer.q
        csv = tmp_path / "walk.csv"
        joint = viewer.robot.actuation.joints[0] if viewer.robot.actuation.joints else next(iter(viewer.robot.slots))
        (value,) = viewer.robot.joint_positions(viewer.q)[joint]
        csv.write_text(f"time,{joint}\n0,{value}\n0.05,{value + 0.02}\n0.1,{value + 0.04}\n")
        step(lambda: viewer.replay(csv), until=lambda: at.says("Trajectory: 0.100 s of 0.1 s"))
        assert viewer.robot.joint_positions(viewer.q)[joint] == pytest.approx((value + 0.04,))
        step(lambda: page.get_by_label("Time").fill("0"))
        start = eurdf.forward_kinematics(viewer.robot, {joint: value}, begin)
        assert viewer.q == pytest.approx(start, abs=1e-9)
        step(lambda: viewer.show(mine))


def test_files_that_change_are_shown_and_choices_stay(chromium: Any, tmp_path: Path) -> None:
    folder = copied("digit_leg", tmp_path)
    urdf, yaml = folder / "robot.urdf", folder / "robot.yaml"
    with watched(chromium, folder) as at:
        at.tab("Show")
        at.page.get_by_label("Link names").check()
        at.page.get_by_label("Follow").select_option("foot")
        at.page.evaluate("page.view.viewport.zoom(0.5)")
        at.tab("Move")
        at.step(lambda: at.slide(3, 0.4))
        camera = "page.view.viewport.camera.position.toArray()"
        seen, placed, before = at.page.evaluate(camera), at.drawn(), at.viewer.robot
        heavier = re.sub(r'mass value="([^"]*)"', r'mass value="1\1"', urdf.read_text(), count=1)
        at.step(lambda: urdf.write_text(heavier), moves=False, until=lambda: at.says("this is the robot now"))
        assert at.viewer.robot is not before
        assert at.far(at.drawn(), placed) < _EXACT
        assert at.page.evaluate(camera) == pytest.approx(seen)
        at.tab("Show")
        assert at.page.get_by_label("Link names").is_checked()
        assert at.page.get_by_label("Follow").input_value() == "link foot"
        wait_for(lambda: at.page.locator(".eu-labels span").filter(visible=True).count() > 3)

        good = yaml.read_text()
        at.step(lambda: yaml.write_text(good + "unknown: 1\n"), moves=False, until=lambda: at.says("have errors"))
        at.tab("Robot")
        line = good.count("\n") + 1
        at.page.get_by_text(re.compile(rf"robot\.yaml:{line}:1: error: .*unknown")).filter(
            visible=True
        ).first.wait_for()
        at.tab("Move")
        at.step(lambda: at.slide(3, 0.6))
        at.step(lambda: yaml.write_text(good), moves=False, until=lambda: at.says("this is the robot now"))
        at.step(lambda: at.slide(3, 0.5))


def test_saving_asks_before_it_replaces(chromium: Any, tmp_path: Path) -> None:
    folder = copied("four_bar", tmp_path)
    yaml = folder / "robot.yaml"
    with watched(chromium, folder) as at:
        before = yaml.read_text()
        at.step(lambda: at.slide(0, 0.6))
        at.page.get_by_label("Name of the configuration").fill("assembled")
        at.click("Save")
        wait_for(lambda: at.says("already has a different configuration 'assembled'"))
        at.click("Cancel")
        assert yaml.read_text() == before
        at.click("Save")
        at.click("Replace “assembled”")
        wait_for(lambda: at.says("saved configuration 'assembled'"))
        assert yaml.read_text() != before
        assert at.page.get_by_label("Name of the configuration").input_value() == "pose_1"


def test_each_layer_is_drawn(chromium: Any) -> None:
    with watched(chromium, "digit_leg") as at:
        at.step(lambda: at.slide(3, 0.4))  # away from its ghost
        at.tab("Show")
        canvas = at.page.locator("canvas")
        boxes = at.page.locator("fieldset").first.get_by_role("checkbox").all()
        assert len(boxes) == 11
        for box in [*(box for box in boxes if not box.is_checked()), boxes[0]]:
            before = canvas.screenshot()
            box.click()
            wait_for(lambda before=before: canvas.screenshot() != before)
        ellipsoid = at.page.evaluate(
            """() => {
              page.showTab.layers.show("inertias", true);
              const { object } = page.showTab.layers.made.get("inertias");
              const at = [...page.view.session.robot.links.keys()].indexOf("foot");
              return object.children[at].children[0].matrix.clone().transpose().elements;
            }"""
        )
        inertia = next(body.inertia for body in at.viewer.robot.mechanism.bodies if body.name == "foot")
        half = np.reshape(ellipsoid, (4, 4))[:3, :3]
        second = inertia.mass / 5.0 * half @ half.T
        assert np.trace(second) * np.eye(3) - second == pytest.approx(_matrix(inertia), abs=1e-12)


def _matrix(inertia: Any) -> np.ndarray:
    """Moments of inertia (3, 3) about the center of mass, in the frame of the link, kg m²."""
    xx, xy, xz, yy, yz, zz = inertia.moments
    R = np.array(pin.XYZQUATToSE3([0.0, 0.0, 0.0, *inertia.pose.quaternion]).rotation)
    return R @ np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]) @ R.T


def test_other_robots_are_beside_the_first(chromium: Any) -> None:
    with watched(chromium, "four_bar") as at:
        second = at.viewer.add(eurdf.load("bennett"), xyz=(0.0, 1.0, 0.0))
        for angle in (0.1, 0.4):
            q = eurdf.forward_kinematics(second.robot, {"motor_a": angle})
            second.show(q)
            data = second.robot.model.createData()
            pin.framesForwardKinematics(second.robot.model, data, q)

            def error(data: Any = data) -> float:
                names = (body.name for body in second.robot.mechanism.bodies)
                there = {name: data.oMf[second.robot.model.getFrameId(name, pin.FrameType.BODY)] for name in names}
                move = pin.SE3(np.eye(3), np.array((0.0, 1.0, 0.0)))
                return at.far(at.drawn(1), {name: (move * pose).homogeneous for name, pose in there.items()})

            wait_for(lambda: at.page.evaluate("page.robots.has(1)") and error() < _EXACT)
        at.step(lambda: at.slide(0, 0.7))


def test_contacts_hold_what_they_touch(chromium: Any) -> None:
    robot = eurdf.load("digit_leg", root="floating").with_contacts({"foot": "6d"})
    with watched(chromium, robot) as at:
        foot = at.drawn()["foot"]
        at.step(lambda: at.slide(3, 0.6))
        assert np.abs(at.drawn()["foot"] - foot).max() < 1e-6
        assert np.abs(eurdf.residual(robot, at.viewer.q)).max() < 1e-6


def test_pictures_videos_and_poses_leave_the_page(chromium: Any) -> None:
    with watched(chromium, "four_bar") as at:
        at.page.context.grant_permissions(["clipboard-read", "clipboard-write"])
        at.step(lambda: at.slide(0, 0.6))
        at.click("Copy as Python")
        wait_for(lambda: at.says("The pose is on the clipboard"))
        scope: dict[str, Any] = {"robot": at.viewer.robot}
        exec(at.page.evaluate("navigator.clipboard.readText()"), scope)
        assert scope["q"] == pytest.approx(at.viewer.q)
        at.tab("Show")
        with at.page.expect_download() as picture:
            at.click("Save a picture")
        assert Path(picture.value.path()).read_bytes().startswith(b"\x89PNG")
        at.click("Record a video")
        for _ in range(20):
            at.page.evaluate("page.view.viewport.turn(0.1, 0)")
            at.page.wait_for_timeout(50)
        with at.page.expect_download() as video:
            at.click("End the video")
        assert len(Path(video.value.path()).read_bytes()) > 1000


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("width", [1100, 390])
def test_page_has_no_barriers_and_panel_is_beside_the_robot(chromium: Any, scheme: Any, width: int) -> None:
    with watched(chromium, "digit_leg") as at:
        page = at.page
        page.emulate_media(color_scheme=scheme)
        page.set_viewport_size({"width": width, "height": 780})
        assert not scrolls_sideways(page)
        canvas, side = page.locator("canvas").bounding_box(), page.locator(".eu-side").bounding_box()
        right, below = canvas["x"] + canvas["width"], canvas["y"] + canvas["height"]
        assert right <= side["x"] or below <= side["y"]
        for tab in ("Move", "Play", "Show", "Robot", "Limits", "Graph"):
            at.tab(tab)
            assert barriers(page) == []


def test_page_says_when_the_server_has_ended(chromium: Any) -> None:
    page = chromium.new_page()
    with eurdf.view("four_bar", port=0) as viewer:
        page.goto(viewer.url)
        wait_for(lambda: page.evaluate("Boolean(globalThis.page?.view)"))
        ended = page.get_by_text("The viewer has ended; run `eurdf view …` again.")
        assert not ended.is_visible()
        port = int(viewer.url.rpartition(":")[2])
    ended.wait_for(timeout=30_000)
    with eurdf.view("bennett", port=port):
        ended.wait_for(state="hidden", timeout=30_000)
        page.get_by_role("heading", name="bennett").wait_for()
    page.close()


def test_hostile_names_are_inert(chromium: Any, tmp_path: Path) -> None:
    """Names of links, joints, closures and configurations are text, whatever markup they look like."""
    attack = "<img src=x onerror=alert(1)>{alert(2)}[a](javascript:alert(3))"
    urdf = (ROBOTS / "four_bar/robot.urdf").read_text()
    yaml = (ROBOTS / "four_bar/robot.yaml").read_text()
    quoted = attack.replace("<", "&lt;").replace(">", "&gt;")
    urdf = urdf.replace('"motor_crank"', f'"motor {quoted}"')
    links = list(dict.fromkeys(re.findall(r'<link name="([^"]*)"', urdf)))
    for link in links[1:]:
        urdf = urdf.replace(f'"{link}"', f'"{link} {quoted}"')
        yaml = re.sub(rf"\b{link}\b(?=[,\]}}])", f"'{link} {attack}'", yaml)
    urdf = re.sub(r'<robot name="[^"]*"', f'<robot name="robot {quoted}"', urdf)
    yaml = yaml.replace("[motor_crank]", f"['motor {attack}']").replace("rocker_pin\n", f"'pin {attack}'\n")
    yaml = yaml.replace("assembled: {}", f"assembled: {{}}\n  'start {attack}': {{}}")
    (tmp_path / "robot.urdf").write_text(urdf)
    (tmp_path / "robot.yaml").write_text(yaml)
    with watched(chromium, tmp_path) as at:
        page = at.page
        assert attack in at.viewer.robot.mechanism.actuators[0]
        page.get_by_text(f"motor {attack}").first.wait_for()
        page.get_by_role("button", name=f"start {attack}").wait_for()
        at.tab("Show")
        for label in ("Link names", "Joint axes"):
            page.get_by_label(label, exact=True).check()
        at.tab("Move")
        at.viewer.show(at.viewer.robot.tree.integrate(at.viewer.q, np.full(at.viewer.robot.tree.nv, 0.3)))
        page.get_by_text(f"“pin {attack}”").first.wait_for()  # the open closure
        (tmp_path / "robot.yaml").write_text(yaml + "unknown: 1\n'bad " + attack + "': 2\n")
        page.get_by_text("the files changed and have errors").wait_for()
        for tab in ("Robot", "Limits", "Graph"):
            at.tab(tab)
        at.tab("Robot")
        page.get_by_text("bad <img src=x onerror=alert(1)>{alert(2)}").first.wait_for()  # long names are shortened
        page.wait_for_timeout(500)
        assert page.locator("img").count() == 0
        assert page.locator("a[href^=javascript]").count() == 0
