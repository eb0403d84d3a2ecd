"""Readers of XML that are not quite: written by hand, or lenient where XML is not."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Any

from eurdf.linking import description
from eurdf.reading.source import Source
from eurdf_conformance.level import Level
from eurdf_conformance.mutants.deviation import Deviation, around
from eurdf_conformance.mutants.mutant import mutant

_TAG = re.compile(r"<[A-Za-z][^<>]*>")
_NO_ELEMENTS = re.compile(r"<!--.*?-->|<\?.*?\?>|<!\[CDATA\[.*?\]\]>", re.DOTALL)

#: No XML, for what is to be refused.
_BROKEN = "<"


def _read_as(change: Callable[[str], str]) -> Deviation:
    """A URDF is read as if another text stood in its file."""

    def read(original: Any, source: Source) -> Any:
        text = change(source.text)
        return original(Source(source.file, text, text.encode()))

    return around(description, "read_xml", read)


def _in_tags(change: Callable[[str], str]) -> Deviation:
    return _read_as(lambda text: _TAG.sub(lambda found: change(found[0]), text))


def _in_values(change: Callable[[str], str]) -> Deviation:
    """The values of attributes are read as others."""

    def value(found: re.Match[str]) -> str:
        changed = change(found[2] if found[3] is None else found[3])
        return found[1] + '"' + changed.replace('"', "&quot;") + '"'

    return _in_tags(lambda tag: re.sub(r"""(=\s*)(?:"([^"]*)"|'([^']*)')""", value, tag).replace('"None"', '""'))


def _refused(pattern: str) -> Deviation:
    """A file in which something stands is refused."""
    found = re.compile(pattern, re.DOTALL)
    return _read_as(lambda text: _BROKEN if found.search(text) else text)


@mutant("EU-URD-001")
def sections_are_read() -> Deviation:
    """What stands in a CDATA section is read as elements."""
    return _read_as(lambda text: re.sub(r"<!\[CDATA\[(.*?)\]\]>", r"\1", text, flags=re.DOTALL))


@mutant("EU-URD-001")
def comments_are_read() -> Deviation:
    """What stands in a comment is read as elements, as where lines are searched for tags."""
    return _read_as(lambda text: re.sub(r"<!--(.*?)-->", r"\1", text, flags=re.DOTALL))


@mutant("EU-URD-001")
def references_by_number_are_text() -> Deviation:
    """A reference to a character by its number is text."""
    return _read_as(lambda text: text.replace("&#", "&amp;#"))


@mutant("EU-URD-001")
def references_in_base_16_are_text() -> Deviation:
    """A reference to a character by its number in base 16 is text."""
    return _read_as(lambda text: re.sub(r"&#x", "&amp;#x", text))


@mutant("EU-URD-001")
def apostrophes_are_text() -> Deviation:
    """Of the five entities of XML `&apos;` is unknown, as in HTML 4."""
    return _read_as(lambda text: text.replace("&apos;", "&amp;apos;"))


@mutant("EU-URD-001")
def references_of_16_bits() -> Deviation:
    """Of the number of a character 16 bits count."""

    def cut(found: re.Match[str]) -> str:
        number = int(found[1][1:], 16) if found[1].startswith("x") else int(found[1])
        return found[0] if number < 1 << 16 else f"&#{number % (1 << 16)};"

    return _read_as(lambda text: re.sub(r"&#(x[0-9a-fA-F]+|[0-9]+);", cut, text))


@mutant("EU-URD-001")
def line_ends_in_attributes_stay() -> Deviation:
    """A tab or a line end in the value of an attribute stays one, as in tinyxml2."""
    return _in_values(lambda value: value.replace("\n", "&#10;").replace("\t", "&#9;"))


@mutant("EU-URD-001", level=Level.STRUCTURE)
def referred_line_ends_are_blanks() -> Deviation:
    """A tab or a line end in the value of an attribute is a blank, be it written as a reference."""
    return _in_values(lambda value: re.sub(r"&#(9|10|13|x9|xA|xD);", " ", value))


@mutant("EU-URD-001")
def tags_end_at_the_first_sign() -> Deviation:
    """A tag ends at the first `>`, be it within the value of an attribute."""

    def cut(text: str) -> str:
        return _BROKEN if re.search(r'<\w[^<>]*=\s*"[^"<]*>', _NO_ELEMENTS.sub("", text)) else text

    return _read_as(cut)


@mutant("EU-URD-001")
def single_quotes_refused() -> Deviation:
    """The value of an attribute must be in double quotes."""
    return _refused(r"<\w[^<>]*=\s*'")


@mutant("EU-URD-001")
def blanks_around_equals_signs_refused() -> Deviation:
    """No blank may stand around the `=` of an attribute."""
    return _refused(r"<\w[^<>]*(?:\s=|=\s+[\"'])")


