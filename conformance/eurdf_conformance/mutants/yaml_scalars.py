"""Scalars of a description that are resolved by another rule than the core schema of YAML 1.2."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from typing import Any

from eurdf.reading import yaml_reader
from eurdf_conformance.mutants.deviation import Deviation, around
from eurdf_conformance.mutants.mutant import mutant

_BOOLEANS_1_1: dict[str, Any] = {
    **dict.fromkeys(("yes", "Yes", "YES", "on", "On", "ON", "y", "Y"), True),
    **dict.fromkeys(("no", "No", "NO", "off", "Off", "OFF", "n", "N"), False),
}


def _words(other: Mapping[str, Any]) -> Deviation:
    """Some words are something else."""
    return around(yaml_reader, "resolve", lambda resolve, text: other[text] if text in other else resolve(text))


def _pattern(pattern: str, value: Callable[[str], Any]) -> Deviation:
    """What looks like this is something else."""
    matches = re.compile(pattern).fullmatch
    return around(yaml_reader, "resolve", lambda resolve, text: value(text) if matches(text) else resolve(text))


@mutant("EU-YML-011")
def booleans_of_yaml_1_1() -> Deviation:
    """Yes, no, on and off are booleans, as in YAML 1.1."""
    return _words(_BOOLEANS_1_1)


@mutant("EU-YML-011")
def octals_of_yaml_1_1() -> Deviation:
    """A number that begins with 0 is octal, as in YAML 1.1."""
    return _pattern("[-+]?0[0-7]+", lambda text: int(text, 8))


@mutant("EU-YML-011")
def no_octals() -> Deviation:
    """A number that begins with 0o is text, as in YAML 1.1."""
    return _pattern("0o[0-7]+", str)


@mutant("EU-YML-011")
def no_hexadecimals() -> Deviation:
    """A number that begins with 0x is text."""
    return _pattern("0x[0-9a-fA-F]+", str)


@mutant("EU-YML-011")
def base_60() -> Deviation:
    """What looks like a time of day is a number to the base 60, as in YAML 1.1."""
    return _pattern(
        "[0-9]+(:[0-5]?[0-9])+", lambda text: sum(int(n) * 60**i for i, n in enumerate(text.split(":")[::-1]))
    )


@mutant("EU-YML-011")
def underscores_in_numbers() -> Deviation:
    """A number may have underscores, as in YAML 1.1."""
    return _pattern("[0-9]+(_[0-9]+)+", int)


@mutant("EU-YML-011")
def exponent_needs_a_point() -> Deviation:
    """A number with an exponent and no point, or no sign in the exponent, is text, as in PyYAML."""
    return _pattern(r"[-+]?([0-9]+[eE][-+]?[0-9]+|[0-9.]+[eE][0-9]+)", str)


@mutant("EU-YML-011")
def dates() -> Deviation:
    """What looks like a date is a day, as in YAML 1.1."""
    return _pattern("[0-9]{4}-[0-9]{2}-[0-9]{2}", lambda text: {"date": text})


@mutant("EU-YML-011")
def tilde_is_text() -> Deviation:
    """A tilde is text."""
    return _words({"~": "~"})


@mutant("EU-YML-011")
def null_in_lower_case_only() -> Deviation:
    """Null and NULL are text."""
    return _words({"Null": "Null", "NULL": "NULL"})


@mutant("EU-YML-011")
def booleans_in_lower_case_only() -> Deviation:
    """True and TRUE are text, as in JSON."""
    return _words({word: word for word in ("True", "TRUE", "False", "FALSE")})


@mutant("EU-YML-011")
def case_does_not_matter() -> Deviation:
    """Words are null or a boolean in whatever case they are written."""
    return around(
        yaml_reader, "resolve", lambda resolve, text: resolve(text.lower()) if text.isalpha() else resolve(text)
    )


@mutant("EU-YML-011")
def numbers_as_in_json() -> Deviation:
    """A number that JSON could not say, such as .5 or +2, is text."""
    return _pattern(r"\+.*|[-+]?\.[0-9].*|[-+]?[0-9]+\.", str)


@mutant("EU-YML-011")
def quotes_do_not_matter() -> Deviation:
    """What stands in quotes is resolved as if it did not."""

    def scalar(original: Any, self: Any, event: Any) -> None:
        if event.tag is None:
            event.implicit = (True, False)
        original(self, event)

    return around(yaml_reader._Reader, "_scalar", scalar)


@mutant("EU-YML-011")
def words_of_strtod() -> Deviation:
    """The words nan and infinity are numbers, without a point before them, as for strtod."""
    return _pattern("[-+]?(?i:nan|inf|infinity)", lambda text: 0.0)


@mutant("EU-YML-011")
def hexadecimals_with_a_sign() -> Deviation:
    """A number that begins with 0x may have a sign."""
    return _pattern("[-+]0x[0-9a-fA-F]+", lambda text: int(text, 16))


@mutant("EU-YML-011")
def hexadecimals_with_an_exponent() -> Deviation:
    """A number that begins with 0x may have a point and an exponent, as for strtod."""
    return _pattern("[-+]?0x[0-9a-fA-F.]+p[-+]?[0-9]+", float.fromhex)


@mutant("EU-YML-011")
def digits_of_any_script() -> Deviation:
    r"""The digits of any script are digits, as for Python's \d."""
    return _pattern(r"(?=.*[^\x00-\x7f])[-+]?\d+", float)


@mutant("EU-YML-011")
def suffixes_of_java() -> Deviation:
    """A number may have a suffix that says its type, as for Java's parseDouble."""
    return _pattern("[-+]?[0-9.]*[0-9](?<!^3)(?<!^6)[fFdD]", lambda text: float(text[:-1]))
