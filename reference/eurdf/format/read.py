"""Reading the YAML file: its version, its errors, its content."""

from __future__ import annotations

from collections.abc import Iterable
from functools import partial
from typing import Literal

from eurdf.diagnostics import Diagnostics, Hint, Proposals
from eurdf.format.closure_model import ClosureEntry, NamedFrame
from eurdf.format.conventions import (
    VERSION2_0,
    VERSION2_1,
    VERSION_KEY,
    Version,
    is_own_key,
    may_have_own_keys,
    own_data,
)
from eurdf.format.fixes import added, removed, renamed, restated
from eurdf.format.joint_model import Fixed, Geared, JointEntry, Spherical, Universal
from eurdf.format.model import DESCRIPTION, VERSION1, VERSION2, Description, Version1, violations
from eurdf.format.wording import described, near, quoted
from eurdf.reading.other_formats import of_mapping
from eurdf.reading.yaml_reader import YamlDocument, YamlReporter

_KEYS1, _KEYS2 = VERSION1.all_keys, VERSION2.all_keys


def read_description(document: YamlDocument, diagnostics: Diagnostics) -> Description | None:
    """The description in a YAML file, of whichever version it is, before any name in it is looked up.

    None if an error was found.
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
    found = violations(version, data)
    if found:
        from eurdf.format.messages import diagnostics_of

        for diagnostic in diagnostics_of(found, version, document):
            diagnostics.add(diagnostic)
        return None
    if version == "1":
        return _from_version1(document) if _lengths_agree(reporter) else None
    if data is not document.data:
        return None
    own = dict(own_data(data)) if may_have_own_keys(document.source.text) else {}
    description: Description = DESCRIPTION.read(data, (), document=document, own_data=own)
    return description


# -- version 1 --------------------------------------------------------------------------------------------------------


def _from_version1(document: YamlDocument) -> Description:
    """The description in a file of version 1, whose parallel lists are of equal length.

    Keys other than the five are kept (EU-ONE-008). Closures are named ``closure_1``, ``closure_2``, … in file order
    (EU-ONE-005), and are 6d where the key ``type`` is left out (EU-ONE-004).
    """
    data = document.data
    file: Version1 = VERSION1.read(data, ())
    types = file.type or ["6d"] * len(file.closed_loop)
    return Description(
        document=document,
        extended_urdf="1",
        closures=tuple(
            ClosureEntry(
                pointer=("closed_loop", index),
                name=f"closure_{index + 1}",
                type=kind.lower(),
                frames=(
                    NamedFrame(pointer=("closed_loop", index, 0), target=a),
                    NamedFrame(pointer=("closed_loop", index, 1), target=b),
                ),
            )
            for index, ((a, b), kind) in enumerate(zip(file.closed_loop, types, strict=True))
        ),
        joints=tuple(map(_joint_of_version1, range(len(file.joint_name)), file.joint_name, file.joint_type)),
        actuators=tuple(Geared(pointer=("name_mot", index), joint=joint) for index, joint in enumerate(file.name_mot)),
        own_data={(key,): value for key, value in data.items() if key not in _KEYS1},
    )


def _joint_of_version1(index: int, name: str, kind: str) -> JointEntry:
    pointer = ("joint_name", index)
    if kind == "SPHERICAL":
        return Spherical(pointer=pointer, name=name, type="spherical")
    if kind == "FIXED":
        return Fixed(pointer=pointer, name=name, type="fixed")
    return Universal(pointer=pointer, name=name, type="universal", axes=(), split=kind.removeprefix("UJOINT_"))


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
            reporter.report("length-mismatch", message, (shorter,))
    return agree


def _warn_of_other_format(reporter: YamlReporter) -> None:
    """Warn of a file without any key of version 1 that another program reads: all of it is the user's own data."""
    data = reporter.document.data
    found = of_mapping(data)
    if found is not None and data.keys().isdisjoint(_KEYS1):
        message = f"the file is {found.title}; as a description of version 1, it has no closure"
        reporter.report("x-other-format", message, (next(iter(data)),), found.hint, key=True)


