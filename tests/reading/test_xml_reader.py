"""Reading XML: the places of elements and attributes, what is refused."""

from __future__ import annotations

import contextlib
import random
from dataclasses import dataclass, field

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from eurdf.diagnostics import Diagnostic, FileError, Place
from eurdf.reading.source import FILE_LIMIT, Source
from eurdf.reading.xml_reader import ATTRIBUTE_LIMIT, TAG_LIMIT, XmlDocument, read_xml
from support.damaged import damaged
from support.processes import watchdog

SAMPLE = """\
<?xml version="1.0" encoding="utf-8"?>
<!-- <robot name="not this one"> & "that" -->
<robot name="bras_à_3_liens" xmlns:xacro="http://ros.org/wiki/xacro">
  <link name="base"/>
  <link name="arm">
    <inertial><mass value="1.5"/><origin xyz="0 0 0.1"
              rpy="0 0 0"/></inertial>
    <visual><geometry><mesh filename="a&amp;b > c.stl"/></geometry></visual>
  </link>
  <joint
      name='shoulder'
      type='revolute'
  >
    <parent link="base"/> <child link="arm"/>
    <limit lower="-1" upper="1" effort="10"
           velocity="2"/>
  </joint>
  <gazebo reference="arm"><xacro:macro xacro:size="2"/><![CDATA[<link name="no"/>]]></gazebo>
</robot>
"""


def source_of(text: str) -> Source:
    return Source("robot.urdf", text, text.encode())


def read(text: str) -> XmlDocument:
    return read_xml(source_of(text))


def error_of(text: str) -> Diagnostic:
    source = source_of(text)
    with watchdog(), pytest.raises(FileError) as caught:
        read_xml(source)
    return caught.value.diagnostic


def meant(text: str, place: Place) -> str:
    assert place.line is not None
    assert place.column is not None
    assert place.end_column is not None
    return text.split("\n")[place.line - 1][place.column - 1 : place.end_column - 1]


# Places


@pytest.mark.parametrize(
    ("xpath", "attribute", "line", "text", "pointer"),
    [
        ("//origin", "rpy", 7, "0 0 0", "/robot/link[2]/inertial/origin/@rpy"),
        ("//gazebo/*", None, 18, "<xacro:macro", "/robot/gazebo/xacro:macro"),
        ("//joint", "mimic", 10, "<joint", "/robot/joint/@mimic"),
    ],
)
def test_places_in_a_urdf(xpath: str, attribute: str | None, line: int, text: str, pointer: str) -> None:
    document = read(SAMPLE)
    [element] = document.root.getroottree().xpath(xpath)
    place = document.place(element, attribute)
    assert (place.file, place.line, place.pointer) == ("robot.urdf", line, pointer)
    assert meant(SAMPLE, place) == text


@dataclass
class Writer:
    """Writes random elements and notes where each begins and the place of each attribute's value."""

    chance: random.Random
    line_break: str
    text: str = ""
    elements: list[int] = field(default_factory=list)
    values: dict[tuple[int, str], tuple[int, int]] = field(default_factory=dict)

    def element(self, depth: int) -> None:
        number = len(self.elements)
        self.elements.append(len(self.text))
        name = self.chance.choice(["link", "joint", "é", "x:plugin", "a.b-c_1"])
        self.text += f"<{name}"
        for attribute in self.chance.sample(["name", "xyz", "ü", "x:y", "日"], self.chance.randrange(4)):
            quote = self.chance.choice("'\"")
            gap = self.chance.choice([" ", "  ", self.line_break, self.line_break + "\t"])
            equals = self.chance.choice(["=", " = ", f"{self.line_break}=", "="])
            self.text += gap + attribute + equals + quote
            value = self.chance.choice(
                ["", "a", "é > ü", "/>", "a='b'" if quote == '"' else 'a="b"', "&lt;", "--> ]]>", "🤖"]
            )
            self.values[number, attribute] = (len(self.text), len(self.text) + len(value))
            self.text += value + quote
        self.text += self.chance.choice(["", " ", self.line_break])
        if self.chance.random() < 0.3:
            self.text += "/>"
            return
        self.text += ">"
        for _ in range(self.chance.randrange(4) if depth else 0):
            self.filling()
            self.element(depth - 1)
        self.filling()
        self.text += f"</{name}>"

    def filling(self) -> None:
        self.text += self.chance.choice(
            [
                *("", "", " ", self.line_break, "text é > ' \"", "&amp;", "&#233;", "<!-- <link name='no'> é -->"),
                *(f"<!--{self.line_break}<a/>-->", "<![CDATA[<b> ]] é]]>", "<?pi <c> ?>"),
            ]
        )


