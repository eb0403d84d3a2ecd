"""The values of a usual YAML file, without their places: those are looked for when something is to be reported.

PyYAML composes nodes in compiled code, which takes two thirds of the time of `yaml_reader`, event by event. But it does
so by recursion, and forgets which anchors and tags it saw. So a file that has any, that could be nested deeply, or in
which anything is wrong is left to `yaml_reader`, which decides.
"""

from __future__ import annotations

import operator
import re
from math import isfinite
from typing import Any

from yaml import CSafeLoader
from yaml.error import YAMLError
from yaml.nodes import MappingNode, ScalarNode

from eurdf.reading.core_schema import WORDS, resolve
from eurdf.reading.source import Source

#: Bytes of a file that is read so. The depth of its blocks is at most the square root of twice as much: each is
#: indented more than the one around it.
MOST_BYTES = 10_000

#: Characters of a file that may begin a nested list or mapping on the same line.
MOST_OPENED = 200

#: Mappings and lists nested, at most, well below `yaml_reader.DEPTH_LIMIT`.
_MOST_NESTED = 32

#: Where an anchor, an alias, a tag or an explicit key may begin, or a directive.
_UNUSUAL = re.compile(rb"(?:^|[\s,:\[{-])[&*!%?]")

#: Byte order marks and breaks that libyaml takes for others than YAML 1.2 does.
_BREAKS = "\ufeff\x85\u2028\u2029"


class _UnusualError(Exception):
    """Something that is left to `yaml_reader`."""


class _Composer(CSafeLoader):
    """Composes nodes whose tags are their values, or the texts of keys."""

    # It calls these for each node, for tags that depend on the path: functions that do nothing, in no time.
    descend_resolver = staticmethod(operator.is_)  # type: ignore[assignment]
    ascend_resolver = staticmethod(tuple)  # type: ignore[assignment]

    def resolve(self, kind: type[Any], text: Any, implicit: Any) -> Any:
        if kind is not ScalarNode or not implicit[0]:
            return text
        # Most plain scalars are names.
        return text if text.isidentifier() and text not in WORDS else resolve(text)


def usual_values(source: Source) -> dict[str, Any] | None:
    """The mapping that a YAML file consists of, as `yaml_reader` reads it; None if only that can tell."""
    data = source.data
    if len(data) > MOST_BYTES or data.count(b"[") + data.count(b"{") + data.count(b"-") > MOST_OPENED:
        return None
    if any(map(data.__contains__, b"&*!%?")) and _UNUSUAL.search(data) is not None:
        return None
    if data.endswith(b" ") or (not data.isascii() and any(map(source.text.__contains__, _BREAKS))):
        return None
    try:
        node = _Composer(data).get_single_node()
        values: dict[str, Any] | None = _value(node, 0) if type(node) is MappingNode else None
    except (YAMLError, _UnusualError):
        return None
    return values


def _value(node: Any, depth: int) -> Any:
    """The value of a node in so many mappings and lists."""
    kind = type(node)
    if kind is ScalarNode:
        value = node.tag
        if type(value) is float and not isfinite(value):
            raise _UnusualError
        return value
    if depth == _MOST_NESTED:
        raise _UnusualError
    if kind is not MappingNode:
        return [_value(item, depth + 1) for item in node.value]
    values = {}
    for key, item in node.value:
        if type(key) is not ScalarNode or type(key.tag) is not str:
            raise _UnusualError
        values[key.tag] = _value(item, depth + 1)
    if len(values) < len(node.value):  # a key twice
        raise _UnusualError
    return values
