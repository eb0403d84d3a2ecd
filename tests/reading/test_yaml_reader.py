"""Reading YAML: the value of a scalar, the place of a value, what is refused."""

from __future__ import annotations

import contextlib
import json
import random
import re
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from eurdf.diagnostics import Diagnostic, FileError, Place
from eurdf.reading.core_schema import resolve
from eurdf.reading.source import FILE_LIMIT, Source
from eurdf.reading.yaml_reader import NODE_LIMIT, YamlDocument, read_yaml
from support.damaged import damaged
from support.processes import watchdog

Pointer = tuple[str | int, ...]

SAMPLE = """\
# yaml-language-server: $schema=extended-urdf-2.0.schema.json
extended_urdf: "2.0"
urdf: robot.urdf
root: floating
closures:
  - name: knee_rod
    type: 6d
    frames: [rod_tip, knee_crank]
  - name: ankle_rod
    type: 3d
    frames:
      - {link: rod, xyz: &tip [0, 0, 0.31]}
      - {link: foot, xyz: *tip}
joints:
  hip_ball: spherical
  'knee cardan': {type: universal, axes: xy}
actuators: [motor_hip_x, {joint: motor_knee, gear_ratio: 50, rotor_inertia: 1.2e-4}]
metadata:
  author: Zoë
  notes: |
    Two lines,
    the second indented
"""


def source_of(text: str) -> Source:
    return Source("robot.yaml", text, text.encode())


def read(text: str) -> YamlDocument:
    return read_yaml(source_of(text))


def error_of(text: str) -> Diagnostic:
    with watchdog(), pytest.raises(FileError) as caught:
        read(text)
    return caught.value.diagnostic


def meant(text: str, place: Place) -> str:
    """What a place points at; to the end of the line where it has no end."""
    assert place.line is not None
    assert place.column is not None
    line = re.split(r"\r\n|\r|\n", text)[place.line - 1]
    return line[place.column - 1 : None if place.end_column is None else place.end_column - 1]


# The place of a value


class Writer:
    """Writes nested data in mixed styles and notes the first character of each value and the one after its last."""

    def __init__(self, chance: random.Random, line_break: str) -> None:
        self.chance = chance
        self.line_break = line_break
        self.text = ""
        self.keys: dict[Pointer, tuple[int, int]] = {}
        self.values: dict[Pointer, tuple[int, int | None]] = {}

    def node(self, value: Any, pointer: Pointer, indent: int, flow: bool) -> None:
        """Begins where the text ends: after a space, or after ``indent`` spaces for a block."""
        start = len(self.text)
        if isinstance(value, dict | list) and value and not flow:
            self.block(value, pointer, indent)
            self.values[pointer] = (start, None)
            return
        if isinstance(value, dict):
            self.text += "{"
            for index, key in enumerate(value):
                self.text += self.chance.choice([", ", ",", " ,  "]) if index else ""
                self.key(key, (*pointer, key))
                self.text += " "
                self.node(value[key], (*pointer, key), indent, True)
            self.text += "}"
        elif isinstance(value, list):
            self.text += "["
            for index, item in enumerate(value):
                self.text += self.chance.choice([", ", f",{self.line_break}{' ' * (indent + 1)}"]) if index else ""
                self.node(item, (*pointer, index), indent, True)
            self.text += "]"
        else:
            self.text += self.scalar(value)
        end = len(self.text)
        self.values[pointer] = (start, None if self.line_break in self.text[start:end] else end)

    def block(self, value: Any, pointer: Pointer, indent: int) -> None:
        steps = list(value) if isinstance(value, dict) else list(range(len(value)))
        for number, step in enumerate(steps):
            if number:
                self.new_line(indent)
            inner = (*pointer, step)
            flow = self.chance.random() < 0.3
            if isinstance(value, dict):
                self.key(step, inner)
                if isinstance(value[step], dict | list) and value[step] and not flow:
                    self.new_line(indent + 2)
                else:
                    self.text += self.chance.choice([" ", "   "])
            else:
                self.text += "- "
            self.node(value[step], inner, indent + 2, flow)

    def new_line(self, indent: int) -> None:
        comment = self.chance.choice(["", "", "  # é: {", f"{self.line_break}# - [日", self.line_break])
        self.text += comment + self.line_break + " " * indent

    def key(self, key: str, pointer: Pointer) -> None:
        start = len(self.text)
        self.text += self.scalar(key)
        self.keys[pointer] = (start, len(self.text))
        self.text += ":"

    def scalar(self, value: Any) -> str:
        if isinstance(value, str):
            if re.fullmatch("[a-zé日🤖]+", value) and resolve(value) == value and self.chance.random() < 0.6:
                return value
            if value.isprintable() and self.chance.random() < 0.5:
                return "'" + value.replace("'", "''") + "'"
        return json.dumps(value, ensure_ascii=False)


