"""Shows a certificate in the terminal."""

from __future__ import annotations

import sys
from collections.abc import Iterator

from eurdf.commands.terminal import Table, write_lines, write_shown
from eurdf.diagnostics.text import Line
from eurdf.diagnostics.wording import visible
from eurdf_conformance.certificate.certificate import Certificate, Failure
from eurdf_conformance.certificate.summary import headline, level_words, parser_title
from eurdf_conformance.judging.level_result import LevelResult
from eurdf_conformance.judging.result import Item, Result
from eurdf_conformance.level import VERSIONS, Level
from eurdf_conformance.properties.explore import EXPLORED
from eurdf_conformance.suite.smoke import smoke_lines

# Number of failures shown; the certificate has all of them.
_SHOWN = 20


def show(certificate: Certificate) -> None:
    """Write to standard output what did not pass, then the levels, then the verdict."""
    if certificate.scope.smoke:
        write_lines(([(visible(line), "")] for line in _smoke_lines(certificate)), sys.stdout)
        return
    lines = [line for failure in certificate.failures[:_SHOWN] for line in _failure_lines(failure)]
    more = len(certificate.failures) - _SHOWN
    if more > 0:
        lines.append([(f"{more} more failures; --certificate DIR writes a page that shows all", "dim")])
    if certificate.scope.explore and any(failure.id.startswith("properties/") for failure in certificate.failures):
        seed = certificate.scope.seed
        lines.append([(f"exploring from seed {seed} writes each failing mechanism as a case into {EXPLORED}/", "dim")])
    lines += [[("differs from the known failures: ", "red"), (visible(each), "")] for each in certificate.unexpected]
    if lines:
        write_lines([*lines, []], sys.stdout)
    rows = (
        ((level, "bold"), *(_level_cell(certificate.at(version, level)) for version in VERSIONS)) for level in Level
    )
    write_shown(Table("level", *(f"version {version}" for version in VERSIONS), rows=rows))
    write_lines([[]], sys.stdout)
    style = "bold green" if certificate.certified else "bold red"
    write_lines([[(f"{visible(parser_title(certificate))}: ", "bold"), (headline(certificate), style)]], sys.stdout)


def _smoke_lines(certificate: Certificate) -> Iterator[str]:
    wrong = [
        Result(
            Item(failure.id, failure.level, failure.version, failure.clauses, failure.title),
            failure.verdict,
            (failure.difference,) if failure.difference else (),
            failure.reproduce,
            failure.log or "",
        )
        for failure in certificate.failures
    ]
    return smoke_lines(wrong, asked=any(level.counts for level in certificate.levels))


def _failure_lines(failure: Failure) -> Iterator[Line]:
    known = " (known)" if failure.known else ""
    name = f"{failure.id}/{failure.level}"
    yield [
        (f"{failure.verdict}{known} ", "yellow" if failure.known else "red"),
        (name, "bold"),
        (f": {failure.title}", ""),
    ]
    for line in (failure.difference or "").splitlines():
        yield [(f"    {visible(line)}", "")]
    if failure.reproduce:
        yield [(f"    {visible(failure.reproduce)}", "dim")]


def _level_cell(result: LevelResult | None) -> tuple[str, str]:
    if result is None or not (result.claimed and result.asked):
        return "not claimed" if result is None else level_words(result), "dim"
    return level_words(result), "green" if result.certified else "red"
