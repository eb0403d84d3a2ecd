"""The text printed for an item that did not pass: all that is needed to fix the parser."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import TypeVar

from eurdf_conformance.corpus.case import CasePlace, InvalidCase, ValidCase
from eurdf_conformance.corpus.clause import read_clauses
from eurdf_conformance.corpus.lines import lines_of
from eurdf_conformance.corpus.read import CorpusCase
from eurdf_conformance.judging.judge import Judgement
from eurdf_conformance.judging.result import Item
from eurdf_conformance.judging.verdict import Verdict
from eurdf_conformance.level import Level
from eurdf_conformance.level_spec import LEVELS, Compared
from eurdf_conformance.protocol.message import Issue
from eurdf_conformance.visible import cut, visible

_Found = TypeVar("_Found")

#: Number of differences, and of issues, shown for one item.
_MOST = 12

#: Number of characters shown of a line of a file.
_WIDTH = 100

#: The clauses that define a quantity, by its name.
_DEFINING: Mapping[str, Sequence[str]] = {
    quantity: clauses for spec in LEVELS.values() for quantity, clauses in spec.defining.items()
}


def failure_text(item: Item, judgement: Judgement, reproduce: str, case: CorpusCase | None) -> str:
    """The text printed for an item that did not pass. Control characters from the parser are escaped.

    Args:
        item: The item.
        judgement: Its verdict, with reason and differences.
        reproduce: The command line that runs it alone.
        case: Its case; None for a property or a protocol rule.
    """
    return visible("\n".join(map(cut, _lines(item, judgement, reproduce, case))))


def _lines(item: Item, judgement: Judgement, reproduce: str, case: CorpusCase | None) -> Iterator[str]:
    yield f"{item.id}/{item.level}: {judgement.verdict}: {judgement.reason}"
    yield f"  {reproduce}"
    if judgement.verdict == Verdict.NOT_STARTED:  # the same for all items
        yield from (f"  {line}" for line in judgement.log.splitlines())
        return
    yield f"  {item.title}"
    if case is not None and case.case.features:
        yield f"  features: {', '.join(case.case.features)}"
    clauses = read_clauses()
    saying = (name for name in _saying(judgement) if item.version in clauses[name].versions)
    for name in dict.fromkeys((*saying, *item.clauses)):
        yield f"  {name}: {clauses[name].text}" if name in clauses else f"  {name}"
    yield from _first(judgement.differences, lambda difference: f"  {difference}", "differences")
    if case is not None and isinstance(case.case, ValidCase):
        yield from where_it_stood(judgement, case.case.configurations)
    if judgement.issues:
        yield "  reported issues:"
        yield from _first(judgement.issues, _issue, "issues")
    if case is not None:
        yield from _files(case, item.level, judgement)
        if isinstance(case.case, InvalidCase):
            yield f"  fix: {case.case.fix}"
    yield from (f"  {line}" for line in judgement.log.splitlines())


def _saying(judgement: Judgement) -> Iterator[str]:
    """The clauses that define the quantities that differ."""
    for each in judgement.differences:
        if found := re.match(r"/values/\d+/(\w+)", each.pointer):
            yield from _DEFINING.get(found[1], ())


def where_it_stood(judgement: Judgement, configurations: Sequence[Mapping[str, Sequence[float]]]) -> Iterator[str]:
    """The configuration of the first difference in the values."""
    pointers = (re.match(r"/values/(\d+)", each.pointer) for each in judgement.differences)
    index = next((int(found[1]) for found in pointers if found), None)
    if index is not None and index < len(configurations):
        yield f"  at configuration {index}: {json.dumps(configurations[index], ensure_ascii=False)}"


def _issue(issue: Issue) -> str:
    place = ":".join(str(part) for part in (issue.file, issue.line, issue.column) if part is not None)
    return f"    {issue.severity} {issue.code or ''} {place}: {issue.message}"


def _first(found: Sequence[_Found], text: Callable[[_Found], str], what: str) -> Iterator[str]:
    yield from map(text, found[:_MOST])
    if len(found) > _MOST:
        yield f"    ... and {len(found) - _MOST} more {what}"


def _files(case: CorpusCase, level: Level, judgement: Judgement) -> Iterator[str]:
    """The two files, with the lines at the expected and reported places."""
    places: list[tuple[CasePlace | Issue, str]] = []
    if isinstance(case.case, InvalidCase):
        places.append((case.case.place, "expected"))
    elif isinstance(case.case, ValidCase) and LEVELS[level].compared is Compared.ISSUES:
        places += [(warning.place, "expected") for warning in case.case.warnings]
    if judgement.verdict == Verdict.FAILED:
        places += [(issue, "given") for issue in judgement.issues[:_MOST]]
    for path in (case.description, case.urdf):
        here: dict[tuple[int, int | None], list[str]] = {}
        for place, whose in places:
            if place.file == path.name and place.line is not None:
                here.setdefault((place.line, place.column), []).append(whose)
        lines = sorted(here, key=lambda place: (place[0], place[1] or 0))
        first = "".join(f":{part}" for part in (lines[0] if lines else ()) if part is not None)
        missing = "" if path.is_file() else " (a folder)" if path.is_dir() else " (missing)"
        yield f"  {path}{first}{missing}"
        for line, column in lines:
            yield from _excerpt(path, line, column, " and ".join(dict.fromkeys(here[line, column])))


def _excerpt(path: Path, line: int, column: int | None, whose: str) -> Iterator[str]:
    lines = lines_of(path)
    if line > len(lines):
        return
    text = "".join(character if character.isprintable() else " " for character in lines[line - 1])
    start = max(0, (column or 0) - _WIDTH // 2) if len(text) > _WIDTH else 0
    yield f"    {line:5} | {text[start : start + _WIDTH]}"
    if column is not None and column <= len(text) + 1:
        yield f"          | {' ' * (column - start - 1)}^ {whose}"
