"""A robot on a page without a server, in a real browser, from a file and offline."""

from __future__ import annotations

import io
import json
import re
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

import eurdf
from eurdf.viewing.live_robot import PageRobot, live_page, page_robot, page_robot_of
from eurdf.viewing.scene import Scene
from support.browser import POSES, VIEW, axe, barriers, browser, errors_of
from support.described import strut
from support.hostile_meshes import collada, gltf
from support.places import ROBOTS
from support.stl import TETRAHEDRON

pytestmark = pytest.mark.slow

# A point of the picture, nearest to the lower left corner, at which a link other than the root is drawn.
_HANDLE = f"""() => {{
  {VIEW}
  const {{ left, right, top, bottom }} = view.viewport.canvas.getBoundingClientRect();
  for (let y = bottom - 4; y > top; y -= 4)
    for (let x = left + 4; x < right; x += 4) {{
      const found = view.grabbing.under({{ clientX: x, clientY: y }});
      if (found && !session.isOfRoot(found.link)) return {{ x, y, link: found.link }};
    }}
}}"""

# Where the held point is in the window.
_HELD = f"""() => {{
  {VIEW}
  const at = view.grabbing.ball.position.clone().project(view.viewport.camera);
  const {{ left, top, width, height }} = view.viewport.canvas.getBoundingClientRect();
  return [left + (0.5 + 0.5 * at.x) * width, top + (0.5 - 0.5 * at.y) * height];
}}"""


@pytest.fixture(scope="module")
def chromium() -> Iterator[Any]:
    with browser() as started:
        yield started


class Opened:
    """A page that shows a robot alone, its errors, and what it loads."""

    def __init__(
        self, chromium: Any, folder: Path, robot: PageRobot, width: int = 1000, height: int = 700, **options: Any
    ):
        file = folder / "page.html"
        file.write_text(live_page(robot), encoding="utf-8")
        self.page = chromium.new_context(
            offline=True, viewport={"width": width, "height": height}, **options
        ).new_page()
        self.errors = errors_of(self.page)
        self.loads: list[str] = []
        self.page.on("dialog", lambda dialog: (self.errors.append(f"dialog: {dialog.message}"), dialog.dismiss()))
        self.page.on("request", lambda request: self.loads.append(request.url))
        self.page.goto(file.as_uri())
        self.page.get_by_role("status").wait_for()

    def ask(self, expression: str) -> Any:
        """The value of an expression in JavaScript that knows ``view``, ``session`` and ``scene``."""
        return self.page.evaluate(f"() => {{ {VIEW} return {expression}; }}")

    def wait(self, condition: str) -> None:
        """Wait until an expression of `ask` is true."""
        self.page.wait_for_function(f"() => {{ {VIEW} return {condition}; }}")

    @property
    def q(self) -> dict[str, list[float]]:
        return dict(self.ask("session.q"))

    @property
    def residual(self) -> float:
        return float(self.page.get_by_role("status").get_attribute("data-residual"))

    def slider(self, name: str) -> Any:
        return self.page.get_by_role("slider", name=name, exact=True)

    def picture(self) -> Any:
        """What the canvas shows."""
        from PIL import Image

        self.wait("view.viewport.waiting === undefined")  # until it is drawn
        return Image.open(io.BytesIO(self.page.locator("canvas").screenshot(timeout=60_000))).convert("RGB")

    def close(self) -> None:
        assert self.errors == []
        assert [url for url in self.loads if not url.startswith(("file:", "data:", "blob:"))] == []
        self.page.context.close()


def assert_drawn_where_the_reference_has_it(page: Opened, robot: eurdf.Robot) -> None:
    q = robot.configuration({name: tuple(each) for name, each in page.q.items()})
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, q)
    poses = page.page.evaluate(POSES)
    assert set(poses) == {body.name for body in robot.mechanism.bodies if not body.virtual}
    for link, pose in poses.items():
        expected = data.oMf[robot.model.getFrameId(link, pin.BODY)].homogeneous
        np.testing.assert_allclose(pose, expected, atol=1e-9, err_msg=link)