@settings(deadline=None)
@given(chance=st.randoms(use_true_random=False), line_break=st.sampled_from(["\n", "\r\n", "\r"]))
def test_elements_and_attributes_have_their_places(chance: random.Random, line_break: str) -> None:
    writer = Writer(chance, line_break)
    writer.text = chance.choice(["", '<?xml version="1.0"?>' + line_break, "<!-- <a> -->", line_break])
    root = "<robot xmlns:x='http://example.org'>"
    writer.elements.append(len(writer.text))
    writer.text += root
    writer.element(3)
    writer.text += "</robot>"
    document = read(writer.text)
    elements = list(document.root.iter())
    assert len(elements) == len(writer.elements)
    for number, (element, start) in enumerate(zip(elements, writer.elements, strict=True)):
        place = document.place(element)
        assert (place.line, place.column) == document.source.position(start)
        assert place.end_column is not None
        assert place.column is not None
        end = start + place.end_column - place.column
        assert (
            document.source.text[start:end].removeprefix("<").rpartition(":")[2]
            == element.tag.rpartition("}")[2].rpartition(":")[2]
        )
        for name in element.attrib:
            written = name.replace("{http://example.org}", "x:")
            first, last = writer.values[number, written]
            found = document.place(element, name)
            assert found == document.source.place(first, last, f"{place.pointer}/@{written}")


@settings(deadline=None)
@given(st.randoms(use_true_random=False))
def test_pointer_is_xpath_of_element(chance: random.Random) -> None:
    writer = Writer(chance, "\n", "<robot xmlns:x='http://example.org'>")
    writer.element(3)
    document = read(writer.text + "</robot>")
    for element in document.root.iter():
        pointer = document.place(element).pointer
        assert document.root.getroottree().xpath(pointer, namespaces={"x": "http://example.org"}) == [element]


# Document types


BOMB = (
    '<!DOCTYPE robot [<!ENTITY a0 "xxxxxxxxxx">'
    + "".join(f'<!ENTITY a{n} "{f"&a{n - 1};" * 10}">' for n in range(1, 12))
    + "]><robot>&a11;</robot>"
)


@pytest.mark.parametrize(
    "before", ["\x01", "<?xml?", "<!--", "<!-- -- -->", "text", "<robot/>", "<?xml version='1.0'?x>"]
)
def test_entity_bomb_behind_other_error_is_harmless(before: str) -> None:
    assert error_of(before + BOMB).code in ("xml-syntax", "xml-doctype")


# Hostile files


