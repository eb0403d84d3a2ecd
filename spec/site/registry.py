"""The registry of clauses: ``python -m spec.site.registry`` draws it from the text into ``spec/clauses.json``."""

from __future__ import annotations

import json
from collections import defaultdict
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from spec.site.citation import Citation, function_citations, suite_citations
from spec.site.clause import SPEC, Clause, Withdrawn, read_chapters, read_clauses, read_withdrawn

CLAUSES = SPEC / "clauses.json"

#: Every id that was ever given, one a line: what stands here never stands for anything else.
IDS = SPEC / "ids.txt"

#: The JSON Schema of the registry, beside it.
SCHEMA = "clauses.schema.json"


def registry(
    clauses: Iterable[Clause],
    withdrawn: Iterable[Withdrawn],
    functions: Iterable[Citation],
    cases: Iterable[Citation] | None,
) -> dict[str, Any]:
    """The registry as it is written.

    Args:
        clauses: The clauses of the text.
        withdrawn: The ids that were withdrawn.
        functions: What the functions of the reference cite.
        cases: What the cases of the suite cite; None where there is no suite.
    """
    enforcing, testing = _sources(functions), _sources(cases or ())
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
                "codes": list(clause.codes),
                "functions": enforcing[clause.id],
                "cases": testing[clause.id],
                "untested": clause.untested,
                "unenforced": clause.unenforced,
            }
            for clause in sorted(clauses, key=lambda clause: clause.id)
        ],
        "withdrawn": [
            {"id": gone.id, "chapter": gone.chapter, "text": gone.text}
            for gone in sorted(withdrawn, key=lambda gone: gone.id)
        ],
    }


def current_registry(folder: Path = SPEC) -> dict[str, Any]:
    """The registry as the text and the code now stand."""
    chapters = read_chapters(folder)
    return registry(read_clauses(chapters), read_withdrawn(chapters), function_citations(), suite_citations())


def registry_text(content: dict[str, Any]) -> str:
    """A registry as its file holds it."""
    return json.dumps(content, indent=2, ensure_ascii=False) + "\n"


def read_ids(path: Path = IDS) -> list[str]:
    """Every id that was ever given."""
    return path.read_text(encoding="utf-8").split() if path.exists() else []


def main() -> None:
    """Write the registry, and take new ids into the list of those given, which only grows."""
    content = current_registry()
    CLAUSES.write_text(registry_text(content), encoding="utf-8")
    ids = {entry["id"] for kind in ("clauses", "withdrawn") for entry in content[kind]}
    IDS.write_text("".join(f"{given}\n" for given in sorted(ids | set(read_ids()))), encoding="utf-8")


def _sources(citations: Iterable[Citation]) -> defaultdict[str, list[str]]:
    found: defaultdict[str, set[str]] = defaultdict(set)
    for citation in citations:
        found[citation.clause].add(citation.source)
    return defaultdict(list, {clause: sorted(sources) for clause, sources in found.items()})


if __name__ == "__main__":
    main()
