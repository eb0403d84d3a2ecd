"""The results of commands as JSON, and the JSON Schema of each, from its fields and the sentence below each of them.

``python -m eurdf.commands.output FOLDER`` writes the schemas.
"""

from __future__ import annotations

import inspect
import re
import sys
from collections.abc import Iterator
from dataclasses import fields, is_dataclass
from importlib import import_module
from pathlib import Path
from pkgutil import resolve_name
from typing import Any, cast, get_args, get_type_hints

from eurdf.commands.terminal import write_json
from eurdf.diagnostics.report import report_schema
from eurdf.json_schema import to_json

#: The results by the names of their schemas: the module, of the commands if it is named alone, and the class of each.
RESULTS = {
    "assemble": ("assemble", "AssemblyInfo"),
    "error": ("command", "FailureInfo"),
    "explain": ("eurdf.explanation", "Explanation"),
    "export": ("conversion_info", "ExportInfo"),
    "import": ("conversion_info", "ImportInfo"),
    "info": ("robot_info", "RobotInfo"),
    "robots": ("robots", "Collection"),
    "serial": ("transmission_info", "SerialInfo"),
    "simplify": ("conversion_info", "SimplifyInfo"),
    "transmission": ("transmission_info", "TransmissionInfo"),
    "written": ("command", "WrittenInfo"),
}


def write_result(result: Any) -> None:
    """Write a result to the standard output."""
    write_json(to_json(result))


def output_schemas() -> dict[str, dict[str, Any]]:
    """JSON Schema (2020-12) of the JSON of each command, by file name."""
    found = {"diagnostics-report.schema.json": report_schema()}
    for name, (module, result) in RESULTS.items():
        path = module if "." in module else f"eurdf.commands.{module}"
        found[f"{name}.schema.json"] = _schema(getattr(import_module(path), result))
    return dict(sorted(found.items()))


def _schema(result: type) -> dict[str, Any]:
    """The JSON Schema of a result, and of the classes of its parts.

    The sentence of a field is the text below it, or what the docstring of its class says under ``Attributes``, or that
    of the class which the result is ``LIKE``, by module and name. It says None or inf where JSON has null.
    """
    from pydantic import ConfigDict, TypeAdapter

    from eurdf.format.schema import DIALECT

    config = ConfigDict(extra="forbid", use_attribute_docstrings=True, arbitrary_types_allowed=True)
    # The configuration of a tuple is also that of its members, which are classes without one.
    parts = TypeAdapter(tuple[result], config=config).json_schema(mode="serialization")["$defs"]  # type: ignore[valid-type]
    for own in parts.values():
        own["description"] = " ".join(own["description"].partition("\n\nAttributes:")[0].split())
    for part in _parts(result):
        own = parts[part.__name__]
        like = [resolve_name(part.LIKE)] if hasattr(part, "LIKE") else []
        sentences = _sentences(*part.__mro__, *like)
        for name, field in own["properties"].items():
            text = field.get("description") or sentences[name]
            text = re.sub(r"\b(None|inf)\b", "null", re.sub(r"(^|[.] )None", r"\1Null", text))
            field.pop("default", None)  # a result has every field
            own["properties"][name] = dict(sorted({**field, "description": text}.items()))
        own["required"] = list(own["properties"])
    own = parts.pop(result.__name__)
    return {"$schema": DIALECT, **({"$defs": parts} if parts else {}), **own}


def _parts(result: Any) -> Iterator[type]:
    """A class of results, and the classes of its parts."""
    if is_dataclass(result):
        yield cast(type, result)
        hints = get_type_hints(result)
        for field in fields(result):
            if not field.metadata.get("exclude"):
                yield from _parts(hints[field.name])
    for argument in get_args(result):
        yield from _parts(argument)


def _sentences(*classes: type) -> dict[str, str]:
    """What the docstrings of classes say of their attributes, by name."""
    text = "\n".join(filter(None, map(inspect.getdoc, classes)))
    found = re.findall(r"^    (\w+): (.+(?:\n     .*)*)", text, re.MULTILINE)
    return {name: " ".join(text.split()).replace("``", "'").replace("`", "'") for name, text in found}


def main(folder: str) -> None:
    """Write every schema into a folder."""
    from eurdf.format.schema import schema_text

    for name, schema in output_schemas().items():
        Path(folder, name).write_text(schema_text(schema), encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1])
