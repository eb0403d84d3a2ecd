"""Every page of the site in a browser: light and dark, wide and narrow; and what the search finds."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import pytest

from support.browser import axe, barriers, browser, errors_of, scrolls_sideways, served
from support.site import BUILDS_SITE, build_site

pytestmark = BUILDS_SITE

#: Width and height of a screen of a desk and of a phone, in pixels.
DESK, PHONE = (1280, 800), (390, 844)

#: The page that must be among the first three results of a search, or the section of a page.
FOUND = {
    "torque": "humanoids",
    "joints": "joints",
    "mimic": "urdf#mimic-joints",
    "four bar": "robots/four_bar",
    "spherical": "joints#spherical-ball-joint",
    "ball joint": "joints#spherical-ball-joint",
    "motor": "actuation#actuation",
    "hinge": "closures#hinges",
    "mesh": "urdf#shapes",
    "limits": "urdf#joints",
    "mobility": "api_closing#closed-configurations",
    "load": "api_robots#eurdf.load",
    "inverse kinematics": "api_kinematics#eurdf.inverse_kinematics",
    "mujoco": "export_mjcf",
    "diagnostics": "diagnostics",
    "unknown-frame": "diagnostics/unknown-frame",
    "EU-CLO-003": "closures#EU-CLO-003",
}


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[Path, str]]:
    """The folder of the site with all robots, and its address."""
    with browser():  # without one, nothing is built
        pass
    folder = tmp_path_factory.mktemp("site") / "html"
    done = build_site(folder)
    assert (done.returncode, done.stderr) == (0, "")
    with served(folder) as address:
        yield folder, address


def _problems(address: str, names: Sequence[str]) -> list[str]:
    """What is wrong with some pages, each opened on a light desk and a dark phone, and then switched over."""
    problems: list[str] = []
    with browser() as chromium:
        page = chromium.new_page()
        errors = errors_of(page)
        for name in names:
            for screen, scheme, other in ((DESK, "light", "dark"), (PHONE, "dark", "light")):
                width, height = screen
                page.set_viewport_size({"width": width, "height": height})
                page.emulate_media(color_scheme=scheme)
                page.goto(f"{address}/{name}")
                found = [f"{scheme}: {each}" for each in barriers(page)]
                for shown in (scheme, other):
                    page.emulate_media(color_scheme=shown)
                    found += [f"{shown}: it scrolls sideways"] * scrolls_sideways(page)
                problems += [f"{name}, {width} px, {each}" for each in (*found, *errors)]
                errors.clear()
    return problems


def test_every_page_opens_without_an_error_or_a_barrier(site: tuple[Path, str]) -> None:
    axe()  # without it, no page is opened
    folder, address = site
    names = sorted(path.relative_to(folder).as_posix() for path in folder.rglob("*.html"))
    assert len(names) > 200
    with ThreadPoolExecutor(2) as threads:  # each has its browser
        problems = list(threads.map(_problems, (address, address), (names[::2], names[1::2])))
    assert problems == [[], []]


def test_search_finds_the_page_of_a_concept_first(site: tuple[Path, str]) -> None:
    _, address = site
    with browser() as chromium:
        page = chromium.new_page()
        errors = errors_of(page)
        missed: dict[str, Any] = {}
        for words, expected in FOUND.items():
            page.goto(f"{address}/search.html?q={words.replace(' ', '+')}")
            page.get_by_text("Search finished").wait_for()
            page.wait_for_load_state("networkidle")  # the page still fetches what it shows of each result
            links = page.locator("ul.search > li > a")
            first = [links.nth(n).get_attribute("href") for n in range(min(3, links.count()))]
            if expected not in [link.replace(".html", "") for link in first]:
                missed[words] = first
        assert missed == {}
        assert errors == []


def test_old_address_of_a_diagnostic_leads_to_its_page(site: tuple[Path, str]) -> None:
    _, address = site
    with browser() as chromium:
        page = chromium.new_page()
        page.goto(f"{address}/diagnostics.html#unknown-frame")
        page.wait_for_url("**/diagnostics/unknown-frame.html")
        page.goto(f"{address}/diagnostics.html#names")
        assert page.get_by_role("heading", name="Names").is_visible()
        assert page.url.endswith("/diagnostics.html#names")