@pytest.mark.parametrize("name", ["digit_leg", "delta", "robotiq_2f85", "screw_press", "reachy_mini"])
def test_each_slider_moves_the_drawn_robot_as_the_reference_does(chromium: Any, tmp_path: Path, name: str) -> None:
    robot = eurdf.load(name)
    page = Opened(chromium, tmp_path, page_robot(name))
    assert_drawn_where_the_reference_has_it(page, robot)
    start = robot.configuration({joint: tuple(each) for joint, each in page.q.items()})
    moved = 0
    for each in page.ask("session.coordinates.map(({ joint, label, upper }) => ({ joint, label, upper }))"):
        page.page.get_by_role("button", name="Reset").click()
        slider = page.slider(each["label"])
        goal = 0.9 * float(slider.input_value()) + 0.1 * each["upper"]
        slider.fill(repr(goal))
        assert page.residual < 1e-9
        assert_drawn_where_the_reference_has_it(page, robot)
        if page.ask("session.stop") is None and not len(robot.tree.springs.idx_v):
            moved += 1
            others = {motor: page.q[motor] for motor in robot.mechanism.actuators}
            assert others[each["joint"]] == pytest.approx([goal], abs=1e-9)
            expected = robot.joint_positions(eurdf.forward_kinematics(robot, others, start))
            for joint, values in expected.items():
                if joint not in _spinning(robot):
                    assert page.q[joint] == pytest.approx(values, abs=1e-6), joint
    assert moved or name == "robotiq_2f85"
    page.close()


def _spinning(robot: eurdf.Robot) -> set[str]:
    """Joints of rods that may spin about their lines, which no actuator controls."""
    return {joint.name for joint in robot.mechanism.joints if joint.type.value in ("spherical", "universal")}


@pytest.mark.parametrize("kind", ["planar", "spherical", "floating"])
def test_actuator_with_a_pose_has_a_slider_for_each_coordinate(chromium: Any, tmp_path: Path, kind: str) -> None:
    robot = strut(kind)
    page = Opened(chromium, tmp_path, page_robot_of(robot))
    labels = page.ask("session.coordinates.map(({ label }) => label)")
    assert len(labels) == {"planar": 3, "spherical": 3, "floating": 6}[kind]
    for label in labels:
        page.slider(label).fill("0.2")
        assert float(page.slider(label).input_value()) == pytest.approx(0.2, abs=1e-9)
        assert page.residual < 1e-9
        assert_drawn_where_the_reference_has_it(page, robot)
    page.close()


@pytest.mark.parametrize("name", ["digit_leg", "delta", "talos_2legs"])
def test_part_follows_the_pointer_until_it_is_released(chromium: Any, tmp_path: Path, name: str) -> None:
    page = Opened(chromium, tmp_path, page_robot(name))
    before, handle = page.q, page.page.evaluate(_HANDLE)
    mouse = page.page.mouse
    mouse.move(handle["x"], handle["y"])
    mouse.down()
    goal = handle["x"] + 12, handle["y"] - 25
    mouse.move(*goal, steps=8)
    page.wait("view.grabbing.held.target === null")
    assert page.page.evaluate(_HELD) == pytest.approx(goal, abs=1.0)
    mouse.up()
    assert page.residual < 1e-9
    assert page.ask("session.limits.every(({ distance }) => distance > -1e-6)")
    assert_drawn_where_the_reference_has_it(page, eurdf.load(name, geometry=False))
    assert page.q.get("root_joint") == before.get("root_joint")
    after = page.q
    page.page.keyboard.press("Control+z")
    assert page.q == before
    page.page.keyboard.press("Control+Shift+z")
    assert page.q == after
    mouse.move(goal[0] + 200, goal[1])
    assert page.q == after
    mouse.move(*goal)
    mouse.down()
    mouse.move(goal[0], 5, steps=4)
    page.page.get_by_text("mm behind").wait_for()
    mouse.up()
    assert page.residual < 1e-9
    page.close()


def test_finger_on_the_robot_moves_it_and_beside_it_turns_the_view(chromium: Any, tmp_path: Path) -> None:
    page = Opened(chromium, tmp_path, page_robot("delta"), 390, 780, has_touch=True, is_mobile=True)
    fingers = page.page.context.new_cdp_session(page.page)

    def swipe(x: float, y: float) -> None:
        for kind, moved in (("touchStart", 0), ("touchMove", 10), ("touchMove", 20), ("touchEnd", None)):
            points = [] if moved is None else [{"x": x + moved, "y": y}]
            fingers.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})
            page.page.wait_for_timeout(100)

    q, camera = page.q, page.ask("view.viewport.camera.position.toArray()")
    box = page.page.locator("canvas").bounding_box()
    swipe(box["x"] + 15, box["y"] + 15)
    assert page.q == q
    assert page.ask("view.viewport.camera.position.toArray()") != camera
    handle, camera = page.page.evaluate(_HANDLE), page.ask("view.viewport.camera.position.toArray()")
    swipe(handle["x"], handle["y"])
    assert page.q != q
    assert page.residual < 1e-9
    assert page.ask("view.viewport.camera.position.toArray()") == camera
    page.close()


