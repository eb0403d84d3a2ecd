"""The viewer in a real browser."""

from __future__ import annotations

import io
import math
import re
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import eurdf
from support.browser import browser
from support.places import ROBOTS

pytestmark = pytest.mark.slow

MISSING = "viser is not installed: pip install -e '.[view]'"


@pytest.fixture(scope="module")
def chromium() -> Iterator[Any]:
    pytest.importorskip("viser", reason=MISSING)
    with browser() as started:
        yield started


def until(condition: Callable[[], bool], page: Any) -> None:
    for _ in range(600):
        if condition():
            return
        page.wait_for_timeout(50)
    raise AssertionError("it did not happen within 30 s")


def opened(chromium: Any, url: str) -> tuple[Any, list[str]]:
    """A page that shows the robot, and its errors."""
    page = chromium.new_page(viewport={"width": 900, "height": 700})
    errors: list[str] = []
    page.on("pageerror", lambda error: errors.append(str(error)))
    page.on("dialog", lambda dialog: (errors.append(f"dialog: {dialog.message}"), dialog.dismiss()))
    page.goto(url)
    return page, errors


def drag_slider(page: Any, number: int, part: float) -> None:
    """Drag the thumb of a slider to a part of its length."""
    thumb = page.get_by_role("slider").nth(number)
    thumb.wait_for()
    track = thumb.locator("xpath=..").bounding_box()
    at = thumb.bounding_box()
    page.mouse.move(at["x"] + at["width"] / 2.0, at["y"] + at["height"] / 2.0)
    page.mouse.down()
    page.mouse.move(track["x"] + part * track["width"], at["y"] + at["height"] / 2.0, steps=8)
    page.mouse.up()


def picture(page: Any) -> Any:
    """What a page has drawn."""
    from PIL import Image

    return Image.open(io.BytesIO(page.locator("canvas").first.screenshot(timeout=60_000))).convert("RGB")


def colors(page: Any) -> int:
    """How many colours the picture of a page has: one or few if nothing is drawn."""
    return len(picture(page).getcolors(1 << 24))


def changed(before: Any, after: Any) -> float:
    """The part of a picture whose pixels differ visibly, beside the panel."""
    beside = (slice(None), slice(0, before.width - 420))
    a, b = (np.asarray(each, dtype=int)[beside] for each in (before, after))
    return float((np.abs(a - b).max(axis=2) > 30).mean())


def still_picture(page: Any) -> Any:
    """What a page has drawn once it draws the same twice."""
    found = [picture(page)]

    def is_still() -> bool:
        page.wait_for_timeout(500)
        found.append(picture(page))
        return changed(*found[-2:]) < 1e-4

    until(is_still, page)
    return found[-1]


def test_slider_moves_the_robot_with_loops_closed(chromium: Any) -> None:
    with eurdf.view("digit_leg", port=0) as viewer:
        page, errors = opened(chromium, viewer.url)
        page.get_by_text("loops are closed").wait_for()
        session = viewer._first.session
        knee = next(index for index, slider in enumerate(session.sliders) if slider.joint == "motor_knee")
        first = viewer.q
        drag_slider(page, knee, 0.3)
        slider = session.sliders[knee]
        goal = slider.lower + 0.3 * (slider.upper - slider.lower)
        until(lambda: abs(session.value(knee) - goal) < 0.1, page)
        assert np.abs(eurdf.residual(viewer.robot, viewer.q)).max() < 1e-9
        assert np.abs(viewer.q - first).max() > 0.1

        # To the end of an ankle motor, where a passive joint stops it: the thumb returns to where the robot is.
        shin = next(index for index, slider in enumerate(session.sliders) if slider.joint == "motor_shin1")
        drag_slider(page, shin, 1.0)
        page.get_by_text("passive joint 'free_foot2' is at its position limit").wait_for()
        assert np.abs(eurdf.residual(viewer.robot, viewer.q)).max() < 1e-9
        shown = page.get_by_role("slider").nth(shin)
        until(
            lambda: math.isclose(float(shown.get_attribute("aria-valuenow")), session.value(shin), abs_tol=1e-3), page
        )
        assert session.value(shin) < session.sliders[shin].upper - 0.1

        page.get_by_role("button", name="reset").click()
        until(lambda: np.array_equal(viewer.q, first), page)
        assert colors(page) > 500  # a robot is drawn
        page.get_by_role("tab", name="Robot").click()
        page.get_by_text("distance to singularity").wait_for()
        page.get_by_text("no errors, no warnings").wait_for()
        assert errors == []
        page.close()


