"""A certificate in words."""

from __future__ import annotations

from collections.abc import Sequence

from eurdf_conformance.certificate.certificate import Certificate
from eurdf_conformance.judging.level_result import LevelResult
from eurdf_conformance.judging.verdict import Verdict
from eurdf_conformance.level import VERSIONS, Level, Version


def certified_levels(certificate: Certificate, version: Version) -> tuple[Level, ...]:
    """The levels certified for a version."""
    return tuple(each.level for each in certificate.levels if each.version == version and each.certified)


def parser_title(certificate: Certificate) -> str:
    """Name and version of the parser, or its command if it could not be started."""
    parser = certificate.parser
    return certificate.parser_option if parser is None else f"{parser.name} {parser.version}".strip()


def headline(certificate: Certificate) -> str:
    """What the parser is certified for, and what else it claims, in a sentence or two."""
    if certificate.parser is None:
        return "The parser could not be started"
    if certificate.scope.smoke:
        return "Smoke test of three cases, which certifies nothing"
    certified = _by_version(certificate, True)
    missing = _by_version(certificate, False)
    if not certified:
        return "Not certified at any level"
    return f"Certified for {certified}{but_for(certificate)}" + (f". Not for {missing}" if missing else "")


def but_for(certificate: Certificate) -> str:
    """The features that the parser lacks, as what follows "certified"; empty if it lacks none."""
    return f", but for {', '.join(certificate.lacks)}" if certificate.lacks else ""


def level_words(result: LevelResult, smoke: bool = False) -> str:
    """The result of a level in a few words."""
    if not result.claimed:
        return "not claimed"
    if not result.asked:
        return "not requested"
    if smoke:
        return f"tried: {', '.join(_counts(result))}" if result.counts else "not tried"
    if not result.items:
        return "no tests"
    if result.certified:
        excused = result.counts.get(Verdict.EXCUSED, 0)
        return f"certified: {result.items - excused} passed" + (f", {excused} excused" if excused else "")
    known = [f"known failures: {result.known_failures}"] if result.known_failures else []
    return f"not certified: {', '.join([*_counts(result), *known])}{_apart(result)}"


def level_count(result: LevelResult) -> str:
    """The result of a level in numbers, for narrow columns; of valid and invalid files apart."""
    if not (result.claimed and result.asked):
        return level_words(result)
    return f"{result.counts.get(Verdict.PASSED, 0)} of {result.items}{_apart(result)}"


def _by_version(certificate: Certificate, certified: bool) -> str:
    """The tested levels that are certified, or that are not, by version."""
    levels = {
        version: [
            each.level
            for each in certificate.levels
            if each.version == version and each.claimed and each.asked and each.certified == certified
        ]
        for version in VERSIONS
    }
    return "; ".join(f"version {version}: {levels_text(these, ', ')}" for version, these in levels.items() if these)


def levels_text(levels: Sequence[Level], separator: str) -> str:
    """The names of levels, or "all levels"."""
    return "all levels" if len(levels) == len(Level) else separator.join(levels)


def _apart(result: LevelResult) -> str:
    return f" ({tallies(result)})" if tallies(result) else ""


def tallies(result: LevelResult) -> str:
    """How many items with valid files passed, and how many with invalid ones; empty if a level has only valid ones.

    A parser that rejects everything passes all invalid ones.
    """
    if not result.invalid.items:
        return ""
    kinds = (("valid", result.valid), ("invalid", result.invalid))
    return " · ".join(f"{name} {each.passed} of {each.items}" for name, each in kinds)


def _counts(result: LevelResult) -> list[str]:
    failed = [verdict for verdict in Verdict if verdict != Verdict.PASSED and result.counts.get(verdict)]
    passed = f"{result.counts.get(Verdict.PASSED, 0)} of {result.items} passed"
    return [*(f"{result.counts[verdict]} {verdict}" for verdict in failed), passed]
