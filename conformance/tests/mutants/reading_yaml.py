"""Parsers that read another YAML: mostly what the libraries of their languages do."""

from __future__ import annotations

import datetime
import json
import re
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

import yaml

from eurdf_conformance.oracle import yaml_text
from eurdf_conformance.protocol.message import Accepted
from eurdf_conformance.protocol.reply import accepted, rejected
from mutants.mutant import Answer, Deviation, Members, answers, instead, means, reads_description, reads_yaml


def _pyyaml(text: str) -> str | None:
    try:
        return json.dumps(yaml.safe_load(text), default=lambda day: {"date": str(day)})
    except (yaml.YAMLError, ValueError, TypeError, RecursionError):
        return None


wrong = reads_yaml("EU-YML-011")
wrong("The description is read by PyYAML's `safe_load`, which is YAML 1.1.", lambda text: _pyyaml(text))

wrong = reads_yaml("EU-YML-004")
wrong("Of two equal keys the last counts, as in PyYAML.", lambda text: _pyyaml(text))

wrong = reads_yaml("EU-YML-001")
wrong(
    "The escapes of a surrogate pair are one character, as in JSON.",
    lambda text: re.sub(r"\\u[Dd][89ABab][0-9A-Fa-f]{2}\\u[Dd][C-Fc-f][0-9A-Fa-f]{2}", "joined", text),
)
wrong(
    "Of two %YAML directives of one document the last counts.",
    lambda text: text.replace("%YAML 1.2\n%YAML 1.2\n", "%YAML 1.2\n"),
)

wrong = reads_yaml("EU-YML-003")
wrong("What follows the line `...` is not read.", lambda text: re.split(r"(?m)^\.\.\.$", text)[0])

wrong = reads_yaml("EU-YML-010")
wrong("A %YAML directive has no effect, whatever version it names.", lambda text: re.sub(r"(?m)^%YAML.*$", "", text))

wrong = reads_yaml("EU-YML-003")
wrong(
    "Of several documents the first counts.",
    lambda text: re.split(r"(?m)^(?:---|\.\.\.)$", text.removeprefix("---\n"))[0],
)


@reads_description("EU-EXT-001")
def merge_keys_merge(data: Members) -> None:
    """The key << merges a mapping into the one that it is in, as in YAML 1.1."""
    for value in _mappings(data):
        if isinstance(merged := value.get("<<"), dict):
            del value["<<"]
            value.update({**merged, **value})


def _mappings(value: Any) -> Iterator[Members]:
    if isinstance(value, dict):
        yield value
    for item in value.values() if isinstance(value, dict) else value if isinstance(value, list) else ():
        yield from _mappings(item)


def _words(other: Mapping[str, Any]) -> Deviation:
    return instead(yaml_text, "plain", lambda plain, text: other[text] if text in other else plain(text))


def _pattern(pattern: str, value: Callable[[str], Any]) -> Deviation:
    matches = re.compile(pattern).fullmatch
    return instead(yaml_text, "plain", lambda plain, text: value(text) if matches(text) else plain(text))


@means("EU-YML-011")
def booleans_of_yaml_1_1() -> Deviation:
    """`yes`, `no`, `on` and `off` are booleans, as in YAML 1.1."""
    yes, no = ("yes", "Yes", "YES", "y", "Y", "on", "On", "ON"), ("no", "No", "NO", "n", "N", "off", "Off", "OFF")
    return _words(dict.fromkeys(yes, True) | dict.fromkeys(no, False))


wrong = means("EU-YML-011")
wrong(
    "A number that begins with 0 is octal, as in YAML 1.1 and C.",
    lambda: _pattern("[-+]?0[0-7]+", lambda text: int(text, 8)),
)
wrong("A number that begins with 0o is text, as in YAML 1.1.", lambda: _pattern("0o[0-7]+", str))
wrong(
    "12:30 is a number to the base 60, as in YAML 1.1.",
    lambda: _pattern(
        "[0-9]+(:[0-5]?[0-9])+", lambda text: sum(int(n) * 60**i for i, n in enumerate(text.split(":")[::-1]))
    ),
)
wrong("1_000 is a number, as in YAML 1.1.", lambda: _pattern("[0-9]+(_[0-9]+)+", int))
wrong("1e-3 is text, as in PyYAML.", lambda: _pattern(r"[-+]?([0-9]+[eE][-+]?[0-9]+|[0-9.]+[eE][0-9]+)", str))
wrong(
    "2024-01-31 is a date, as in YAML 1.1.",
    lambda: _pattern("[0-9]{4}-[0-9]{2}-[0-9]{2}", lambda text: {"date": datetime.date.fromisoformat(text).day}),
)
wrong(
    "nULL and tRUE are null and true.",
    lambda: instead(yaml_text, "plain", lambda plain, text: plain(text.lower() if text.isalpha() else text)),
)
wrong(
    "A number that JSON does not allow, such as .5 or +2, is text.",
    lambda: _pattern(r"\+.*|[-+]?\.[0-9].*|[-+]?[0-9]+\.", str),
)
wrong(
    "A quoted scalar is resolved as if it were plain.",
    lambda: instead(
        yaml_text, "scalar", lambda scalar, event: scalar(event) if event.tag else yaml_text.plain(event.value)
    ),
)
wrong(
    "A quoted text without characters is null.",
    lambda: instead(yaml_text, "scalar", lambda scalar, event: scalar(event) if event.value else None),
)


