"""What a check found on one robot, and its form in JSON."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

from eurdf.diagnostics.diagnostic import Diagnostic
from eurdf.diagnostics.registry import OWN_PREFIX, Phase, Severity

#: Version of the JSON form; it grows by one when a field changes its meaning or goes.
REPORT_VERSION = 1


@dataclass(frozen=True, slots=True)
class Report:
    """The findings on one robot.

    Attributes:
        path: The robot, as the user named it: a folder, a file, or a name of the collection.
        diagnostics: In the order found.
    """

    path: str
    diagnostics: tuple[Diagnostic, ...] = ()

    @property
    def errors(self) -> tuple[Diagnostic, ...]:
        """The findings of severity error."""
        return tuple(found for found in self.diagnostics if found.severity is Severity.ERROR)

    @property
    def warnings(self) -> tuple[Diagnostic, ...]:
        """The findings of severity warning."""
        return tuple(found for found in self.diagnostics if found.severity is Severity.WARNING)

    @property
    def ok(self) -> bool:
        """Whether there is no error."""
        return not self.errors

    def passes(self, strict: bool = False) -> bool:
        """Whether there is no error and, when strict, no warning either."""
        return not (self.diagnostics if strict else self.errors)

    def to_json(self, strict: bool = False) -> dict[str, Any]:
        """One entry of ``robots`` in `reports_to_json`; ``ok`` is what `passes` says."""
        return {
            "path": encodable(self.path),
            "ok": self.passes(strict),
            "diagnostics": [_diagnostic_to_json(found) for found in self.diagnostics],
        }


def reports_to_json(reports: Iterable[Report], strict: bool = False) -> dict[str, Any]:
    """The findings on any number of robots as one object, which `report_schema` describes.

    Args:
        reports: One a robot, in the order to show them.
        strict: Whether a warning makes ``ok`` false too; severities stay as they are.
    """
    robots = [report.to_json(strict) for report in reports]
    return {"version": REPORT_VERSION, "ok": all(robot["ok"] for robot in robots), "robots": robots}


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
    """The text with a lone surrogate (half a character, as in an undecodable file name) spelled out as an escape."""
    return text.encode("utf-8", "backslashreplace").decode("utf-8")


def report_schema() -> dict[str, Any]:
    """The JSON Schema (2020-12) of `reports_to_json`."""
    position = {"type": ["integer", "null"], "minimum": 1}
    diagnostic = _closed_object(
        "One finding.",
        {
            "code": {
                "type": "string",
                "pattern": "^[a-z0-9]+(-[a-z0-9]+)*$",
                "description": "What is wrong: a permanent name, never used for anything else. One that begins with "
                f"'{OWN_PREFIX}' is advice of this parser, which no clause of the specification asks for.",
                "examples": ["unknown-frame"],
            },
            "severity": {
                "enum": [severity.value for severity in Severity],
                "description": "An error is against a MUST of the specification, a warning against a SHOULD or advice.",
            },
            "phase": {
                "enum": [phase.value for phase in Phase],
                "description": "Where in the reading it was found; an error keeps later phases from being judged.",
            },
            "clause": {
                "type": ["string", "null"],
                "pattern": "^EU-[A-Z]{3}-[0-9]{3}$",
                "description": "Id of the clause of the specification that is not met; null for advice.",
                "examples": ["EU-FRM-001"],
            },
            "message": {
                "type": "string",
                "description": "What is wrong, as one sentence without a full stop.",
                "examples": ["closure 'knee' names the frame 'rod_tpi', which does not exist"],
            },
            "hint": {
                "type": ["string", "null"],
                "description": "What would be right, where that can be told.",
                "examples": ["did you mean 'rod_tip'?"],
            },
            "file": {
                "type": "string",
                "description": "Path of the file the finding is in, as given or relative to the working directory.",
                "examples": ["robots/four_bar/robot.yaml"],
            },
            "line": {**position, "description": "Line, from 1; null for the file as a whole."},
            "column": {**position, "description": "Column, from 1, in Unicode code points; null where not known."},
            "end_column": {
                **position,
                "description": "Column just after the last character meant, on the same line; null where not known.",
            },
            "pointer": {
                "type": "string",
                "description": "JSON pointer of the value in a YAML file, XPath of the element or attribute in a URDF.",
                "examples": ["/closures/0/frames/1", "/robot/joint[3]/limit/@lower"],
            },
        },
    )
    robot = _closed_object(
        "The findings on one robot.",
        {
            "path": {
                "type": "string",
                "description": "The robot, as it was named: a folder, a file, or a name of the collection.",
                "examples": ["robots/four_bar"],
            },
            "ok": {
                "type": "boolean",
                "description": "Whether the robot passes: no error and, in a strict check, no warning either.",
            },
            "diagnostics": {"type": "array", "items": diagnostic, "description": "The findings, in the order found."},
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
                "robots": {"type": "array", "items": robot, "description": "One entry a robot."},
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
