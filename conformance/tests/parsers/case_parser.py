"""Parsers that know all answers by heart, from the cases themselves; each but the first has one error."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path

from eurdf_conformance.corpus.case import CasePlace, ValidCase
from eurdf_conformance.corpus.read import CorpusCase, read_cases
from eurdf_conformance.level import VERSIONS, Level, Version
from eurdf_conformance.protocol.message import Accepted, Issue, Quantity, Rejected, Skipped, Unsupported, Values
from eurdf_conformance.protocol.reply import accepted, rejected, skipped, unsupported

#: The valid case, and the invalid one, at which the others go wrong.
VALID, INVALID = "closures/parallelogram-3d-closure", "frames/closure-at-unknown-frame"


#: All files of a case, by their paths from its folder.
Content = frozenset[tuple[str, bytes]]
Configuration = Mapping[str, Sequence[float]]
Reply = Accepted | Rejected | Unsupported | Skipped


@cache
def index() -> dict[Content, list[CorpusCase]]:
    """The cases by their files; two of them may have the same."""
    found: dict[Content, list[CorpusCase]] = {}
    for case in read_cases():
        found.setdefault(frozenset(case.files.items()), []).append(case)
    return found


def content(description: Path) -> Content:
    """All files of the folder that a parser was given."""
    folder = description.parent
    return frozenset((str(path.relative_to(folder)), path.read_bytes()) for path in folder.rglob("*") if path.is_file())


def case_of(description: Path) -> CorpusCase:
    """The case with these files."""
    return index()[content(description)][0]


class Right:
    """Says what the cases say."""

    name = "by_heart"
    version = "1"
    language = "Python"
    claims: Mapping[Version, Sequence[Level]] = dict.fromkeys(VERSIONS, tuple(Level))

    def __init__(self) -> None:
        self.case: CorpusCase | None = None
        self.files: Content = frozenset()

    def load(self, description: Path, urdf: Path) -> Reply:
        case = case_of(description)
        if isinstance(case.case, ValidCase):
            self.case = case
            self.files = content(description)
            warnings = [issue(each.code, each.place, "warning") for each in case.case.warnings]
            return accepted(case.expected.robot, warnings)
        return rejected(issue(case.case.code, case.case.place, "error"))

    def evaluate(
        self, configurations: Sequence[Configuration], frames: Sequence[str], quantities: Sequence[Quantity]
    ) -> list[Values]:
        alike = (case for case in index()[self.files] if isinstance(case.case, ValidCase))
        return next(case.expected.values for case in alike if case.case.configurations == list(configurations))


def issue(code: str, place: CasePlace, severity: str) -> Issue:
    said = {"code": code, "severity": severity, "message": "?", **place.model_dump()}
    return Issue.model_validate(said)


class Lenient(Right):
    """Accepts one thing that is wrong."""

    def load(self, description: Path, urdf: Path) -> Reply:
        if case_of(description).name == INVALID:
            return accepted(None, ["this looks odd"])
        return super().load(description, urdf)


class Misread(Right):
    """Reads another upper limit, places one link elsewhere, and reports an error one column off."""

    def load(self, description: Path, urdf: Path) -> Reply:
        reply = super().load(description, urdf)
        if case_of(description).name == INVALID and isinstance(reply, Rejected):
            (found,) = reply.issues
            return rejected(found.model_copy(update={"column": (found.column or 0) + 1}))
        if case_of(description).name == VALID and isinstance(reply, Accepted) and reply.robot is not None:
            joints = [reply.robot.joints[0].model_copy(update={"upper": [9.0]}), *reply.robot.joints[1:]]
            return accepted(reply.robot.model_copy(update={"joints": joints}))
        return reply

    def evaluate(
        self, configurations: Sequence[Configuration], frames: Sequence[str], quantities: Sequence[Quantity]
    ) -> list[Values]:
        values = super().evaluate(configurations, frames, quantities)
        assert self.case is not None
        if self.case.name != VALID or "poses" not in quantities:
            return values
        poses = dict(values[0].poses or {})
        poses["elbow"] = poses["elbow"].model_copy(update={"translation": [7.0, 7.0, 7.0]})
        return [values[0].model_copy(update={"poses": poses}), *values[1:]]


class Crashing(Right):
    """Is gone when it meets one case."""

    def load(self, description: Path, urdf: Path) -> Reply:
        if case_of(description).name == VALID:
            os._exit(3)
        return super().load(description, urdf)


def claiming(claims: Mapping[Version, Sequence[Level]]) -> type[Right]:
    return type("Claiming", (Right,), {"claims": claims})


#: What they claim: to accept one version, to know how things move, to say what is read and what is wrong, nothing.
Modest = claiming({"2": (Level.ACCEPT,)})
Moving = claiming({"2": (Level.DYNAMICS,)})
Telling = claiming({"2": (Level.DIAGNOSE, Level.STRUCTURE)})
Silent = claiming({})


class Shy(Right):
    """Does not answer all that it claims."""

    def load(self, description: Path, urdf: Path) -> Reply:
        if case_of(description).name == VALID:
            return unsupported("closures", "not written yet")
        if case_of(description).name == INVALID:
            return skipped("it is Sunday")
        return super().load(description, urdf)
