"""A live page in a real browser, from a file and offline."""

from __future__ import annotations

import io
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

import eurdf
from eurdf.viewing.live_robot import live_page
from support.browser import browser
from support.places import ROBOTS

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def chromium() -> Iterator[Any]:
    with browser() as started:
        yield started


def opened(
    chromium: Any, folder: Path, robot: eurdf.Robot, width: int = 1000, height: int = 700, scheme: str = "light"
) -> tuple[Any, list[str], list[str]]:
    """A page that shows the robot, its errors, and what it loads."""
    file = folder / "page.html"
    file.write_text(live_page(robot), encoding="utf-8")
    size = {"width": width, "height": height}
    page = chromium.new_context(offline=True, viewport=size, color_scheme=scheme).new_page()
    errors: list[str] = []
    loads: list[str] = []
    page.on("pageerror", lambda error: errors.append(str(error)))
    page.on("console", lambda message: errors.append(message.text) if message.type == "error" else None)
    page.on("dialog", lambda dialog: (errors.append(f"dialog: {dialog.message}"), dialog.dismiss()))
    page.on("request", lambda request: loads.append(request.url))
    page.goto(file.as_uri())
    page.get_by_text("The loops are closed").wait_for()
    return page, errors, loads


def residual(page: Any) -> float:
    return float(page.get_by_role("status").get_attribute("data-residual"))


def drawn(page: Any) -> Any:
    """What the canvas shows, and how many colours that has."""
    from PIL import Image

    page.wait_for_timeout(300)  # until it is drawn
    image = Image.open(io.BytesIO(page.locator("canvas").screenshot(timeout=60_000))).convert("RGB")
    return image, len(image.getcolors(1 << 24))


def changed(one: Any, other: Any) -> int:
    """How many pixels differ clearly."""
    from PIL import ImageChops

    return sum(ImageChops.difference(one, other).convert("L").histogram()[40:])


def test_sliders_move_the_drawn_robot_with_loops_closed(chromium: Any, tmp_path: Path) -> None:
    page, errors, loads = opened(chromium, tmp_path, eurdf.load("digit_leg"))
    before, colors = drawn(page)
    assert colors > 200  # a robot is drawn
    knee, shin = (page.get_by_role("slider", name=name) for name in ("motor_knee", "motor_shin1"))
    knee.fill("-0.6")
    assert residual(page) < 1e-9
    assert page.evaluate("document.querySelector('.eu-live').page.motion.value(3)") == pytest.approx(-0.6, abs=1e-12)
    after, _ = drawn(page)
    assert changed(before, after) > 1000
    shin.fill(shin.get_attribute("max"))
    page.get_by_text("Passive joint “free_foot").wait_for()
    assert residual(page) < 1e-9
    assert float(shin.input_value()) < float(shin.get_attribute("max")) - 0.1

    page.get_by_role("button", name="Reset").click()
    assert changed(before, drawn(page)[0]) == 0
    page.get_by_label("Loops").check()
    assert changed(before, drawn(page)[0]) > 1000
    page.get_by_label("Loops").uncheck()
    box = page.locator("canvas").bounding_box()
    page.mouse.move(box["x"] + 100, box["y"] + 100)
    page.mouse.down()
    page.mouse.move(box["x"] + 250, box["y"] + 120, steps=3)
    page.mouse.up()
    assert changed(before, drawn(page)[0]) > 1000

    page.get_by_role("button", name="Play").click()
    page.wait_for_timeout(1000)
    page.get_by_role("button", name="Pause").click()
    assert residual(page) < 1e-9
    assert abs(page.evaluate("document.querySelector('.eu-live').page.motion.value(0)")) > 0.01
    assert errors == []
    assert len(loads) == 1  # the page itself
    page.context.close()


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

    page, errors, _ = opened(chromium, tmp_path, eurdf.load(name), width, height, scheme)
    assert page.get_by_role("heading", level=1).text_content() == name
    size = "[document.documentElement.scrollWidth, document.documentElement.scrollHeight]"
    assert page.evaluate(size) == [width, height]
    for each in ("footer", ".eu-live-status"):
        box = page.locator(each).bounding_box()
        assert 0 < box["y"] < box["y"] + box["height"] < height
    canvas = page.locator("canvas").bounding_box()
    assert canvas["width"] * canvas["height"] > 0.35 * width * height

    whole = Image.open(io.BytesIO(page.screenshot(timeout=60_000)))
    before, _ = drawn(page)
    corners = lightness(whole, (2, 2)), lightness(before, (5, 5)), lightness(before, (5, before.height - 5))
    assert all(corner < 80 if scheme == "dark" else corner > 230 for corner in corners)

    page.get_by_role("slider").first.fill("0.3")
    assert residual(page) < 1e-9
    assert changed(before, drawn(page)[0]) > 20
    page.get_by_role("button", name="Reset").click()
    page.evaluate("(({drawing}) => { drawing.parts = []; })(document.querySelector('.eu-live').page)")
    page.get_by_role("button", name="Reset").click()  # draws the ground alone
    robot = ImageChops.difference(before, drawn(page)[0]).convert("L").point(lambda value: 255 * (value > 12))
    left, top, right, bottom = robot.getbbox()
    assert min(left, top, before.width - right, before.height - bottom) > 2  # head and foot are in the picture
    assert max((right - left) / before.width, (bottom - top) / before.height) > 0.5
    assert errors == []
    page.context.close()


def test_theme_that_the_user_chooses_repaints_the_robot(chromium: Any, tmp_path: Path) -> None:
    page, errors, _ = opened(chromium, tmp_path, eurdf.load("double_wishbone"))
    light, _ = drawn(page)
    page.evaluate("document.body.dataset.theme = 'dark'")
    dark, _ = drawn(page)
    assert lightness(light, (5, 5)) > 230
    assert lightness(dark, (5, 5)) < 80
    # The tyre is nearly black; where the page is dark, it is lighter.
    assert sum(dark.convert("L").histogram()[:36]) < 0.1 * sum(light.convert("L").histogram()[:36])
    page.evaluate("document.body.dataset.theme = 'light'")
    assert changed(light, drawn(page)[0]) == 0
    page.evaluate("delete document.body.dataset.theme")
    page.emulate_media(color_scheme="dark")
    assert changed(dark, drawn(page)[0]) < 100  # the border differs at the corners
    assert errors == []
    page.context.close()


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
    page, errors, _ = opened(chromium, tmp_path, eurdf.load(tmp_path))
    page.get_by_role("button", name=f"start {attack}").wait_for()
    slider = page.get_by_role("slider", name=f"motor {attack}")
    slider.fill("0.4")
    assert residual(page) < 1e-9
    assert page.locator("img").count() == 0
    assert errors == []
    page.context.close()
