"""The badge: a small picture that shows which levels a parser is certified for."""

from __future__ import annotations

from lxml import etree

from eurdf_conformance.certificate.certificate import Certificate
from eurdf_conformance.certificate.summary import but_for, certified_levels, levels_text
from eurdf_conformance.level import VERSIONS

_SVG = "http://www.w3.org/2000/svg"
_GREEN, _GREY, _DARK = "#2e7d32", "#757575", "#444"

# Advance widths of a sans-serif of 11 px, px: narrow, wide, and all other characters. Each text states how wide it is
# (textLength), so no font of the viewer can overflow the box.
_NARROW, _WIDE = "iljft|,.:1 I()", "mwMW"
_WIDTHS = (3.9, 9.8, 6.7)
_HEIGHT, _PADDING = 20, 7


def badge(certificate: Certificate) -> str:
    """The badge as SVG text: the versions on the left, the levels on the right."""
    left, right = badge_texts(certificate)
    color = _GREEN if any(certified_levels(certificate, version) for version in VERSIONS) else _GREY
    widths = [_width(text) + 2 * _PADDING for text in (left, right)]
    total = sum(widths)
    said = f"{left}: {right}"
    svg = etree.Element("svg", xmlns=_SVG, width=str(total), height=str(_HEIGHT), role="img")
    svg.set("aria-label", said)
    _add(svg, "title").text = said
    clip = _add(svg, "clipPath", id="round")
    _add(clip, "rect", width=total, height=_HEIGHT, rx=3)
    boxes = _add(svg, "g", **{"clip-path": "url(#round)"})
    _add(boxes, "rect", width=widths[0], height=_HEIGHT, fill=_DARK)
    _add(boxes, "rect", x=widths[0], width=widths[1], height=_HEIGHT, fill=color)
    texts = _add(svg, "g", **{"fill": "#fff", "font-family": "Verdana,DejaVu Sans,sans-serif", "font-size": 11})
    for text, start, width in ((left, 0, widths[0]), (right, widths[0], widths[1])):
        _add(texts, "text", x=start + _PADDING, y=14, textLength=width - 2 * _PADDING).text = text
    return etree.tostring(svg, encoding="unicode", pretty_print=True)


def badge_texts(certificate: Certificate) -> tuple[str, str]:
    """The left and the right text of the badge."""
    certified = {version: certified_levels(certificate, version) for version in VERSIONS}
    versions = [version for version in VERSIONS if certified[version]]
    if not versions:
        return "Extended URDF", "not certified"
    said = [levels_text(certified[version], " ") for version in versions]
    without = but_for(certificate)
    if len(set(said)) == 1:
        return f"Extended URDF {', '.join(versions[:-1])}{' and ' * (len(versions) > 1)}{versions[-1]}", said[
            0
        ] + without
    return "Extended URDF", ", ".join(
        f"{version}: {text}" for version, text in zip(versions, said, strict=True)
    ) + without


def _add(parent: etree._Element, name: str, **attributes: object) -> etree._Element:
    return etree.SubElement(parent, name, {key: str(value) for key, value in attributes.items()})


def _width(text: str) -> int:
    narrow, wide, other = _WIDTHS
    return round(sum(narrow if c in _NARROW else wide if c in _WIDE else other for c in text))
