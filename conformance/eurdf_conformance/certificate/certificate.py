"""The certificate: the result of a parser in the suite, as one JSON value, which has a JSON Schema.

Two runs of one suite on one parser with one seed give the same bytes: it holds no time but the date, and that only
where it is given. This is so however a run is spread over processes.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from eurdf_conformance.feature import Feature
from eurdf_conformance.json_schema import published, schema_text
from eurdf_conformance.judging.level_result import Count, LevelResult
from eurdf_conformance.judging.verdict import Verdict
from eurdf_conformance.level import Level, Version
from eurdf_conformance.protocol.message import ParserInfo

#: Name of its file in a folder.
FILE = "certificate.json"

Hash = Annotated[str, Field(pattern="^sha256:[0-9a-f]{64}$")]


class _Part(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid", use_attribute_docstrings=True)


class Suite(_Part):
    """The suite that was run."""

    version: str
    """Version of the package."""
    protocol: str
    """Version of the protocol spoken."""
    clauses: Hash
    """Hash of the clauses of the specification: ids, texts, levels and versions."""
    corpus: Hash
    """Hash of the cases, whatever the order of their files."""
    properties: Hash
    """Hash of the properties, and of the mechanisms that they are tried on."""


class Scope(_Part):
    """What the run was asked to test."""

    levels: tuple[Level, ...]
    versions: tuple[Version, ...]
    smoke: bool
    """Whether it was three cases only, which certify nothing."""
    explore: Count
    """Number of further random mechanisms for each property."""
    seed: int
    """The seed of the order of the items, of the fresh cases and of further mechanisms."""
    fresh: Hash | None
    """Hash of the fresh cases, which are drawn from the seed; null if there were none."""


class ClauseResult(_Part):
    """How many items that test a clause ran, those excused not counted, and how many of them passed."""

    id: str
    items: Count
    passed: Count


class Failure(_Part):
    """An item that did not pass."""

    id: str
    """Topic and id of a case, or name of a property."""
    level: Level
    version: Version
    title: str
    clauses: tuple[str, ...]
    verdict: Verdict
    known: bool
    """Whether it was expected, by a file that the certificate does not hold."""
    difference: str | None
    """What is wrong, and the first of what differs from the expected answer."""
    log: str | None
    """In a smoke run, further details, such as the end of the parser's standard error; it is not compared."""
    reproduce: str
    """Command line that runs this item alone."""


class Certificate(_Part):
    """The result of a parser in the conformance suite."""

    certificate: Literal["1.0"] = "1.0"
    """Version of this form."""
    suite: Suite
    parser_option: str
    """The value of `--parser`: 'package.module:object', or 'cmd:' and a command line."""
    parser: ParserInfo | None
    """Name, version and claims that the parser reported; null if it could not be started."""
    lacks: tuple[Feature, ...]
    """The features that the parser lacks, and is not certified for."""
    scope: Scope
    date: Annotated[str, Field(pattern=r"^\d{4}-\d{2}-\d{2}$")] | None
    """Day of the run, if given. It is stated by the author of the certificate; a second run cannot verify it."""
    certified: bool
    """Whether every level claimed and asked for is certified."""
    levels: tuple[LevelResult, ...]
    """By version and level: all of them."""
    clauses: tuple[ClauseResult, ...]
    """By id: those of which an item was asked."""
    failures: tuple[Failure, ...]
    """By id and level."""
    unexpected: tuple[str, ...]
    """Where the results differ from the file of known failures."""

    def at(self, version: Version, level: Level) -> LevelResult | None:
        """The result of one level."""
        return next((each for each in self.levels if (each.version, each.level) == (version, level)), None)

    def to_text(self) -> str:
        """The text of the certificate's file."""
        return json.dumps(self.model_dump(mode="json"), indent=2, ensure_ascii=False) + "\n"


class NoCertificate(Exception):  # noqa: N818 - shown to the user as it is
    """The path has no certificate; the text gives the reason."""


def read_certificate(path: Path) -> Certificate:
    """Read a certificate from its file, or from the folder that holds it.

    Raises:
        NoCertificate: There is none, or it does not fit the schema.
    """
    file = path / FILE if path.is_dir() else path
    try:
        return Certificate.model_validate_json(file.read_bytes())
    except OSError as error:
        raise NoCertificate(f"cannot read '{file}': {error.strerror or error}") from error
    except ValidationError as error:
        first = error.errors()[0]
        where = "".join(f"/{part}" for part in first["loc"])
        raise NoCertificate(f"'{file}' is not a certificate: {f'{where}: ' if where else ''}{first['msg']}") from error


def certificate_schema() -> dict[str, Any]:
    """The JSON Schema (2020-12) of a certificate."""
    return published("schema:certificate", Certificate.model_json_schema(mode="serialization"))


if __name__ == "__main__":
    sys.stdout.write(schema_text(certificate_schema()))
