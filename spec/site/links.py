"""Checks the links of a built site: no internal link is broken, and no page loads external files."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

# Elements that load what they name, with the attribute that names it; an <a> only leads there.
_LOADING = {
    "audio": "src",
    "embed": "src",
    "iframe": "src",
    "img": "src",
    "input": "src",
    "link": "href",
    "object": "data",
    "script": "src",
    "source": "src",
    "track": "src",
    "video": "src",
}
# Kinds of <link> that a browser only remembers.
_NOT_LOADED = {"author", "canonical", "index", "license", "next", "prev", "search"}
_STYLE_URL = re.compile(r"url\(\s*['\"]?(?P<url>[^'\")]+)|@import\s+['\"](?P<imported>[^'\"]+)")


@dataclass
class Page:
    """The anchors and links of a page.

    Attributes:
        anchors: How often each id occurs.
        links: What it leads to.
        loads: What is loaded to show it.
    """

    anchors: Counter[str] = field(default_factory=Counter)
    links: list[str] = field(default_factory=list)
    loads: list[str] = field(default_factory=list)


def site_errors(folder: Path) -> list[str]:
    """The errors in the links of a site, as ``page: message``."""
    pages = {path: read_page(path.read_text(encoding="utf-8")) for path in sorted(folder.rglob("*.html"))}
    errors = []
    for path, page in pages.items():
        name = path.relative_to(folder)
        errors += [f"{name}: the id '{anchor}' occurs {n} times" for anchor, n in page.anchors.items() if n > 1]
        errors += [f"{name}: '{url}' is broken" for url in page.links if not _leads(url, path, folder, pages)]
        errors += [f"{name}: '{url}' is loaded from another site" for url in page.loads if _is_external(url)]
        for url in page.loads:
            if not _is_external(url) and not _leads(url, path, folder, pages):
                errors.append(f"{name}: '{url}' does not exist")
    for path in sorted(folder.rglob("*.css")):
        for url in _style_urls(path.read_text(encoding="utf-8")):
            if _is_external(url):
                errors.append(f"{path.relative_to(folder)}: '{url}' is loaded from another site")
    return errors


def read_page(text: str) -> Page:
    """The anchors and links of a page."""
    reader = _Reader()
    reader.feed(text)
    reader.close()
    return reader.page


class _Reader(HTMLParser):
    def __init__(self) -> None:
        super().__init__()
        self.page = Page()
        self._in_style = False

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        values = {name: value for name, value in attrs if value is not None}
        if "id" in values:
            self.page.anchors[values["id"]] += 1
        if tag == "a" and "href" in values:
            self.page.links.append(values["href"])
        relations = set(values.get("rel", "").split())
        if (attribute := _LOADING.get(tag)) in values and not (tag == "link" and relations <= _NOT_LOADED):
            self.page.loads.append(values[attribute])
        for candidate in values.get("srcset", "").split(","):
            if candidate.strip():
                self.page.loads.append(candidate.split()[0])
        self.page.loads += _style_urls(values.get("style", ""))
        self._in_style = tag == "style"

    def handle_endtag(self, tag: str) -> None:
        self._in_style = False

    def handle_data(self, data: str) -> None:
        if self._in_style:
            self.page.loads += _style_urls(data)


def _style_urls(style: str) -> Iterator[str]:
    for match in _STYLE_URL.finditer(style):
        yield match["url"] or match["imported"]


def _is_external(url: str) -> bool:
    address = urlsplit(url)
    return bool(address.netloc) or address.scheme not in ("", "data")


def _leads(url: str, path: Path, folder: Path, pages: dict[Path, Page]) -> bool:
    address = urlsplit(url)
    if address.scheme or address.netloc:
        return True
    target = path if not address.path else (path.parent / unquote(address.path)).resolve()
    if not target.is_relative_to(folder.resolve()) or not target.is_file():
        return False
    fragment = unquote(address.fragment)
    return not fragment or target not in pages or fragment in pages[target].anchors
