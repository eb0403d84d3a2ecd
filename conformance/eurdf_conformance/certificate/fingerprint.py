"""Hashes that say whether two runs were of the same suite."""

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
    """Hash of what clauses demand, whoever enforces and tests them; those of this edition if left out."""
    values = [
        [clause.id, clause.keyword, clause.text, clause.level, clause.versions, sorted(clause.codes)]
        for clause in sorted(clauses or read_clauses().values(), key=lambda clause: clause.id)
    ]
    return _hash(json.dumps(values, ensure_ascii=False).encode())


def corpus_hash(cases: Iterable[CorpusCase] | None = None) -> str:
    """Hash of all files of cases, in whatever order these come; of all cases if left out."""
    return files_hash(dict(chain.from_iterable(map(case_files, all_cases() if cases is None else cases))))


def properties_hash() -> str:
    """Hash of what the properties hold, and of the mechanisms that they are tried on in every certification."""
    values = [[each.name, each.title, each.clauses, each.levels, each.versions] for each in PROPERTIES]
    return files_hash({"properties": json.dumps(values, ensure_ascii=False).encode(), FROZEN.name: FROZEN.read_bytes()})


def files_hash(files: Mapping[str, bytes]) -> str:
    """Hash of files by name: that of the sorted lines that hold their hashes and names."""
    lines = sorted(f"{_hash(content)}  {name}\n" for name, content in files.items())
    return _hash("".join(lines).encode())


def _hash(content: bytes) -> str:
    return f"sha256:{hashlib.sha256(content).hexdigest()}"
