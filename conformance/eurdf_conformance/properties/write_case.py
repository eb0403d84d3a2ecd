"""What was found by exploring, as a case that is ready to commit."""

from __future__ import annotations

import hashlib
import shlex
from collections.abc import Iterator
from pathlib import Path

import yaml

from eurdf_conformance.corpus.case import CASE
from eurdf_conformance.corpus.clause import read_clauses
from eurdf_conformance.corpus.expect import expect
from eurdf_conformance.corpus.expected import EXPECTED_FILE, expected_text
from eurdf_conformance.corpus.read import CASE_FILE, CASES, CorpusCase, case_folders
from eurdf_conformance.properties.property import Property
from eurdf_conformance.properties.query import Query

_ALPHABET = "abcdefghijklmnopqrstuvwxyz0123456789"


def write_case(prop: Property, query: Query, folder: Path) -> Path:
    """Write a robot into a folder of its own, with what the oracle expects.

    Args:
        prop: The property that the parser breaks.
        query: The query on which it breaks it.
        folder: Where; the case goes into the folder of its topic there.

    Returns:
        The folder of the case.
    """
    topic = "closures" if query.mechanism.closures else "joints"
    name = fresh_id(query, {path.name for path in case_folders()})
    home = folder / topic / name
    home.mkdir(parents=True, exist_ok=True)
    query.files.write(home)
    clauses = read_clauses()
    said = {
        "id": name,
        "title": f"{prop.title.removesuffix('.')}: found by exploring, {name}.",
        "version": query.version,
        "clauses": [clause for clause in prop.clauses if query.version in clauses[clause].versions],
        "valid": True,
        "provenance": {"expectation": "oracle", "note": f"found on exploring the property {prop.name}"},
        "configurations": [{joint: list(q) for joint, q in each.items()} for each in query.configurations],
        "frames": list(query.frames),
    }
    case = CASE.validate_python(said)
    text = yaml.safe_dump(said, sort_keys=False, allow_unicode=True, width=120, default_flow_style=None)
    (home / CASE_FILE).write_text(text, encoding="utf-8")
    expected = expect(CorpusCase(case, topic, home, home))
    (home / EXPECTED_FILE).write_text(expected_text(expected), encoding="utf-8")
    return home


def how_to_keep(case: Path) -> Iterator[str]:
    """What to do with a case that was written, one line each."""
    here = Path.cwd()
    topic = (CASES.relative_to(here) if CASES.is_relative_to(here) else CASES) / case.parent.name
    yield "to keep it: look at its title and its clauses, move it to the others, and see what the lint says"
    yield f"  {shlex.join(['mv', str(case), f'{topic}/'])}"
    yield "  python -m eurdf_conformance.corpus.lint"
    yield f"to run it alone: when it is there, the same command with -k {case.name}"


def fresh_id(query: Query, taken: set[str]) -> str:
    """An id that no case has: made of the files, so that what is found again is written to the same place."""
    digest = int.from_bytes(hashlib.sha256(query.files.description + query.files.urdf).digest(), "big")
    while True:
        digest, number = divmod(digest, len(_ALPHABET) ** 6)
        name = "".join(_ALPHABET[number // len(_ALPHABET) ** i % len(_ALPHABET)] for i in range(6))
        if name not in taken or not digest:
            return name
