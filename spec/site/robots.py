"""The pages of the robots of the collection: a gallery, and for each robot a page on which it moves.

They are made when the site is built. A page has no server behind it: its scripts close the loops. The directive
``{live-robot}`` shows a robot that moves on any other page.
"""

from __future__ import annotations

import contextlib
import io
import re
import shutil
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from docutils import nodes
from docutils.nodes import Node
from sphinx.application import Sphinx
from sphinx.config import Config
from sphinx.util.docutils import SphinxDirective

import eurdf
from eurdf.commands.main import main as run_command
from eurdf.viewing.graph import graph_svg
from eurdf.viewing.live_robot import live_view, page_robot
from eurdf.viewing.page_files import page_path
from spec.site.clause import ROOT
from spec.site.pages import on_the_site

#: Folder of the pages, on the site and in the repository.
FOLDER = "robots"

_INTRODUCTION = """\
# Robots

Open a robot, and drag a part or move an actuator: the loops stay closed. Each robot is also a folder of files to start
from, and a name that the commands know: `eurdf view digit_leg`.
"""

_LIVE = "eu-live-robot"  # class of the element with a robot that moves

# A link or picture of Markdown: what is shown, and the target, without its anchor.
_LINK = re.compile(r"(?P<shown>!?\[[^\]]*\])\((?!https?:|#)(?P<path>[^)#\s]+)(?P<anchor>#[^)\s]*)?\)")


def write_robot_pages(folder: Path, robots: Sequence[str]) -> None:
    """Write the source of the gallery and of the pages of some robots of the collection.

    Args:
        folder: The folder that Sphinx reads pages from.
        robots: Names of robots of the collection; without one there is no gallery either.
    """
    if not robots:
        return
    pages = folder / FOLDER
    pages.mkdir()
    for name in robots:
        (pages / f"{name}.md").touch()  # links lead to it
    cards = [_write_page(pages, name) for name in robots]
    toctree = "\n".join(("```{toctree}", ":hidden:", "", *robots, "```"))
    gallery = "\n".join(("::::{container} eu-gallery", *cards, "::::"))
    (pages / "index.md").write_text(f"{_INTRODUCTION}\n{gallery}\n\n{toctree}\n", encoding="utf-8")


def _write_page(pages: Path, name: str) -> str:
    """Write the source of a page and what it shows or offers; return that of the robot's card in the gallery."""
    source, own = ROOT / FOLDER / name, pages / name
    own.mkdir()
    robot = eurdf.load(source)
    files = sorted(file for file in source.iterdir() if file.suffix in (".urdf", ".yaml", ".py"))
    for file in (*files, *source.glob("*.png"), *source.glob("*.svg")):
        shutil.copy(file, own)
    (own / "graph.html").write_text(
        f'<div class="eu-graph" style="overflow-x: auto; padding: 2px 8px">{graph_svg(robot.mechanism)}</div>',
        encoding="utf-8",
    )
    (own / "info.txt").write_text(_info(source), encoding="utf-8")
    title, _, text = (source / "README.md").read_text(encoding="utf-8").partition("\n")
    links = "\n".join(f"- [{file.name}]({name}/{file.name})" for file in files)
    meshes = "" if not (source / "meshes").is_dir() else "\n- meshes: in the folder of the robot in the repository"
    (pages / f"{name}.md").write_text(
        f"{title}\n\n"
        f"```{{live-robot}} {name}\n```\n\n"
        f"{_with_links_of_the_site(text, name, pages).strip()}\n\n"
        f"## Links and loops\n\n```{{raw}} html\n:file: {name}/graph.html\n```\n\n"
        f"## What `eurdf info {name}` says\n\n```{{literalinclude}} {name}/info.txt\n:language: none\n```\n\n"
        f"## Files\n\n{links}{meshes}\n",
        encoding="utf-8",
    )
    analysis, mechanism = eurdf.analyze(robot), robot.mechanism
    title = title.removeprefix("# ")
    loops, actuators = len(mechanism.constraints), len(mechanism.actuators)
    return (
        f":::{{container}} eu-card\n"
        f"```{{image}} {name}/picture.png\n:alt: {title}\n:target: {name}.html\n:loading: lazy\n```\n"
        f"[{title}]({name}.md)\n\n"
        f"{loops} loop{'s' * (loops != 1)}, {actuators} actuator{'s' * (actuators != 1)}, "
        f"mobility {analysis.mobility}\n:::"
    )


def _info(path: Path) -> str:
    """What `eurdf info` prints about a robot."""
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed):
        code = run_command(["info", str(path)])
    if code:
        raise ValueError(f"eurdf info {path} exits with {code}")
    return printed.getvalue()


def _with_links_of_the_site(text: str, name: str, pages: Path) -> str:
    """The text of a robot's README, whose links lead to pages of the site where it has one."""

    def translated(match: re.Match[str]) -> str:
        path = (ROOT / FOLDER / name / match["path"]).resolve()
        if not path.is_relative_to(ROOT):
            return match[0]
        inside = path.relative_to(ROOT)
        if inside.parent == Path(FOLDER) / name:
            target = f"{name}/{inside.name}"
        else:
            found = on_the_site(inside.as_posix(), pages.parent)
            if found is None:
                return match[0]
            target = found if "://" in found else f"/{found}"
        return f"{match['shown']}({target}{match['anchor'] or ''})"

    return _LINK.sub(translated, text)


class LiveRobotDirective(SphinxDirective):
    """``{live-robot}``: a robot of the collection that moves; the content is shown where scripts do not run."""

    has_content = True
    required_arguments = 1

    def run(self) -> list[Node]:
        """The robot, and what replaces it."""
        view = live_view(page_robot(ROOT / FOLDER / self.arguments[0]))
        shown: list[Node] = [nodes.raw("", view, format="html", classes=[_LIVE])]
        if self.content:
            start, end = (nodes.raw("", tag, format="html") for tag in ("<noscript>", "</noscript>"))
            shown += [start, *self.parse_content_to_nodes(), end]
        return shown


def _add_script(app: Sphinx, page: str, template: str, context: dict[str, Any], tree: nodes.document | None) -> None:
    """Load the script and the style of live robots on the pages that have one."""
    if tree is not None and any(_LIVE in raw["classes"] for raw in tree.findall(nodes.raw)):
        app.add_css_file("page.css")
        app.add_js_file("page.js", loading_method="defer")


def _publish(app: Sphinx, config: Config) -> None:
    config.html_static_path += [str(page_path(name)) for name in ("page.js", "page.css")]


def setup(app: Sphinx) -> None:
    """Add the directive, and publish the script and the style of the pages."""
    app.add_directive("live-robot", LiveRobotDirective)
    app.connect("html-page-context", _add_script)
    app.connect("config-inited", _publish)
