"""By what each mutant is caught: ``python -m eurdf_conformance.mutants.matrix`` writes `kill_matrix.md`."""

from __future__ import annotations

import sys
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

from eurdf_conformance.corpus.clause import read_clauses
from eurdf_conformance.level import VERSIONS
from eurdf_conformance.mutants.catalogue import MUTANTS
from eurdf_conformance.mutants.kills import EXAMPLES, kills
from eurdf_conformance.mutants.mutant import Mutant
from eurdf_conformance.mutants.unbroken import UNBROKEN

#: In a checkout; it is no part of the installed package.
PAGE = Path(__file__).parents[2] / "kill_matrix.md"

#: So many of those that catch a mutant are named.
_NAMED = 6

_HEAD = f"""# Kill matrix

The suite is tested by **mutants**: the reference reader with one thing broken, in
[`eurdf_conformance/mutants`](eurdf_conformance/mutants/__init__.py). Each breaks one clause, and must be caught by a
case or a property that cites that clause, at its level, and that the reference passes. One that survives fails the
tests.

A case is named by topic, id and level, a property by name, version and level. A row says how many catch a mutant, and
names the first {_NAMED}. Of a property {EXAMPLES} examples are tried; the suite tries more. Rules of the protocol are
put to a process of the mutant's, as the suite does, for version {VERSIONS[-1]} alone.

Written by `python -m eurdf_conformance.mutants.matrix`.
"""


def page(caught: Mapping[str, Sequence[str]]) -> str:
    """The page.

    Args:
        caught: For each mutant by which items it is caught.
    """
    return "\n".join(_lines(caught)) + "\n"


def row(mutant: Mutant, items: Sequence[str]) -> str:
    """The row of one mutant."""
    named = ", ".join(f"`{item}`" for item in items[:_NAMED]) + (", …" if len(items) > _NAMED else "")
    return (
        f"| {mutant.clause} | `{mutant.name}` | {mutant.breaks.replace('|', chr(92) + '|')} | {len(items)} | {named} |"
    )


def in_order() -> list[Mutant]:
    """All mutants, by clause."""
    clauses = list(read_clauses())
    return sorted(MUTANTS.values(), key=lambda mutant: clauses.index(mutant.clause))


def _lines(caught: Mapping[str, Sequence[str]]) -> Iterator[str]:
    yield _HEAD
    survive = sum(not caught[name] for name in MUTANTS)
    only_accept = sum(mutant.only_accepts for mutant in MUTANTS.values())
    yield f"{len(MUTANTS)} mutants, {survive} of which survive."
    yield f"{only_accept} of them only accept what they should reject, and build no robot of it."
    yield ""
    yield "| clause | mutant | what is broken | caught by | which |"
    yield "| --- | --- | --- | --- | --- |"
    yield from (row(mutant, caught[mutant.name]) for mutant in in_order())
    yield ""
    yield "## Clauses that no mutant breaks"
    yield ""
    yield "| clause | why |"
    yield "| --- | --- |"
    yield from (f"| {clause} | {why} |" for clause, why in UNBROKEN.items())


def _kills(name: str) -> list[str]:
    return kills(MUTANTS[name])


def main() -> int:
    """Write the page; 1 where a mutant survives."""
    with ProcessPoolExecutor(2) as pool:
        caught = dict(zip(MUTANTS, pool.map(_kills, MUTANTS), strict=True))
    PAGE.write_text(page(caught), encoding="utf-8")
    survivors = [name for name in MUTANTS if not caught[name]]
    sys.stdout.writelines(f"{MUTANTS[name].clause}: {name} survives: {MUTANTS[name].breaks}\n" for name in survivors)
    sys.stdout.write(f"{len(MUTANTS)} mutants, {len(survivors)} of which survive\n")
    return int(bool(survivors))


if __name__ == "__main__":
    sys.exit(main())
