"""``python -m eurdf_conformance.corpus.show CASE`` prints a case: its files, or their edit, and what is expected."""

from __future__ import annotations

import argparse
import difflib
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

from eurdf_conformance.corpus.case import InvalidCase
from eurdf_conformance.corpus.expect import expect
from eurdf_conformance.corpus.expected import expected_text
from eurdf_conformance.corpus.read import CASES, CorpusCase, NotACase, case_names, read_case
from eurdf_conformance.oracle import NotRead
from eurdf_conformance.visible import visible


def shown(case: CorpusCase) -> Iterator[str]:
    """A case, line by line."""
    said = case.case
    yield f"{case.name}: {said.title}"
    yield f"version {said.version}, {', '.join(said.clauses)}"
    origin = case.origin
    if isinstance(said, InvalidCase):
        place = ":".join(str(part) for part in (said.place.file, said.place.line, said.place.column) if part)
        yield f"invalid: {said.code} at {place}"
        yield f"fix: {said.fix}"
    before = {} if origin is None else origin.files
    for name in sorted({*before, *case.files}):
        old, new = (_lines(files[name]) if name in files else None for files in (before, case.files))
        if old is None or new is None:
            yield f"--- {name}{' is missing' if new is None else ''}"
            yield from new or ()
        elif old != new:
            names = f"{origin.name if origin else ''}/{name}", f"{case.name}/{name}"
            yield from difflib.unified_diff(old, new, *names, lineterm="")
    if not isinstance(said, InvalidCase):
        yield "valid; the oracle expects:"
        yield from (f"warning: {each.code} in {each.place.file}" for each in said.warnings)
        try:
            yield from expected_text(expect(case)).splitlines()
        except NotRead as error:
            yield f"the oracle does not read the files: {error}"


def _lines(content: bytes) -> list[str]:
    return content.decode("utf-8", errors="backslashreplace").split("\n")


def main(arguments: Sequence[str] | None = None) -> int:
    """Print a case.

    Returns:
        0 if it is printed, 1 if its file does not describe a case.
    """
    parser = argparse.ArgumentParser(prog="python -m eurdf_conformance.corpus.show", description=__doc__)
    parser.add_argument("case", metavar="CASE", help="topic/name, or the file of a case")
    parser.add_argument("--out", metavar="FOLDER", type=Path, help="write the files of the case into a folder too")
    options = parser.parse_args(arguments)
    path = CASES / f"{options.case}.yaml" if options.case in set(case_names()) else Path(options.case)
    if not path.is_file():
        parser.error(f"there is no case '{options.case}'")
    try:
        case = read_case(path.absolute())
        sys.stdout.writelines(f"{visible(line)}\n" for line in shown(case))
        if options.out is not None:
            case.write(options.out)
    except NotACase as error:
        sys.stdout.write(f"{error}\n")
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
