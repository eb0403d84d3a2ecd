"""The rules of cases. ``python -m eurdf_conformance.corpus.lint`` lists the errors in cases and what is not tested.

No parser runs here: that a parser reports exactly the code of each invalid case, and accepts its twin, is shown by the
tests of that parser.
"""

from __future__ import annotations

import argparse
import re
import sys
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from eurdf_conformance.corpus.case import NAME, SCHEMA_FILE, TOPICS, CasePlace, InvalidCase, ValidCase, schema_text
from eurdf_conformance.corpus.clause import Clause, read_clauses
from eurdf_conformance.corpus.content import Replace
from eurdf_conformance.corpus.coverage import missing
from eurdf_conformance.corpus.expect import stale
from eurdf_conformance.corpus.lines import lines_of
from eurdf_conformance.corpus.protocol_rule import OF_RUNNERS, RULES
from eurdf_conformance.corpus.read import CASES, Cases, CorpusCase, NotACase, case_names
from eurdf_conformance.oracle import NotRead, read

#: Lines that the edit of an invalid case may replace.
LINES = 7


@dataclass(frozen=True, slots=True)
class LintError:
    """A rule that a case violates."""

    path: Path
    rule: str
    message: str

    def __str__(self) -> str:
        return f"{self.path}: {self.rule}: {self.message}"


@dataclass(frozen=True)
class Corpus:
    """All readable cases, and the clauses."""

    cases: Sequence[CorpusCase]
    clauses: Mapping[str, Clause]

    @cached_property
    def ids(self) -> Counter[str]:
        """The number of cases for each id."""
        return Counter(case.id for case in self.cases)

    @cached_property
    def titles(self) -> Counter[tuple[str, str]]:
        """The number of cases of a version for each title."""
        return Counter((case.case.version, case.case.title) for case in self.cases)


#: Yields what is wrong with a case.
Rule = Callable[[CorpusCase, Corpus], Iterator[str]]


def lint(root: Path = CASES, clauses: Mapping[str, Clause] | None = None) -> list[LintError]:
    """The errors in the cases of a folder."""
    cases, errors = _sorted_out(root)
    corpus = Corpus(cases, read_clauses() if clauses is None else clauses)
    return errors + [
        LintError(case.path, name, message)
        for case in cases
        for name, rule in RULES_OF_CASES.items()
        for message in rule(case, corpus)
    ]


def _sorted_out(root: Path) -> tuple[list[CorpusCase], list[LintError]]:
    """The cases whose files can be made, and the errors of the others."""
    known = Cases(root)
    cases: list[CorpusCase] = []
    errors: list[LintError] = []
    expected = {root / f"{name}.expected.json" for name in case_names(root)}
    for path in sorted(path for path in root.rglob("*") if path.is_file()):
        name = path.relative_to(root).with_suffix("").as_posix()
        if path.suffix == ".yaml" and re.fullmatch(NAME, name):
            try:
                _ = known[name].files
                cases.append(known[name])
            except NotACase as error:
                errors.append(LintError(error.path, "case", error.why))
        elif path not in expected:
            errors.append(LintError(path, "name", f"a case is <topic>/<name>.yaml; the topics are {', '.join(TOPICS)}"))
    return cases, errors


def _id(case: CorpusCase, corpus: Corpus) -> Iterator[str]:
    if corpus.ids[case.id] > 1:
        yield f"another case has the id '{case.id}'"


def _title(case: CorpusCase, corpus: Corpus) -> Iterator[str]:
    if corpus.titles[case.case.version, case.case.title] > 1:
        yield f"another case of version {case.case.version} has the same title"


def _clauses(case: CorpusCase, corpus: Corpus) -> Iterator[str]:
    for name in case.case.clauses:
        if name not in corpus.clauses:
            yield f"there is no clause {name}"
        elif case.case.version not in corpus.clauses[name].versions:
            yield f"{name} is no clause of version {case.case.version}"
    if len(set(case.case.clauses)) < len(case.case.clauses):
        yield "a clause is listed twice"


def _code(case: CorpusCase, corpus: Corpus) -> Iterator[str]:
    cited = [corpus.clauses[name] for name in case.case.clauses if name in corpus.clauses]
    if isinstance(case.case, InvalidCase):
        broken = [clause for clause in cited if case.case.code in clause.codes]
        if not any(clause.must for clause in broken):
            yield f"'{case.case.code}' is the code of no MUST that the case cites"
        elif case.case.either != all(clause.level == "diagnose" for clause in broken):
            yield "`either` is for the errors whose clauses are of level diagnose, and for no others"
        return
    codes = {code for clause in corpus.clauses.values() if not clause.must for code in clause.codes}
    for warning in case.case.warnings:
        if warning.code not in codes:
            yield f"'{warning.code}' is the code of no warning"


