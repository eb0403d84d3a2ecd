"""The lint of the specification: each fixture breaks one rule, and the lint reports it."""

from __future__ import annotations

from pathlib import Path

import pytest

from eurdf.diagnostics import Phase, Rule, Severity
from spec.site.citation import case_citations, citations_in, cited
from spec.site.clause import Chapter
from spec.site.lint import RULES, lint
from spec.site.registry import read_ids
from spec.site.specification import Specification, current_specification
from support.places import DATA as ALL_DATA

DATA = ALL_DATA / "lint"
FIXTURES = sorted(DATA.glob("*.md"))


def _beside(fixture: Path, suffix: str) -> Path:
    """What a fixture is judged by: its own file, where it has one."""
    own = fixture.with_suffix(suffix)
    return own if own.exists() else DATA / f"sound{suffix}"


def _codes(path: Path) -> dict[str, Rule]:
    rows = [line.split(maxsplit=3) for line in path.read_text(encoding="utf-8").splitlines()]
    return {
        code: Rule(code, Phase.LINK, Severity(severity), None if clause == "-" else clause, title)
        for code, clause, severity, title in rows
    }


def _specification(fixture: Path) -> Specification:
    codes, ids = _beside(fixture, ".codes.txt"), _beside(fixture, ".ids.txt")
    return Specification(
        chapters=[Chapter(fixture.stem, fixture, fixture.read_text(encoding="utf-8"))],
        codes=_codes(codes),
        codes_path=codes,
        ids=read_ids(ids),
        ids_path=ids,
        functions=citations_in(_beside(fixture, ".functions.py"), DATA),
        cases=case_citations(_beside(fixture, ".corpus")),
    )


def _found(fixture: Path) -> list[str]:
    findings = lint(_specification(fixture))
    return [f"{found.path.relative_to(DATA)}:{found.line}: {found.message} [{found.rule}]" for found in findings]


@pytest.mark.parametrize("fixture", FIXTURES, ids=lambda fixture: fixture.stem)
def test_fixture_gives_its_stated_error(fixture: Path) -> None:
    expected = fixture.read_text(encoding="utf-8").splitlines()[0].removeprefix("<!-- ").removesuffix(" -->")
    assert _found(fixture) == ([] if expected == "nothing" else [expected])


def test_every_rule_has_a_fixture() -> None:
    found = {rule: set() for rule in RULES}
    for fixture in FIXTURES:
        specification = _specification(fixture)
        for rule in RULES:
            found[rule] |= {finding.rule for finding in rule(specification)}
    assert [rule.__name__ for rule in RULES if not found[rule]] == []


def test_specification_is_sound() -> None:
    assert [str(finding) for finding in lint(current_specification())] == []


@pytest.mark.parametrize(
    ("text", "ids"),
    [
        ("EU-CLO-005, EU-CLO-006: the loops close", ["EU-CLO-005", "EU-CLO-006"]),
        ("EU-URD-009, -010, -014 to -016: a tree", [f"EU-URD-{n:03}" for n in (9, 10, 14, 15, 16)]),
        ("EU-SCH-001 to EU-SCH-003, and EU-EXT-001", ["EU-SCH-001", "EU-SCH-002", "EU-SCH-003", "EU-EXT-001"]),
        ("from -3 to -100, and nothing of EU-CLO", []),
        ("EU-CLO-001 and -002", ["EU-CLO-001", "EU-CLO-002"]),
    ],
)
def test_docstring_can_cite_several_clauses(text: str, ids: list[str]) -> None:
    assert cited(text) == ids
