"""A named configuration written into the text of a description; all else stays character by character."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import Any

from eurdf.format.yaml_text import Value
from eurdf.reading.yaml_node import YamlCollection, end_of, start_of
from eurdf.reading.yaml_reader import YamlDocument, plain_data
from eurdf.writing.yaml_edits import NotEditable, YamlEdits


def with_configuration(document: YamlDocument, name: str, coordinates: Mapping[str, Sequence[float]]) -> str:
    """The text of a description of version 2 with a named configuration added, or its coordinates replaced.

    The coordinates are given by joint, as files have them. Comments, also those inside a configuration that is
    replaced, and the rest of the text stay as they are. A joint that the file states and ``coordinates`` does not is an
    error: where it is at its neutral, state that.

    Raises:
        NotEditable: The result does not read back as it should, such as where an anchor is involved.
    """
    value: dict[str, Value] = {joint: _plain(values) for joint, values in coordinates.items()}
    edits = YamlEdits(document)
    _state(edits, document, name, value)
    text = edits.text()
    if not _reads_back(text, document.data, name, value):
        raise NotEditable(f"configuration '{name}' cannot be written without changing other parts of the file")
    return text


def _state(edits: YamlEdits, document: YamlDocument, name: str, value: dict[str, Value]) -> None:
    configurations = document.root.nodes.get("configurations")
    if isinstance(configurations, YamlCollection) and name in configurations.nodes:
        _replace(edits, document, configurations, name, value)
    else:
        edits.add_entries("configurations", {name: value})


def _replace(
    edits: YamlEdits, document: YamlDocument, configurations: YamlCollection, name: str, value: dict[str, Value]
) -> None:
    """Give a configuration that is there its new coordinates, joint by joint, for comments may be between them."""
    old = configurations.nodes[name]
    if isinstance(old, YamlCollection) and not old.nodes:
        edits.fill(configurations, name, value)
        return
    if not isinstance(old, YamlCollection):  # an alias of a configuration
        edits.change(start_of(old), end_of(old), edits.flow(value))
        return
    for joint, coordinates in value.items():
        if joint in old.nodes and not _same(old.data[joint], coordinates):
            start = start_of(old.nodes[joint])
            # The items of a list may be below their key, which nothing else may.
            deeper = "  " if edits.indent(start) is not None and document.source.text[start] == "-" else ""
            edits.change(start, end_of(old.nodes[joint]), deeper + edits.flow(coordinates))
    new = {joint: coordinates for joint, coordinates in value.items() if joint not in old.nodes}
    if new:
        edits.add(old, list(old.nodes)[-1], new)


def _plain(values: Sequence[float]) -> Value:
    """Coordinates as a file has them: whole numbers without a point, one alone without brackets."""
    numbers: list[int | float] = [int(value) if value == int(value) else value for value in map(float, values)]
    return numbers[0] if len(numbers) == 1 else numbers


def _same(old: object, new: Value) -> bool:
    """Whether coordinates are the same numbers, however they are written."""
    as_list = [value if isinstance(value, list) else [value] for value in (old, new)]
    return as_list[0] == as_list[1]


def _reads_back(text: str, before: Mapping[str, Any], name: str, value: Mapping[str, Value]) -> bool:
    """Whether a text has the data of before, and the coordinates in the configuration."""
    after = plain_data(text)
    if after is None:
        return False
    found = after["configurations"].pop(name)
    others = {key: other for key, other in before.get("configurations", {}).items() if key != name}
    same_rest = _canonical({**before, "configurations": others}) == _canonical(after)
    return same_rest and found.keys() == value.keys() and all(_same(found[joint], value[joint]) for joint in value)


def _canonical(value: object) -> str:
    """Plain data as text: 1, 1.0 and true differ in it, the order of keys does not."""
    return json.dumps(value, sort_keys=True)