@pytest.mark.parametrize(
    "text",
    [
        "<a>" * 400_000,
        "<a " + "b='' " * (TAG_LIMIT + 1) + "/>",
        "<a>" + "<b/>" * (TAG_LIMIT + 1) + "</a>",
        "<a b='" + "é" * (ATTRIBUTE_LIMIT // 2) + "x'/>",
        "<a>" + "\n" * FILE_LIMIT + "</a>",
    ],
    ids=["nesting", "attributes", "elements", "value", "file"],
)
def test_size_limit_is_enforced(text: str) -> None:
    assert error_of(text).code == "file-too-large"


@pytest.mark.parametrize(
    "text",
    [
        "<a b='" + "é" * (ATTRIBUTE_LIMIT // 2) + "'/>",
        "<a>" + "\n" * (FILE_LIMIT - 7) + "</a>",
        "<a>" + "x" * 11_000_000 + "</a>",
        "<a" + "x" * 100_000 + "/>",
    ],
    ids=["value", "file", "text", "name"],
)
def test_file_within_limits_is_read(text: str) -> None:
    assert read(text).root.tag.startswith("a")


def test_hundred_thousand_siblings_have_places() -> None:
    source = source_of("<robot>\n" + '<link name="a"/>\n' * 100_000 + "</robot>")
    with watchdog():
        document = read_xml(source)
        for number, element in list(enumerate(document.root, 1))[::100]:
            place = document.place(element)
            assert (place.line, place.pointer) == (number + 1, f"/robot/link[{number}]")


@pytest.mark.parametrize(
    "text",
    [
        *(" " * 20_000_000, "<!--" * 240_000, "<?a" * 900_000, "<?xml " + " encoding" * 2_000_000),
        *("<a>" + "&amp;" * 3_000_000, "<a>" + "<b>" * 100 + "</b>" * 100 + "<c/>" * 200_000),
        *("<a " + " ".join(f"b{n}=''" for n in range(200_000)), "<a>" + "<x:b/>" * 200_000 + "</a>"),
        "<a " + " ".join(f"xmlns:b{n}='u{n}'" for n in range(100_000)) + "/>",
    ],
)
def test_any_text_within_limits_is_fast(text: str) -> None:
    source = source_of(text)
    with watchdog(), contextlib.suppress(FileError):
        document = read_xml(source)
        document.place(document.root)


def places_are_found(document: XmlDocument) -> None:
    for element in document.root.iter():
        document.place(element)
        for name in element.attrib:
            assert document.place(element, name).pointer.rpartition("/")[2].startswith("@")


def test_damaged_file_gives_document_or_error() -> None:
    marks = ["<!--", "-->", "<![CDATA[", "]]>", "<?", "?>", "<!DOCTYPE", "</link>"]
    junk = [*"\0\x01\t\n\r <>/=&;'\"?!-[]é\u2028\ufffe:", *marks]
    outcomes = damaged(SAMPLE, junk, read, places_are_found)
    assert {"read", "xml-syntax"} <= outcomes


JUNK = ["<a", "</a", ">", "/>", " b", "=", "'", '"', "&", "x", ";", "<!--", "-->", "<?", "?>", ":", "é"]


@settings(deadline=None, max_examples=300)
@given(st.lists(st.sampled_from(JUNK)))
def test_any_text_gives_document_or_error(pieces: list[str]) -> None:
    try:
        document = read("".join(pieces))
    except FileError as error:
        assert error.diagnostic.code in ("xml-syntax", "xml-doctype")  # noqa: PT017 - either outcome is right
    else:
        document.place(document.root)


# Messages


@pytest.mark.parametrize(
    ("text", "position", "message", "hint"),
    [
        ("", (1, 1), "empty", None),
        ("robot:\n", (1, 1), "does not begin with an element", "<robot"),
        ("<!-- only -->", (1, 14), "no element", None),
        (
            "<robot>\n <link>\n</robot>",
            (3, 1),
            "</robot> does not match the open <link> of line 2; </link> is expected",
            None,
        ),
        ("<robot>\n é<link>\n", (2, 3), "<link> is never closed", "</link>"),
        ("<robot/>\n<robot/>", (2, 1), "after the end of the root element", None),
        ("<robot é='ü'\n a='1' a='2'/>", (2, 8), "the attribute 'a' occurs twice", None),
        ("<robot é='ü' a=1/>", (1, 16), "must be quoted", None),
        ("<robot a='b&c'/>", (1, 12), "'&' is not escaped", "&amp;"),
        ("<robot a='<'/>", (1, 11), "'<' is inside a tag", "&lt;"),
        ("<robot>\n <link\n <link/>\n</robot>", (3, 2), "'<' is inside a tag", "close the tag before it"),
        ("<robot>é &x; </robot>", (1, 10), "the entity '&x;' is unknown", "&amp;"),
        ("<robot>a & b</robot>", (1, 10), "a '&' is not escaped", "&amp;"),
        ("<robot>\r\né\x07</robot>", (2, 2), "U+0007", None),
        ("<robot><!-- a -- b --></robot>", (1, 15), "'--' is not allowed in a comment", None),
        ("<robot>\n<!-- a", (2, 1), "'<!--' is never closed", None),
        ("<robot name='r'", (1, 1), "never closed", None),
        ("\n<?xml version='1.0'?><robot/>", (2, 1), "very beginning", None),
        ("< robot/>", (1, 2), "white space is not allowed here", None),
        ("<robot xmlns:a='u'>\n<a:b/>\n<a:b:c/></robot>", (3, 2), "the ':' in the name 'a:b:c'", "at most one ':'"),
        ("<robot><?é:y z?></robot>", (1, 10), "the ':' in the name 'é:y'", "an instruction"),
        ("<robot>\n<sensor:eye/></robot>", (2, 2), "'sensor' of 'sensor:eye' is not declared", 'xmlns:sensor="'),
        ("<robot><drake:joint/></robot>", (1, 9), "'drake' of 'drake:joint'", 'xmlns:drake="http://drake.mit.edu"'),
        ("<robot><é xmlns:x='u' x:b='1' y:c='2'/></robot>", (1, 31), "'y' of 'y:c' is not declared", "declare it"),
        ("<robot xmlns:x='u' x:a='1' xmlns:y='u' y:a='2'/>", (1, 40), "'x:a' and 'y:a' have one name", "remove one"),
        ("<robot><a b='c' xmlns:x=''/></robot>", (1, 17), "the namespace 'xmlns:x' is empty", "give it a name"),
        ("<robot xmlns:xmlns='u'/>", (1, 2), "<robot>: reserved prefix (xmlns)", "use others"),
        ("<robot xmlns:x='http://www.w3.org/XML/1998/namespace'/>", (1, 2), "reserved namespace", "use others"),
    ],
)
def test_syntax_error_is_reported_plainly_at_its_place(
    text: str, position: tuple[int, int | None], message: str, hint: str | None
) -> None:
    diagnostic = error_of(text)
    assert diagnostic.code == "xml-syntax"
    assert (diagnostic.line, diagnostic.column) == position
    assert message in diagnostic.message
    assert hint is None or hint in str(diagnostic.hint)
