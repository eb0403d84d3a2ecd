"""The registry: ``python -m spec.site.registry`` writes the clauses and the codes of the text to ``spec/clauses.json``.

It also writes the codes as a module of the package in JavaScript. The registry has no references to clauses:
`clauses_with_references` computes them.
"""

from __future__ import annotations

import json
from collections import defaultdict
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

from eurdf.diagnostics import REGISTRY, Rule
from spec.site.citation import Citation, function_citations, suite_citations
from spec.site.clause import SPEC, Chapter, read_chapters, read_clauses, read_withdrawn
from spec.site.example import read_diagnostics

CLAUSES = SPEC / "clauses.json"

#: The phase, severity and clause of each code, for the package in JavaScript.
CODES = SPEC.parent / "js" / "src" / "reading" / "codes.js"

#: Every id ever used, one per line: an id is never reused.
IDS = SPEC / "ids.txt"

#: The JSON Schema of the registry, beside it.
SCHEMA = "clauses.schema.json"


def registry(chapters: Sequence[Chapter], rules: Iterable[Rule] = REGISTRY.values()) -> dict[str, Any]:
    """The registry as JSON data.

    Args:
        chapters: The text of the specification.
        rules: The diagnostics; advice of the reference parser is left out, because it has no clause.
    """
    places = {shown.code: shown.place for shown in read_diagnostics(chapters)}
    return {
        "$schema": SCHEMA,
        "clauses": [
            {
                "id": clause.id,
                "chapter": clause.chapter,
                "keyword": clause.keyword,
                "text": clause.text,
                "level": clause.level,
                "versions": list(clause.versions),
                "untested": clause.untested,
                "unenforced": clause.unenforced,
            }
            for clause in sorted(read_clauses(chapters), key=lambda clause: clause.id)
        ],
        "diagnostics": [
            {
                "code": rule.code,
                "clause": rule.clause,
                "phase": rule.phase,
                "severity": rule.severity,
                "title": rule.title,
                "place": places[rule.code],
            }
            for rule in rules
            if rule.clause is not None
        ],
        "withdrawn": [
            {"id": gone.id, "chapter": gone.chapter, "text": gone.text}
            for gone in sorted(read_withdrawn(chapters), key=lambda gone: gone.id)
        ],
    }


def current_registry(folder: Path = SPEC) -> dict[str, Any]:
    """The registry of the current text."""
    return registry(read_chapters(folder))


def clauses_with_references() -> dict[str, dict[str, Any]]:
    """The clauses of the current text by id, each with what refers to it.

    ``codes``: the diagnostics that report it; ``functions``, ``cases``: citations by what enforces and tests it.
    """
    content = current_registry()
    codes, functions, cases = defaultdict(list), _by_clause(function_citations()), _by_clause(suite_citations() or ())
    for diagnostic in content["diagnostics"]:
        codes[diagnostic["clause"]].append(diagnostic["code"])
    return {
        id_: {**entry, "codes": codes[id_], "functions": functions[id_], "cases": cases[id_]}
        for id_, entry in ((entry["id"], entry) for entry in content["clauses"])
    }


def registry_text(content: dict[str, Any]) -> str:
    """A registry as the text of its file: one entry per line."""
    lists = ",\n".join(
        f'  "{name}": [\n' + ",\n".join(f"    {_line(entry)}" for entry in content[name]) + "\n  ]"
        for name in ("clauses", "diagnostics", "withdrawn")
    )
    return f'{{\n  "$schema": {_line(content["$schema"])},\n{lists}\n}}\n'


def codes_text(content: dict[str, Any]) -> str:
    """The codes of a registry as a module in JavaScript."""
    parts = ("phase", "severity", "clause")
    rows = "".join(
        f"  [{_line(entry['code'])}, {_object({part: entry[part] for part in parts})}],\n"
        for entry in content["diagnostics"]
    )
    head = "// Written by `python -m spec.site.registry`, from the specification."
    return f"{head}\n\nexport const CODES = new Map([\n{rows}]);\n"


def _object(entry: dict[str, str]) -> str:
    return "{ " + ", ".join(f"{name}: {_line(value)}" for name, value in entry.items()) + " }"


def _line(value: Any) -> str:
    return json.dumps(value, ensure_ascii=False)


def read_ids(path: Path = IDS) -> list[str]:
    """Every id ever used."""
    return path.read_text(encoding="utf-8").split() if path.exists() else []


def main() -> None:
    """Write the registry and the codes, and add new ids to the list, which only grows."""
    content = current_registry()
    CLAUSES.write_text(registry_text(content), encoding="utf-8")
    CODES.write_text(codes_text(content), encoding="utf-8")
    ids = {entry["id"] for kind in ("clauses", "withdrawn") for entry in content[kind]}
    IDS.write_text("".join(f"{given}\n" for given in sorted(ids | set(read_ids()))), encoding="utf-8")


def _by_clause(citations: Iterable[Citation]) -> defaultdict[str, list[Citation]]:
    found: defaultdict[str, dict[str, Citation]] = defaultdict(dict)
    for citation in citations:
        found[citation.clause].setdefault(citation.source, citation)
    return defaultdict(list, {clause: [each[name] for name in sorted(each)] for clause, each in found.items()})


if __name__ == "__main__":
    main()
