"""The rule on the README: it shows the picture and the computed dimensions."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence

import eurdf
from eurdf.mechanism.mechanism import Mechanism
from robots.quality.candidate import Candidate

#: Columns of the dimension table. For a robot with a floating root, a column ``root`` precedes them, with one row for
#: each root.
COLUMNS = ("nv", "closures", "nc", "rank", "mobility", "redundant", "actuated", "uncontrolled", "moving mass")


def is_documented(candidate: Candidate) -> list[str] | None:
    """README.md shows picture.png and the computed dimensions, and the metadata have a description; None if open."""
    if not candidate.closes:
        return None
    errors = []
    if not candidate.robot.mechanism.metadata.get("description"):
        errors.append("the metadata have no description; add metadata: {description: …}")
    file = candidate.folder / "README.md"
    if not file.is_file():
        return [*errors, "README.md is missing"]
    text = file.read_text(encoding="utf-8", errors="replace")
    if "](picture.png)" not in text:
        errors.append("README.md does not show picture.png")
    measured = dimension_table(candidate)
    stated = stated_dimensions(text.splitlines())
    if not stated:
        errors.append(f"README.md has no table of dimensions with the columns {_row(measured[0])}")
    elif stated[0] != measured[0]:
        errors.append(f"README.md: the columns of the dimensions must be {_row(measured[0])}")
    else:
        errors += [f"README.md: the computed dimensions are {_row(row)}" for row in measured[1:] if row not in stated]
        errors += [
            f"README.md: this row differs from the computed dimensions: {_row(row)}"
            for row in stated[1:]
            if row not in measured
        ]
    return errors


def dimension_table(candidate: Candidate) -> list[list[str]]:
    """Head and rows of the table, as computed."""
    if candidate.robot.mechanism.root == "fixed":
        return [list(COLUMNS), dimension_row(candidate.robot)]
    rows = [["root", *COLUMNS]]
    for root in ("fixed", "floating"):
        rows.append([root, *dimension_row(eurdf.load(candidate.path, root=root, geometry=False))])
    return rows


def dimension_row(robot: eurdf.Robot) -> list[str]:
    """The dimensions of a robot that closes."""
    found = eurdf.analyze(robot)
    mass = sum(inertia.mass for inertia in robot.model.inertias[1:])
    counts = (found.nc, found.rank, found.mobility, found.redundant, found.actuated, found.uncontrolled)
    return [str(found.nv), _closures(robot.mechanism), *map(str, counts), f"{mass:.2f} kg"]


def _closures(mechanism: Mechanism) -> str:
    """Number and types: ``3 (6d)``, ``12 (3×6d + 9×3d)``."""
    counts = Counter(closure.type for closure in mechanism.closures)
    kinds = list(counts) if len(counts) == 1 else [f"{counts[kind]}×{kind}" for kind in sorted(counts, reverse=True)]
    return f"{len(mechanism.closures)} ({' + '.join(kinds)})" if kinds else "0"


def stated_dimensions(lines: Sequence[str]) -> list[list[str]]:
    """Head and rows of the first table that has a column ``nv``, as text."""
    for number, line in enumerate(lines):
        if "nv" in _cells(line):
            rows = []
            for row in lines[number:]:
                if not row.startswith("|"):
                    break
                rows.append(_cells(row))
            return [rows[0], *rows[2:]]
    return []


def _cells(line: str) -> list[str]:
    return [cell.strip() for cell in line.strip().strip("|").split("|")] if line.startswith("|") else []


def _row(cells: Iterable[str]) -> str:
    return f"| {' | '.join(cells)} |"
