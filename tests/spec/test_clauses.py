"""The clauses of the specification: how they are read from the text, and the registry that is drawn from it."""

from __future__ import annotations

import json
import re
from pathlib import Path

import jsonschema
import pytest

from eurdf.diagnostics import REGISTRY
from spec.site.clause import SPEC, Chapter, Clause, Withdrawn, keywords, read_chapters, read_clauses, read_withdrawn
from spec.site.registry import CLAUSES, CODES, IDS, SCHEMA, codes_text, current_registry, read_ids, registry_text
from support.places import ROOT

ID = re.compile(r"EU-[A-Z]{3}-\d{3}")

CHAPTER = """\
# Gears

Text, and a list:

- of one thing

:::{clause} EU-TST-001
:level: kinematics
:version: 2
:code: gear-alone gear-loose
:untested: "Gears: nobody has any."

A gear MUST be one of

- a wheel with teeth,
- $n$ of them.
:::

````{code-block} markdown
```{clause} EU-TST-009
```
````

````{admonition} Within
:::{clause} EU-TST-002
:level: parser
A reader SHOULD NOT
`MUST` it.
:::
````

:::{withdrawn} EU-TST-003
It went into {clause}`EU-TST-001`.
:::
"""


def _chapter(text: str) -> list[Chapter]:
    return [Chapter("gears", Path("gears.md"), text)]


def test_clause_has_place_keyword_and_options() -> None:
    first, second = read_clauses(_chapter(CHAPTER))
    assert first == Clause(
        id="EU-TST-001",
        chapter="gears",
        line=7,
        keyword="MUST",
        text="A gear MUST be one of\n\n- a wheel with teeth,\n- $n$ of them.",
        level="kinematics",
        versions=("2",),
        codes=("gear-alone", "gear-loose"),
        untested="Gears: nobody has any.",
        unenforced=None,
    )
    assert (second.id, second.line, second.keyword, second.versions) == ("EU-TST-002", 25, "SHOULD NOT", ("1", "2"))


def test_withdrawn_id_names_its_replacement() -> None:
    assert read_withdrawn(_chapter(CHAPTER)) == [
        Withdrawn("EU-TST-003", "gears", 32, "It went into {clause}`EU-TST-001`.")
    ]


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("A reader MUST NOT, and SHOULD.", ["MUST NOT", "SHOULD"]),
        ("It must; a MUSTER, `MUST` and ``a ` MAY``.", []),
        ("It MUST\nNOT.", ["MUST"]),
    ],
)
def test_normative_words_are_capitals_outside_code(text: str, words: list[str]) -> None:
    assert keywords(text) == words


def test_clause_registry_is_current() -> None:
    assert CLAUSES.read_text(encoding="utf-8") == registry_text(current_registry()), "python -m spec.site.registry"
    assert CODES.read_text(encoding="utf-8") == codes_text(current_registry()), "python -m spec.site.registry"


def test_registry_matches_its_schema_strictly() -> None:
    schema = json.loads((SPEC / SCHEMA).read_text(encoding="utf-8"))
    validator = jsonschema.Draft202012Validator(schema)
    validator.check_schema(schema)
    registry = json.loads(CLAUSES.read_text(encoding="utf-8"))
    validator.validate(registry)
    for kind in ("clauses", "diagnostics"):
        entry = registry[kind][0]
        for name in entry:
            lacking = {key: value for key, value in entry.items() if key != name}
            assert not validator.is_valid({**registry, kind: [lacking]}), name
        assert not validator.is_valid({**registry, kind: [{**entry, "other": 1}]})


def test_registry_lists_codes_with_phase_severity_place() -> None:
    diagnostics = {entry["code"]: entry for entry in json.loads(CLAUSES.read_text(encoding="utf-8"))["diagnostics"]}
    assert set(diagnostics) == {rule.code for rule in REGISTRY.values() if rule.clause}
    frame = diagnostics["unknown-frame"]
    assert (frame["clause"], frame["phase"], frame["severity"]) == ("EU-FRM-001", "link", "error")
    assert frame["place"] == "the name"


def test_every_cited_clause_exists() -> None:
    clauses = {clause.id for clause in read_clauses(read_chapters())}
    for path in (ROOT / "reference").rglob("*.py"):
        for clause in ID.findall(path.read_text(encoding="utf-8")):
            assert clause in clauses, f"{path.name} names {clause}"


def test_ids_are_listed_once_in_order() -> None:
    ids = read_ids(IDS)
    assert ids == sorted(set(ids))