def _warn_of_near_misses(reporter: YamlReporter) -> None:
    """Warn of keys that are read as user-defined, but look like keys of the format (EU-ONE-002)."""
    for key in reporter.document.data:
        if key in _KEYS1 or is_own_key(key):
            continue
        hint: Hint = None
        proposals: Proposals = ()
        if key != "metadata" and key in _KEYS2:  # ``metadata`` is likely the user's own
            version = _first_version_with(key)
            message = f"'{key}' is a key of version {version}; in this file of version 1 it is your own data"
            hint = f'a file of version {version} begins with {VERSION_KEY}: "{version}" and has no key of version 1'
        elif meant := near(key, (*_KEYS1, VERSION_KEY)):
            message = f"{quoted(key)} is similar to '{meant}', but is read as your own data"
            proposals = partial(renamed, reporter.document, (key,), meant, key=True)
        else:
            continue
        reporter.report("near-miss-key", message, (key,), hint, proposals, key=True)


# -- the version of a file --------------------------------------------------------------------------------------------


def version_of(document: YamlDocument) -> Version | None:
    """The version of a file; None if it has an error that leaves this unknown."""
    return _version(YamlReporter(document, Diagnostics()))


def _version(reporter: YamlReporter) -> Version | None:
    """The version of a file (EU-VER-002, EU-VER-003); None if unknown."""
    data = reporter.document.data
    if VERSION_KEY in data:
        return _written_version(reporter)
    if not data.keys().isdisjoint(_KEYS1):
        return "1"
    misspelt = next((key for key in data if not is_own_key(key) and near(key, [VERSION_KEY])), None)
    if misspelt is not None:
        message = f"the file has the key {quoted(misspelt)}, but not '{VERSION_KEY}', which states its version"
        proposals = renamed(reporter.document, (misspelt,), VERSION_KEY, key=True)
        reporter.report("missing-key", message, (misspelt,), None, proposals, key=True)
        return None
    version2_key = _first(data, _KEYS2)
    if version2_key is None:
        return "1"
    version = _first_version_with(version2_key)
    message = f"the file has '{version2_key}', a key of version {version}, but lacks '{VERSION_KEY}'"
    hint = f'begin the file with {VERSION_KEY}: "{version}"'
    if found := of_mapping(data):
        message, hint = f"the file lacks '{VERSION_KEY}': it is {found.title}", found.hint
    proposals = added(reporter.document, (), VERSION_KEY, version)
    reporter.report("missing-key", message, (version2_key,), hint, proposals, key=True)
    return None


def _first(data: Iterable[str], keys: Iterable[str]) -> str | None:
    return next((key for key in data if key in keys), None)


def _first_version_with(key: str) -> Version:
    """The first version that has a key of the whole file of version 2."""
    return VERSION2_0 if key in VERSION2.keys(VERSION2_0) else VERSION2_1


def _written_version(reporter: YamlReporter) -> Literal["2.0", "2.1"] | None:
    """Version 2.0 or 2.1, or None if the file states another (EU-VER-001)."""
    value = reporter.document.data[VERSION_KEY]
    pointer = (VERSION_KEY,)
    meant: Literal["2.0", "2.1"] = VERSION2_1 if value == float(VERSION2_1) else VERSION2_0
    hint = f'write {VERSION_KEY}: "{meant}", in quotes'
    if value in (VERSION2_0, VERSION2_1):
        return VERSION2_0 if value == VERSION2_0 else VERSION2_1
    if value in ("1", "1.0"):
        message = f"'{VERSION_KEY}' cannot be {described(value)}: a file of version 1 does not state its version"
        proposals = removed(reporter.document, pointer, f"'{VERSION_KEY}'")
        reporter.report("unsupported-version", message, pointer, f"leave '{VERSION_KEY}' out", proposals)
        return None
    if isinstance(value, str):
        message = f"version {described(value)} of Extended URDF is not known"
        hint = f"the known versions are {VERSION2_0} and {VERSION2_1}: {hint}"
        known = {"2": VERSION2_0, VERSION2_0: VERSION2_0, VERSION2_1: VERSION2_1}.get(value.strip().lstrip("vV"))
        proposals = () if known is None else (restated(reporter.document, pointer, known, f"write {VERSION_KEY}:"),)
        reporter.report("unsupported-version", message, pointer, hint, proposals)
        return None
    is_number = isinstance(value, int | float) and not isinstance(value, bool)
    shown = f"the number {value}" if is_number else described(value)
    if shown in ("the number 1", "the number 1.0"):
        hint = f"leave '{VERSION_KEY}' out: a file of version 1 does not state its version"
    is_known = value in (2, float(VERSION2_1))
    proposals = (restated(reporter.document, pointer, meant, f"write {VERSION_KEY}:"),) if is_known else ()
    reporter.report("wrong-type", f"'{VERSION_KEY}' must be text, not {shown}", pointer, hint, proposals)
    return meant