@mutant("EU-URD-001")
def comments_in_joints_refused() -> Deviation:
    """A comment may not stand within a joint."""
    return _refused(r"<joint(?:(?!</joint>).)*<!--")


@mutant("EU-URD-001")
def instructions_refused() -> Deviation:
    """A processing instruction is a fault of syntax."""
    return _refused(r"<\?(?!xml\s)")


@mutant("EU-URD-001")
def default_namespaces_hide_elements() -> Deviation:
    """An element in a default namespace is none of URDF's, as for a reader that heeds namespaces."""
    return _refused(r'<(?:robot|joint)\s[^<>]*xmlns="\w')


@mutant("EU-URD-001", level=Level.KINEMATICS)
def prefixes_of_attributes_are_dropped() -> Deviation:
    """An attribute with a prefix counts where there is none without, as for a reader that looks at local names."""

    def dropped(tag: str) -> str:
        for found in re.findall(r"\s(?!xmlns)\w+:(\w+)\s*=", tag):
            if not re.search(rf"\s{found}\s*=", tag):
                tag = re.sub(rf"(\s)\w+:({found}\s*=)", r"\1\2", tag)
        return tag

    return _in_tags(dropped)


@mutant("EU-URD-001")
def second_attribute_dropped() -> Deviation:
    """Of an attribute that stands twice in an element the first counts, as in tinyxml2."""

    def once(tag: str) -> str:
        seen: set[str] = set()

        def attribute(found: re.Match[str]) -> str:
            kept = "" if found[1] in seen else found[0]
            seen.add(found[1])
            return kept

        return re.sub(r"""\s([\w:]+)\s*=\s*("[^"]*"|'[^']*')""", attribute, tag)

    return _in_tags(once)


@mutant("EU-URD-001")
def lone_ampersands_are_text() -> Deviation:
    """An ampersand that begins no reference of XML is text, as in tinyxml2 and in browsers."""
    return _read_as(lambda text: re.sub(r"&(?!(?:amp|lt|gt|quot|apos|#\d+|#x[0-9a-fA-F]+);)", "&amp;", text))


@mutant("EU-URD-001")
def dashes_in_comments_pass() -> Deviation:
    """Two dashes may stand in a comment."""
    return _read_as(lambda text: re.sub(r"<!--.*?-->", "", text, flags=re.DOTALL))


@mutant("EU-URD-001")
def what_follows_the_root_is_passed_over() -> Deviation:
    """A file is read up to the end of its root element."""
    return _read_as(lambda text: text.partition("</robot>")[0] + "</robot>" if "</robot>" in text else text)


@mutant("EU-URD-001")
def text_after_the_root_is_passed_over() -> Deviation:
    """Text may follow the root element."""
    return _read_as(lambda text: re.sub(r"</robot>[^<]*", "</robot>", text))


@mutant("EU-URD-001")
def tags_in_any_case() -> Deviation:
    """An end tag may be in another case than the tag that it ends."""
    return _read_as(lambda text: re.sub(r"</\w+", lambda found: found[0].lower(), text))


@mutant("EU-URD-001")
def values_without_quotes_pass() -> Deviation:
    """The value of an attribute may stand without quotes, as in HTML."""
    return _read_as(lambda text: re.sub(r"""(<[^<>]*\s\w+=)([^\s"'<>/]+)""", r'\1"\2"', text))


@mutant("EU-URD-001")
def attributes_without_value_pass() -> Deviation:
    """An attribute may have no value, as in HTML."""
    return _read_as(lambda text: re.sub(r"(<\w[^<>]*?)\s\w+(?=\s*/?>)", r"\1", text))


@mutant("EU-URD-001")
def control_characters_pass() -> Deviation:
    """Any character may stand in a file."""
    return _read_as(lambda text: re.sub("[\x01-\x08\x0b\x0c\x0e-\x1f]", "", text))


@mutant("EU-URD-001")
def references_to_control_characters_pass() -> Deviation:
    """Any character may be referred to."""
    return _read_as(lambda text: re.sub(r"&#(?:[1-8]|1[124-9]|2\d|3[01]);", "", text))


@mutant("EU-URD-001")
def signs_in_values_pass() -> Deviation:
    """A `<` may stand in the value of an attribute, as in tinyxml2."""
    return _read_as(lambda text: re.sub(r'="([^"\n]*)<([^"\n]*)"', r'="\1&lt;\2"', text))


@mutant("EU-URD-001")
def ends_of_sections_pass() -> Deviation:
    """The end of a section may stand in text, as in tinyxml2."""
    return _read_as(lambda text: text if "<![CDATA[" in text else text.replace("]]>", ""))


@mutant("EU-URD-001")
def end_of_the_file_closes() -> Deviation:
    """What is not closed at the end of the file is closed there."""
    return _read_as(lambda text: text + "</robot>" if "<robot" in text and "</robot>" not in text else text)
