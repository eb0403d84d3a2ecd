"""The clauses of the specification, the registry of codes and the code agree."""

from __future__ import annotations

import re
from pathlib import Path

from eurdf.diagnostics import REGISTRY

ROOT = Path(__file__).parents[1]
CLAUSE = re.compile(r"EU-[A-Z]{3}-\d{3}")


def _clauses() -> dict[str, str]:
    """Text of every clause in the specification, by its id."""
    clauses: dict[str, str] = {}
    for path in sorted((ROOT / "spec").glob("*.md")):
        clause = re.compile(r"^\((EU-[A-Z]{3}-\d{3})\)=\n\*\*(EU-[A-Z]{3}-\d{3})\*\* (.+)$", re.M)
        for match in clause.finditer(path.read_text(encoding="utf-8")):
            assert match[1] == match[2], path
            assert match[1] not in clauses, f"{match[1]} stands twice"
            clauses[match[1]] = match[3]
    return clauses


def test_every_code_stands_behind_the_clause_that_it_cites() -> None:
    clauses = _clauses()
    for code, rule in REGISTRY.items():
        assert f"`{code}`" in clauses[rule.clause], code


def test_every_code_named_in_the_specification_is_registered_for_that_clause() -> None:
    for clause, text in _clauses().items():
        for code in re.findall(r"`([a-z0-9-]+)`$", text):
            assert REGISTRY[code].clause == clause


def test_errors_enforce_a_must_and_warnings_a_should() -> None:
    clauses = _clauses()
    for code, rule in REGISTRY.items():
        assert ("MUST" in clauses[rule.clause]) == (rule.severity == "error"), code


def test_every_clause_that_the_code_names_exists() -> None:
    clauses = _clauses()
    for path in (ROOT / "reference").rglob("*.py"):
        for clause in CLAUSE.findall(path.read_text(encoding="utf-8")):
            assert clause in clauses, f"{path.name} names {clause}"
