"""By what each mutant is caught: ``python -m eurdf_conformance.mutants.matrix`` writes `kill_matrix.md`."""

from __future__ import annotations

import sys
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

from eurdf_conformance.corpus.clause import read_clauses
from eurdf_conformance.level import VERSIONS, Version
from eurdf_conformance.mutants.catalogue import MUTANTS
from eurdf_conformance.mutants.kills import ENOUGH, EXAMPLES, by_version, kills
from eurdf_conformance.mutants.mutant import Mutant
from eurdf_conformance.mutants.unbroken import UNBROKEN

#: In a checkout; it is no part of the installed package.
PAGE = Path(__file__).parents[2] / "kill_matrix.md"

#: So many of those that catch a mutant are named, of each version.
_NAMED = 3

_HEAD = f"""# Kill matrix

The suite is tested by **mutants**: the reference reader with one thing broken, in
[`eurdf_conformance/mutants`](eurdf_conformance/mutants/__init__.py). Each breaks one clause, and must be caught by a
case or a property that cites that clause, at its level, and that the reference passes. Each version of the format is
certified apart, so a mutant must be caught in each version of its clause in which files can show what is broken. One
that survives in a version fails the tests.

A case is named by topic, id and level, a property by name, version and level. A row says how many catch a mutant in
each version, with a dash where none has to, and names the first {_NAMED} of each; cases, and after them properties, are
tried until {ENOUGH} have caught it. Of a property {EXAMPLES} examples are tried; the suite tries more. Rules of the
protocol are put to a process of the mutant's, as the suite does, for version {VERSIONS[-1]} alone, and count for both.

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
    found = by_version(mutant, items)
    counts = " | ".join(str(len(found[version])) if version in found else "-" for version in VERSIONS)
    named = dict.fromkeys(item for version in VERSIONS for item in found.get(version, ())[:_NAMED])
    more = ", …" if len(named) < len(items) else ""
    which = ", ".join(f"`{item}`" for item in named) + more
    return f"| {mutant.clause} | `{mutant.name}` | {mutant.breaks.replace('|', chr(92) + '|')} | {counts} | {which} |"


def survivors(caught: Mapping[str, Sequence[str]], version: Version) -> list[Mutant]:
    """The mutants that nothing catches in a version in which they are to be caught."""
    return [each for each in _of(version) if not by_version(each, caught[each.name])[version]]


def _of(version: Version) -> list[Mutant]:
    return [mutant for mutant in MUTANTS.values() if version in mutant.versions]


def in_order() -> list[Mutant]:
    """All mutants, by clause."""
    clauses = list(read_clauses())
    return sorted(MUTANTS.values(), key=lambda mutant: clauses.index(mutant.clause))


def _lines(caught: Mapping[str, Sequence[str]]) -> Iterator[str]:
    yield _HEAD
    only_accept = sum(mutant.only_accepts for mutant in MUTANTS.values())
    yield f"There are {len(MUTANTS)} mutants."
    yield from (_survive(caught, version) for version in VERSIONS)
    yield f"{only_accept} only accept what they should reject, and build no robot of it."
    yield ""
    header = ["clause", "mutant", "what is broken", *(f"in version {version}" for version in VERSIONS), "which"]
    yield f"| {' | '.join(header)} |"
    yield f"| {' | '.join('---' for _ in header)} |"
    yield from (row(mutant, caught[mutant.name]) for mutant in in_order())
    yield ""
    yield "## Clauses that no mutant breaks"
    yield ""
    yield "| clause | why |"
    yield "| --- | --- |"
    yield from (f"| {clause} | {why} |" for clause, why in UNBROKEN.items())


def _survive(caught: Mapping[str, Sequence[str]], version: Version) -> str:
    surviving = len(survivors(caught, version))
    return f"{len(_of(version))} are to be caught in version {version}, {surviving} of which survive."


def _kills(name: str) -> list[str]:
    return kills(MUTANTS[name])


def main() -> int:
    """Write the page; 1 where a mutant survives."""
    with ProcessPoolExecutor(2) as pool:
        caught = dict(zip(MUTANTS, pool.map(_kills, MUTANTS), strict=True))
    PAGE.write_text(page(caught), encoding="utf-8")
    for version in VERSIONS:
        for mutant in survivors(caught, version):
            sys.stdout.write(f"{mutant.clause}: {mutant.name} survives in version {version}: {mutant.breaks}\n")
        sys.stdout.write(f"{_survive(caught, version)}\n")
    return int(any(survivors(caught, version) for version in VERSIONS))


if __name__ == "__main__":
    sys.exit(main())
