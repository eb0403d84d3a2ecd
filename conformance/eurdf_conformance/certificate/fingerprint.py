"""Hashes that tell whether two runs used the same suite."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable

from eurdf_conformance.corpus.clause import Clause, read_clauses
from eurdf_conformance.corpus.release import files_hash
from eurdf_conformance.properties import PROPERTIES
from eurdf_conformance.properties.example import FROZEN


def clauses_hash(clauses: Iterable[Clause] | None = None) -> str:
    """Hash of the requirements of the clauses; of this edition's by default."""
    values = [
        [clause.id, clause.keyword, clause.text, clause.level, clause.versions, sorted(clause.codes)]
        for clause in sorted(clauses or read_clauses().values(), key=lambda clause: clause.id)
    ]
    return _hash(json.dumps(values, ensure_ascii=False).encode())


def properties_hash() -> str:
    """Hash of the relations and of the stored mechanisms that each certification tests them on."""
    values = [[each.name, each.title, each.clauses, each.levels, each.versions] for each in PROPERTIES]
    return files_hash({"properties": json.dumps(values, ensure_ascii=False).encode(), FROZEN.name: FROZEN.read_bytes()})


def _hash(content: bytes) -> str:
    return f"sha256:{hashlib.sha256(content).hexdigest()}"
