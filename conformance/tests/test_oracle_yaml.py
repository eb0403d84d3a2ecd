"""YAML as the oracle reads it: the core schema of YAML 1.2, whatever its library would make of a scalar."""

from __future__ import annotations

import pytest

from eurdf_conformance.oracle import NotRead
from eurdf_conformance.oracle.yaml_text import value_of


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
