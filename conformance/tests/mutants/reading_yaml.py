"""Parsers that read another YAML: mostly what the libraries of their languages do."""

from __future__ import annotations

import datetime
import json
import re
from collections.abc import Callable, Iterator, Mapping
from functools import partial
from typing import Any

import yaml

from eurdf_conformance.oracle import yaml_text
from mutants.mutant import Answer, Deviation, Members, accepting, instead, rejecting, text_of


def _pyyaml(text: str) -> str | None:
    try:
        return json.dumps(yaml.safe_load(text), default=lambda day: {"date": str(day)})
    except (yaml.YAMLError, ValueError, TypeError, RecursionError):
        return None


READS_YAML = {
    "EU-YML-001": {
        "The escapes of a surrogate pair are one character, as in JSON.": partial(
            re.sub, r"\\u[Dd][89ABab][0-9A-Fa-f]{2}\\u[Dd][C-Fc-f][0-9A-Fa-f]{2}", "joined"
        ),
        "Of two %YAML directives of one document the last counts.": partial(
            re.sub, "%YAML 1.2\n%YAML 1.2\n", "%YAML 1.2\n"
        ),
    },
    "EU-YML-003": {
        "What follows the line `...` is not read.": lambda text: re.split(r"(?m)^\.\.\.$", text)[0],
        "Of several documents the first counts.": lambda text: re.split(
            r"(?m)^(?:---|\.\.\.)$", text.removeprefix("---\n")
        )[0],
    },
    "EU-YML-004": {"Of two equal keys the last counts, as in PyYAML.": _pyyaml},
    "EU-YML-008": {
        "The tag of a key is not read: `!!str 12` is a number.": partial(re.sub, r"!(!str)? (?=[\w.]+:)", ""),
        "A hexadecimal number as a key is its text.": partial(re.sub, r"(?<=[{ ,])(0x[0-9A-F]+)(?=:)", r'"\1"'),
        "A number with a point as a key is its text, as a JSON object has it.": partial(
            re.sub, r"(?<=[{ ,])([0-9]+\.[0-9]+)(?=:)", r'"\1"'
        ),
    },
    "EU-YML-009": {
        "`+.inf` is text, as if only the sign - were allowed.": partial(re.sub, r"\+\.(inf|Inf|INF)\b", '"inf"'),
        "`.NAN` is text; only `.nan` and `.NaN` are no number.": partial(re.sub, r"(?<=[ ,])\.NAN\b", '"nan"'),
    },
    "EU-YML-010": {
        "A %YAML directive has no effect, whatever version it names.": partial(re.sub, r"(?m)^%YAML.*$", ""),
    },
    "EU-YML-011": {"The description is read by PyYAML's `safe_load`, which is YAML 1.1.": _pyyaml},
}


def _mappings(value: Any) -> Iterator[Members]:
    if isinstance(value, dict):
        yield value
    for item in value.values() if isinstance(value, dict) else value if isinstance(value, list) else ():
        yield from _mappings(item)


def _merge(data: Members) -> None:
    for value in _mappings(data):
        if isinstance(merged := value.get("<<"), dict):
            del value["<<"]
            value.update({**merged, **value})


READS_DESCRIPTION = {
    "EU-EXT-001": {"The key << merges a mapping into the one that it is in, as in YAML 1.1.": _merge},
}

_scalar = partial(instead, yaml_text, "scalar")


def _words(other: Mapping[str, Any]) -> Deviation:
    return instead(yaml_text, "plain", lambda plain, text: other[text] if text in other else plain(text))


def _pattern(pattern: str, value: Callable[[str], Any]) -> Deviation:
    matches = re.compile(pattern).fullmatch
    return instead(yaml_text, "plain", lambda plain, text: value(text) if matches(text) else plain(text))


def _without_the_last_line_break(right: Callable[[Any], Any], event: Any) -> Any:
    found = right(event)
    return found.rstrip("\n") if event.style in ("|", ">") else found


