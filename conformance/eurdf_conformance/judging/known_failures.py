"""Known failures: items that the author of a parser expects to fail, listed in a file.

The file is a YAML list of mappings ``{id, level, verdict, reason}``. It excuses nothing: a level with a known failure
is not certified. But a run in which all known failures fail as stated, and nothing else does, is as expected.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import yaml
from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, TypeAdapter, ValidationError

from eurdf_conformance.json_schema import published, schema_text
from eurdf_conformance.judging.result import Item, Result
from eurdf_conformance.judging.verdict import NO_FAILURE, Verdict
from eurdf_conformance.level import Level
from eurdf_conformance.strict_yaml import load_strictly

#: Verdicts that are not those of a failure.
_NO_KNOWN = NO_FAILURE | {Verdict.NOT_RUN}


def _is_failure(verdict: Any) -> Any:
    if verdict in _NO_KNOWN:
        raise ValueError(f"a known failure cannot be '{verdict}'")
    return verdict


_FAILURES = [verdict.value for verdict in Verdict if verdict not in _NO_KNOWN]


class KnownFailure(BaseModel):
    """An item that is expected to fail."""

    model_config = ConfigDict(frozen=True, extra="forbid", use_attribute_docstrings=True)

    id: Annotated[str, Field(min_length=1)]
    """Id of the case, with its topic, or name of the property, as reports show it."""
    level: Level
    """Level at which it fails."""
    verdict: Annotated[Verdict, BeforeValidator(_is_failure), Field(json_schema_extra={"enum": _FAILURES})]
    """The expected verdict."""
    reason: Annotated[str, Field(pattern=r"\S")]
    """Why: a sentence for people, such as the address of an issue."""


_FILE: TypeAdapter[list[KnownFailure]] = TypeAdapter(list[KnownFailure])


class WrongKnownFailures(Exception):  # noqa: N818 - shown to the user as it is
    """The file cannot be used; its text says why."""

    def __init__(self, path: Path, errors: Sequence[str]) -> None:
        self.path = path
        self.errors = tuple(errors)
        super().__init__(f"{path}: {'; '.join(errors)}")


@dataclass(frozen=True)
class KnownFailures:
    """The known failures of one parser."""

    failures: tuple[KnownFailure, ...] = ()

    def expects(self, result: Result) -> bool:
        """Whether the item is known to fail with this verdict."""
        return self.of(result.item) == result.verdict

    def of(self, item: Item) -> Verdict | None:
        """The verdict expected of an item; None where it is expected to pass."""
        return next((known.verdict for known in self.failures if (known.id, known.level) == item.key), None)

    def unexpected(self, results: Iterable[Result], planned: Iterable[Item]) -> list[str]:
        """Where the results differ from the file, one sentence each, in the order of the file.

        Args:
            results: The results of the items.
            planned: Every item of the suite.
        """
        verdicts = {result.item.key: result.verdict for result in results}
        items = {item.key for item in planned}
        found = []
        for known in self.failures:
            name = f"{known.id}/{known.level}"
            given = verdicts.get((known.id, known.level))
            if (known.id, known.level) not in items:
                found.append(f"{name}: the suite has no such item{_hint(known)}")
            elif given == Verdict.PASSED:
                found.append(f"{name}: listed as '{known.verdict}' but passes; remove it from the known failures")
            elif given not in (None, Verdict.NOT_RUN, known.verdict):
                found.append(f"{name}: listed as '{known.verdict}', but the verdict is '{given}'")
        return found


def _hint(known: KnownFailure) -> str:
    case, _, level = known.id.rpartition("/")
    return f"; write the id without its level: '{case}'" if level in list(Level) else ""


#: Nothing is known to fail.
NONE_KNOWN = KnownFailures()


def read_known_failures(path: Path) -> KnownFailures:
    """Read a file of known failures.

    Raises:
        WrongKnownFailures: It cannot be read, is not YAML, violates the schema, or lists an item twice.
    """
    try:
        value = load_strictly(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise WrongKnownFailures(path, [error.strerror or str(error)]) from error
    except UnicodeDecodeError as error:
        raise WrongKnownFailures(path, ["not UTF-8"]) from error
    except yaml.YAMLError as error:
        raise WrongKnownFailures(path, [" ".join(str(error).split())]) from error
    try:
        failures = _FILE.validate_python([] if value is None else value)
    except ValidationError as error:
        raise WrongKnownFailures(path, [_error_text(detail) for detail in error.errors()]) from error
    names = Counter(f"{known.id}/{known.level}" for known in failures)
    twice = [f"{name} is listed {count} times" for name, count in names.items() if count > 1]
    if twice:
        raise WrongKnownFailures(path, twice)
    return KnownFailures(tuple(failures))


def _error_text(detail: Any) -> str:
    where = "".join(f"[{part}]" if isinstance(part, int) else f".{part}" for part in detail["loc"])
    return f"{where or 'the file'}: {detail['msg'].removeprefix('Value error, ')}"


def known_failures_schema() -> dict[str, Any]:
    """The JSON Schema (2020-12) of the file."""
    return published(
        "schema:known-failures",
        _FILE.json_schema(),
        title="Known failures of a parser of Extended URDF",
        description="Items of the conformance suite that are expected to fail, each with its reason.",
    )


if __name__ == "__main__":
    import sys

    sys.stdout.write(schema_text(known_failures_schema()))
