"""The rules that cases keep. ``python -m eurdf_conformance.corpus.lint`` says which do not, and what is not tested.

Nothing here asks a parser: that a parser gives exactly the code of each invalid case, and accepts its twin, is for the
tests of that parser to show.
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

from eurdf_conformance.corpus.case import SCHEMA_FILE, TOPICS, CasePlace, InvalidCase, ValidCase, schema_text
from eurdf_conformance.corpus.clause import Clause, read_clauses
from eurdf_conformance.corpus.coverage import missing
from eurdf_conformance.corpus.expect import stale
from eurdf_conformance.corpus.expected import EXPECTED_FILE
from eurdf_conformance.corpus.lines import lines_of
from eurdf_conformance.corpus.one_edit import edit_errors
from eurdf_conformance.corpus.protocol_rule import OF_RUNNERS, RULES
from eurdf_conformance.corpus.read import CASE_FILE, CASES, CorpusCase, NotACase, case_folders, read_case


@dataclass(frozen=True, slots=True)
class Fault:
    """A rule that a case breaks."""

    path: Path
    rule: str
    message: str

    def __str__(self) -> str:
        return f"{self.path}: {self.rule}: {self.message}"


@dataclass(frozen=True)
class Corpus:
    """All cases that can be read, and the clauses."""

    cases: Sequence[CorpusCase]
    clauses: Mapping[str, Clause]

    def twin(self, case: CorpusCase) -> CorpusCase | None:
        """The valid twin of an invalid case, if it has one."""
        assert isinstance(case.case, InvalidCase)
        return self._by_id.get(case.case.twin)

    @cached_property
    def _by_id(self) -> Mapping[str, CorpusCase]:
        return {case.id: case for case in reversed(self.cases)}

    @cached_property
    def ids(self) -> Counter[str]:
        """How many cases have each id."""
        return Counter(case.id for case in self.cases)

    @cached_property
    def titles(self) -> Counter[str]:
        """How many cases have each title."""
        return Counter(case.case.title for case in self.cases)


#: Given a case, what is wrong with it.
Rule = Callable[[CorpusCase, Corpus], Iterator[str]]


def lint(root: Path = CASES, clauses: Mapping[str, Clause] | None = None) -> list[Fault]:
    """What is wrong with the cases below a folder."""
    faults, cases = [], []
    folders = set(case_folders(root))
    for path in sorted(root.glob(f"**/{CASE_FILE}")):
        if path.parent not in folders:
            faults.append(
                Fault(path, "folder", f"a case stands in <topic>/<id>/, a topic being one of {', '.join(TOPICS)}")
            )
    for folder in case_folders(root):
        try:
            cases.append(read_case(folder))
        except NotACase as error:
            faults.append(Fault(error.path, "schema", error.why))
    corpus = Corpus(cases, read_clauses() if clauses is None else clauses)
    return faults + [
        Fault(case.folder / CASE_FILE, name, message)
        for case in cases
        for name, rule in RULES_OF_CASES.items()
        for message in rule(case, corpus)
    ]


def _id(case: CorpusCase, corpus: Corpus) -> Iterator[str]:
    if case.id != case.folder.name:
        yield f"id '{case.id}' is not the name of the folder"
    if corpus.ids[case.id] > 1:
        yield f"id '{case.id}' is another case's too"


def _title(case: CorpusCase, corpus: Corpus) -> Iterator[str]:
    if corpus.titles[case.case.title] > 1:
        yield "another case has the same title"


def _clauses(case: CorpusCase, corpus: Corpus) -> Iterator[str]:
    for name in case.case.clauses:
        if name not in corpus.clauses:
            yield f"there is no clause {name}"
        elif case.case.version not in corpus.clauses[name].versions:
            yield f"{name} is no clause of version {case.case.version}"
    if len(set(case.case.clauses)) < len(case.case.clauses):
        yield "a clause stands twice"


def _code(case: CorpusCase, corpus: Corpus) -> Iterator[str]:
    cited = [corpus.clauses[name] for name in case.case.clauses if name in corpus.clauses]
    if isinstance(case.case, InvalidCase):
        broken = [clause for clause in cited if case.case.code in clause.codes]
        if not any(clause.must for clause in broken):
            yield f"'{case.case.code}' stands for no MUST that the case cites"
        elif case.case.either != all(clause.level == "diagnose" for clause in broken):
            yield "`either` is for the errors whose clauses are of level diagnose, and for no others"
        return
    codes = {code for clause in corpus.clauses.values() if not clause.must for code in clause.codes}
    for warning in case.case.warnings:
        if warning.code not in codes:
            yield f"'{warning.code}' is the code of no warning"


def _twin(case: CorpusCase, corpus: Corpus) -> Iterator[str]:
    if not isinstance(case.case, InvalidCase):
        return
    twin = corpus.twin(case)
    if twin is None:
        yield f"there is no twin {case.case.twin}"
    elif not isinstance(twin.case, ValidCase):
        yield f"the twin {twin.id} is not valid"
    elif twin.case.version != case.case.version:
        yield f"the twin {twin.id} is of version {twin.case.version}"
    elif twin.case.warnings:  # which the fault might hide, or not
        yield f"the twin {twin.id} has warnings"
    else:
        yield from edit_errors((case.description, case.urdf), (twin.description, twin.urdf))


def _named_files(urdf: Path) -> list[str]:
    """The meshes and textures that a URDF names."""
    text = urdf.read_text(encoding="utf-8", errors="replace") if urdf.is_file() else ""
    return re.findall(r'filename="([^"]*)"', text)


def _files(case: CorpusCase, corpus: Corpus) -> Iterator[str]:
    files = [case.description, case.urdf]
    if isinstance(case.case, ValidCase):
        yield from (f"there is no file {path.name}" for path in files if not path.is_file())
    if case.case.robot is None:
        named = _named_files(case.urdf)
        known = {CASE_FILE, case.case.description, Path(case.case.urdf).parts[0], "robot.urdf", *named}
        known |= {EXPECTED_FILE} if isinstance(case.case, ValidCase) else set()
        for path in sorted(case.folder.iterdir()):
            if path.name not in known:
                yield f"no one reads '{path.name}'"
        # A file that is missing is a fault of its own, which a parser tells beside that of the case.
        told = {case.case.code} if isinstance(case.case, InvalidCase) else {each.code for each in case.case.warnings}
        if not told & {"urdf-mesh-missing", "urdf-texture-missing"}:
            yield from (f"there is no file {name}" for name in named if not _is_there(case.urdf.parent, name))


def _is_there(folder: Path, name: str) -> bool:
    return not name.strip() or "://" in name or (folder / name).is_file()


def _place(case: CorpusCase, corpus: Corpus) -> Iterator[str]:
    if isinstance(case.case, InvalidCase):
        places = [case.case.place]
    else:
        places = [warning.place for warning in case.case.warnings]
    for place in places:
        yield from _place_faults(place, case)


def _place_faults(place: CasePlace, case: CorpusCase) -> Iterator[str]:
    path = next((path for path in (case.description, case.urdf) if path.name == place.file), None)
    if path is None:
        yield f"place: '{place.file}' is none of its two files"
        return
    if place.line is None or place.column is None:
        return
    if not path.is_file():
        yield f"place: there is no file '{place.file}' to have a line"
        return
    lines = lines_of(path)
    if place.line > len(lines):
        yield f"place: '{place.file}' has {len(lines)} lines, none is {place.line}"
    elif place.column > len(lines[place.line - 1]) + 1:
        yield f"place: line {place.line} of '{place.file}' has no column {place.column}"


def _expected(case: CorpusCase, corpus: Corpus) -> Iterator[str]:
    if isinstance(case.case, ValidCase) and case.description.is_file() and case.urdf.is_file():
        yield from stale(case)


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
}


def main(arguments: Sequence[str] | None = None) -> int:
    """Say what is wrong with the cases, and which clauses lack one.

    Returns:
        0 where nothing is wrong, 1 where something is.
    """
    parser = argparse.ArgumentParser(prog="python -m eurdf_conformance.corpus.lint", description=__doc__)
    parser.add_argument("root", nargs="?", type=Path, default=CASES, help="folder of the topics")
    parser.add_argument("--complete", action="store_true", help="a clause without a case is a fault too")
    options = parser.parse_args(arguments)
    clauses = read_clauses()
    faults = [str(fault) for fault in lint(options.root, clauses)]
    if options.root == CASES and SCHEMA_FILE.read_text(encoding="utf-8") != schema_text():
        faults.append(f"{SCHEMA_FILE}: not current: python -m eurdf_conformance.corpus.case")
    cases = [case.case for case in _readable(options.root)]
    tested = {clause for rule in RULES for clause in rule.clauses}
    gaps = list(missing(cases, clauses, tested | set(OF_RUNNERS)))
    sys.stdout.writelines(f"{line}\n" for line in [*faults, *(f"missing: {gap}" for gap in gaps)])
    sys.stdout.write(f"{len(cases)} cases, {len(faults)} faults, {len(gaps)} clauses without their cases\n")
    return int(bool(faults or (options.complete and gaps)))


def _readable(root: Path) -> Iterator[CorpusCase]:
    for folder in case_folders(root):
        try:
            yield read_case(folder)
        except NotACase:
            continue


if __name__ == "__main__":
    sys.exit(main())
