"""The site of the specification: built as published, every page is complete and needs nothing else."""

from __future__ import annotations

import json
import re
import shutil
from functools import cache
from pathlib import Path

import pytest
from lxml import html

import eurdf
from eurdf.diagnostics import REGISTRY
from spec.site.citation import case_citations
from spec.site.clause import ROOT, SPEC, read_chapters, read_clauses
from spec.site.pages import address
from support.browser import browser
from support.public import MODULES, own_names
from support.site import BUILDS_SITE, build_site

#: The robots that get a page here; each takes time.
ROBOTS = ("digit_leg", "digit_leg_3d")

pytestmark = BUILDS_SITE


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The site; its build fails if a link is broken or a page loads something from another site."""
    folder = tmp_path_factory.mktemp("site") / "html"
    done = build_site(folder, robots=ROBOTS)
    assert done.returncode == 0, done.stderr
    assert done.stderr == ""
    return folder


@cache
def _anchors(site: Path, page: str) -> list[str]:
    from spec.site.links import read_page

    return list(read_page((site / f"{page}.html").read_text(encoding="utf-8")).anchors.elements())


def test_every_clause_has_anchor_in_its_chapter(site: Path) -> None:
    for clause in read_clauses(read_chapters()):
        assert _anchors(site, clause.chapter).count(clause.id) == 1, clause.id


def test_pages_of_docs_are_on_the_site(site: Path) -> None:
    assert [page.stem for page in (ROOT / "docs").glob("*.md") if not (site / f"{page.stem}.html").exists()] == []
    assert 'href="simulators.html"' in (site / "export.html").read_text(encoding="utf-8")
    adapters = (site / "write_an_adapter.html").read_text(encoding="utf-8")
    assert f"{address('Source')}/blob/main/conformance/eurdf_conformance/certificate/" in adapters


def test_first_screen_moves_and_leads_on(site: Path) -> None:
    page = (site / "index.html").read_text(encoding="utf-8")
    first = page[page.index("eu-start") : page.index("robot.yaml", page.index("</noscript>"))]
    robot, without_scripts = first.split("<noscript>")
    assert 'src="_static/page.js' in page
    assert len(robot) < 40_000
    assert '<img alt="The foot of Digit' in without_scripts
    assert 'src="_images/digit_leg.webp"' in without_scripts
    assert "page.js" not in (site / "tutorial.html").read_text(encoding="utf-8")
    targets = (
        "robots/digit_leg.html",
        "robots/index.html",
        "drop.html",
        "tutorial.html",
        "scope.html",
        "write_an_adapter.html",
    )
    assert [target for target in targets if f'href="{target}"' not in first] == []


def test_robot_page_shows_motion_figures_graph_and_files(site: Path) -> None:
    page = (site / "robots/digit_leg.html").read_text(encoding="utf-8")
    data = page[page.index('<script type="application/json">') + 32 :]
    files = json.loads(data[: data.index("</script>")])
    for key, name in (("urdf", "robot.urdf"), ("description", "robot.yaml")):
        assert files[key]["text"] == (ROOT / "robots/digit_leg" / name).read_text(encoding="utf-8")
    text = _text(site / "robots/digit_leg.html")
    for shown in ("Where the figures come from", "mobility 9 degrees of freedom", "achilles (6d)"):
        assert shown in text
    for name in ("robot.urdf", "robot.yaml", "build.py"):
        assert f'/{name}"' in page
    other = (site / "robots/digit_leg_3d.html").read_text(encoding="utf-8")
    assert 'href="digit_leg.html"' in other  # a README's link to another robot
    gallery = (site / "robots/index.html").read_text(encoding="utf-8")
    assert all(f'href="{robot}.html"' in gallery for robot in ROBOTS)


def test_every_diagnostic_has_a_page_with_what_is_printed(site: Path) -> None:
    rows = _anchors(site, "diagnostics")
    index = (site / "diagnostics.html").read_text(encoding="utf-8")
    for code, rule in REGISTRY.items():
        assert rows.count(code) == 1
        assert f'href="diagnostics/{code}.html"' in index
        assert rule.title in _text(site / f"diagnostics/{code}.html")
    page = _text(site / "diagnostics/unknown-frame.html")
    assert "is not a link, joint or frame of the robot" in page
    assert "fix: write" in page


@pytest.mark.parametrize(
    ("page", "schema"),
    [("schema_1", "extended-urdf-1"), ("schema_2", "extended-urdf-2.0"), ("schema_2_1", "extended-urdf-2.1")],
)
def test_every_schema_property_has_anchor_and_description(site: Path, page: str, schema: str) -> None:
    content = json.loads((ROOT / "schema" / f"{schema}.schema.json").read_text(encoding="utf-8"))
    anchors, text = _anchors(site, page), _text(site / f"{page}.html")
    for name, definition in {"file": content, **content["$defs"]}.items():
        assert name in anchors
        for key, value in definition.get("properties", {}).items():
            assert f"{name}.{key}" in anchors
            assert " ".join(value["description"].split()) in text


def test_every_anchor_of_the_search_exists_and_has_text(site: Path) -> None:
    index = json.loads(
        (site / "searchindex.js").read_text(encoding="utf-8").removeprefix("Search.setIndex(").rstrip(")")
    )
    anchors = {(page, anchor) for places in index["alltitles"].values() for page, anchor in places if anchor}
    anchors |= {(page, anchor) for places in index["indexentries"].values() for page, anchor, _ in places}
    for prefix, objects in index["objects"].items():
        for page, kind, _, anchor, name in objects:
            full = f"{prefix}.{name}" if prefix else name
            anchors.add((page, {"": full, "-": f"{index['objnames'][str(kind)][1]}-{full}"}.get(anchor, anchor)))
    assert len(anchors) > 1000
    pages = {page: html.parse(str(site / f"{index['docnames'][page]}.html")) for page, _ in anchors}
    named = {(page, each.get("id")): each for page, tree in pages.items() for each in tree.iterfind(".//*[@id]")}
    assert [place for place in anchors if not (place in named and named[place].text_content().strip())] == []


def test_every_public_name_is_documented_once(site: Path) -> None:
    pages = {page.stem: _anchors(site, page.stem) for page in site.glob("api_*.html")}
    expected = [f"eurdf.{name}" for name in own_names(eurdf)]
    for module in MODULES:
        names = own_names(getattr(eurdf, module)).keys() - own_names(eurdf).keys() - {"Portable"}
        if module == "batch":
            names = own_names(eurdf.batch)
        expected += [f"eurdf.{module}.{name}" for name in names]
    shown = [name for anchors in pages.values() for name in anchors if re.fullmatch(r"eurdf(\.[a-z]\w*)?\.\w+", name)]
    assert sorted(shown) == sorted(expected)


def test_docstring_has_links_shapes_and_errors(site: Path) -> None:
    page = (site / "api_closing.html").read_text(encoding="utf-8")
    assert 'href="closures.html#EU-CLO-008"' in page
    assert 'href="diagnostics/urdf-no-range.html"' in page
    assert 'id="eurdf.results.Analysis.mobility"' in page
    text = _text(site / "api_closing.html")
    assert "eurdf.assemble(robot: Robot | RobotSource, q0: Named | None = None, *, hold: str" in text
    assert "q0: Where to start (nq,)" in text
    assert "ValueError: q0 or hold_at is not a configuration" in text
    assert "B<sub>J</sub> = B A⁺" in (site / "api_transmissions.html").read_text(encoding="utf-8")
    assert "progress: Callable[[int, int], None] | None = None" in _text(site / "api_batch.html")


def test_public_names_in_pages_are_links(site: Path) -> None:
    page = (site / "toolbox.html").read_text(encoding="utf-8")
    assert 'href="api_closing.html#eurdf.assemble"' in page
    assert 'href="api_batch.html#module-eurdf.batch"' in page


def test_clause_folds_its_cases_and_links_them(site: Path) -> None:
    page = (site / "closures.html").read_text(encoding="utf-8")
    clause = page[page.index('id="EU-CLO-002"') : page.index('id="EU-CLO-003"')]
    shown, folded = clause.split("<details", 1)
    assert "MUST NOT" in shown
    cases = [citation for citation in case_citations() or () if citation.clause == "EU-CLO-002"]
    assert f"</span> {len(cases)} cases</summary>" in folded
    for case in cases:
        url = f"{address('Source')}/blob/main/conformance/eurdf_conformance/corpus/cases/{case.source}.yaml"
        assert f'<a href="{url}#L1"><code>{case.source}</code></a>' in folded


def _text(page: Path) -> str:
    from html.parser import HTMLParser

    pieces: list[str] = []

    class Reader(HTMLParser):
        def handle_data(self, data: str) -> None:
            pieces.append(data)

    Reader().feed(page.read_text(encoding="utf-8"))
    return " ".join("".join(pieces).split())


def _small_site(folder: Path, text: str) -> Path:
    """The source of a site with one page, as the specification is set up otherwise."""
    source = folder / "spec"
    source.mkdir()
    for name in ("conf.py", "clauses.json", "clauses.schema.json"):
        shutil.copy(SPEC / name, source)
    shutil.copytree(SPEC / "site" / "static", source / "site" / "static")
    shutil.copytree(ROOT / "schema", folder / "schema")
    (source / "drawing.svg").write_text('<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 9 9"/>', encoding="utf-8")
    (source / "index.md").write_text(text, encoding="utf-8")
    return source


def test_broken_reference_fails_the_build(tmp_path: Path) -> None:
    source = _small_site(
        tmp_path,
        """\