def test_limits_turn_red_and_the_stop_says_which_joint_it_is(chromium: Any, tmp_path: Path) -> None:
    page = Opened(chromium, tmp_path, page_robot("digit_leg"))
    red = "scene.parts.filter(({ material: { color } }) => color.r > 2 * color.g && color.r > 2 * color.b).length"
    calm = page.ask(red)
    shin = page.slider("motor_shin1")
    shin.fill(shin.get_attribute("max"))
    page.page.get_by_text("Passive joint “free_foot").wait_for()
    assert page.residual < 1e-9
    assert float(shin.input_value()) < float(shin.get_attribute("max")) - 0.1
    assert page.ask(red) > calm
    shown = "scene.loops.closures.filter(({ dots: [dot] }) => dot.visible).map(({ closure }) => closure.name)"
    assert page.ask(shown) == ["rod1", "rod2"]
    page.page.get_by_text("1 at a limit").click()
    row = page.page.locator("tr.eu-live-at-limit")
    assert row.locator("td").last.text_content() == "0.000 rad"
    page.page.get_by_label("Degrees").check()
    assert row.locator("td").last.text_content() == "0.0°"
    page.page.get_by_text("is at its position limit 33.0°.").wait_for()
    page.page.get_by_role("button", name="Reset").click()
    assert page.ask(red) == calm
    assert row.count() == 0
    assert page.ask(shown) == []
    page.close()


def test_keys_play_turn_reset_and_undo(chromium: Any, tmp_path: Path) -> None:
    page = Opened(chromium, tmp_path, page_robot("five_bar"))
    canvas, start = page.page.locator("canvas"), page.q
    camera = "view.viewport.camera.position.toArray()"
    canvas.focus()
    for key, least in (("ArrowLeft", 1e-3), ("ArrowUp", 1e-3), ("+", 1e-3)):
        before = page.ask(camera)
        canvas.press(key)
        assert float(np.linalg.norm(np.subtract(page.ask(camera), before))) > least
    canvas.press("Space")
    page.page.get_by_role("button", name="Pause").wait_for()
    page.wait("Math.abs(session.value(session.coordinates[0])) > 0.01")
    canvas.press("Space")
    page.page.get_by_role("button", name="Play").wait_for()
    played = page.q
    assert played != start
    assert page.residual < 1e-9
    canvas.press("r")
    assert page.q == start
    canvas.press("Control+z")
    assert page.q == played
    canvas.press("Control+z")
    assert page.q == start
    page.slider(page.ask("session.coordinates[0].label")).press("ArrowRight")
    assert page.q != start
    page.close()


def test_loops_are_shown_and_an_open_one_is_named_and_closed(chromium: Any, tmp_path: Path) -> None:
    page = Opened(chromium, tmp_path, page_robot("four_bar"))
    assert page.page.get_by_role("button", name="Assemble").is_hidden()
    before = page.picture()
    page.page.get_by_label("Loops").check()
    assert changed(before, page.picture()) > 1000
    page.page.get_by_label("Loops").uncheck()
    page.ask("session.show({ ...session.q, [session.robot.joints[0].name]: [0.6] })")
    page.page.get_by_text("The loops are open at “").wait_for()
    page.page.get_by_role("button", name="Assemble").click()
    page.page.get_by_text("The loops are closed").wait_for()
    assert page.residual < 1e-9
    page.close()


def changed(one: Any, other: Any) -> int:
    """How many pixels differ clearly."""
    from PIL import ImageChops

    return sum(ImageChops.difference(one, other).convert("L").histogram()[40:])


