"""All cases for those who do not use pytest: ``python -m eurdf_conformance.corpus.archive OUT`` writes two files.

``eurdf-corpus.zip`` holds ``cases/<topic>/<name>.yaml`` of each case, its files in the folder ``cases/<topic>/<name>/``
and, of a valid case, ``<name>.expected.json``; and beside them ``index.json``, the list of the cases, the schemas, the
clauses, a README on how to judge a parser with them, and the license. ``eurdf-corpus.json`` is the cases as one value,
the index with ``expected`` and, in place of the names of files, their contents: a text, or ``{"base64": …}`` if it is
not UTF-8, or null if that file of the robot is missing. The bytes are the same whenever and wherever they are written.
``eurdf_conformance.corpus.packages`` makes packages of the zip.
"""

from __future__ import annotations

import argparse
import base64
import io
import json
import sys
import zipfile
from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any

from eurdf_conformance.carried import carried
from eurdf_conformance.corpus.archive_schema import MAKING, expected_schema, index_schema
from eurdf_conformance.corpus.case import SCHEMA_FILE, ValidCase
from eurdf_conformance.corpus.clause import read_clauses, read_registry
from eurdf_conformance.corpus.read import CorpusCase, NotACase, read_cases
from eurdf_conformance.corpus.release import case_files, corpus_hash, suite_version
from eurdf_conformance.protocol.message import PROTOCOL
from eurdf_conformance.write_together import write_together

#: Name of the archive and of the packages made of it.
NAME = "eurdf-corpus"

#: Version of the form of `index.json` and of the one value.
MANIFEST = "3.0"

#: Schemas that the zip contains, by their names in it.
_SCHEMAS = {
    f"schema/extended-urdf-{version}.schema.json": carried(f"schema/extended-urdf-{version}.schema.json")
    for version in ("1", "2.0", "2.1")
}

_README = Path(__file__).with_name("package") / "README.md"

#: The earliest date that a zip file can contain.
_DATE = (1980, 1, 1, 0, 0, 0)


def write_archive(folder: Path, cases: Iterable[CorpusCase]) -> None:
    """Write the zip and the manifest into a folder, which is created if necessary: both, or none.

    Raises:
        OSError: They cannot be written; what was there before is still there.
    """
    cases = list(cases)
    archive, plain = archive_paths(folder)
    files = {archive: _zipped(cases), plain: _json(manifest(cases))}
    folder.mkdir(parents=True, exist_ok=True)
    write_together(files)


def archive_paths(folder: Path) -> tuple[Path, Path]:
    """The paths of the zip and the manifest in a folder."""
    return folder / f"{NAME}.zip", folder / f"{NAME}.json"


def _zipped(cases: Iterable[CorpusCase]) -> bytes:
    cases = sorted(cases, key=lambda case: case.name)
    entries = {name: content for case in cases for name, content in case_files(case)} | _beside(cases)
    written = io.BytesIO()
    # Stored, since what deflate makes of the same bytes depends on the library that does it.
    with zipfile.ZipFile(written, "w", zipfile.ZIP_STORED) as archive:
        for name, content in sorted(entries.items()):
            info = zipfile.ZipInfo(name, _DATE)
            info.create_system, info.external_attr = 3, 0o644 << 16
            archive.writestr(info, content)
    return written.getvalue()


def _beside(cases: Iterable[CorpusCase]) -> dict[str, bytes]:
    """The files beside the cases, which make the zip usable without this project."""
    citing = defaultdict(list)
    for case in cases:
        for clause in case.case.clauses:
            citing[clause].append(case.name)
    registry = read_registry()
    clauses = {
        "clauses": [{**entry, "cases": sorted(citing[entry["id"]])} for entry in registry["clauses"]],
        "diagnostics": registry["diagnostics"],
    }
    return {
        _README.name: _README.read_bytes(),
        "index.json": _json(index(cases)),
        "clauses.json": _json(clauses),
        **{name: path.read_bytes() for name, path in _SCHEMAS.items()},
        SCHEMA_FILE.name: SCHEMA_FILE.read_bytes(),
        "index.schema.json": _json(index_schema()),
        "expected.schema.json": _json(expected_schema()),
        "LICENSE": carried("LICENSE").read_bytes(),
    }