STRINGS = st.text(alphabet="abé日🤖 /~'\"#:,[{-\x85\u2028\n\t", max_size=8)
SCALARS = st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False, allow_infinity=False) | STRINGS
NESTED = st.recursive(
    SCALARS, lambda inner: st.lists(inner, max_size=4) | st.dictionaries(STRINGS, inner, max_size=4), max_leaves=20
)


@settings(deadline=None)
@given(
    data=st.dictionaries(STRINGS, NESTED, min_size=1, max_size=4),
    chance=st.randoms(use_true_random=False),
    line_break=st.sampled_from(["\n", "\r\n", "\r"]),
)
def test_pointer_leads_to_value_and_place(data: dict[str, Any], chance: random.Random, line_break: str) -> None:
    writer = Writer(chance, line_break)
    writer.node(data, (), 0, False)
    document = read(writer.text + line_break)
    assert document.data == data
    for pointer, (start, end) in writer.values.items():
        expected = document.source.place(start, end, "".join(f"/{escaped(step)}" for step in pointer))
        assert document.place(pointer) == expected
    for pointer, (start, end) in writer.keys.items():
        place = document.place(pointer, key=True)
        assert (place.line, place.column) == document.source.position(start)
        assert place.end_column == document.source.position(end)[1]


def escaped(step: str | int) -> str:
    return str(step).replace("~", "~0").replace("/", "~1")


@pytest.mark.parametrize(
    ("pointer", "key", "text"),
    [
        (("closures", 0), True, "name: knee_rod"),
        (("joints", "knee cardan"), True, "'knee cardan'"),
        (("metadata", "notes"), False, "|"),
        (("closures", 1, "frames", 0, "xyz"), False, "&tip [0, 0, 0.31]"),
        (("closures", 1, "frames", 1, "xyz"), False, "*tip"),
        (("closures", 1, "frames", 1, "xyz", 2), False, "0.31"),
    ],
)
def test_places_in_a_description(pointer: Pointer, key: bool, text: str) -> None:
    assert meant(SAMPLE, read(SAMPLE).place(pointer, key)) == text


@pytest.mark.parametrize(
    ("pointer", "nearest"),
    [
        (("closures", 0, "tipe"), ("closures", 0)),
        (("closures", 7, "type"), ("closures",)),
        (("closures", -1), ("closures",)),
        (("closures", "0"), ("closures",)),
        (("root", "x", "y"), ("root",)),
        (("nothing",), ()),
    ],
)
def test_missing_value_has_place_of_parent(pointer: Pointer, nearest: Pointer) -> None:
    document = read(SAMPLE)
    found, expected = document.place(pointer), document.place(nearest)
    assert (found.line, found.column, found.end_column) == (expected.line, expected.column, expected.end_column)
    assert found.pointer == "/" + "/".join(map(str, pointer))


# Keys


@pytest.mark.parametrize(
    ("key", "what", "hint"),
    [
        ("1", "a number", 'quote it: "1"'),
        ("null", "a key is null", 'quote it: "null"'),
        ("true", "a boolean", 'quote it: "true"'),
        (".nan", "a number", 'quote it: ".nan"'),
        ("? [a]\n", "a list", None),
        ("? {a: 1}\n", "a mapping", None),
        ("!!int '7'", "a number", 'quote it: "7"'),
    ],
)
def test_non_string_key_is_refused(key: str, what: str, hint: str | None) -> None:
    diagnostic = error_of(f"a:\n  b: 1\n  {key}{'  ' if key.startswith('?') else ''}: x\n")
    assert (diagnostic.code, diagnostic.hint) == ("yaml-key-not-string", hint)
    assert what in diagnostic.message
    assert (diagnostic.line, diagnostic.pointer) == (3, "/a")