# A page

[There](index.md#nowhere), {clause}`EU-TST-001`, {code}`no-such-code`, $\\nosuchcommand{x}$.

![](drawing.svg)

:::{diagnostic} unknown-frame
:place: the name
```diff
-no such line
+another
```
:::

:::{container}
```{index} ! nothing
```
:::
""",
    )
    done = build_site(tmp_path / "html", source, ())
    assert done.returncode != 0
    for message in (
        "local id not found in doc 'index': 'nowhere'",
        "clause reference target not found: EU-TST-001",
        "code reference target not found: no-such-code",
        "an unknown command: \\nosuchcommand",
        "the figure has no alternative text: add alt",
        "the lines to replace occur 0 times",
        "{index} must be in a section",
    ):
        assert message in done.stderr


def test_external_picture_fails_the_build(tmp_path: Path) -> None:
    source = _small_site(tmp_path, "# A page\n\n![A picture](https://example.org/picture.png)\n")
    done = build_site(tmp_path / "html", source, ())
    assert (done.returncode, done.stderr) == (
        1,
        "index.html: 'https://example.org/picture.png' is loaded from another site\n",
    )


def test_page_links_are_parsed_like_a_browser(tmp_path: Path) -> None:
    from spec.site.links import site_errors

    (tmp_path / "a.html").write_text(
        '<html><head><link rel="stylesheet" href="//cdn.example.org/a.css"><link rel="canonical" href="https://a.b/">'
        '<style>@import "https://a.b/c.css";</style><script src="b.js"></script></head>'
        '<body><p id="x"></p><p id="x"></p><a href="#x">1</a><a href="#y">2</a><a href="b.html">3</a>'
        '<a href="https://example.org/">4</a><img src="data:image/png;base64,AA" srcset="http://a.b/1.png 2x">'
        "</body></html>",
        encoding="utf-8",
    )
    (tmp_path / "c.css").write_text("@font-face { src: url('https://fonts.example.org/f.woff2'); }", encoding="utf-8")
    assert sorted(site_errors(tmp_path)) == [
        "a.html: '#y' is broken",
        "a.html: '//cdn.example.org/a.css' is loaded from another site",
        "a.html: 'b.html' is broken",
        "a.html: 'b.js' does not exist",
        "a.html: 'http://a.b/1.png' is loaded from another site",
        "a.html: 'https://a.b/c.css' is loaded from another site",
        "a.html: the id 'x' occurs 2 times",
        "c.css: 'https://fonts.example.org/f.woff2' is loaded from another site",
    ]


def test_equation_becomes_mathml_with_source() -> None:
    from spec.site.math import mathml

    shown = mathml(r"q < \frac{\theta}{2}", display=True)
    assert shown.startswith('<math alttext="q &lt; \\frac{\\theta}{2}" ')
    assert "<mfrac>" in shown
    assert 'display="block"' in shown
    with pytest.raises(ValueError, match="nosuchcommand"):
        mathml(r"\nosuchcommand", display=False)


def test_drawing_has_page_colours_and_alt_text() -> None:
    from spec.site.figures import inline_svg

    svg = '<?xml version="1.0"?>\n<svg viewBox="0 0 1 1"><path id="a"/><use href="#a"/><path fill="url(#a)"/></svg>'
    assert inline_svg(svg, "bar", 'a "bar"') == (
        '<svg role="img" class="eu-drawing" aria-label="a &quot;bar&quot;" viewBox="0 0 1 1">'
        '<path id="bar-a"/><use href="#bar-a"/><path fill="url(#bar-a)"/></svg>'
    )


def test_code_schemas_and_pages_state_no_address_of_the_project() -> None:
    addresses = address("Documentation"), address("Source")
    folders = "conformance/eurdf_conformance", "docs", "reference", "schema", "spec"
    files = [path for folder in folders for kind in ("json", "md", "py") for path in (ROOT / folder).rglob(f"*.{kind}")]
    assert len(files) > 500
    # Metadata of distributions repeat them; `test_packaging.py` compares these.
    files = [path for path in files if path.name != "package.json"]
    assert [path for path in files if any(url in path.read_text(encoding="utf-8") for url in addresses)] == []


def test_robot_moves_on_its_page_from_a_file_and_offline(tmp_path: Path) -> None:
    with browser() as chromium:  # first: without one, nothing is built
        source = _small_site(tmp_path, "# Site\n\n```{toctree}\nrobots/index\n```\n")
        done = build_site(tmp_path / "html", source, ("five_bar_3d",))
        assert (done.returncode, done.stderr) == (0, "")
        page = chromium.new_context(offline=True, viewport={"width": 360, "height": 700}).new_page()
        errors: list[str] = []
        page.on("pageerror", lambda error: errors.append(str(error)))
        page.on("console", lambda message: errors.append(message.text) if message.type == "error" else None)
        page.goto((tmp_path / "html/robots/index.html").as_uri())
        page.get_by_role("link", name="Five-bar linkage").last.click()
        page.get_by_text("The loops are closed").wait_for()
        motors = page.get_by_role("slider")
        assert motors.count() == 2
        for index, value in enumerate(("0.2", "-0.1")):
            motors.nth(index).fill(value)
        moved = page.evaluate(
            "(({ session }) => session.coordinates.map((each) => session.value(each)))"
            "(document.querySelector('.eu-live').view)"
        )
        assert moved == pytest.approx([0.2, -0.1], abs=1e-12)
        assert float(page.locator(".eu-live-status").get_attribute("data-residual")) < 1e-9
        assert page.evaluate("document.documentElement.scrollWidth") <= 360
        assert errors == []


def test_index_contains_every_clause(site: Path) -> None:
    text = _text(site / "all_clauses.html")
    for clause in read_clauses(read_chapters()):
        assert clause.id in text


def test_schemas_and_registry_are_published(site: Path) -> None:
    for name in ("extended-urdf-1.schema.json", "extended-urdf-2.0.schema.json", "clauses.json", "clauses.schema.json"):
        json.loads((site / name).read_text(encoding="utf-8"))


def test_equations_of_a_line_are_separate() -> None:
    from spec.site.math import separate_equations

    assert separate_equations(r"a = b , \qquad c = d .") == ["a = b , ", " c = d ."]
    matrix = r"\begin{matrix} a \qquad b \end{matrix}"
    assert separate_equations(matrix) == [matrix]
