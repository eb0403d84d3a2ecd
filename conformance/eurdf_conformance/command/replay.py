"""Compares a second run with a certificate."""

from __future__ import annotations

import re
import sys
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from pydantic import BaseModel, ConfigDict, ValidationError

from eurdf_conformance.certificate.certificate import FILE, Certificate, Failure
from eurdf_conformance.certificate.issue import installed_suite
from eurdf_conformance.certificate.summary import level_words
from eurdf_conformance.certificate.write import certificate_files
from eurdf_conformance.comparison.text import same_text
from eurdf_conformance.corpus.read import all_cases
from eurdf_conformance.json_schema import published, schema_text
from eurdf_conformance.judging.known_failures import KnownFailure, KnownFailures
from eurdf_conformance.judging.level_result import LevelResult
from eurdf_conformance.judging.result import Key, Result
from eurdf_conformance.judging.verdict import Verdict
from eurdf_conformance.level import VERSIONS, Level
from eurdf_conformance.protocol.json_text import read_json
from eurdf_conformance.suite.item import planned_items
from eurdf_conformance.suite.reproduce import Setting, is_command_line

# How far apart numbers in the description of a failure may be, relative and absolute: those of answers may have been
# computed on another processor. What they are compared with has tolerances of 1e-9 and more.
_RELATIVE, _ABSOLUTE = 1e-6, 1e-9

# What `KnownFailures.unexpected` says of an entry: id, level, and verdict where that is said.
_UNEXPECTED = re.compile(r"(.+)/([a-z]+): (?:listed as '([a-z ]+)'|the suite has no such item)", re.DOTALL)


class Replay(BaseModel):
    """The result of running a certificate again."""

    model_config = ConfigDict(frozen=True, extra="forbid", use_attribute_docstrings=True)

    same: bool
    """Whether the results are the same."""
    differences: tuple[str, ...]
    """The differences, one sentence each."""


def suite_differences(certificate: Certificate) -> list[str]:
    """Differences between the suite of a certificate and the installed one, one line each."""
    before, now = certificate.suite.model_dump(), installed_suite().model_dump()
    return [
        f"suite, {part}: {before[part]} in the certificate, {now[part]} here"
        for part in before
        if before[part] != now[part]
    ]


def replay_differences(certificate: Certificate, again: Certificate) -> list[str]:
    """Differences between a second run and a certificate, one line each.

    Neither the date nor the command that reached the parser matters, nor which failures were expected (`own_errors`),
    nor the last digits of numbers that a parser has computed: all else that a certificate says is to be the same.
    """
    found = [*_parser_info(certificate, again), *_levels(certificate, again), *_failures(certificate, again)]
    found = [*_fresh(certificate, again), *(found or _clauses(certificate, again))]
    if found or _essence(certificate) == _essence(again):
        return found
    return ["the certificate contradicts the results of its cases"]


def _fresh(before: Certificate, now: Certificate) -> Iterator[str]:
    if before.scope.fresh != now.scope.fresh:
        yield "fresh cases: the seed gives others here; another version of Hypothesis draws others"


def own_errors(certificate: Certificate) -> list[str]:
    """Errors of a certificate that contradicts itself, one line each.

    A second run cannot tell which failures were expected, nor how the first was started. But what the certificate says
    of it must agree with itself.
    """
    return [*_commands(certificate), *_known(certificate), *_unexpected(certificate)]


def file_differences(path: Path, certificate: Certificate) -> list[str]:
    """Files that differ from those the suite writes for a certificate, one line each.

    Args:
        path: The file that it was read from, or the folder, in which the files beside it are looked at too.
        certificate: As it was read.
    """
    file = path / FILE if path.is_dir() else path
    found = [] if file.read_bytes() == certificate.to_text().encode() else [f"{file.name}: {_otherwise(file)}"]
    for name, text in certificate_files(certificate).items() if path.is_dir() else ():
        if not (path / name).is_file():
            found.append(f"{name}: it is missing")
        elif (path / name).read_bytes() != text.encode():
            found.append(f"{name}: it does not show this certificate")
    return found


def _otherwise(file: Path) -> str:
    """How the file of a certificate differs from what the suite writes."""
    _, errors = read_json(file.read_bytes())
    return errors[0] if errors else "not formatted as the suite writes it"


def _commands(certificate: Certificate) -> Iterator[str]:
    """Command lines in the certificate that do not run the item they belong to."""
    scope = certificate.scope
    setting = Setting(certificate.parser_option, explore=scope.explore, seed=scope.seed)
    for failure in certificate.failures:
        if failure.verdict == Verdict.NOT_RUN and not failure.reproduce:
            continue
        if not is_command_line(failure.reproduce, setting, failure.id, failure.level):
            yield f"{_name(failure)}: the reproduce command is not one of the suite: {failure.reproduce}"