MEANS = {
    "EU-YML-011": {
        "`yes`, `no`, `on` and `off` are booleans, as in YAML 1.1.": _words(
            dict.fromkeys(("yes", "Yes", "YES", "y", "Y", "on", "On", "ON"), True)
            | dict.fromkeys(("no", "No", "NO", "n", "N", "off", "Off", "OFF"), False)
        ),
        "A number that begins with 0 is octal, as in YAML 1.1 and C.": _pattern(
            "[-+]?0[0-7]+", lambda text: int(text, 8)
        ),
        "A number that begins with 0o is text, as in YAML 1.1.": _pattern("0o[0-7]+", str),
        "12:30 is a number to the base 60, as in YAML 1.1.": _pattern(
            "[0-9]+(:[0-5]?[0-9])+", lambda text: sum(int(n) * 60**i for i, n in enumerate(text.split(":")[::-1]))
        ),
        "1_000 is a number, as in YAML 1.1.": _pattern("[0-9]+(_[0-9]+)+", int),
        "1e-3 is text, as in PyYAML.": _pattern(r"[-+]?([0-9]+[eE][-+]?[0-9]+|[0-9.]+[eE][0-9]+)", str),
        "2024-01-31 is a date, as in YAML 1.1.": _pattern(
            "[0-9]{4}-[0-9]{2}-[0-9]{2}", lambda text: {"date": datetime.date.fromisoformat(text).day}
        ),
        "nULL and tRUE are null and true.": instead(
            yaml_text, "plain", lambda plain, text: plain(text.lower() if text.isalpha() else text)
        ),
        "A number that JSON does not allow, such as .5 or +2, is text.": _pattern(
            r"\+.*|[-+]?\.[0-9].*|[-+]?[0-9]+\.", str
        ),
        "A quoted scalar is resolved as if it were plain.": _scalar(
            lambda right, event: right(event) if event.tag else yaml_text.plain(event.value)
        ),
        "A quoted text without characters is null.": _scalar(
            lambda right, event: right(event) if event.value else None
        ),
        "A block scalar loses the line break at its end.": _scalar(_without_the_last_line_break),
    },
}


def _rejecting(where: Callable[[str], Any]) -> Callable[..., Answer]:
    """Some texts of descriptions are rejected."""
    return rejecting(lambda description, urdf: where(description.read_bytes().decode()))


def _deeper_than(most: int, scalar: int) -> Callable[..., Answer]:
    """Values that are nested deeper are rejected, where a scalar counts so much."""

    def depth(value: Any) -> int:
        if not isinstance(value, dict | list):
            return scalar
        return 1 + max(map(depth, value.values() if isinstance(value, dict) else value), default=0)

    return _rejecting(lambda text: depth(yaml_text.value_of(text.removeprefix("\ufeff"))) > most)


def _is_large(value: Any) -> bool:
    if isinstance(value, dict | list):
        return any(map(_is_large, value.values() if isinstance(value, dict) else value))
    return isinstance(value, int | float) and abs(value) > 3.4e38


def _accepting(code: str, pattern: str) -> Callable[..., Answer]:
    """What must be rejected with a code is accepted in some texts of descriptions."""
    return accepting(code, lambda issue, description, urdf: re.search(pattern, text_of(description)))


ANSWERS = {
    "EU-SEC-001": {"A node with a tag such as !!python/object is accepted.": accepting("yaml-unknown-tag")},
    "EU-FIL-003": {
        "A description that begins with a byte order mark is rejected.": _rejecting(
            lambda text: text.startswith("\ufeff")
        ),
    },
    "EU-YML-001": {"A description with a tab is rejected, wherever it is.": _rejecting(lambda text: "\t" in text)},
    "EU-YML-004": {
        "A key that an alias gives is not compared with the others.": _accepting("yaml-duplicate-key", r"\*\w+ :"),
    },
    "EU-YML-005": {
        "A description with a tag of the core schema is rejected.": _rejecting(
            re.compile(r"!!(str|int|float|map|seq|bool|null)").search
        ),
    },
    "EU-YML-006": {
        "A description with an alias is rejected.": _rejecting(re.compile(r"(?m)[ \[{,]\*[A-Za-z0-9]").search),
    },
    "EU-YML-007": {
        "Mappings and lists may be nested 63 deep, not 64.": _deeper_than(63, scalar=0),
        "A scalar in 64 mappings and lists is nested 65 deep.": _deeper_than(64, scalar=1),
        "An alias inside the value of another alias adds nothing to the depth.": _accepting(
            "yaml-too-deep", r"(?m)&\w+ [^\n]*\*\w"
        ),
    },
    "EU-YML-009": {
        "A number beyond the range of single precision is rejected.": _rejecting(
            lambda text: _is_large(yaml_text.value_of(text.removeprefix("\ufeff")))
        ),
        "A number with more than 309 digits is beyond a double, also if they are zeros.": _rejecting(
            re.compile("0{310}").search
        ),
    },
}
