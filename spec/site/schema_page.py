"""A page that shows a JSON Schema: its definitions and properties, with type, default, description and example."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from typing import Any

import yaml
from docutils import nodes

Schema = dict[str, Any]

#: Anchor of the file as a whole.
FILE = "file"

_DEFINITIONS = "#/$defs/"
_TYPES = {
    "array": "list",
    "boolean": "true or false",
    "integer": "whole number",
    "null": "null",
    "number": "number",
    "object": "mapping",
    "string": "text",
}


def schema_sections(schema: Schema) -> list[nodes.section]:
    """The sections of the page: the whole file, then its definitions, by title.

    Every section and every property has an anchor: ``file``, ``file.closures``, ``Closure``, ``Closure.frames``.
    """
    definitions: dict[str, Schema] = schema.get("$defs", {})
    titles = {name: _title(name, definition) for name, definition in definitions.items()}
    sections = [_section(FILE, "The file", schema, titles)]
    for name, definition in sorted(definitions.items(), key=lambda item: titles[item[0]]):
        sections.append(_section(name, titles[name], definition, titles))
    return sections


def property_anchors(schema: Schema) -> Iterator[tuple[str, str]]:
    """The anchor of every section and property of the page, and its title."""
    for name, definition in ((FILE, schema), *schema.get("$defs", {}).items()):
        yield name, _title(name, definition)
        for key, value in definition.get("properties", {}).items():
            yield f"{name}.{key}", value.get("title", key)


def _title(name: str, definition: Schema) -> str:
    """The title of a definition, or the words of its name."""
    words: str = definition.get("title") or re.sub(r"(?<=[a-z])(?=[A-Z])", " ", name).capitalize()
    return words


def _section(name: str, title: str, definition: Schema, titles: dict[str, str]) -> nodes.section:
    section = nodes.section("", nodes.title("", title), ids=[name], names=[name.lower()], classes=["eu-definition"])
    for paragraph in definition.get("description", "").split("\n\n"):
        if paragraph:
            section += nodes.paragraph("", paragraph)
    properties = definition.get("properties", {})
    if properties:
        required = set(definition.get("required", ()))
        for key, value in properties.items():
            section += _property(name, key, value, key in required, titles)
        section += nodes.paragraph("", "", *_other_keys(definition), classes=["eu-facts"])
    else:
        section += nodes.paragraph("", "", *_type(definition, titles), classes=["eu-facts"])
    return section


def _property(owner: str, key: str, value: Schema, required: bool, titles: dict[str, str]) -> nodes.container:
    anchor = f"{owner}.{key}"
    head = nodes.paragraph("", "", classes=["eu-head"])
    head += nodes.reference("", "", nodes.literal("", key), refid=anchor, classes=["eu-name"])
    head += nodes.Text(" ")
    head += nodes.inline("", "", *_type(value, titles), classes=["eu-type"])
    if required:
        head += nodes.Text(" ")
        head += nodes.inline("", "required", classes=["eu-badge"])
    entry = nodes.container("", head, ids=[anchor], classes=["eu-property"])
    entry += nodes.paragraph("", value.get("description", ""))
    if "default" in value and value["default"] is not None:
        default = nodes.literal("", _flow(value["default"]))
        entry += nodes.paragraph("", "", nodes.Text("Left out, it is "), default, nodes.Text("."), classes=["eu-facts"])
    for example in value.get("examples", ()):
        text = _entry(key, example)
        entry += nodes.literal_block(text, text, language="yaml")
    return entry


def _other_keys(definition: Schema) -> Iterator[nodes.Node]:
    if definition.get("additionalProperties", True) is not False:
        yield nodes.Text("Other keys are user-defined.")
    elif any(pattern == "^x-" for pattern in definition.get("patternProperties", ())):
        yield nodes.Text("Any other key is user-defined and begins with ")
        yield nodes.literal("", "x-")
        yield nodes.Text(".")
    else:
        yield nodes.Text("There are no other keys.")
    for key, others in definition.get("dependentRequired", {}).items():
        yield nodes.Text(" ")
        yield nodes.literal("", key)
        yield nodes.Text(" requires ")
        yield from _joined([[nodes.literal("", other)] for other in others], " and ")
        yield nodes.Text(".")


def _type(value: Schema, titles: dict[str, str]) -> Iterator[nodes.Node]:
    """The type of a value in words, with links to the sections of its definitions."""
    for choice in ("oneOf", "anyOf"):
        choices = [option for option in value.get(choice, ()) if option.keys() != {"required"}]
        if choices:
            yield from _joined([list(_type(option, titles)) for option in choices], " or ")
            return
    if "$ref" in value:
        name = value["$ref"].removeprefix(_DEFINITIONS)
        yield nodes.reference("", titles.get(name, name), refid=name)
    elif "const" in value:
        yield nodes.literal("", _flow(value["const"]))
    elif "enum" in value:
        yield nodes.Text("one of ")
        yield from _joined([[nodes.literal("", _flow(option))] for option in value["enum"]], ", ")
    elif value.get("type") == "array":
        yield nodes.Text(f"list{_count(value)}, each ")
        yield from _type(value.get("items", {}), titles)
        if value.get("uniqueItems"):
            yield nodes.Text(", all different")
    elif value.get("type") == "object" and isinstance(value.get("additionalProperties"), dict):
        yield nodes.Text("mapping of names to ")
        yield from _type(value["additionalProperties"], titles)
    else:
        types = value.get("type", "anything")
        names = [types] if isinstance(types, str) else types
        yield nodes.Text(" or ".join(_TYPES.get(name, name) for name in names))
        yield from _bounds(value)


def _bounds(value: Schema) -> Iterator[nodes.Node]:
    words = {"minimum": "at least", "exclusiveMinimum": "more than", "maximum": "at most", "exclusiveMaximum": "below"}
    for key, word in words.items():
        if key in value:
            yield nodes.Text(f", {word} {value[key]}")
    if value.get("minLength") == 1:
        yield nodes.Text(", not empty")
    if "const" in value.get("not", {}):
        yield nodes.Text(f", not {value['not']['const']}")
    if "pattern" in value:
        yield nodes.Text(" that matches ")
        yield nodes.literal("", value["pattern"])


def _count(value: Schema) -> str:
    least, most = value.get("minItems"), value.get("maxItems")
    if least is None and most is None:
        return ""
    if least == most:
        return f" of {least}"
    return f" of {least or 0} or more" if most is None else f" of {least or 0} to {most}"


def _joined(parts: Sequence[Sequence[nodes.Node]], word: str) -> Iterator[nodes.Node]:
    for index, part in enumerate(parts):
        if index:
            yield nodes.Text(word)
        yield from part


class _Indented(yaml.SafeDumper):
    """Indents lists more than their key."""

    def increase_indent(self, flow: bool = False, indentless: bool = False) -> None:
        super().increase_indent(flow, False)


def _entry(key: str, value: object) -> str:
    """A key and its value as YAML."""
    if isinstance(value, dict | list):
        text: str = yaml.dump(
            {key: value}, Dumper=_Indented, sort_keys=False, default_flow_style=None, allow_unicode=True, width=100
        )
        if not text.startswith("{"):
            return text.rstrip()
    return f"{key}: {_flow(value)}"


def _flow(value: object) -> str:
    """A value as YAML on one line."""
    text: str = yaml.safe_dump(value, default_flow_style=True, allow_unicode=True, width=10_000)
    return text.removesuffix("\n").removesuffix("\n...")
