"""The result of a check of one robot, and its JSON form."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

from eurdf.diagnostics.diagnostic import Diagnostic
from eurdf.diagnostics.registry import OWN_PREFIX, Phase, Severity

#: Version of the JSON form; it increases by one when a field changes its meaning or is removed.
REPORT_VERSION = 1


@dataclass(frozen=True, slots=True)
class Report:
    """The diagnostics of one robot.

    Attributes:
        path: The robot as the user gave it: a folder, a file, or a name of the collection.
        diagnostics: In the order found.
    """

    path: str
    diagnostics: tuple[Diagnostic, ...] = ()

    @property
    def errors(self) -> tuple[Diagnostic, ...]:
        """The errors."""
        return tuple(found for found in self.diagnostics if found.severity is Severity.ERROR)

    @property
    def warnings(self) -> tuple[Diagnostic, ...]:
        """The warnings."""
        return tuple(found for found in self.diagnostics if found.severity is Severity.WARNING)

    @property
    def ok(self) -> bool:
        """Whether there is no error."""
        return not self.errors

    def passes(self, strict: bool = False) -> bool:
        """Whether there is no error and, if strict, no warning."""
        return not (self.diagnostics if strict else self.errors)

    def to_json(self, strict: bool = False) -> dict[str, Any]:
        """One entry of ``robots`` in `reports_to_json`; ``ok`` is the result of `passes`."""
        return {
            "path": encodable(self.path),
            "ok": self.passes(strict),
            "diagnostics": [_diagnostic_to_json(found) for found in self.diagnostics],
        }


def reports_to_json(reports: Iterable[Report], strict: bool = False, skipped: Iterable[str] = ()) -> dict[str, Any]:
    """The diagnostics of any number of robots as one object; `report_schema` describes it.

    Args:
        reports: One for each robot, in the order to show.
        strict: Whether a warning makes ``ok`` false, too; severities do not change.
        skipped: Folders without a robot that were given among others.
    """
    robots = [report.to_json(strict) for report in reports]
    ok = all(robot["ok"] for robot in robots)
    return {"version": REPORT_VERSION, "ok": ok, "robots": robots, "skipped": [encodable(path) for path in skipped]}


def _diagnostic_to_json(found: Diagnostic) -> dict[str, Any]:
    place = found.place
    return {
        "code": found.code,
        "severity": found.severity.value,
        "phase": found.phase.value,
        "clause": found.clause,
        "message": encodable(found.message),
        "hint": None if found.hint is None else encodable(found.hint),
        "file": encodable(place.file),
        "line": place.line,
        "column": place.column,
        "end_column": place.end_column,
        "pointer": encodable(place.pointer),
    }


def encodable(text: str) -> str:
    """The text with lone surrogates (as in an undecodable file name) replaced by escapes."""
    return text.encode("utf-8", "backslashreplace").decode("utf-8")


def report_schema() -> dict[str, Any]:
    """The JSON Schema (2020-12) of `reports_to_json`."""
    position = {"type": ["integer", "null"], "minimum": 1}
    diagnostic = _closed_object(
        "One diagnostic.",
        {
            "code": {
                "type": "string",
                "pattern": "^[a-z0-9]+(-[a-z0-9]+)*$",
                "description": "A permanent name of the error, never used for anything else. A code that begins with "
                f"'{OWN_PREFIX}' is advice of this parser, which no clause of the specification requires.",
                "examples": ["unknown-frame"],
            },
            "severity": {
                "enum": [severity.value for severity in Severity],
                "description": "An error violates a MUST of the specification; a warning, a SHOULD, or it is advice.",
            },
            "phase": {
                "enum": [phase.value for phase in Phase],
                "description": "The phase that reports it; an error can prevent later phases from running.",
            },
            "clause": {
                "type": ["string", "null"],
                "pattern": "^EU-[A-Z]{3}-[0-9]{3}$",
                "description": "Id of the violated clause of the specification; null for advice.",
                "examples": ["EU-FRM-001"],
            },
            "message": {
                "type": "string",
                "description": "What is wrong, as one sentence without a full stop.",
                "examples": ["closure 'knee' names the frame 'rod_tpi', which does not exist"],
            },
            "hint": {
                "type": ["string", "null"],
                "description": "What to do about it; null if unknown.",
                "examples": ["did you mean 'rod_tip'?"],
            },
            "file": {
                "type": "string",
                "description": "Path of the file, as given or relative to the working directory.",
                "examples": ["robots/four_bar/robot.yaml"],
            },
            "line": {**position, "description": "Line, from 1; null for the whole file."},
            "column": {**position, "description": "Column, from 1, in Unicode code points; null if unknown."},
            "end_column": {
                **position,
                "description": "Column after the last character of the place, on the same line; null if unknown.",
            },
            "pointer": {
                "type": "string",
                "description": "JSON pointer of the value in a YAML file, XPath of the element or attribute in a URDF.",
                "examples": ["/closures/0/frames/1", "/robot/joint[3]/limit/@lower"],
            },
        },
    )
    robot = _closed_object(
        "The diagnostics of one robot.",
        {
            "path": {
                "type": "string",
                "description": "The robot as given: a folder, a file, or a name of the collection.",
                "examples": ["robots/four_bar"],
            },
            "ok": {
                "type": "boolean",
                "description": "Whether the robot passes: no error and, in a strict check, no warning.",
            },
            "diagnostics": {
                "type": "array",
                "items": diagnostic,
                "description": "The diagnostics, in the order found.",
            },
        },
    )
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "Report of a check of Extended URDF robots",
        **_closed_object(
            "What 'eurdf check --format json' writes.",
            {
                "version": {"const": REPORT_VERSION, "description": "Version of this form."},
                "ok": {"type": "boolean", "description": "Whether every robot passes."},
                "robots": {"type": "array", "items": robot, "description": "One entry for each robot."},
                "skipped": {
                    "type": "array",
                    "items": {"type": "string"},
                    "description": "Folders without a robot that were given among others.",
                    "examples": [["robots/textures"]],
                },
            },
        ),
    }


def _closed_object(description: str, properties: dict[str, Any]) -> dict[str, Any]:
    return {
        "type": "object",
        "description": description,
        "properties": properties,
        "required": list(properties),
        "additionalProperties": False,
    }
