"""YAML as the oracle reads it: the core schema of YAML 1.2, whatever its library would make of a scalar."""

from __future__ import annotations

from typing import Any

import pytest

from eurdf_conformance.oracle import NotRead
from eurdf_conformance.oracle.yaml_text import value_of

PLAIN = {
    **{text: text for text in ("yes", "no", "on", "off", "y", "n", "12:30", "1_000", "0b11", "0o8", "0X1F", "-0x1F")},
    **{text: text for text in ("2001-01-01", ".", "-.", "1e", "1e+", "nULL", "tRue", "=", "<<", "1,000", "+", "1.2.3")},
    **dict.fromkeys(("null", "Null", "NULL", "~", "")),
    **dict.fromkeys(("true", "True", "TRUE"), True),
    **dict.fromkeys(("false", "False", "FALSE"), False),
    "012": 12,
    "-012": -12,
    "+2": 2,
    "0o14": 12,
    "0x1F": 31,
    "1e-3": 0.001,
    "1E3": 1000.0,
    "+1.e+3": 1000.0,
    ".5": 0.5,
    "-.5": -0.5,
    "1.": 1.0,
    "-0.0": -0.0,
}


@pytest.mark.parametrize(("text", "value"), PLAIN.items())
def test_a_plain_scalar_has_the_type_of_the_core_schema(text: str, value: Any) -> None:
    for source in (f"key: {text}", f"{{key: {text} }}"):
        found = value_of(source)["key"] if "," not in text else value
        assert (found, type(found)) == (value, type(value))


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ('"12"', "12"),
        ("'no'", "no"),
        ("! 12", "12"),
        ("!!str 12", "12"),
        ("!!str", ""),
        ("!!int 012", 12),
        ("!!float 3", 3.0),
        ("!!float .5", 0.5),
        ('!!bool "true"', True),
        ("!!null ''", None),
        ("|\n  12\n", "12\n"),
        (">-\n  a\n  b\n", "a b"),
        ("!!seq [1]", [1]),
        ("!!map {a: 1}", {"a": 1}),
        ("[&a {x: no}, *a, &a 2, *a]", [{"x": "no"}, {"x": "no"}, 2, 2]),
        ("[&a [&a 1, *a], *a]", [[1, 1], 1]),
        ("[&a [&a [&a 1]], *a]", [[[1]], 1]),
        ('{"a":1, b: , "": c}', {"a": 1, "b": None, "": "c"}),
        ("{<<: {a: 1}}", {"<<": {"a": 1}}),
        ("[http://a.b/c, a#b]", ["http://a.b/c", "a#b"]),
        ("a\x85b\u2028c\u2029\ue000", "a\x85b\u2028c\u2029\ue000"),
    ],
)
def test_quotes_tags_blocks_and_aliases_have_their_yaml_meaning(text: str, value: Any) -> None:
    found = value_of(f"key: {text}")["key"]
    assert (found, type(found)) == (value, type(value))


@pytest.mark.parametrize("source", ["%YAML 1.2\n---\nkey: 1", "---\nkey: 1\n...\n", "key: 1\r\n", "{key: 1} # end"])
def test_a_document_may_have_start_and_end_markers(source: str) -> None:
    assert value_of(source) == {"key": 1}


@pytest.mark.parametrize(
    "text",
    [
        ".inf",
        "-.INF",
        ".nan",
        "1e400",
        "9" * 400,
        "9" * 5000,
        "!own 1",
        "!!set {a}",
        "!!timestamp 2001-01-01",
        "!!int 1.0",
        "!!int x",
        "!!float 0x10",
        "!<int> 1",
        "!!map [1]",
        "*a",
        "&a [*a]",
        "[&a 1, &a [*a]]",
        "{a: 1, a: 2}",
        "{a: 1, 'a': 2}",
        "{1: 2}",
        "{null: 2}",
        "{[a]: 2}",
        "[a",
        '"\\ud800"',
        "1\n---\nkey: 2",
        "[" * 70 + "]" * 70,
        "\n - &a [1, 1, 1, 1, 1, 1, 1, 1, 1, 1]"
        + "".join(f"\n - &{b} [{', '.join(['*' + a] * 10)}]" for a, b in zip("abcde", "bcdef", strict=True)),
    ],
)
def test_an_invalid_value_is_not_read(text: str) -> None:
    with pytest.raises(NotRead):
        value_of(f"key: {text}")


@pytest.mark.parametrize("source", ["", "# nothing", "%YAML 1.1\n---\na: 1", "%YAML 1.3\n---\na: 1"])
def test_no_document_or_another_yaml_version_is_not_read(source: str) -> None:
    with pytest.raises(NotRead):
        value_of(source)
