"""The scripts and the style of the pages of robots, which Node builds from ``js/`` when this package is installed."""

from __future__ import annotations

from pathlib import Path

from eurdf.diagnostics.extras import build_page_command

#: Where ``js/build.js`` writes them.
_FOLDER = Path(__file__).parent / "page"

# What the page of the viewer loads; its title is the name of the robot.
_SERVED = ("live.js", "page.css", "live.css")
_PAGE = (
    b'<!doctype html><html lang="en"><head><meta charset="utf-8"><title>eurdf view</title>'
    b'<meta name="viewport" content="width=device-width, initial-scale=1"><link rel="icon" href="data:,">'
    b'<link rel="stylesheet" href="/page.css"><link rel="stylesheet" href="/live.css">'
    b'<script defer src="/live.js"></script></head><body></body></html>'
)


def page_path(name: str) -> Path:
    """The file of a script or style of the pages of robots.

    Args:
        name: ``page.js``, of a page that needs no server; ``live.js``, of the viewer; ``drop.js``, of the page that
            takes dropped files; ``page.css``, of all of them; ``live.css``, of the viewer.

    Raises:
        FileNotFoundError: Node was not there when the package was installed; the text says what to run.
    """
    file = _FOLDER / name
    if not file.is_file():
        raise FileNotFoundError(f"the page of robots is not built, '{name}' is missing; run: {build_page_command()}")
    return file


def page_file(name: str) -> str:
    """What to place in ``<script>`` or ``<style>``; see `page_path`."""
    return page_path(name).read_text(encoding="utf-8")


def served_page(path: str) -> bytes | None:
    """The page of the viewer, at the path "/" of its address, and the files that it loads; None for any other path.

    Raises:
        FileNotFoundError: As `page_file`.
    """
    if path == "/":
        return _PAGE
    name = path.removeprefix("/")
    return page_file(name).encode() if name in _SERVED else None