def index(cases: Iterable[CorpusCase]) -> dict[str, Any]:
    """The list of the cases: of each what it says, the levels at which it is tested, and the names of its files."""
    cases = list(cases)
    return {
        "manifest": MANIFEST,
        "version": suite_version(),
        "corpus": corpus_hash(cases),
        "protocol": PROTOCOL,
        "cases": [
            {
                "name": case.name,
                "levels": case.levels,
                "case": case.case.model_dump(mode="json", exclude_none=True, exclude=set(MAKING)),
                "files": sorted(case.files),
            }
            for case in cases
        ],
    }


def manifest(cases: Iterable[CorpusCase]) -> dict[str, Any]:
    """All cases as one JSON value."""
    cases = list(cases)
    listed = index(cases)
    for entry, case in zip(listed["cases"], cases, strict=True):
        entry["files"] = {name: _content(case.files.get(name)) for name in _names(case)}
        entry["expected"] = case.expected.model_dump(mode="json") if isinstance(case.case, ValidCase) else None
    cited = {clause for case in cases for clause in case.case.clauses}
    clauses = {name: clause.text for name, clause in sorted(read_clauses().items()) if name in cited}
    return {**listed, "clauses": clauses}


def _names(case: CorpusCase) -> Iterator[str]:
    """The names of the robot's two files, whether they exist or not, and then of the other files."""
    yield from dict.fromkeys((case.case.description, case.case.urdf, *case.files))


def _json(value: Any) -> bytes:
    return (json.dumps(value, ensure_ascii=False, indent=1) + "\n").encode("utf-8")


def _content(content: bytes | None) -> str | dict[str, str] | None:
    if content is None:
        return None
    try:
        return content.decode("utf-8")
    except UnicodeDecodeError:
        return {"base64": base64.b64encode(content).decode("ascii")}


def main(arguments: Sequence[str] | None = None) -> int:
    """Write the two files, and print their paths.

    Returns:
        0 where they are written, 2 where they are not.
    """
    parser = argparse.ArgumentParser(
        prog="python -m eurdf_conformance.corpus.archive",
        description=f"Write all cases of the suite into a folder: {NAME}.zip, with a README.md in it, and"
        f" {NAME}.json, the same as one JSON value.",
        epilog="Exit codes: 0 written, 2 not written.",
    )
    parser.add_argument("out", metavar="OUT", type=Path, help="the folder; it is made where it is not there")
    parser.add_argument("--force", action="store_true", help="replace the two files if they are there already")
    options = parser.parse_args(arguments)
    refusal = None
    try:
        refusal = _refusal(options.out, options.force)
        if refusal is None:
            cases = read_cases()
            write_archive(options.out, cases)
    except OSError as error:
        refusal = f"cannot write '{error.filename or options.out}': {error.strerror or error}"
    except NotACase as error:
        refusal = str(error)
    if refusal is not None:
        sys.stderr.write(f"{parser.prog}: {refusal}\n")
        return 2
    archive, plain = archive_paths(options.out)
    sys.stdout.write(f"{archive}: {len(cases)} cases\n{plain}: the same as one JSON value\n")
    return 0


def _refusal(folder: Path, force: bool) -> str | None:
    """Why nothing may be written there."""
    if folder.exists() and not folder.is_dir():
        return f"'{folder}' is a file, and is to be a folder"
    there = [path for path in archive_paths(folder) if path.exists()]
    if there and not force:
        return f"'{there[0]}' already exists; --force replaces it"
    return None


if __name__ == "__main__":
    sys.exit(main())
