"""Writes a failure found by exploring as a case that is ready to commit."""

from __future__ import annotations

import hashlib
import shlex
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import yaml

from eurdf_conformance.corpus.case import CASE
from eurdf_conformance.corpus.clause import read_clauses
from eurdf_conformance.corpus.expect import expect
from eurdf_conformance.corpus.expected import expected_text
from eurdf_conformance.corpus.read import CASES, all_cases, read_case
from eurdf_conformance.properties.files import DESCRIPTION, URDF
from eurdf_conformance.properties.property import Property
from eurdf_conformance.properties.query import Query

_ALPHABET = "abcdefghijklmnopqrstuvwxyz0123456789"


def write_case(prop: Property, query: Query, folder: Path) -> Path:
    """Write a robot as a case, with the oracle's expectation.

    Args:
        prop: The property that the parser breaks.
        query: The query on which it breaks it.
        folder: Where; the case goes into the folder of its topic there.

    Returns:
        The file of the case.
    """
    id_ = fresh_id(query, {case.id for case in all_cases()})
    path = folder / ("closures" if query.mechanism.closures else "joints") / f"found-{id_}.yaml"
    clauses = read_clauses()
    said = {
        "id": id_,
        "title": f"{prop.title.removesuffix('.')}: found by exploring, {id_}.",
        "version": query.version,
        "clauses": [clause for clause in prop.clauses if query.version in clauses[clause].versions],
        "valid": True,
        "provenance": {"expectation": "oracle", "note": f"found on exploring the property {prop.name}"},
        "configurations": [{joint: list(q) for joint, q in each.items()} for each in query.configurations],
        "frames": list(query.frames),
        "files": {DESCRIPTION: query.files.description.decode("utf-8"), URDF: query.files.urdf.decode("utf-8")},
    }
    CASE.validate_python(said)
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(_text(said), encoding="utf-8")
    case = read_case(path)
    case.expectation.write_text(expected_text(expect(case)), encoding="utf-8")
    return path


def _text(said: Mapping[str, Any]) -> str:
    """The text of a case file: texts of files as blocks, everything else in flow style."""
    short = {key: value for key, value in said.items() if key != "files"}
    head = yaml.safe_dump(short, sort_keys=False, allow_unicode=True, width=120, default_flow_style=None)
    return head + yaml.dump({"files": said["files"]}, Dumper=_Blocks, sort_keys=False, allow_unicode=True)


class _Blocks(yaml.SafeDumper):
    """Writes texts of several lines as blocks."""


def _block(dumper: yaml.SafeDumper, text: str) -> yaml.ScalarNode:
    return dumper.represent_scalar("tag:yaml.org,2002:str", text, style="|" if "\n" in text else None)


_Blocks.add_representer(str, _block)


def how_to_keep(path: Path) -> Iterator[str]:
    """How to add the written case to the corpus, one line per step."""
    here = Path.cwd()
    topic = (CASES.relative_to(here) if CASES.is_relative_to(here) else CASES) / path.parent.name
    files = map(str, (path, path.with_suffix(".expected.json")))
    yield "to keep it: look at its title and its clauses, give it a name that says what it shows,"
    yield "move it to the others, and see what the lint says"
    yield f"  {shlex.join(['mv', *files, f'{topic}/'])}"
    yield "  python -m eurdf_conformance.corpus.lint"
    yield f"to run it alone: when it is there, the same command with -k {path.parent.name}/{path.stem}"


def fresh_id(query: Query, taken: set[str]) -> str:
    """A new id, derived from the files, so that a failure found again is written to the same place."""
    digest = int.from_bytes(hashlib.sha256(query.files.description + query.files.urdf).digest(), "big")
    while True:
        digest, number = divmod(digest, len(_ALPHABET) ** 6)
        name = "".join(_ALPHABET[number // len(_ALPHABET) ** i % len(_ALPHABET)] for i in range(6))
        if name not in taken or not digest:
            return name
