"""The page that checks and moves a dropped robot, in a real browser."""

from __future__ import annotations

import io
import json
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

import eurdf
from eurdf_conformance.corpus.case import InvalidCase
from eurdf_conformance.corpus.read import read_cases
from spec.site.clause import ROOT
from spec.site.drop import write_drop_page
from support.browser import POSES, VIEW, barriers, browser, errors_of, scrolls_sideways, served
from support.hostile import HOSTILE, INERTIAL, joint
from support.places import ROBOTS
from support.stl import TETRAHEDRON
from support.wild import ROBOTS as WILD_ROBOTS
from support.wild import needs_wild

pytestmark = pytest.mark.slow

_FOUND = """() => [...document.querySelectorAll("#diagnostics > li")].map((item) =>
  [".drop-severity", "a", ".drop-at"].map((part) => item.querySelector(part).textContent))"""

#: Names that would do something if they were markup, or a property that all objects have.
_NAMES = (
    "<img src=x onerror=alert(1)>",
    "</script><script>alert(1)</script>",
    "__proto__",
    "constructor",
    "${alert(1)}",
)

_COLLECTION = (
    "battobot", "delta", "digit_leg", "double_wishbone", "excavator", "four_bar", "kangaroo_2legs", "reachy_mini",
    "screw_press", "stewart_platform",
)  # fmt: skip