def lightness(image: Any, at: tuple[int, int]) -> int:
    return int(image.convert("L").getpixel(at))


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize(
    ("name", "width", "height"), [("digit_leg", 1280, 700), ("unitree_g1", 390, 700), ("double_wishbone", 700, 390)]
)
def test_page_fills_window_in_colours_of_theme(
    chromium: Any, tmp_path: Path, name: str, width: int, height: int, scheme: str
) -> None:
    from PIL import Image, ImageChops

    axe()
    page = Opened(chromium, tmp_path, page_robot(name), width, height, color_scheme=scheme)
    assert page.page.get_by_role("heading", level=1).text_content() == name
    size = "[document.documentElement.scrollWidth, document.documentElement.scrollHeight]"
    assert page.ask(size) == [width, height]
    for each in ("footer", ".eu-live-status"):
        box = page.page.locator(each).bounding_box()
        assert 0 < box["y"] < box["y"] + box["height"] < height
    canvas = page.page.locator("canvas").bounding_box()
    assert canvas["width"] * canvas["height"] > 0.35 * width * height
    assert barriers(page.page) == []

    whole = Image.open(io.BytesIO(page.page.screenshot(timeout=60_000)))
    before = page.picture()
    assert len(before.getcolors(1 << 24)) > 200  # a robot is drawn
    corners = lightness(whole, (2, 2)), lightness(before, (5, 5)), lightness(before, (5, before.height - 5))
    assert all(corner < 80 if scheme == "dark" else corner > 225 for corner in corners)
    page.page.get_by_role("slider").first.fill("0.3")
    assert changed(before, page.picture()) > 20
    page.page.get_by_role("button", name="Reset").click()
    assert changed(before, page.picture()) == 0
    page.ask("(view.viewport.ground.forEach((each) => { each.visible = false; }), view.viewport.draw())")
    alone = page.picture()
    page.ask("(scene.visible = false, view.viewport.draw())")
    robot = ImageChops.difference(alone, page.picture()).convert("L").point(lambda value: 255 * (value > 10))
    left, top, right, bottom = robot.getbbox()
    assert min(left, top, before.width - right, before.height - bottom) > 2  # head and foot are in the picture
    assert max((right - left) / before.width, (bottom - top) / before.height) > 0.5
    page.close()


def test_theme_that_the_user_chooses_repaints_the_robot(chromium: Any, tmp_path: Path) -> None:
    page = Opened(chromium, tmp_path, page_robot("double_wishbone"))
    light = page.picture()
    page.page.evaluate("document.body.dataset.theme = 'dark'")
    dark = page.picture()
    assert lightness(light, (5, 5)) > 225
    assert lightness(dark, (5, 5)) < 80
    # The tyre is nearly black; where the page is dark, it is lighter.
    assert sum(dark.convert("L").histogram()[:36]) < 0.1 * sum(light.convert("L").histogram()[:36])
    page.page.evaluate("document.body.dataset.theme = 'light'")
    assert changed(light, page.picture()) == 0
    page.page.evaluate("delete document.body.dataset.theme")
    page.page.emulate_media(color_scheme="dark")
    assert changed(dark, page.picture()) < 100  # the border differs at the corners
    page.close()


def test_nothing_is_drawn_while_nothing_changes(chromium: Any, tmp_path: Path) -> None:
    page = Opened(chromium, tmp_path, page_robot("digit_leg"))
    drawn = "view.viewport.renderer.info.render.frame"
    page.wait(f"{drawn} > 0 && view.viewport.waiting === undefined")
    page.page.evaluate("() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")
    frames = page.ask(drawn)
    page.page.wait_for_timeout(500)
    assert page.ask(drawn) == frames
    page.slider("motor_knee").fill("-0.3")
    page.wait(f"{drawn} > {frames}")
    page.close()


_OBJ = b"mtllib other.mtl\nv 0 0 0\nv 1 0 0\nv 0 2 0\nv 0 0 3\nf 1 2 3\nf 1 2 4\nf 1 3 4\nf 2 3 4\n"
_SHAPE = (
    '<link name="{0}"><visual><origin xyz="0 0 1" rpy="0.3 0 0"/><geometry>'
    '<mesh filename="meshes/{0}" scale="2 1 -1"/></geometry></visual></link>'
)


def _collada(up: str) -> bytes:
    asset = f'<asset><unit name="inch" meter="0.0254"/><up_axis>{up}</up_axis></asset>'
    return collada("1 0 0 0 2 0 0 0 3", asset).replace(b"<node>", b"<node><translate>1 2 3</translate>")


def without_materials(document: Any) -> Any:
    (mesh,) = document["meshes"]
    (primitive,) = mesh["primitives"]
    kept = {key: document[key] for key in document if key not in ("images", "textures", "materials")}
    return {**kept, "meshes": [{"primitives": [{key: primitive[key] for key in ("attributes", "mode")}]}]}