def test_slider_moves_what_is_drawn(chromium: Any) -> None:
    """The bodies themselves, without dots and lines, and back again."""
    with eurdf.view("digit_leg", port=0) as viewer:
        page, errors = opened(chromium, viewer.url)
        page.set_viewport_size({"width": 1200, "height": 800})
        page.get_by_text("loops are closed").wait_for()
        viewer._worker.call(lambda: viewer._first.figure.toggle("closures", False))
        before = still_picture(page)
        drag_slider(page, 0, 0.2)
        until(lambda: changed(before, picture(page)) > 0.015, page)
        page.get_by_role("button", name="reset").click()
        until(lambda: changed(before, picture(page)) < 0.006, page)  # but for the shadow, which viser draws once
        assert errors == []
        page.close()


def test_page_says_when_the_server_has_ended(chromium: Any) -> None:
    with eurdf.view("four_bar", port=0) as viewer:
        page, errors = opened(chromium, viewer.url)
        page.get_by_text("loops are closed").wait_for()
        ended = page.get_by_text("the viewer has ended; run `eurdf view …` again")
        page.wait_for_timeout(3000)
        assert not ended.is_visible()
        port = int(viewer.url.rpartition(":")[2])
    ended.wait_for(timeout=30_000)
    with eurdf.view("four_bar", port=port):
        ended.wait_for(state="hidden", timeout=30_000)
    assert errors == []
    page.close()


def test_dragged_frame_moves_the_robot_with_loops_closed(chromium: Any) -> None:
    with eurdf.view("digit_leg", port=0) as viewer:
        page, errors = opened(chromium, viewer.url)
        page.set_viewport_size({"width": 1200, "height": 800})
        page.get_by_text("loops are closed").wait_for()
        page.locator("input[value='(none)']").first.click()
        page.get_by_role("option", name="foot", exact=True).click()
        until(lambda: viewer._panel._move._gizmo._handle is not None, page)
        page.wait_for_timeout(2000)  # until it is drawn
        first = viewer.q
        page.mouse.move(623, 563)  # the arrow up, as the camera sees it at the start
        page.wait_for_timeout(500)
        page.mouse.down()
        page.mouse.move(623, 530, steps=6)
        page.wait_for_timeout(500)
        page.mouse.up()
        until(lambda: np.abs(viewer.q - first).max() > 0.05, page)
        assert np.abs(eurdf.residual(viewer.robot, viewer.q)).max() < 1e-9
        assert errors == []
        page.close()


def test_motion_plays_and_pauses(chromium: Any) -> None:
    with eurdf.view("four_bar", port=0) as viewer:
        page, errors = opened(chromium, viewer.url)
        page.get_by_role("tab", name="Play").click()
        page.get_by_role("button", name="gravity").click()
        page.get_by_text(re.compile(r"gravity: \d+\.\d\d s")).wait_for()
        page.get_by_role("button", name="pause").click()
        page.get_by_role("button", name="continue").wait_for()
        q = viewer.q
        page.wait_for_timeout(200)
        assert (viewer.q == q).all()
        page.get_by_role("button", name="continue").click()
        until(lambda: not np.array_equal(viewer.q, q), page)
        assert np.abs(eurdf.residual(viewer.robot, viewer.q)).max() < 1e-9
        assert errors == []
        page.close()


def test_saved_page_shows_the_robot_offline(chromium: Any, tmp_path: Path) -> None:
    with eurdf.view("four_bar", port=0) as viewer:
        file = viewer.save(tmp_path / "scene.html")
    context = chromium.new_context(offline=True, viewport={"width": 600, "height": 400})
    page = context.new_page()
    requests: list[str] = []
    page.on("request", lambda request: requests.append(request.url))
    page.goto(file.as_uri())
    page.locator("canvas").first.wait_for()
    until(lambda: colors(page) > 200, page)
    assert [url for url in requests if not url.startswith(("file:", "data:", "blob:"))] == []
    context.close()


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
    with eurdf.view(tmp_path, port=0) as viewer:
        assert attack in viewer.robot.mechanism.actuators[0]
        page, errors = opened(chromium, viewer.url)
        page.get_by_text("loops are closed").wait_for()
        page.get_by_text(f"motor {attack}").first.wait_for()
        page.get_by_role("tab", name="Show").click()
        for label in ("link names", "joint axes", "frames"):
            if page.get_by_label(label, exact=True).count():
                page.get_by_label(label, exact=True).click()
        viewer.show(viewer.robot.tree.integrate(viewer.q, np.full(viewer.robot.tree.nv, 0.3)))
        page.get_by_text(f"'pin {attack}'").first.wait_for()  # the open closure
        (tmp_path / "robot.yaml").write_text(yaml + "unknown: 1\n'bad " + attack + "': 2\n")
        page.get_by_text("the files changed and have errors").wait_for()
        page.get_by_role("tab", name="Robot").click()
        page.get_by_text("bad <img src=x onerror=alert(1)>{alert(2)}").first.wait_for()  # long names are shortened
        page.wait_for_timeout(500)
        assert page.locator("img[src=x]").count() == 0
        assert page.locator("a[href^=javascript]").count() == 0
        assert errors == []
        page.close()
