"""The result of a check of one robot, and its JSON form."""

from __future__ import annotations

from collections.abc import Collection, Iterable
from dataclasses import dataclass, replace
from typing import Any

from eurdf.diagnostics.diagnostic import Diagnostic
from eurdf.diagnostics.fix import Fix
from eurdf.diagnostics.registry import OWN_PREFIX, Phase, Severity
from eurdf.diagnostics.wording import encodable

_REGION = ("line", "column", "end_line", "end_column")

#: Version of the JSON form; it increases by one when a field changes its meaning or is removed.
REPORT_VERSION = 1


@dataclass(frozen=True, slots=True, repr=False)
class Report:
    """The diagnostics of one robot.

    Attributes:
        path: The robot as the user gave it: a folder, a file, or a name of the collection.
        diagnostics: In the order found.
        notes: What could be done with the robot although nothing is wrong, one sentence each.
    """

    path: str
    diagnostics: tuple[Diagnostic, ...] = ()
    notes: tuple[str, ...] = ()

    def without(self, codes: Collection[str]) -> Report:
        """The same report without the diagnostics of some codes."""
        return replace(self, diagnostics=tuple(found for found in self.diagnostics if found.code not in codes))

    @property
    def errors(self) -> tuple[Diagnostic, ...]:
        """The errors."""
        return tuple(found for found in self.diagnostics if found.severity is Severity.ERROR)

    @property
    def warnings(self) -> tuple[Diagnostic, ...]:
        """The warnings."""
        return tuple(found for found in self.diagnostics if found.severity is Severity.WARNING)

    @property
    def fixes(self) -> tuple[Fix, ...]:
        """What `eurdf check --fix` does about them."""
        return tuple(found.fix for found in self.diagnostics if found.fix is not None)

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
            "notes": [encodable(note) for note in self.notes],
        }

    def __repr__(self) -> str:
        return f"<Report on '{self.path}': {len(self.errors)} errors, {len(self.warnings)} warnings>"


def reports_to_json(reports: Iterable[Report], strict: bool = False, skipped: Iterable[str] = ()) -> dict[str, Any]:
    """The diagnostics of any number of robots as one object; `report_schema` describes it.

    If strict, a warning makes ``ok`` false, too; severities do not change. The folders ``skipped`` had no robot.
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
        "fix": None if found.fix is None else _fix_to_json(found.fix),
        "file": encodable(place.file),
        "line": place.line,
        "column": place.column,
        "end_column": place.end_column,
        "pointer": encodable(place.pointer),
    }


def _fix_to_json(fix: Fix) -> dict[str, Any]:
    edits = []
    for edit in fix.edits:
        region = dict(zip(_REGION, edit.region, strict=True))
        edits.append({"file": encodable(edit.file), **region, "text": encodable(edit.text)})
    return {"summary": encodable(fix.summary), "edits": edits}


def report_schema() -> dict[str, Any]:
    """The JSON Schema (2020-12) of `reports_to_json`."""
    position = {"type": ["integer", "null"], "minimum": 1}
    text, maybe_text = {"type": "string"}, {"type": ["string", "null"]}
    place = {"type": "integer", "minimum": 1}
    edit = _closed_object(
        "A part of a file, and what to write in its place.",
        file=_value(text, "Path of the file, as in the diagnostic.", "robots/four_bar/robot.yaml"),
        line=_value(place, "Line of the first character of the part, from 1."),
        column=_value(place, "Its column, from 1, in Unicode code points."),
        end_line=_value(place, "Line of the character after the last one of the part."),
        end_column=_value(place, "Its column; the part is empty if this is the first character."),
        text=_value(text, "What to write instead.", "rod_tip"),
    )
    fix = _closed_object(
        "Edits that a trial showed to be right: the diagnostic is gone, and there is no new one.",
        summary=_value(text, "What they do, as the hint says it.", "write 'rod_tip'"),
        edits=_value({"type": "array", "items": edit}, "Parts of files that do not overlap."),
    )
    diagnostic = _closed_object(
        "One diagnostic.",
        code=_value(
            {**text, "pattern": "^[a-z0-9]+(-[a-z0-9]+)*$"},
            "A permanent name of the error, never used for anything else. A code that begins with "
            f"'{OWN_PREFIX}' is advice of this parser, which no clause of the specification requires.",
            "unknown-frame",
        ),
        severity=_value(
            {"enum": [severity.value for severity in Severity]},
            "An error violates a MUST of the specification; a warning, a SHOULD, or it is advice.",
        ),
        phase=_value(
            {"enum": [phase.value for phase in Phase]},
            "The phase that reports it; an error can prevent later phases from running.",
        ),
        clause=_value(
            {**maybe_text, "pattern": "^EU-[A-Z]{3}-[0-9]{3}$"},
            "Id of the violated clause of the specification; null for advice.",
            "EU-FRM-001",
        ),
        message=_value(
            text,
            "What is wrong, as one sentence without a full stop.",
            "closure 'knee' names the frame 'rod_tpi', which does not exist",
        ),
        hint=_value(maybe_text, "What to do about it; null if unknown.", "did you mean 'rod_tip'?"),
        fix=_value(
            {"anyOf": [fix, {"type": "null"}]}, "What 'eurdf check --fix' does about it; null if none is certain."
        ),
        file=_value(
            text, "Path of the file, as given or relative to the working directory.", "robots/four_bar/robot.yaml"
        ),
        line=_value(position, "Line, from 1; null for the whole file."),
        column=_value(position, "Column, from 1, in Unicode code points; null if unknown."),
        end_column=_value(position, "Column after the last character of the place, on the same line; null if unknown."),
        pointer=_value(
            text,
            "JSON pointer of the value in a YAML file, XPath of the element or attribute in a URDF.",
            "/closures/0/frames/1",
            "/robot/joint[3]/limit/@lower",
        ),
    )
    robot = _closed_object(
        "The diagnostics of one robot.",
        path=_value(text, "The robot as given: a folder, a file, or a name of the collection.", "robots/four_bar"),
        ok=_value({"type": "boolean"}, "Whether the robot passes: no error and, in a strict check, no warning."),
        diagnostics=_value({"type": "array", "items": diagnostic}, "The diagnostics, in the order found."),
        notes=_value(
            {"type": "array", "items": text},
            "What could be done with the robot although nothing is wrong, as sentences.",
        ),
    )
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "Report of a check of Extended URDF robots",
        **_closed_object(
            "What 'eurdf check --json' writes.",
            version=_value({"const": REPORT_VERSION}, "Version of this form."),
            ok=_value({"type": "boolean"}, "Whether every robot passes."),
            robots=_value({"type": "array", "items": robot}, "One entry for each robot."),
            skipped=_value(
                {"type": "array", "items": text},
                "Folders without a robot that were given among others.",
                ["robots/textures"],
            ),
        ),
    }


def _value(schema: dict[str, Any], description: str, *examples: Any) -> dict[str, Any]:
    return {**schema, "description": description, **({"examples": list(examples)} if examples else {})}


def _closed_object(description: str, **properties: Any) -> dict[str, Any]:
    return {
        "type": "object",
        "description": description,
        "properties": properties,
        "required": list(properties),
        "additionalProperties": False,
    }