def test_meshes_of_each_format_are_drawn_where_the_reference_has_them(chromium: Any, tmp_path: Path) -> None:
    triangle = np.array([[1, 0, 0], [0, 2, 0], [0, 0, 3]], "<f4").tobytes()
    files = {
        "a.stl": TETRAHEDRON,
        "b.obj": _OBJ,
        "c.dae": _collada("Y_UP"),
        "d.dae": _collada("Z_UP"),
        "e.gltf": json.dumps(without_materials(gltf("f.bin", ""))).encode(),
        "f.bin": triangle,
    }
    (tmp_path / "meshes").mkdir()
    for name, content in files.items():
        (tmp_path / "meshes" / name).write_bytes(content)
    names = [name for name in files if name != "f.bin"]
    links = "".join(map(_SHAPE.format, names))
    joint = '<joint name="{0}" type="fixed"><parent link="a.stl"/><child link="{0}"/></joint>'
    joints = "".join(map(joint.format, names[1:]))
    (tmp_path / "robot.urdf").write_text(f'<robot name="meshes">{links}{joints}</robot>')
    robot = eurdf.load(tmp_path / "robot.urdf")
    page = Opened(chromium, tmp_path, page_robot(tmp_path / "robot.urdf"))
    page.page.evaluate(f"async () => {{ {VIEW} await scene.loaded; }}")
    drawn = page.ask(
        "scene.parts.map(({ mesh, link }) => { const p = mesh.geometry.attributes.position;"
        " mesh.updateWorldMatrix(true, false); return [link, Array.from({ length: p.count }, (_, i) =>"
        " mesh.position.clone().fromBufferAttribute(p, i).applyMatrix4(mesh.matrixWorld).toArray())]; })"
    )
    scene = Scene(robot, robot.tree.neutral())
    placed = scene.at(robot.tree.neutral())
    assert len(drawn) == len(scene.parts) == 5
    for part in scene.parts:
        (vertices,) = [np.array(found) for link, found in drawn if link == scene.bodies[part.body]]
        expected = part.vertices_at(placed)
        assert {tuple(each) for each in vertices.round(5) + 0.0} == {tuple(each) for each in expected.round(5) + 0.0}
    page.close()


def test_mesh_that_cannot_be_drawn_is_named(chromium: Any, tmp_path: Path) -> None:
    (tmp_path / "cut.stl").write_bytes(TETRAHEDRON[:100])
    shapes = "".join(
        f'<visual><geometry><mesh filename="{name}"/></geometry></visual>' for name in ("none.obj", "cut.stl", "a.ply")
    )
    (tmp_path / "robot.urdf").write_text(f'<robot name="a"><link name="a">{shapes}</link></robot>')
    page = Opened(chromium, tmp_path, page_robot(tmp_path / "robot.urdf"))
    for name in ("none.obj", "cut.stl", "a.ply"):
        page.page.get_by_text(f"The mesh {name} is not drawn").wait_for()
    page.close()


def test_robot_without_its_meshes_is_grabbed_by_its_bones(chromium: Any, tmp_path: Path) -> None:
    urdf = (ROBOTS / "four_bar/robot.urdf").read_text(encoding="utf-8")
    urdf = re.sub("<geometry>.*?</geometry>", '<geometry><mesh filename="none.stl"/></geometry>', urdf, flags=re.DOTALL)
    (tmp_path / "robot.urdf").write_text(urdf, encoding="utf-8")
    shutil.copy(ROBOTS / "four_bar/robot.yaml", tmp_path)
    page = Opened(chromium, tmp_path, page_robot(tmp_path))
    page.page.get_by_text("The mesh none.stl is not drawn").wait_for()
    before, handle = page.q, page.page.evaluate(_HANDLE)
    page.page.mouse.move(handle["x"], handle["y"])
    page.page.mouse.down()
    page.page.mouse.move(handle["x"] - 10, handle["y"], steps=4)
    page.wait("view.grabbing.held.target === null")
    page.page.mouse.up()
    assert page.q["motor_crank"] != before.get("motor_crank", [0.0])
    assert page.residual < 1e-9
    page.close()


def test_hostile_names_are_inert(chromium: Any, tmp_path: Path) -> None:
    attack = "</script><img src=x onerror=alert(1)>"
    quoted = attack.replace("<", "&lt;").replace(">", "&gt;")
    urdf = (ROBOTS / "four_bar/robot.urdf").read_text(encoding="utf-8")
    yaml = (ROBOTS / "four_bar/robot.yaml").read_text(encoding="utf-8")
    urdf = re.sub(r'<robot name="[^"]*"', f'<robot name="robot {quoted}"', urdf)
    urdf = urdf.replace('"motor_crank"', f'"motor {quoted}"')
    yaml = yaml.replace("[motor_crank]", f"['motor {attack}']").replace("rocker_pin\n", f"'pin {attack}'\n")
    yaml = yaml.replace("assembled: {}", f"assembled: {{}}\n  'start {attack}': {{}}")
    (tmp_path / "robot.urdf").write_text(urdf, encoding="utf-8")
    (tmp_path / "robot.yaml").write_text(yaml, encoding="utf-8")
    page = Opened(chromium, tmp_path, page_robot(tmp_path))
    page.page.get_by_role("button", name=f"start {attack}").wait_for()
    page.slider(f"motor {attack}").fill("0.4")
    assert page.residual < 1e-9
    assert page.page.locator("img").count() == 0
    page.close()
