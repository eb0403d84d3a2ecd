"""What pages need to be usable with a keyboard or a screen reader, where theme and Sphinx lack it."""

from __future__ import annotations

from typing import Any

from docutils.nodes import Element
from sphinx.application import Sphinx
from sphinx.writers.html5 import HTML5Translator


class AccessibleTranslator(HTML5Translator):
    """Writes pages."""

    def starttag(self, node: Element, tagname: str, *args: Any, **attributes: Any) -> str:
        """The start of an element; a heading by its role, as the caption of a table of contents, has a level too."""
        if attributes.get("ROLE") == "heading":
            attributes["ARIA-LEVEL"] = "2"
        return super().starttag(node, tagname, *args, **attributes)


def setup(app: Sphinx) -> None:
    """Write pages with the translator."""
    app.set_translator("html", AccessibleTranslator)
