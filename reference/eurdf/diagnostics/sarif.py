"""Diagnostics as a SARIF 2.1.0 log, for code hosts and editors."""

from __future__ import annotations

import os
import re
from collections.abc import Iterable
from functools import cache
from importlib.metadata import PackageNotFoundError, metadata
from pathlib import Path
from typing import Any
from urllib.parse import quote

from eurdf.diagnostics.diagnostic import Diagnostic, Place
from eurdf.diagnostics.fix import Fix
from eurdf.diagnostics.registry import REGISTRY
from eurdf.diagnostics.report import Report
from eurdf.diagnostics.wording import encodable

_SCHEMA = "https://docs.oasis-open.org/sarif/sarif/v2.1.0/errata01/os/schemas/sarif-schema-2.1.0.json"

# Characters that a viewer would read as a link, "[text](target)", or as a placeholder, "{0}".
_LINK = re.compile(r"\[(?=[^\[\]]*\]\()")
_BRACE = re.compile(r"[{}]")


def sarif_log(reports: Iterable[Report], version: str, folder: str | None = None) -> dict[str, Any]:
    """One log with one run that contains the diagnostics of all robots, and the version of eurdf.

    A diagnostic of a URDF that several robots share occurs once. Paths are relative to the folder, by default the
    working directory; a file outside of it has an absolute path.
    """
    found = list(dict.fromkeys(found for report in reports for found in report.diagnostics))
    used = {one.code for one in found}
    codes = [code for code in REGISTRY if code in used]
    index = {code: number for number, code in enumerate(codes)}
    folder = os.getcwd() if folder is None else folder
    driver = {"name": "eurdf", "version": version, "rules": [_rule(code) for code in codes]}
    run = {
        "tool": {"driver": driver},
        "columnKind": "unicodeCodePoints",
        "results": [_result(one, index[one.code], folder) for one in found],
    }
    return {"$schema": _SCHEMA, "version": "2.1.0", "runs": [run]}


def _rule(code: str) -> dict[str, Any]:
    rule = REGISTRY[code]
    properties = {"clause": rule.clause} if rule.clause else {}
    return {
        "id": code,
        "shortDescription": {"text": rule.title},
        "helpUri": help_uri(code),
        "defaultConfiguration": {"level": rule.severity.value},
        "properties": {**properties, "phase": rule.phase.value},
    }


def _result(found: Diagnostic, index: int, folder: str) -> dict[str, Any]:
    text = f"{found.message}."
    if found.hint:
        hint = found.hint[0].upper() + found.hint[1:]
        text = f"{text} {hint}" if hint.endswith(("?", ".")) else f"{text} {hint}."
    fixes = {} if found.fix is None else {"fixes": [_fix(found.fix, folder)]}
    return {
        "ruleId": found.code,
        "ruleIndex": index,
        "level": found.severity.value,
        "message": {"text": _text(text)},
        "locations": [_location(found.place, folder)],
        **fixes,
    }


def _fix(fix: Fix, folder: str) -> dict[str, Any]:
    changes: dict[str, list[dict[str, Any]]] = {}
    for edit in fix.edits:
        region = dict(zip(("startLine", "startColumn", "endLine", "endColumn"), edit.region, strict=True))
        replacement = {"deletedRegion": region, "insertedContent": {"text": encodable(edit.text)}}
        changes.setdefault(_uri(edit.file, folder), []).append(replacement)
    return {
        "description": {"text": _text(fix.summary)},
        "artifactChanges": [
            {"artifactLocation": {"uri": uri}, "replacements": replacements} for uri, replacements in changes.items()
        ],
    }


def _text(text: str) -> str:
    """A text that a viewer shows as it is."""
    return _LINK.sub(r"\\[", _BRACE.sub(lambda brace: 2 * brace.group(), encodable(text)))


def _location(place: Place, folder: str) -> dict[str, Any]:
    physical: dict[str, Any] = {"artifactLocation": {"uri": _uri(place.file, folder)}}
    if place.line is not None:
        region = {"startLine": place.line}
        if place.column is not None:
            region["startColumn"] = place.column
            if place.end_column is not None and place.end_column >= place.column:
                region["endColumn"] = place.end_column
        physical["region"] = region
    location: dict[str, Any] = {"physicalLocation": physical}
    if place.pointer:
        location["logicalLocations"] = [{"fullyQualifiedName": encodable(place.pointer)}]
    return location


def _uri(file: str, folder: str) -> str:
    path = Path(os.path.abspath(os.path.join(folder, file)))
    base = os.path.abspath(folder)
    if path.is_relative_to(base):
        return quote(os.fsencode(path.relative_to(base).as_posix()))
    return path.as_uri()


def help_uri(code: str) -> str:
    """The page of a code on the documentation site of the package, or else the code's URN.

    The site is the URL ``Documentation`` of the package's metadata (``[project.urls]`` in pyproject.toml). Without it,
    the result is ``urn:extended-urdf:…``, as for schemas.
    """
    site = _site()
    return f"{site}/diagnostics/{code}.html" if site else f"urn:extended-urdf:diagnostic:{code}"


@cache
def _site() -> str | None:
    try:
        urls: list[str] = metadata("eurdf").get_all("Project-URL") or []
    except PackageNotFoundError:
        return None
    for url in urls:
        label, _, address = url.partition(",")
        if label.strip().lower() == "documentation":
            return address.strip().rstrip("/")
    return None
