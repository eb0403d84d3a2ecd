"""The pages of the site: the chapters of the specification beside the pages of `docs`, all in one folder.

A link works in both places: on the code host it leads to the file in the repository, on the site to the page of that
file, or to the code host if the site has no page of it.
"""

from __future__ import annotations

import re
import shutil
import sys
from functools import cache
from pathlib import Path

from sphinx.application import Sphinx
from sphinx.util import logging

from spec.site.clause import ROOT

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

_LOGGER = logging.getLogger(__name__)

#: Folders of pages, relative to the root of the repository.
FOLDERS = ("spec", "docs")

#: Pages that are below another one in the table of contents, as a pattern. The page itself has no toctree, which the
#: code host would show as code.
BELOW = {"export.md": "export_*.md"}

#: The page that checks a dropped robot, as a file of the repository.
DROP_PAGE = "js/page/drop.html"

# The target of a link or picture out of the folder of the page, or of a link to a page in a folder below, without its
# anchor.
_OUTSIDE = re.compile(r"(?<=\]\()(?:\.\./(?P<path>[^)#\s]+)|(?P<below>\w+/[^)#\s]+\.md))")


def page_files(source: Path) -> dict[str, Path]:
    """The files of the pages, by name.

    Args:
        source: The folder of the specification; that of the other pages is beside it.

    Raises:
        ValueError: Two files have the same name.
    """
    pages: dict[str, Path] = {}
    for folder in (source, source.parent / "docs"):
        for path in sorted(folder.glob("*.md")):
            if path.name == "README.md":
                continue
            if path.name in pages:
                raise ValueError(f"two pages have the name {path.name}: {pages[path.name]} and {path}")
            pages[path.name] = path
    return pages


def gather(folder: Path, source: Path) -> None:
    """Copy all pages, and the files that they show or offer, into one folder, from which Sphinx reads them."""
    for name, path in page_files(source).items():
        shutil.copyfile(path, folder / name)
    for name, below in BELOW.items():
        if pages := sorted(path.stem for path in folder.glob(below)):
            with (folder / name).open("a", encoding="utf-8") as page:
                page.write("\n".join(("", "```{toctree}", ":hidden:", "", *pages, "```", "")))
    docs, schemas = source.parent / "docs", source.parent / "schema"
    for path in (*source.glob("*.svg"), *source.glob("clauses*.json"), *schemas.glob("*.schema.json")):
        shutil.copyfile(path, folder / path.name)
    for pictures in (source / "figures", docs / "pictures"):
        if pictures.is_dir():
            shutil.copytree(pictures, folder / pictures.name)


@cache
def address(label: str) -> str:
    """An address of the project: ``Documentation`` (the site) or ``Source`` (the repository), without a final slash.

    They are stated once, in ``[project.urls]`` of pyproject.toml.
    """
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    url: str = project["urls"][label]
    return url.rstrip("/")


@cache
def source_url(path: str, line: int | None = None) -> str:
    """The address of a file or folder of the repository at the code host."""
    kind = "tree" if (ROOT / path).is_dir() else "blob"
    return f"{address('Source')}/{kind}/main/{path}" + (f"#L{line}" if line else "")


def on_the_site(target: str, pages: Path) -> str | None:
    """What a link to a file of the repository becomes on the site; None if there is no such file.

    Args:
        target: Path of the file, relative to the root of the repository.
        pages: The folder that Sphinx reads pages from.
    """
    path = Path(target)
    if target == DROP_PAGE:
        return f"page:{path.name}"
    if path.parts[0] == "robots" and path.name in ("robots", "README.md"):
        robot = path.parent.name
        page = f"robots/{robot}.md" if robot not in ("", "robots") else "robots/index.md"
        if (pages / page).is_file():
            return page
    if str(path.parent) in FOLDERS and path.suffix == ".md" and path.name != "README.md":
        return path.name
    if path.parts[:2] == ("docs", "pictures"):
        return "/".join(path.parts[1:])
    if path.parent == Path("schema") or (path.parent == Path("spec") and path.suffix == ".json"):
        return path.name
    return source_url(target) if (ROOT / target).exists() else None


def _translate_links(app: Sphinx, page: str, content: list[str]) -> None:
    folder = next((each for each in FOLDERS if (ROOT / each / f"{page}.md").exists()), "")

    def translated(match: re.Match[str]) -> str:
        path = match["path"] or f"{folder}/{match['below']}"
        url = on_the_site(path, Path(app.srcdir))
        if url is None:
            _LOGGER.warning("the repository has no file '%s'", path, location=page)
        return url or match[0]

    content[0] = _OUTSIDE.sub(translated, content[0])


def setup(app: Sphinx) -> None:
    """Translate the links of each page."""
    app.connect("source-read", _translate_links)
