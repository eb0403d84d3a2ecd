"""Parsers that know all answers by heart, from the cases themselves; each but the first has one error."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from pathlib import Path

from eurdf_conformance.corpus.case import CasePlace, ValidCase
from eurdf_conformance.corpus.read import CASES, CorpusCase, collection_folder, read_case, read_cases
from eurdf_conformance.level import VERSIONS, Level, Version
from eurdf_conformance.protocol.message import Accepted, Issue, Quantity, Rejected, Skipped, Unsupported, Values
from eurdf_conformance.protocol.reply import accepted, rejected, skipped, unsupported

#: The valid case, and the invalid one, at which the others go wrong.
VALID, INVALID = "closures/parallelogram-3d-closure", "frames/closure-at-unknown-frame"


class Cases(dict[tuple[Path, Path], CorpusCase]):
    """The cases by their files, of which only those that are asked for are read."""

    def __missing__(self, files: tuple[Path, Path]) -> CorpusCase:
        folder = files[0].parent
        if folder.parent == collection_folder():
            robots = [case for case in read_cases() if isinstance(case.case, ValidCase) and case.case.robot is not None]
            self.update({(case.description, case.urdf): case for case in robots})
        else:  # the last two names of the folder are those of the case
            self[files] = read_case(CASES / folder.parent.name / f"{folder.name}.yaml")
        return dict(self)[files]


class Right:
    """Says what the cases say."""

    name = "by_heart"
    version = "1"
    language = "Python"
    claims: Mapping[Version, Sequence[Level]] = dict.fromkeys(VERSIONS, tuple(Level))

    def __init__(self) -> None:
        self.cases = Cases()
        self.case: CorpusCase | None = None

    def load(self, description: Path, urdf: Path) -> Accepted | Rejected | Unsupported | Skipped:
        case = self.cases[description, urdf]
        if isinstance(case.case, ValidCase):
            self.case = case
            warnings = [issue(each.code, each.place, "warning") for each in case.case.warnings]
            return accepted(case.expected.robot, warnings)
        return rejected(issue(case.case.code, case.case.place, "error"))

    def evaluate(
        self,
        configurations: Sequence[Mapping[str, Sequence[float]]],
        frames: Sequence[str],
        quantities: Sequence[Quantity],
    ) -> list[Values] | Unsupported | Skipped:
        assert self.case is not None
        return self.case.expected.values


def issue(code: str, place: CasePlace, severity: str) -> Issue:
    said = {"code": code, "severity": severity, "message": "?", **place.model_dump()}
    return Issue.model_validate(said)


class Lenient(Right):
    """Accepts one thing that is wrong."""

    def load(self, description: Path, urdf: Path) -> Accepted | Rejected | Unsupported | Skipped:
        if self.cases[description, urdf].name == INVALID:
            return accepted(None, ["this looks odd"])
        return super().load(description, urdf)


class Misread(Right):
    """Reads another upper limit, places one link elsewhere, and reports an error one column off."""

    def load(self, description: Path, urdf: Path) -> Accepted | Rejected | Unsupported | Skipped:
        reply = super().load(description, urdf)
        if self.cases[description, urdf].name == INVALID and isinstance(reply, Rejected):
            (found,) = reply.issues
            return rejected(found.model_copy(update={"column": (found.column or 0) + 1}))
        if self.cases[description, urdf].name == VALID and isinstance(reply, Accepted) and reply.robot is not None:
            joints = [reply.robot.joints[0].model_copy(update={"upper": [9.0]}), *reply.robot.joints[1:]]
            return accepted(reply.robot.model_copy(update={"joints": joints}))
        return reply

    def evaluate(
        self,
        configurations: Sequence[Mapping[str, Sequence[float]]],
        frames: Sequence[str],
        quantities: Sequence[Quantity],
    ) -> list[Values] | Unsupported | Skipped:
        values = super().evaluate(configurations, frames, quantities)
        assert isinstance(values, list)
        assert self.case is not None
        if self.case.name != VALID or "poses" not in quantities:
            return values
        poses = dict(values[0].poses or {})
        poses["elbow"] = poses["elbow"].model_copy(update={"translation": [7.0, 7.0, 7.0]})
        return [values[0].model_copy(update={"poses": poses}), *values[1:]]


class Crashing(Right):
    """Is gone when it meets one case."""

    def load(self, description: Path, urdf: Path) -> Accepted | Rejected | Unsupported | Skipped:
        if self.cases[description, urdf].name == VALID:
            os._exit(3)
        return super().load(description, urdf)


class Modest(Right):
    """Claims to accept version 2, no more."""

    claims: Mapping[Version, Sequence[Level]] = {"2": (Level.ACCEPT,)}


class Moving(Right):
    """Claims nothing but to know how things move."""

    claims: Mapping[Version, Sequence[Level]] = {"2": (Level.DYNAMICS,)}


class Telling(Right):
    """Claims to say what it reads, and what is wrong."""

    claims: Mapping[Version, Sequence[Level]] = {"2": (Level.DIAGNOSE, Level.STRUCTURE)}


class Silent(Right):
    """Claims nothing."""

    claims: Mapping[Version, Sequence[Level]] = {}


class Shy(Right):
    """Does not answer all that it claims."""

    def load(self, description: Path, urdf: Path) -> Accepted | Rejected | Unsupported | Skipped:
        if self.cases[description, urdf].name == VALID:
            return unsupported("closures", "not written yet")
        if self.cases[description, urdf].name == INVALID:
            return skipped("it is Sunday")
        return super().load(description, urdf)