def _known(certificate: Certificate) -> Iterator[str]:
    """Counts of known failures that contradict the listed failures."""
    for failure in certificate.failures:
        if failure.known and failure.verdict == Verdict.NOT_RUN:
            yield f"{_name(failure)}: known failure, but the item was not run"
    known = Counter((failure.version, failure.level) for failure in certificate.failures if failure.known)
    for level in certificate.levels:
        if level.known_failures != (count := known[level.version, level.level]):
            name = f"version {level.version}, {level.level}"
            yield f"{name}: known_failures is {level.known_failures}, but {count} failures are known"


def _unexpected(certificate: Certificate) -> Iterator[str]:
    """Sentences on the file of known failures that no file can cause."""
    if not certificate.unexpected:
        return
    items = {item.key: item for item in planned_items(all_cases())}
    failed = {(failure.id, failure.level): failure.verdict for failure in certificate.failures}
    asked = {(each.version, each.level) for each in certificate.levels if each.claimed and each.asked}
    results = [
        Result(item, failed.get(key, Verdict.PASSED))
        for key, item in items.items()
        if (item.version, item.level) in asked
    ]
    expected = {(failure.id, failure.level) for failure in certificate.failures if failure.known}
    for sentence in certificate.unexpected:
        known = _entry(sentence)
        if (
            known is None
            or (known.id, known.level) in expected
            or KnownFailures((known,)).unexpected(results, items.values()) != [sentence]
        ):
            yield f"unexpected: does not follow from the failures: {sentence}"


def _entry(sentence: str) -> KnownFailure | None:
    """The known failure that a sentence is about."""
    if (said := _UNEXPECTED.match(sentence)) is None:
        return None
    try:
        return KnownFailure.model_validate(
            {"id": said[1], "level": said[2], "verdict": said[3] or Verdict.FAILED, "reason": "?"}
        )
    except ValidationError:
        return None


def _name(failure: Failure) -> str:
    return f"{failure.id}/{failure.level}"


def _essence(certificate: Certificate) -> dict[str, Any]:
    """The results that a second run must reproduce."""
    value = certificate.model_dump(exclude={"suite", "parser_option", "date", "unexpected"})
    for failure in value["failures"]:
        del failure["known"], failure["reproduce"], failure["difference"], failure["log"]
    for level in value["levels"]:
        del level["known_failures"]
    return value


def _parser_info(before: Certificate, now: Certificate) -> Iterator[str]:
    if before.parser is None or now.parser is None:
        if before.parser != now.parser:
            yield "parser: started then, not now" if before.parser else "parser: started now, not then"
        return
    for part, was in before.parser.model_dump().items():
        if (given := getattr(now.parser, part)) != was:
            yield f"parser, {part}: '{was}' then, '{given}' now"
    if before.lacks != now.lacks:
        then, here = (", ".join(each.lacks) or "nothing" for each in (before, now))
        yield f"parser, lacks: {then} then, {here} now"


def _levels(before: Certificate, now: Certificate) -> Iterator[str]:
    for version in VERSIONS:
        for level in Level:
            then, here = (_level(each.at(version, level)) for each in (before, now))
            if then != here:
                yield f"version {version}, {level}: {then} then, {here} now"


def _level(result: LevelResult | None) -> str:
    return "absent" if result is None else level_words(result.model_copy(update={"known_failures": 0}))


def _clauses(before: Certificate, now: Certificate) -> Iterator[str]:
    was, given = ({each.id: f"{each.passed} of {each.items} passed" for each in all_.clauses} for all_ in (before, now))
    for name in sorted(was.keys() | given.keys()):
        then, here = was.get(name, "absent"), given.get(name, "absent")
        if then != here:
            yield f"clause {name}: {then} then, {here} now"


def _failures(before: Certificate, now: Certificate) -> Iterator[str]:
    was, given = _by_key(before), _by_key(now)
    for key in sorted(was.keys() | given.keys()):
        name = "/".join(key)
        if key not in given:
            yield f"{name}: {was[key].verdict} then, no failure now"
        elif key not in was:
            yield f"{name}: no failure then, {given[key].verdict} now"
        elif was[key].verdict != given[key].verdict:
            yield f"{name}: {was[key].verdict} then, {given[key].verdict} now"
        elif not _same_difference(was[key].difference, given[key].difference):
            yield f"{name}: fails differently: {_line(was[key])} then, {_line(given[key])} now"


def _same_difference(one: str | None, other: str | None) -> bool:
    return same_text(one or "", other or "", relative=_RELATIVE, absolute=_ABSOLUTE)


def _line(failure: Failure) -> str:
    return "; ".join((failure.difference or "no difference stated").splitlines())


def _by_key(certificate: Certificate) -> dict[Key, Failure]:
    return {(failure.id, failure.level): failure for failure in certificate.failures}


def replay_schema() -> dict[str, Any]:
    """The JSON Schema (2020-12) of a `Replay`."""
    return published("schema:replay", Replay.model_json_schema(mode="serialization"))


if __name__ == "__main__":
    sys.stdout.write(schema_text(replay_schema()))