@means("EU-YML-011")
def blocks_end_without_a_line_break() -> Deviation:
    """A block scalar loses the line break at its end."""

    def scalar(right: Callable[[Any], Any], event: Any) -> Any:
        found = right(event)
        return found.rstrip("\n") if event.style in ("|", ">") else found

    return instead(yaml_text, "scalar", scalar)


wrong = answers("EU-SEC-001")
wrong(
    "A node with a tag such as !!python/object is accepted.",
    lambda right, description, urdf: (
        accepted() if {issue.code for issue in right.issues} == {"yaml-unknown-tag"} else right
    ),
)


def _rejects_text(where: Callable[[str], Any], right: Answer, description: Path) -> Answer:
    if isinstance(right, Accepted) and where(description.read_bytes().decode()):
        return rejected("this is not supported")
    return right


wrong = answers("EU-FIL-003")
wrong(
    "A description that begins with a byte order mark is rejected.",
    lambda right, description, urdf: _rejects_text(lambda text: text.startswith("\ufeff"), right, description),
)

wrong = answers("EU-YML-001")
wrong(
    "A description with a tab is rejected, wherever it is.",
    lambda right, description, urdf: _rejects_text(lambda text: "\t" in text, right, description),
)

wrong = answers("EU-YML-005")
wrong(
    "A description with a tag of the core schema is rejected.",
    lambda right, description, urdf: _rejects_text(
        lambda text: re.search(r"!!(str|int|float|map|seq|bool|null)", text), right, description
    ),
)

wrong = answers("EU-YML-006")
wrong(
    "A description with an alias is rejected.",
    lambda right, description, urdf: _rejects_text(
        lambda text: re.search(r"(?m)[ \[{,]\*[A-Za-z0-9]", text), right, description
    ),
)


def _depth(value: Any) -> int:
    if not isinstance(value, dict | list):
        return 0
    return 1 + max(map(_depth, value.values() if isinstance(value, dict) else value), default=0)


wrong = answers("EU-YML-007")
wrong(
    "Mappings and lists may be nested 63 deep, not 64.",
    lambda right, description, urdf: _rejects_text(
        lambda text: _depth(yaml_text.value_of(text.removeprefix("\ufeff"))) > 63, right, description
    ),
)


@answers("EU-YML-007")
def scalars_are_nested_too(right: Answer, description: Path, urdf: Path) -> Answer:
    """A scalar in 64 mappings and lists is nested 65 deep."""

    def depth(value: Any) -> int:
        inside = value.values() if isinstance(value, dict) else value if isinstance(value, list) else ()
        return 1 + max(map(depth, inside), default=0)

    return _rejects_text(lambda text: depth(yaml_text.value_of(text.removeprefix("\ufeff"))) > 64, right, description)


@answers("EU-YML-009")
def numbers_of_single_precision(right: Answer, description: Path, urdf: Path) -> Answer:
    """A number beyond the range of single precision is rejected."""

    def large(value: Any) -> bool:
        if isinstance(value, dict | list):
            return any(map(large, value.values() if isinstance(value, dict) else value))
        return isinstance(value, int | float) and abs(value) > 3.4e38

    return _rejects_text(lambda text: large(yaml_text.value_of(text.removeprefix("\ufeff"))), right, description)


wrong = reads_yaml("EU-YML-009")
wrong(
    "`+.inf` is text, as if only the sign - were allowed.", lambda text: re.sub(r"\+\.(inf|Inf|INF)\b", '"inf"', text)
)
wrong("`.NAN` is text; only `.nan` and `.NaN` are no number.", lambda text: re.sub(r"(?<=[ ,])\.NAN\b", '"nan"', text))

wrong = reads_yaml("EU-YML-008")
wrong("The tag of a key is not read: `!!str 12` is a number.", lambda text: re.sub(r"!(!str)? (?=[\w.]+:)", "", text))
wrong("A hexadecimal number as a key is its text.", lambda text: re.sub(r"(?<=[{ ,])(0x[0-9A-F]+)(?=:)", r'"\1"', text))
wrong(
    "A number with a point as a key is its text, as a JSON object has it.",
    lambda text: re.sub(r"(?<=[{ ,])([0-9]+\.[0-9]+)(?=:)", r'"\1"', text),
)


@answers("EU-YML-007")
def aliases_in_aliases_are_no_deeper(right: Answer, description: Path, urdf: Path) -> Answer:
    """An alias inside the value of another alias adds nothing to the depth."""
    is_nested = re.search(rb"(?m)&\w+ [^\n]*\*\w", description.read_bytes())
    return accepted() if is_nested and {issue.code for issue in right.issues} == {"yaml-too-deep"} else right


wrong = answers("EU-YML-009")
wrong(
    "A number with more than 309 digits is beyond a double, also if they are zeros.",
    lambda right, description, urdf: _rejects_text(lambda text: re.search("0{310}", text), right, description),
)


@answers("EU-YML-004")
def keys_by_alias_may_repeat(right: Answer, description: Path, urdf: Path) -> Answer:
    """A key that an alias gives is not compared with the others."""
    is_by_alias = re.search(rb"\*\w+ :", description.read_bytes())
    return accepted() if is_by_alias and {issue.code for issue in right.issues} == {"yaml-duplicate-key"} else right
