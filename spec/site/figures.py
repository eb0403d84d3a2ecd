"""Drawings are embedded in the page, so that they use its colours, also in dark mode."""

from __future__ import annotations

import re
from html import escape
from pathlib import Path
from typing import Any

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.transforms.post_transforms import SphinxPostTransform
from sphinx.util import logging

_LOGGER = logging.getLogger(__name__)

_PROLOGUE = re.compile(r"^.*?(?=<svg\b)", re.S)
_ID = re.compile(r"""(\bid=["']|url\(["']?#|\bhref=["']#)""")


class InlineDrawings(SphinxPostTransform):
    """Replaces each image of an SVG by the SVG."""

    default_priority = 5  # before images are collected to be copied
    formats = ("html",)

    def run(self, **kwargs: Any) -> None:
        """Replace the images of the page."""
        for image in list(self.document.findall(nodes.image)):
            path = Path(self.env.srcdir, image["uri"])
            if path.suffix == ".svg" and path.exists():
                alt = image.get("alt", "").strip()
                if not alt:
                    _LOGGER.warning("the figure has no alternative text: add alt", location=image)
                drawing = inline_svg(path.read_text(encoding="utf-8"), path.stem, alt)
                image.replace_self(nodes.raw("", drawing, format="html"))


def inline_svg(svg: str, name: str, alt: str) -> str:
    """A drawing in a page.

    Args:
        svg: The file.
        name: Prefix for ids in it, which are unique in a page.
        alt: What it shows, in words.
    """
    svg = _ID.sub(rf"\g<1>{name}-", _PROLOGUE.sub("", svg, count=1))
    return svg.replace("<svg", f'<svg role="img" class="eu-drawing" aria-label="{escape(alt)}"', 1)


def setup(app: Sphinx) -> None:
    """Add the transform."""
    app.add_post_transform(InlineDrawings)
