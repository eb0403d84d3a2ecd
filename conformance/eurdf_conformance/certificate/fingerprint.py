"""Hashes that tell whether two runs used the same suite."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable, Mapping
from itertools import chain

from eurdf_conformance.corpus.archive import case_files
from eurdf_conformance.corpus.clause import Clause, read_clauses
from eurdf_conformance.corpus.read import CorpusCase, all_cases
from eurdf_conformance.properties import PROPERTIES
from eurdf_conformance.properties.example import FROZEN


def clauses_hash(clauses: Iterable[Clause] | None = None) -> str:
    """Hash of the requirements of the clauses; of this edition's by default."""
    values = [
        [clause.id, clause.keyword, clause.text, clause.level, clause.versions, sorted(clause.codes)]
        for clause in sorted(clauses or read_clauses().values(), key=lambda clause: clause.id)
    ]
    return _hash(json.dumps(values, ensure_ascii=False).encode())


def corpus_hash(cases: Iterable[CorpusCase] | None = None) -> str:
    """Hash of the files of cases, in any order; of all cases by default."""
    return files_hash(dict(chain.from_iterable(map(case_files, all_cases() if cases is None else cases))))


def properties_hash() -> str:
    """Hash of the relations and of the stored mechanisms that each certification tests them on."""
    values = [[each.name, each.title, each.clauses, each.levels, each.versions] for each in PROPERTIES]
    return files_hash({"properties": json.dumps(values, ensure_ascii=False).encode(), FROZEN.name: FROZEN.read_bytes()})


def files_hash(files: Mapping[str, bytes]) -> str:
    """Hash of files by name: the hash of the sorted lines with the hash and the name of each file."""
    lines = sorted(f"{_hash(content)}  {name}\n" for name, content in files.items())
    return _hash("".join(lines).encode())


def _hash(content: bytes) -> str:
    return f"sha256:{hashlib.sha256(content).hexdigest()}"
