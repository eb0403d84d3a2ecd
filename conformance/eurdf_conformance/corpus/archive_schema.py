"""JSON Schemas (2020-12) of the JSON files of the archive of the corpus."""

from __future__ import annotations

import json
import re
from typing import Annotated, Any

from pydantic import Field

from eurdf_conformance import json_schema
from eurdf_conformance.corpus.case import Case, CaseName, InvalidCase, ValidCase
from eurdf_conformance.corpus.content import Part
from eurdf_conformance.corpus.expected import Expected
from eurdf_conformance.level import Level

#: Keys of a case on how its files are made, which users of the archive do not need.
MAKING = frozenset({"base", "edits", "files", "edit"})


class IndexedCase(Part):
    """A case, and the files in its folder."""

    name: CaseName
    levels: list[Level] = Field(description="The levels at which it is tested.")
    case: Annotated[Case, Field(discriminator="valid")]
    files: list[str] = Field(description="Paths of its files, from its folder.")


class Index(Part):
    """The list of all cases."""

    manifest: str = Field(description="Version of the form of this file.")
    version: str = Field(description="Version of the suite and of this package.")
    corpus: str = Field(pattern=r"^sha256:[0-9a-f]{64}$", description="Hash of the cases.")
    protocol: str = Field(description="Version of the protocol between the suite and a parser.")
    cases: list[IndexedCase]


def index_schema() -> json_schema.Schema:
    """JSON Schema of ``index.json``."""
    schema = Index.model_json_schema()
    for kind in (ValidCase, InvalidCase):
        said = schema["$defs"][kind.__name__]
        said["properties"] = {key: value for key, value in said["properties"].items() if key not in MAKING}
        said["required"] = [key for key in said["required"] if key not in MAKING]
    used = _references(schema, {key: value for key, value in schema.items() if key != "$defs"})
    schema["$defs"] = {name: value for name, value in schema["$defs"].items() if name in used}
    return json_schema.published("schema:corpus-index", schema)


def expected_schema() -> json_schema.Schema:
    """JSON Schema of ``<name>.expected.json``."""
    return json_schema.published("schema:corpus-expected", Expected.model_json_schema(mode="serialization"))


def _references(schema: json_schema.Schema, part: Any) -> set[str]:
    """The names of the definitions that a part of a schema uses, directly or through others."""
    found: set[str] = set()
    new = {json.dumps(part)}
    while new:
        names = {name for text in new for name in re.findall(r'"#/\$defs/(\w+)"', text)} - found
        found |= names
        new = {json.dumps(schema["$defs"][name]) for name in names}
    return found
