"""Whether a second run came to what a certificate says."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from pydantic import BaseModel, ConfigDict

from eurdf_conformance.certificate.certificate import Certificate, Failure, LevelResult
from eurdf_conformance.certificate.issue import installed_suite
from eurdf_conformance.certificate.summary import level_words
from eurdf_conformance.certificate.write import certificate_files
from eurdf_conformance.json_schema import published, schema_text
from eurdf_conformance.level import VERSIONS, Level
from eurdf_conformance.verdict.result import Key


class Replay(BaseModel):
    """What came of running a certificate again."""

    model_config = ConfigDict(frozen=True, extra="forbid", use_attribute_docstrings=True)

    same: bool
    """Whether it came to the same."""
    differences: tuple[str, ...]
    """In what it did not, a sentence each."""


def suite_differences(certificate: Certificate) -> list[str]:
    """In what the suite of a certificate is not the one installed here, one line each."""
    before, now = certificate.suite.model_dump(), installed_suite().model_dump()
    return [
        f"suite, {part}: {before[part]} in the certificate, {now[part]} here"
        for part in before
        if before[part] != now[part]
    ]


def replay_differences(certificate: Certificate, again: Certificate) -> list[str]:
    """In what a second run is not what a certificate says, one line each.

    Neither the date nor the command that reached the reader matters, nor which failures were expected: all else that a
    certificate says is to be the same.
    """
    found = [*_reader(certificate, again), *_levels(certificate, again), *_failures(certificate, again)]
    found = found or list(_clauses(certificate, again))
    if found or _essence(certificate) == _essence(again):
        return found
    return ["what it says does not follow from what became of the cases"]


def file_differences(folder: Path, certificate: Certificate) -> list[str]:
    """Which of the files beside a certificate do not show what it says, one line each."""
    return [
        f"{name}: it does not show this certificate"
        for name, text in certificate_files(certificate).items()
        if (folder / name).is_file() and (folder / name).read_bytes() != text.encode()
    ]


def _essence(certificate: Certificate) -> dict[str, Any]:
    """All that a second run is to come to again."""
    value = certificate.model_dump(exclude={"suite", "parser", "date", "unexpected"})
    for failure in value["failures"]:
        del failure["known"], failure["reproduce"]
    for level in value["levels"]:
        del level["known_failures"]
    return value


def _reader(before: Certificate, now: Certificate) -> Iterator[str]:
    if before.reader is None or now.reader is None:
        if before.reader != now.reader:
            yield "reader: started then, not now" if before.reader else "reader: started now, not then"
        return
    for part, was in before.reader.model_dump().items():
        if (given := getattr(now.reader, part)) != was:
            yield f"reader, {part}: '{was}' then, '{given}' now"


def _levels(before: Certificate, now: Certificate) -> Iterator[str]:
    for version in VERSIONS:
        for level in Level:
            then, here = (_level(each.at(version, level)) for each in (before, now))
            if then != here:
                yield f"version {version}, {level}: {then} then, {here} now"


def _level(result: LevelResult | None) -> str:
    return "not in it" if result is None else level_words(result.model_copy(update={"known_failures": 0}))


def _clauses(before: Certificate, now: Certificate) -> Iterator[str]:
    was, given = ({each.id: f"{each.passed} of {each.items} passed" for each in all_.clauses} for all_ in (before, now))
    for name in sorted(was.keys() | given.keys()):
        then, here = was.get(name, "not in it"), given.get(name, "not in it")
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
        elif was[key].difference != given[key].difference:
            yield f"{name}: fails otherwise: {_line(was[key])} then, {_line(given[key])} now"


def _line(failure: Failure) -> str:
    return "; ".join((failure.difference or "nothing said").splitlines())


def _by_key(certificate: Certificate) -> dict[Key, Failure]:
    return {(failure.id, failure.level): failure for failure in certificate.failures}


def replay_schema() -> dict[str, Any]:
    """The JSON Schema (2020-12) of a `Replay`."""
    return published("schema:replay", Replay.model_json_schema(mode="serialization"))


if __name__ == "__main__":
    sys.stdout.write(schema_text(replay_schema()))