@pytest.mark.parametrize(
    "text",
    ["a: {b: 1, c: 2, b: 3}\n", "a:\n  b: 1\n  c: 2\n  b: 3\n", "a:\n  b: 1\n  'b': 3\n", 'a: {b: 1, "\\x62": 3}'],
)
def test_duplicate_key_is_refused_at_second_place(text: str) -> None:
    diagnostic = error_of(text)
    assert (diagnostic.code, diagnostic.pointer) == ("yaml-duplicate-key", "/a/b")
    assert (diagnostic.line, diagnostic.column) != (None, None)
    assert meant(text, diagnostic.place).strip("'") in ("b", '"\\x62"')
    first = 1 if text.startswith("a: {") else 2
    assert diagnostic.hint == f"it first occurs on line {first}"
    assert diagnostic.column is not None
    assert diagnostic.line is not None
    assert (diagnostic.line, diagnostic.column) > (first, 5)


# Aliases


def test_alias_counts_as_one_node() -> None:
    assert error_of("a: &a 1\nb: [" + "*a," * NODE_LIMIT + "]").code == "file-too-large"


# Hostile files


@pytest.mark.parametrize("opening", ["[", "{a: ", "- ", "? ", "[\n", "[{a: "])
def test_endless_nesting_is_refused(opening: str) -> None:
    code = error_of(opening * (4_000_000 // len(opening))).code
    assert code == ("yaml-key-not-string" if opening == "? " else "yaml-too-deep")


@pytest.mark.parametrize(
    "text",
    [
        "- 1\n" * 1_000_000,
        "a: [" + "1," * 1_500_000 + "]",
        "".join(f"%TAG !a{n}! b\n" for n in range(200_000)) + "---\na: 1\n",
        "a: 1\n" + "#" * FILE_LIMIT,
    ],
    ids=["items", "flow items", "directives", "bytes"],
)
def test_size_limit_is_enforced(text: str) -> None:
    assert error_of(text).code == "file-too-large"


@pytest.mark.parametrize(
    "text",
    [
        *("'" + "x" * 4_000_000, '"' + "\\x41" * 1_000_000, "x" * 4_000_000, "a: 0x" + "1" * 4_000_000),
        *("a: ." + "1" * 4_000_000 + "e1", "a: !" + "x" * 4_000_000, "a: &" + "x" * 4_000_000, "\n" * 4_000_000),
        *("---\n" * 1_000_000, "a: |\n" + "  x\n" * 1_000_000, "a:" + "\t" * 4_000_000),
        *("a: '\x85" + "\u2028x" * 900_000 + "'", "".join(" " * n + "a:\n" for n in range(2800))),
    ],
)
def test_any_text_within_limits_is_fast(text: str) -> None:
    with watchdog(), contextlib.suppress(FileError):
        read(text)


@pytest.mark.parametrize("character", ["\0", "\x01", "\x1b", "\x7f", "\x80", "\ufffe"])
def test_control_character_is_refused_at_its_place(character: str) -> None:
    diagnostic = error_of(f"é: 1\r\nb: 'x{character}'\r\n")
    assert (diagnostic.code, diagnostic.line, diagnostic.column) == ("yaml-syntax", 2, 6)
    assert f"U+{ord(character):04X}" in diagnostic.message


def test_damaged_file_gives_document_or_error() -> None:
    characters = "\0\t\n\r -:,[]{}#&*!|>'\"%@`~?<=\\é\x85\u2028"
    junk = [*characters, "\r\n", "---", "...", "%YAML 1.1\n", "1e999", "*tip", "!!int "]
    outcomes = damaged(SAMPLE, junk, read, lambda document: document.place(("closures", 1, "frames", 1, "xyz", 2)))
    assert {"read", "yaml-syntax", "yaml-alias", "yaml-several-documents"} <= outcomes


@settings(deadline=None, max_examples=300)
@given(
    st.binary(max_size=60).map(lambda data: data.decode("utf-8", "ignore"))
    | st.text(alphabet="a1 -:,[]{}#&*!|>'\"\n\t%?~\r")
)
def test_any_text_gives_document_or_error(text: str) -> None:
    try:
        document = read(text)
    except FileError as error:
        assert error.diagnostic.code.startswith("yaml-")  # noqa: PT017 - either outcome is right
    else:
        json.dumps(document.data, allow_nan=False)


# What is no YAML mapping


@pytest.mark.parametrize(
    ("text", "what"),
    [
        ("", "empty"),
        ("# only a comment\n", "contains only comments"),
        ("---\n...\n", "empty"),
        ("null\n", "empty"),
        ("[1, 2]\n", "a list"),
        ("robot\n", "a string"),
        ("12\n", "a number"),
        ("true\n", "a boolean"),
    ],
)
def test_non_mapping_is_reported_with_its_type(text: str, what: str) -> None:
    diagnostic = error_of(text)
    assert diagnostic.code == "yaml-empty"
    assert what in diagnostic.message
    assert "mapping" in diagnostic.message


@pytest.mark.parametrize(
    ("text", "position", "message", "hint"),
    [
        ("a:\n\tb: 1\n", (2, 1), "a tab is used as indentation", "indent with spaces"),
        ("é: ü: x\n", (1, 5), "':' is not allowed here", "quote"),
        ("a: 1\nbc\nd: 2\n", (2, 1), "no ':' after it", "key: value"),
        ("a:\n  b: 1\n c: 2\n", (3, 2), "the mapping that begins on line 1", "like 'b'"),
        ("a:\n  - 1\n  b: 2\n", (3, 3), "the list that begins on line 2", "'- '"),
        ("a: [1, 2\nb: 3\n", (2, 2), "']' is missing in the list that begins on line 1", None),
        ("a:\n  [1,\n   2\n", (2, 3), "'[' is never closed", None),
        ("a: {b: 1\n", (1, 4), "'{' is never closed", None),
        ("a: {b: 1 c: 2}\n", (1, 11), "'}' is missing", None),
        ("a: 'x\nb: 1\n", (1, 4), "never closed", None),
        ("a: 'it's'\n", (1, 8), "after the end of a value", "quote"),
        ("a: @b\n", (1, 4), "a value cannot begin with '@'", "quote"),
        ("a: - b\n", (1, 4), "a list item cannot begin here", "line of its own"),
        ('日本: "\\d"\n', (1, 6), "unknown escape", "single quotes"),
        ("a: ]\n", (1, 4), "a value is missing", None),
        ("{a: 1} b\n", (1, 8), "does not continue anything", None),
        ("a: &é 1\n", (1, 5), "not a valid anchor name", "ASCII letters"),
        ("a: &an:chor 1\n", (1, 4), "not a valid anchor name", "ASCII letters"),
        ("a: &b 1\nc: *b:\n", (2, 4), "not a valid anchor name", "ASCII letters"),
        ("a: {?b: 1}\n", (1, 6), "directly before a key", "quote"),
        ("%MINE 1\n---\na: 1\n", (1, 6), "only the directives", "remove the line"),
    ],
)
def test_syntax_error_is_reported_plainly_at_its_place(
    text: str, position: tuple[int, int], message: str, hint: str | None
) -> None:
    diagnostic = error_of(text)
    assert diagnostic.code == "yaml-syntax"
    assert (diagnostic.line, diagnostic.column) == position
    assert message in diagnostic.message
    assert hint is None or hint in str(diagnostic.hint)


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("%MINE 1\n---\na: b\n", {"a": "b"}),
        ("a: &b:c d\n", {"a": "d"}),
        ("a: &é b\n", {"a": "b"}),
        ("a: b\n\t\nc: d\n", {"a": "b", "c": "d"}),
        ("a:\n  -\tb\n", {"a": ["b"]}),
        ("a:\tb\n", {"a": "b"}),
        ("a: |\n \tb\n", {"a": "\tb\n"}),
        ("a: {b: :c}\n", {"a": {"b": ":c"}}),
        ("a: {b: ?c}\n", {"a": {"b": "?c"}}),
        ("a: {?b: c}\n", {"a": {"?b": "c"}}),
        ("a: [?b: c]\n", {"a": [{"?b": "c"}]}),
        ("a: [::b]\n", {"a": ["::b"]}),
        ("a: {b:, c: d}\n", {"a": {"b": None, "c": "d"}}),
        ("a: {b\n  c: d}\n", {"a": {"b c": "d"}}),
        ('a: {"b"\n  : c}\n', {"a": {"b": "c"}}),
        ("a: |\n  b\n   ", {"a": "b\n \n"}),
        ("a: |\n  b\n   \n", {"a": "b\n \n"}),
        ("a: >-\n  b\n ", {"a": "b"}),
        ("a: |\n  b\u2028   ", {"a": "b\u2028   "}),
        ("a: 'b\n  '\n ", {"a": "b "}),
        ("a: b\n  ", {"a": "b"}),
    ],
)
def test_yaml_edge_cases_are_refused_or_yaml_1_2(text: str, value: object) -> None:
    # EU-YML-012. The values are those of YAML 1.2.2, by hand.
    try:
        found: object = read_yaml(Source("robot.yaml", text, text.encode())).data
    except FileError as error:
        found = error.diagnostic.code
    assert found in (value, "yaml-syntax")