def _twin(case: CorpusCase, corpus: Corpus) -> Iterator[str]:
    if not isinstance(case.case, InvalidCase) or case.origin is None:
        return
    twin = case.origin.case
    if twin.version != case.case.version:
        yield f"the twin is of version {twin.version}"
    if isinstance(edit := case.case.edit, Replace) and edit.replace.count("\n") >= LINES:
        yield f"the edit replaces more than {LINES} lines"


def _named_files(urdf: Path) -> list[str]:
    """The meshes and textures that a URDF names."""
    text = urdf.read_text(encoding="utf-8", errors="replace") if urdf.is_file() else ""
    return re.findall(r'filename="([^"]*)"', text)


def _files(case: CorpusCase, corpus: Corpus) -> Iterator[str]:
    if isinstance(case.case, ValidCase):
        yield from (f"there is no file {path.name}" for path in (case.description, case.urdf) if not path.is_file())
    # A file that is missing is an error of its own, which a parser reports too.
    reported = {case.case.code} if isinstance(case.case, InvalidCase) else {each.code for each in case.case.warnings}
    if not reported & {"urdf-mesh-missing", "urdf-texture-missing"}:
        named = _named_files(case.urdf)
        yield from (f"there is no file {name}" for name in named if not _is_there(case.urdf.parent, name))


def _is_there(folder: Path, name: str) -> bool:
    return not name.strip() or "://" in name or (folder / name).is_file()


def _place(case: CorpusCase, corpus: Corpus) -> Iterator[str]:
    if isinstance(case.case, InvalidCase):
        places = [case.case.place]
    else:
        places = [warning.place for warning in case.case.warnings]
    for place in places:
        yield from _place_errors(place, case)


def _place_errors(place: CasePlace, case: CorpusCase) -> Iterator[str]:
    path = next((path for path in (case.description, case.urdf) if path.name == place.file), None)
    if path is None:
        yield f"'{place.file}' is not a file of the case"
        return
    if place.line is None or place.column is None:
        return
    if not path.is_file():
        yield f"there is no file '{place.file}' for the line"
        return
    lines = lines_of(path)
    if place.line > len(lines):
        yield f"'{place.file}' has {len(lines)} lines, no line {place.line}"
    elif place.column > len(lines[place.line - 1]) + 1:
        yield f"line {place.line} of '{place.file}' has no column {place.column}"


def _expected(case: CorpusCase, corpus: Corpus) -> Iterator[str]:
    if isinstance(case.case, ValidCase) and case.description.is_file() and case.urdf.is_file():
        yield from stale(case)


def _loops(case: CorpusCase, corpus: Corpus) -> Iterator[str]:
    """EU-CLO-016: no case depends on how long a parser searches for a closed configuration."""
    if isinstance(case.case, InvalidCase) and case.case.code != "closure-cannot-close":
        return
    try:
        closes = read(case.description, case.urdf, case.case.version).loops_close()
    except (OSError, NotRead):  # `files` and `expected` report it
        return
    if closes is not isinstance(case.case, ValidCase):
        yield "the least search closes the loops" if closes else "the least search does not close the loops"


#: Each rule by its name, which its fixture has too.
RULES_OF_CASES: Mapping[str, Rule] = {
    "id": _id,
    "title": _title,
    "clauses": _clauses,
    "code": _code,
    "twin": _twin,
    "files": _files,
    "place": _place,
    "expected": _expected,
    "loops": _loops,
}


def main(arguments: Sequence[str] | None = None) -> int:
    """List the errors in the cases, and the clauses without a case.

    Returns:
        0 if there is no error, else 1.
    """
    parser = argparse.ArgumentParser(prog="python -m eurdf_conformance.corpus.lint", description=__doc__)
    parser.add_argument("root", nargs="?", type=Path, default=CASES, help="folder of the topics")
    parser.add_argument("--complete", action="store_true", help="a clause without a case is an error")
    options = parser.parse_args(arguments)
    clauses = read_clauses()
    errors = [str(error) for error in lint(options.root, clauses)]
    if options.root == CASES and SCHEMA_FILE.read_text(encoding="utf-8") != schema_text():
        errors.append(f"{SCHEMA_FILE}: out of date: run python -m eurdf_conformance.corpus.case")
    cases = [case.case for case in _sorted_out(options.root)[0]]
    tested = {clause for rule in RULES for clause in rule.clauses}
    gaps = list(missing(cases, clauses, tested | set(OF_RUNNERS)))
    sys.stdout.writelines(f"{line}\n" for line in [*errors, *(f"missing: {gap}" for gap in gaps)])
    sys.stdout.write(f"{len(cases)} cases, {len(errors)} errors, {len(gaps)} clauses without cases\n")
    return int(bool(errors or (options.complete and gaps)))


if __name__ == "__main__":
    sys.exit(main())
