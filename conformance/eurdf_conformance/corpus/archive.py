"""All cases for those who do not use pytest: ``python -m eurdf_conformance.corpus.archive OUT`` writes two files.

``eurdf-conformance-cases.zip`` holds a folder a case, ``<topic>/<id>/``, with `case.yaml`, the robot's two files and,
of a valid case, `expected.json`. ``eurdf-conformance-cases.json`` is the same as one JSON value,

    {"manifest": "1.0", "protocol": "1.0", "clauses": {id: text}, "cases": [
        {"topic": …, "case": what case.yaml says, "files": {name: content}, "expected": …}]}

where the content is a text, or ``{"base64": …}`` of what is none, or null where there is no such file. The bytes are
the same whenever and wherever they are written.
"""

from __future__ import annotations

import base64
import json
import sys
import zipfile
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

from eurdf_conformance.corpus.case import ValidCase
from eurdf_conformance.corpus.clause import read_clauses
from eurdf_conformance.corpus.expected import EXPECTED_FILE
from eurdf_conformance.corpus.read import CASE_FILE, CorpusCase, read_cases
from eurdf_conformance.protocol.message import PROTOCOL

NAME = "eurdf-conformance-cases"

MANIFEST = "1.0"

#: The earliest that a zip can say.
_DATE = (1980, 1, 1, 0, 0, 0)


def write_archive(folder: Path, cases: Iterable[CorpusCase]) -> None:
    """Write the zip and the manifest into a folder, which is made where it is not there."""
    cases = list(cases)
    folder.mkdir(parents=True, exist_ok=True)
    # Stored, since what deflate makes of the same bytes depends on the library that does it.
    with zipfile.ZipFile(folder / f"{NAME}.zip", "w", zipfile.ZIP_STORED) as archive:
        for name, path in sorted(entry for case in cases for entry in case_files(case)):
            info = zipfile.ZipInfo(name, _DATE)
            info.create_system, info.external_attr = 3, 0o644 << 16
            archive.writestr(info, path.read_bytes())
    (folder / f"{NAME}.json").write_text(json.dumps(manifest(cases), ensure_ascii=False, indent=1) + "\n", "utf-8")


def manifest(cases: Iterable[CorpusCase]) -> dict[str, Any]:
    """All cases as one JSON value."""
    cases = list(cases)
    cited = {clause for case in cases for clause in case.case.clauses}
    return {
        "manifest": MANIFEST,
        "protocol": PROTOCOL,
        "clauses": {name: clause.text for name, clause in sorted(read_clauses().items()) if name in cited},
        "cases": [
            {
                "topic": case.topic,
                "case": case.case.model_dump(mode="json", exclude_none=True),
                "files": {name: _content(path) for name, path in _robot_files(case)},
                "expected": case.expected.model_dump(mode="json") if isinstance(case.case, ValidCase) else None,
            }
            for case in cases
        ],
    }


def case_files(case: CorpusCase) -> Iterator[tuple[str, Path]]:
    """Every file of a case, by its name in the zip."""
    yield f"{case.path}/{CASE_FILE}", case.folder / CASE_FILE
    if isinstance(case.case, ValidCase):
        yield f"{case.path}/{EXPECTED_FILE}", case.folder / EXPECTED_FILE
    for name, path in _robot_files(case):
        if path.is_file():
            yield f"{case.path}/{name}", path
        elif path.is_dir():  # a fault of its own: a folder where a file should be
            yield from ((f"{case.path}/{name}/{each.name}", each) for each in path.iterdir())


def _robot_files(case: CorpusCase) -> list[tuple[str, Path]]:
    return [(case.case.description, case.description), (case.case.urdf, case.urdf)]


def _content(path: Path) -> str | dict[str, str] | None:
    if not path.is_file():
        return None
    content = path.read_bytes()
    try:
        return content.decode("utf-8")
    except UnicodeDecodeError:
        return {"base64": base64.b64encode(content).decode("ascii")}


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit("usage: python -m eurdf_conformance.corpus.archive OUT")
    write_archive(Path(sys.argv[1]), read_cases())
