"""Equations as MathML, generated when the site is built: browsers render it without loading anything."""

from __future__ import annotations

import re
from html import escape

from docutils import nodes
from latex2mathml.converter import convert
from sphinx.application import Sphinx
from sphinx.util import logging
from sphinx.writers.html5 import HTML5Translator

_LOGGER = logging.getLogger(__name__)

# What a command becomes that the converter does not know.
_UNKNOWN = re.compile(r"<m(?:i|text|o)[^>]*>\\[A-Za-z]+")


def mathml(latex: str, display: bool) -> str:
    """An equation as MathML, with its source for copying and screen readers.

    Args:
        latex: The equation in LaTeX.
        display: Whether it is on its own line.

    Raises:
        ValueError: Where it cannot be converted.
    """
    try:
        converted: str = convert(latex.strip(), display="block" if display else "inline")
    except Exception as error:  # the converter raises exceptions of any type
        raise ValueError(f"'{latex}' is not an equation: {error!r}") from error
    if unknown := _UNKNOWN.search(converted):
        raise ValueError(f"'{latex}' has an unknown command: {unknown[0].rpartition('>')[2]}")
    return converted.replace("<math ", f'<math alttext="{escape(latex.strip())}" ', 1)


def _visit_math(self: HTML5Translator, node: nodes.math) -> None:
    self.body.append(_shown(node, node.astext(), display=False))
    raise nodes.SkipNode


def _visit_math_block(self: HTML5Translator, node: nodes.math_block) -> None:
    anchor = f' id="{escape(node["ids"][0])}"' if node["ids"] else ""
    number = f'<span class="eqno">({escape(str(node["number"]))})</span>' if node.get("number") else ""
    parts = "".join(_shown(node, part, display=True) for part in separate_equations(node.astext()))
    self.body.append(f'<div class="eu-equation"{anchor}>{parts}{number}</div>\n')
    raise nodes.SkipNode


def separate_equations(latex: str) -> list[str]:
    """The equations of a line, which are separated by a wide space: a narrow screen shows them one below another."""
    return [latex] if r"\begin" in latex else [part for part in latex.split(r"\qquad") if part.strip()]


def _shown(node: nodes.math | nodes.math_block, latex: str, display: bool) -> str:
    try:
        return mathml(latex, display)
    except ValueError as error:
        _LOGGER.warning(str(error), location=node)
        return f"<code>{escape(latex)}</code>"


def setup(app: Sphinx) -> None:
    """Register the renderer for ``html_math_renderer``."""
    app.add_html_math_renderer("mathml", (_visit_math, None), (_visit_math_block, None))
