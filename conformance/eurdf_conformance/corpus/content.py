"""The contents of a case's files, and the edits that make one file from another."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Discriminator, Field, Tag, model_validator

#: Where a line of a diagnostic ends.
_END = re.compile(rb"\r\n|\n|\r")


class Part(BaseModel):
    """A part of a case."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True, validate_by_name=True, serialize_by_alias=True)


FilePath = Annotated[
    str,
    Field(
        pattern=r"^[^/\\.][^/\\]*(/[^/\\.][^/\\]*)*$",
        description="Path from the folder of the case.",
        examples=["robot.urdf", "parts/wiper.urdf"],
    ),
]


class Hex(Part):
    """Bytes in hexadecimal, for content that is not UTF-8."""

    hex: str = Field(pattern=r"^([0-9a-f]{2} ?)+$", examples=["ff fe"])


class Repeated(Part):
    """A text that is repeated."""

    repeat: str = Field(description="The text; in it, {i} is the number of the repetition, from 0.")
    times: Annotated[int, Field(ge=2)]


Piece = str | Hex | Repeated

Content = Annotated[Piece | list[Piece], Field(description="A text, in UTF-8, or pieces of the file in their order.")]


class Replace(Part):
    """One text in a file is replaced by another."""

    file: FilePath
    line: Annotated[int, Field(ge=1)] | None = Field(
        None, description="The line on which the text begins; needed if the text occurs more than once in the file."
    )
    replace: str = Field(min_length=1, description="The text. It occurs once in the file, or once on the line.")
    with_: Content = Field(alias="with", description="What takes its place.")

    @model_validator(mode="before")
    @classmethod
    def _changes(cls, value: Any) -> Any:
        if isinstance(value, Mapping) and "with" in value and value.get("replace") == value["with"]:
            raise ValueError("the edit changes nothing")
        return value


class Rename(Part):
    """A file is renamed."""

    file: FilePath
    rename: FilePath


def _kind(edit: Any) -> str:
    is_rename = "rename" in edit if isinstance(edit, Mapping) else isinstance(edit, Rename)
    return "rename" if is_rename else "replace"


Edit = Annotated[Annotated[Replace, Tag("replace")] | Annotated[Rename, Tag("rename")], Discriminator(_kind)]


def content_bytes(content: Content) -> bytes:
    """The bytes of a file, or of a part of it."""
    if isinstance(content, list):
        return b"".join(map(content_bytes, content))
    if isinstance(content, Hex):
        return bytes.fromhex(content.hex)
    if isinstance(content, Repeated):
        return "".join(content.repeat.replace("{i}", str(i)) for i in range(content.times)).encode("utf-8")
    return content.encode("utf-8")


def edited(files: Mapping[str, bytes], edit: Edit) -> dict[str, bytes]:
    """The files after an edit.

    Args:
        files: Contents by path.
        edit: The edit.

    Raises:
        ValueError: The edit does not fit the files: the message says why.
    """
    if edit.file not in files:
        raise ValueError(f"there is no file '{edit.file}' to edit")
    if isinstance(edit, Rename):
        return {edit.rename if name == edit.file else name: content for name, content in files.items()}
    before, old = files[edit.file], edit.replace.encode("utf-8")
    begin, end = _line(before, edit.line) if edit.line else (0, len(before))
    found = [match.start() for match in re.finditer(b"(?=" + re.escape(old) + b")", before)]
    found = [start for start in found if begin <= start < end]
    if len(found) != 1:
        where = f"'{edit.file}'" if edit.line is None else f"line {edit.line} of '{edit.file}'"
        raise ValueError(f"the text to replace occurs {len(found)} times in {where}, expected once: {edit.replace!r}")
    after = before[: found[0]] + content_bytes(edit.with_) + before[found[0] + len(old) :]
    return {**files, edit.file: after}


def _line(content: bytes, number: int) -> tuple[int, int]:
    """The offsets of the beginning of a line and of the next one."""
    starts = [0, *(match.end() for match in _END.finditer(content)), len(content)]
    return (starts[number - 1], starts[number]) if number < len(starts) else (0, 0)
