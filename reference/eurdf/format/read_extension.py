"""Reading the YAML file: its version, its errors, its content."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

from eurdf.diagnostics import Diagnostics
from eurdf.format.conforms import conforms, keys_of
from eurdf.format.described import described, quoted
from eurdf.format.extension import Extension
from eurdf.format.near import near
from eurdf.format.normal_form import from_version1, from_version2
from eurdf.format.own_key import is_own_key
from eurdf.format.version import VERSION2_0, VERSION2_1, VERSION_KEY, Version
from eurdf.reading.other_formats import of_mapping
from eurdf.reading.reporter import YamlReporter

if TYPE_CHECKING:
    from eurdf.reading.yaml_reader import YamlDocument


def read_extension(document: YamlDocument, diagnostics: Diagnostics) -> Extension | None:
    """The description in a YAML file, of whichever version it is, before any name in it is looked up.

    Args:
        document: The file.
        diagnostics: Where findings are added.

    Returns:
        The description, or None if an error was found.
    """
    data = document.data
    reporter = YamlReporter(document, diagnostics)
    version = _version(reporter)
    if version is None:
        return None
    if version == "1":
        _warn_of_other_format(reporter)
        _warn_of_near_misses(reporter)
    elif data[VERSION_KEY] != version:  # already reported; report other errors too
        data = {**data, VERSION_KEY: version}
    if not conforms(version)(data):
        from eurdf.format.violation import violations

        found = violations(version, data, document)
        for diagnostic in found:
            diagnostics.add(diagnostic)
        if found:
            return None
    if version == "1":
        return from_version1(document) if _lengths_agree(reporter) else None
    return from_version2(version, document) if data is document.data else None


def version_of(document: YamlDocument) -> Version | None:
    """The version of a file; None if it has an error that leaves this unknown."""
    return _version(YamlReporter(document, Diagnostics()))


def _version(reporter: YamlReporter) -> Version | None:
    """The version of a file (EU-VER-002, EU-VER-003); None if unknown."""
    data = reporter.document.data
    if VERSION_KEY in data:
        return _written_version(reporter)
    if any(key in data for key in keys_of("1")):
        return "1"
    misspelt = next((key for key in data if not is_own_key(key) and near(key, [VERSION_KEY])), None)
    if misspelt is not None:
        reporter.report(
            "missing-key",
            f"the file has the key {quoted(misspelt)}, but not '{VERSION_KEY}', which states its version",
            (misspelt,),
            f"did you mean '{VERSION_KEY}'?",
            key=True,
        )
        return None
    version2_key = next((key for key in data if key in keys_of(VERSION2_1)), None)
    if version2_key is not None:
        version = _first_version_with(version2_key)
        message = f"the file has '{version2_key}', a key of version {version}, but lacks '{VERSION_KEY}'"
        hint = f'begin the file with {VERSION_KEY}: "{version}"'
        if found := of_mapping(data):
            message, hint = f"the file lacks '{VERSION_KEY}': it is {found.title}", found.hint
        reporter.report("missing-key", message, (version2_key,), hint, key=True)
        return None
    return "1"


def _first_version_with(key: str) -> str:
    """The first version that has a key of the whole file."""
    return VERSION2_0 if key in keys_of(VERSION2_0) else VERSION2_1


def _written_version(reporter: YamlReporter) -> Literal["2.0", "2.1"] | None:
    """Version 2.0 or 2.1, or None if the file states another (EU-VER-001)."""
    value = reporter.document.data[VERSION_KEY]
    pointer = (VERSION_KEY,)
    meant: Literal["2.0", "2.1"] = VERSION2_1 if value == float(VERSION2_1) else VERSION2_0
    quoted = f'write {VERSION_KEY}: "{meant}", in quotes'
    if value in (VERSION2_0, VERSION2_1):
        return VERSION2_0 if value == VERSION2_0 else VERSION2_1
    if value in ("1", "1.0"):
        message = f"'{VERSION_KEY}' cannot be {described(value)}: a file of version 1 does not state its version"
        reporter.report("unsupported-version", message, pointer, f"leave '{VERSION_KEY}' out")
        return None
    if isinstance(value, str):
        hint = f"the known versions are {VERSION2_0} and {VERSION2_1}: {quoted}"
        reporter.report(
            "unsupported-version", f"version {described(value)} of Extended URDF is not known", pointer, hint
        )
        return None
    shown = (
        f"the number {value}" if isinstance(value, int | float) and not isinstance(value, bool) else described(value)
    )
    message = f"'{VERSION_KEY}' must be text, not {shown}"
    if shown in ("the number 1", "the number 1.0"):
        quoted = f"leave '{VERSION_KEY}' out: a file of version 1 does not state its version"
    reporter.report("wrong-type", message, pointer, quoted)
    return meant


def _warn_of_other_format(reporter: YamlReporter) -> None:
    """Warn of a file without any key of version 1 that another program reads: all of it is the user's own data."""
    data = reporter.document.data
    found = of_mapping(data)
    if found is not None and not any(key in data for key in keys_of("1")):
        message = f"the file is {found.title}; as a description of version 1, it has no closure"
        reporter.report("x-other-format", message, (next(iter(data)),), found.hint, key=True)


def _warn_of_near_misses(reporter: YamlReporter) -> None:
    """Warn of keys that are read as user-defined, but look like keys of the format (EU-ONE-002)."""
    known = keys_of("1")
    for key in reporter.document.data:
        if key in known or is_own_key(key):
            continue
        if key != "metadata" and key in keys_of(VERSION2_1):  # ``metadata`` is likely the user's own
            version = _first_version_with(key)
            message = f"'{key}' is a key of version {version}; in this file of version 1 it is your own data"
            hint = f'a file of version {version} begins with {VERSION_KEY}: "{version}" and has no key of version 1'
        elif meant := near(key, (*known, VERSION_KEY)):
            message = f"{quoted(key)} is similar to '{meant}', but is read as your own data"
            hint = f"did you mean '{meant}'?"
        else:
            continue
        reporter.report(
            "near-miss-key",
            message,
            (key,),
            hint,
            key=True,
        )


def _lengths_agree(reporter: YamlReporter) -> bool:
    """Whether the lists of version 1 that belong together have the same length (EU-ONE-003)."""
    data = reporter.document.data
    agree = True
    for first, second in (("closed_loop", "type"), ("joint_name", "joint_type")):
        if second not in data:
            continue
        lengths = {key: len(data.get(key, ())) for key in (first, second)}
        if lengths[first] != lengths[second]:
            agree = False
            shorter = min((key for key in lengths if key in data), key=lambda key: lengths[key])
            counts = f"{lengths[first]} and {lengths[second]}"
            message = f"'{first}' and '{second}' must have the same number of items, not {counts}"
            reporter.report(
                "length-mismatch",
                message,
                (shorter,),
            )
    return agree
