"""The JSON Schema (2020-12) of each message: ``python -m eurdf_conformance.protocol.schema`` writes the files."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any, get_args

from eurdf_conformance.json_schema import Schema, published, schema_text
from eurdf_conformance.protocol.message import PROTOCOL, Answer, AnyAnswer, AnyRequest, Request

#: The folder of the files, which are named by command or outcome, such as ``load.schema.json``.
FOLDER = Path(__file__).parent / "schema"


def message_schemas() -> dict[str, Schema]:
    """The schema of each message, by its command or its outcome."""
    messages: tuple[type[Request] | type[Answer], ...] = (*get_args(AnyRequest), *get_args(AnyAnswer))
    return {_word(message): _schema(message) for message in messages}


def main(folder: Path) -> None:
    """Write a file for each message."""
    folder.mkdir(exist_ok=True)
    for word, schema in message_schemas().items():
        (folder / f"{word}.schema.json").write_text(schema_text(schema), encoding="utf-8")


def _schema(message: type[Request] | type[Answer]) -> Schema:
    """The schema of a kind of message, EU-PRO-003.

    A request has all its members, always; of an answer, some may be left out.
    """
    schema = _without_titles(message.model_json_schema())
    members, tag = schema["properties"], _tag(message)
    del members[tag]["default"]
    if issubclass(message, Request):
        schema["required"] = list(members)
    else:
        schema["required"] = [name for name in members if name == tag or name in schema["required"]]
    return published(f"protocol:{PROTOCOL}:{_word(message)}", schema, title=_word(message))


def _tag(message: type[Request] | type[Answer]) -> str:
    return "command" if issubclass(message, Request) else "outcome"


def _word(message: type[Request] | type[Answer]) -> str:
    """The command of a request, the outcome of an answer."""
    return str(message.model_fields[_tag(message)].default)


def _without_titles(schema: Any) -> Any:
    """Without the titles that pydantic makes of the names of members."""
    if isinstance(schema, list):
        return [_without_titles(item) for item in schema]
    if not isinstance(schema, dict):
        return schema
    return {
        key: _without_titles(value) for key, value in schema.items() if not (key == "title" and isinstance(value, str))
    }


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else FOLDER)