@pytest.fixture(scope="module")
def address(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    site = tmp_path_factory.mktemp("site")
    write_drop_page(site)
    shutil.copytree(ROOT / "spec" / "site" / "static", site / "_static")
    with served(site) as address:
        yield f"{address}/drop.html"


@pytest.fixture(scope="module")
def chromium() -> Iterator[Any]:
    with browser() as started:
        yield started


class Opened:
    """The page, and what it did: errors, dialogs and requests."""

    def __init__(self, chromium: Any, address: str, width: int = 1100, height: int = 700, **options: Any) -> None:
        self.page = chromium.new_context(viewport={"width": width, "height": height}, **options).new_page()
        self.errors = errors_of(self.page)
        self.loads: list[str] = []
        self.page.on("dialog", lambda dialog: (self.errors.append(f"dialog: {dialog.message}"), dialog.dismiss()))
        self.page.on("request", lambda request: self.loads.append(request.url))
        self.address = address
        self.page.goto(address)

    def drop(self, *paths: Path) -> None:
        """Drop files or folders, as a person does."""
        input_ = self.page.context.new_cdp_session(self.page)
        data = {"items": [], "files": [str(path) for path in paths], "dragOperationsMask": 1}
        for kind in ("dragEnter", "dragOver", "drop"):
            input_.send("Input.dispatchDragEvent", {"type": kind, "x": 300, "y": 300, "data": data})
        self.wait()

    def wait(self) -> None:
        """Until nothing more is computed."""
        self.page.wait_for_timeout(100)
        self.page.locator("#message.drop-busy").wait_for(state="hidden", timeout=120_000)

    def press(self, name: str) -> None:
        self.page.get_by_role("button", name=name).first.click()
        self.wait()

    def saved(self, name: str) -> bytes:
        """What a button downloads."""
        with self.page.expect_download() as download:
            self.page.get_by_role("button", name=name).click()
        return Path(download.value.path()).read_bytes()

    def text(self, name: str) -> str:
        shown: str = self.page.locator(f"#{name}").text_content()
        return shown

    @property
    def found(self) -> list[list[str]]:
        """Of each diagnostic, its severity, code and place."""
        found: list[list[str]] = self.page.evaluate(_FOUND)
        return found

    @property
    def q(self) -> dict[str, list[float]]:
        q: dict[str, list[float]] = self.page.evaluate(f"() => {{ {VIEW} return session.q; }}")
        return q

    def close(self) -> None:
        assert self.errors == []
        assert [
            url for url in self.loads if not url.startswith((self.address.rpartition("/")[0], "blob:", "data:"))
        ] == []
        self.page.context.close()


def assert_moves_as_the_reference(page: Opened, robot: eurdf.Robot) -> None:
    """Compare the poses on the page with forward kinematics, at the start and after a motion of each slider."""
    assert page.page.locator("#facts dd").first.text_content() == str(eurdf.analyze(robot).mobility)
    sliders = page.page.locator("input[type=range]")
    assert sliders.count() > 0
    for number in range(-1, min(sliders.count(), 4)):
        if number >= 0:
            slider = sliders.nth(number)
            slider.fill(repr(0.9 * float(slider.input_value()) + 0.1 * float(slider.get_attribute("max"))))
        assert page.page.locator("#loops .drop-open").count() == 0
        q = robot.configuration({name: tuple(each) for name, each in page.q.items()})
        assert np.abs(eurdf.residual(robot, q)).max(initial=0) < 1e-9
        data = robot.model.createData()
        pin.framesForwardKinematics(robot.model, data, q)
        for link, pose in page.page.evaluate(POSES).items():
            expected = data.oMf[robot.model.getFrameId(link, pin.BODY)].homogeneous
            np.testing.assert_allclose(pose, expected, atol=1e-9, err_msg=link)


@pytest.mark.parametrize("name", _COLLECTION)
def test_dropped_robot_moves_as_the_reference_does(chromium: Any, address: str, name: str) -> None:
    page = Opened(chromium, address)
    page.drop(ROBOTS / name)
    assert page.text("verdict") == "Valid"
    assert_moves_as_the_reference(page, eurdf.load(name, geometry=False))
    page.close()


@needs_wild
@pytest.mark.parametrize("name", [name for name, path in WILD_ROBOTS.items() if path.is_dir()])
def test_dropped_published_robot_moves_as_the_reference_does(chromium: Any, address: str, name: str) -> None:
    page = Opened(chromium, address)
    page.drop(WILD_ROBOTS[name])
    assert page.text("verdict").startswith("Valid")
    assert_moves_as_the_reference(page, eurdf.load(WILD_ROBOTS[name], geometry=False))
    page.close()


def test_errors_of_the_suite_have_their_codes_and_places(chromium: Any, address: str, tmp_path: Path) -> None:
    page = Opened(chromium, address)
    wrong = {}
    for case in [each for each in read_cases() if isinstance(each.case, InvalidCase)][::40]:
        folder = tmp_path / case.id
        folder.mkdir()
        case.write(folder)
        page.page.goto("about:blank")
        page.page.goto(address)
        page.drop(*folder.iterdir())
        said = case.case
        place = [said.place.file, said.place.line, said.place.column]
        expected = [said.code, ":".join(str(part) for part in place if part is not None)]
        found = [each for severity, *each in page.found if severity == "error"]
        if found != [expected] and said.code not in ("yaml-syntax", "xml-syntax"):
            wrong[case.name] = found, expected
    assert wrong == {}
    page.close()


def test_names_of_a_file_are_never_markup(chromium: Any, address: str, tmp_path: Path) -> None:
    links = [f"l{number} {name}" for number, name in enumerate(_NAMES)] + list(_NAMES)
    escape = {"<": "&lt;", ">": "&gt;", '"': "&quot;"}
    written = ["".join(escape.get(letter, letter) for letter in link) for link in links]
    joints = "".join(joint(name, "root", name) for name in written)
    elements = "".join(f'<link name="{name}">{INERTIAL}</link>' for name in ("root", *written))
    urdf = f'<robot name="{written[-1]}{written[0]}">{elements}{joints}</robot>'
    right = {"extended_urdf": "2.1", "actuators": links}
    wrong = {**right, "frames": [{"name": f"f {name}", "link": f"{name}?"} for name in _NAMES]}
    for number, description in enumerate((right, wrong)):
        folder = tmp_path / f"{_NAMES[0].replace('/', '')} {number}"
        folder.mkdir()
        (folder / "robot.urdf").write_text(urdf, encoding="utf-8")
        (folder / "robot.yaml").write_text(json.dumps(description), encoding="utf-8")
        page = Opened(chromium, address)
        page.drop(folder)
        assert page.text("verdict") == ("Valid" if description is right else f"{len(_NAMES)} errors")
        assert page.page.locator("#robot img, #robot script, #message *").count() == 0
        if description is right:
            assert page.page.locator("input[type=range]").count() == len(links)
            assert page.page.locator("input[type=range]").first.get_attribute("aria-label") == links[0]
        page.close()


@pytest.mark.parametrize(
    "name",
    [
        "a YAML file of 100 MB",
        "an alias bomb",
        "an entity bomb",
        "100,000 lists in one another",
        "60,000 misspelt elements",
        "20,000 unknown actuators of 3,000 joints",
        "a chain of 10,000 fixed links",
        "a chain of 4,000 joints",
        "500 closures that share 500 joints",
        "a cycle of 10,000 links",
    ],
)
def test_hostile_file_ends_in_a_message(chromium: Any, address: str, tmp_path: Path, name: str) -> None:
    hostile = HOSTILE[name]
    page = Opened(chromium, address)
    written = hostile.write(tmp_path)
    page.drop(*written.parent.iterdir())
    codes = {code for severity, code, _ in page.found if severity == "error"}
    said = page.text("message") + page.text("notes")
    assert hostile.code in codes if hostile.code else "too large" in said or "it takes more than" in said
    page.press("Open another")
    page.drop(ROBOTS / "four_bar")
    assert page.text("verdict") == "Valid"
    page.close()


def test_open_loop_is_shown_assembled_and_written(chromium: Any, address: str, tmp_path: Path) -> None:
    source = (ROBOTS / "delta" / "robot.yaml").read_text(encoding="utf-8")
    opened = source.replace("  assembled: {}", "  # measured on the robot\n  assembled: {motor_1: 0.4}  # rad")
    assert opened != source
    (tmp_path / "robot.yaml").write_text(opened, encoding="utf-8")
    shutil.copy(ROBOTS / "delta" / "robot.urdf", tmp_path)
    report = eurdf.check(tmp_path)
    page = Opened(chromium, address)
    page.drop(*tmp_path.iterdir())
    place = report.errors[0].place
    assert page.found == [["error", "assembled-open", f"robot.yaml:{place.line}:{place.column}"]]
    assert page.page.locator("#loops li").all_text_contents()[0].startswith("rod_2a is open by 0.368 m")
    assert page.page.locator(".drop-labels span").count() == 4
    page.press("Assemble")
    assert page.page.locator("#loops li, .drop-labels span").count() == 0
    page.press("Write this pose")
    assert page.text("verdict") == "Valid"
    corrected = page.saved("Download YAML").decode()
    assert "  # measured on the robot\n  assembled: {motor_1: " in corrected
    assert [line for line in corrected.splitlines() if line not in opened.splitlines()] == [
        line for line in corrected.splitlines() if line.startswith("  assembled: ")
    ]
    (tmp_path / "robot.yaml").write_text(corrected, encoding="utf-8")
    assert eurdf.check(tmp_path).ok
    page.close()


def test_certain_fixes_are_applied_to_the_text(chromium: Any, address: str) -> None:
    page = Opened(chromium, address)
    page.press("A four-bar with two mistakes")
    assert [code for _, code, _ in page.found] == ["unknown-frame", "unknown-actuator"]
    page.press("Fix: write rocker_pin_b")
    page.press("Fix: write motor_crank")
    assert page.text("verdict") == "Valid"
    assert page.saved("Download YAML") == (ROBOTS / "four_bar" / "robot.yaml").read_bytes()
    page.close()


def test_link_holds_the_robot_and_its_pose(chromium: Any, address: str) -> None:
    page = Opened(chromium, address)
    page.press("Leg of Digit")
    page.page.get_by_role("slider", name="motor_knee").fill("-0.3")
    page.press("Copy link")
    other = Opened(chromium, page.page.url)
    other.wait()
    other.page.locator("#facts dd").first.wait_for()
    assert (other.text("name"), other.text("verdict"), other.q) == ("digit_leg", "Valid", page.q)
    for damaged in (page.page.url[:-40], f"{address}#robot=AAAA", f"{address}#robot=!"):
        broken = Opened(chromium, damaged)
        broken.page.get_by_text("The link is damaged").wait_for()
        broken.close()
    other.close()
    page.close()


def test_robot_that_no_link_can_hold_is_refused(chromium: Any, address: str, tmp_path: Path) -> None:
    noise = np.random.default_rng(1).integers(33, 126, 400_000).astype(np.uint8).tobytes().decode().replace("-", "_")
    urdf = (ROBOTS / "four_bar" / "robot.urdf").read_text(encoding="utf-8")
    (tmp_path / "robot.urdf").write_text(f"{urdf}<!-- {noise} -->", encoding="utf-8")
    page = Opened(chromium, address)
    page.drop(tmp_path / "robot.urdf")
    page.press("Copy link")
    assert "send the files instead" in page.text("message")
    page.close()


def test_urdf_with_loops_of_another_dialect_moves(chromium: Any, address: str, tmp_path: Path) -> None:
    robot = eurdf.load("planar_3rrr", geometry=False)
    eurdf.export(robot, "loop-joint").write(tmp_path / "looped")
    shutil.move(tmp_path / "looped" / "robot.urdf", tmp_path / "looped.urdf")
    page = Opened(chromium, address)
    page.drop(tmp_path / "looped.urdf")
    assert page.page.locator("#facts dd").first.text_content() == str(eurdf.analyze(robot).mobility)
    (tmp_path / "robot.yaml").write_bytes(page.saved("Download YAML"))
    assert eurdf.check(tmp_path / "robot.yaml").ok
    assert_moves_as_the_reference(page, eurdf.load(tmp_path / "robot.yaml", geometry=False))
    page.close()


def test_meshes_are_found_in_the_dropped_package(chromium: Any, address: str, tmp_path: Path) -> None:
    for folder in ("urdf", "meshes"):
        (tmp_path / folder).mkdir()
    (tmp_path / "package.xml").write_text("<package><name>arm</name></package>", encoding="utf-8")
    (tmp_path / "meshes" / "part.stl").write_bytes(TETRAHEDRON)
    files = ("package://arm/meshes/part.stl", "../meshes/part.stl", "package://arm/meshes/other.stl", "/etc/a.stl")
    shapes = "".join(f'<visual><geometry><mesh filename="{name}"/></geometry></visual>' for name in files)
    (tmp_path / "urdf" / "arm.urdf").write_text(
        f'<robot name="arm"><link name="a">{shapes}</link></robot>', encoding="utf-8"
    )
    page = Opened(chromium, address)
    page.drop(tmp_path)
    assert page.page.evaluate(f"async () => {{ {VIEW} await scene.loaded; return scene.parts.length; }}") == 2
    assert [code for _, code, _ in page.found] == ["urdf-mesh-missing"]
    page.close()


def test_files_without_a_robot_are_refused_with_what_to_do(chromium: Any, address: str, tmp_path: Path) -> None:
    page = Opened(chromium, address)
    for name, said in (
        ("arm.urdf.xacro", "xacro arm.urdf.xacro > robot.urdf"),
        ("arm.sdf", "eurdf import arm.sdf"),
        ("notes.txt", "no URDF and no description"),
    ):
        (tmp_path / name).write_text("", encoding="utf-8")
        page.drop(tmp_path / name)
        assert said in page.text("message")
    page.close()


def test_robot_is_chosen_among_several(chromium: Any, address: str) -> None:
    page = Opened(chromium, address)
    page.drop(ROBOTS / "four_bar", ROBOTS / "delta")
    assert page.text("name") == "delta"
    page.page.get_by_label("Files of the robot").select_option("four_bar/robot.v1.yaml")
    page.wait()
    assert page.text("name") == "four_bar"
    page.close()


def test_page_can_connect_to_nothing(chromium: Any, address: str) -> None:
    page = Opened(chromium, address)
    refused = "Failed to fetch"
    assert refused in page.page.evaluate(f"fetch({json.dumps(address)}).catch((error) => error.message)")
    assert all("Content Security Policy" in error or "csp" in error for error in page.errors)
    page.page.context.close()


def test_picture_shows_the_robot(chromium: Any, address: str) -> None:
    from PIL import Image

    page = Opened(chromium, address)
    page.press("Leg of Digit")
    picture = Image.open(io.BytesIO(page.saved("Save picture"))).convert("RGB")
    colors = picture.getcolors(maxcolors=1 << 24)
    assert picture.width > 300
    assert len(colors) > 100
    page.close()


@pytest.mark.parametrize(("width", "scheme"), [(1280, "light"), (390, "dark")])
def test_page_has_no_barriers(chromium: Any, address: str, width: int, scheme: Any) -> None:
    page = Opened(chromium, address, width, 844, color_scheme=scheme)
    for example in ("", "Leg of Digit", "A four-bar with two mistakes", "A delta robot with open loops"):
        if example:
            if page.page.get_by_role("button", name="Open another").is_visible():
                page.press("Open another")
            page.press(example)
        assert not scrolls_sideways(page.page)
        assert barriers(page.page) == []
    page.close()
