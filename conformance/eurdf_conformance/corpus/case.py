"""The content of a case file. ``python -m eurdf_conformance.corpus.case`` writes its JSON Schema."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Field, TypeAdapter, model_validator
from typing_extensions import Self

from eurdf_conformance import json_schema
from eurdf_conformance.corpus.content import Content, Edit, FilePath, Part
from eurdf_conformance.level import Version

#: The folders of cases, in the order in which cases are run.
TOPICS = (
    "yaml",
    "schema",
    "names",
    "urdf",
    "frames",
    "joints",
    "merging",
    "closures",
    "couplings",
    "actuation",
    "configurations",
    "inertia",
    "extensions",
    "version1",
    "robots",
)

SCHEMA_FILE = Path(__file__).with_name("case.schema.json")

CaseId = Annotated[str, Field(pattern=r"^[a-z0-9]{6}$", description="Opaque and permanent.")]
#: Topic and name of a case.
NAME = rf"({'|'.join(TOPICS)})/[a-z0-9]+(-[a-z0-9]+)*"

CaseName = Annotated[
    str,
    Field(
        pattern=f"^{NAME}$",
        description="Topic and name of a case: the path of its file, without its ending.",
        examples=["urdf/smallest"],
    ),
]
ClauseId = Annotated[str, Field(pattern=r"^EU-[A-Z]{3}-[0-9]{3}$", examples=["EU-FRM-001"])]
Code = Annotated[str, Field(pattern=r"^[a-z0-9]+(-[a-z0-9]+)*$", examples=["unknown-frame"])]
Sentence = Annotated[str, Field(pattern=r"^[^\n]+\.$")]
FileName = Annotated[str, Field(pattern=r"^[^/\\]+$")]
Coordinates = Annotated[list[Annotated[float, Field(allow_inf_nan=False)]], Field(min_length=1)]


class CasePlace(Part):
    """The place of a diagnostic; without line and column it is the whole file."""

    file: FileName = Field(description="Name of one of the two files.")
    line: Annotated[int, Field(ge=1)] | None = None
    column: Annotated[int, Field(ge=1)] | None = Field(None, description="In characters.")

    @model_validator(mode="after")
    def _both_or_neither(self) -> Self:
        if (self.column is None) != (self.line is None):
            raise ValueError("line and column are given together, or neither, for the file as a whole")
        return self


class ExpectedWarning(Part):
    """A warning that a parser must report on a valid case."""

    code: Code
    place: CasePlace


class Provenance(Part):
    """The source of the expectation, which is never a parser."""

    expectation: Literal["hand", "oracle"] = Field(
        description="hand: follows from the clauses, or is computed as the note says; oracle: written by the oracle."
    )
    note: str = Field("", description="For values by hand: how they were found.")


class BaseCase(Part):
    """The keys that every case has."""

    id: CaseId
    title: Sentence = Field(description="What the case is about, as a sentence.")
    version: Version = Field(description="Version of the format.")
    clauses: list[ClauseId] = Field(min_length=1, description="The clauses that it tests, the main one first.")
    features: list[str] = Field([], description="What of the format it uses that parsers often lack.")
    description: FileName = Field("robot.yaml", description="Name of the YAML file.")
    urdf: str = Field("robot.urdf", description="Path of the URDF that it names, from its folder, existing or not.")


class ValidCase(BaseCase):
    """A case of two valid files."""

    valid: Literal[True]
    base: CaseName | None = Field(None, description="A valid case without a base, whose files are those of this one.")
    edits: list[Edit] = Field([], description="Edits of the files of the base.")
    files: dict[FilePath, Content] = Field({}, description="Files beside those of the base, or in their place.")
    provenance: Provenance = Provenance(expectation="oracle", note="")
    warnings: list[ExpectedWarning] = Field([], description="All warnings that the files deserve.")
    configurations: list[dict[str, Coordinates]] = Field(
        [],
        description="Where the robot is evaluated: by joint its coordinates; a joint left out is at its neutral.",
    )
    frames: list[str] = Field([], description="Frames of which poses are asked for.")

    @model_validator(mode="after")
    def _edits_of_base(self) -> Self:
        if self.edits and self.base is None:
            raise ValueError("`edits` are those of the files of a `base`")
        return self


class InvalidCase(BaseCase):
    """A case of two files with one error."""

    valid: Literal[False]
    code: Code = Field(description="The one error.")
    place: CasePlace
    twin: CaseName = Field(description="The valid case whose files, after the edit, are those of this one.")
    edit: Edit = Field(description="The one edit, which makes the files invalid.")
    fix: Sentence = Field(description="What to do about it, as a sentence.")
    provenance: Provenance = Provenance(expectation="hand", note="")
    either: bool = Field(
        False,
        description="Whether the error, of inertia or closure, leaves a robot that a parser may accept or reject.",
    )


Case = ValidCase | InvalidCase

CASE: TypeAdapter[Case] = TypeAdapter(Annotated[Case, Field(discriminator="valid")])


def case_schema() -> dict[str, Any]:
    """JSON Schema (2020-12) of a case file."""
    title = "A case of the conformance suite of Extended URDF"
    return json_schema.published("schema:conformance-case", CASE.json_schema(), title=title)


def schema_text() -> str:
    """The text of the schema's file."""
    return json_schema.schema_text(case_schema())


if __name__ == "__main__":
    SCHEMA_FILE.write_text(schema_text(), encoding="utf-8")
