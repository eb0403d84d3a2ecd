"""The nodes of a YAML file, with their places."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

#: The keys and indices that lead to a value.
Pointer = tuple[str | int, ...]

#: Index, in characters, of the first character of a node and of the one after its last. The end is None for a mapping
#: or list in block style: libyaml puts it where the next node begins.
Span = tuple[int, int | None]


class YamlCollection:
    """A mapping or a list.

    Attributes:
        data: The plain ``dict`` or ``list``.
        span: Its place.
        is_open: Whether it is still being read.
        is_mapping: Whether it is a mapping.
        awaits_key: Whether it is a mapping in which a key comes next.
        key: In a mapping, the last key that came.
        keys: In a mapping, the place of each key.
        nodes: The node of each value, by key or index.
        size: Number of nodes in it, keys and itself included, aliases expanded; while it is being read, number of nodes
            in the file before it.
        height: Number of mappings and lists nested at the deepest, itself included, aliases expanded.
    """

    __slots__ = ("awaits_key", "data", "height", "is_mapping", "is_open", "key", "keys", "nodes", "size", "span")

    def __init__(self, data: dict[str, Any] | list[Any], span: Span, size: int) -> None:
        self.data: Any = data
        self.span = span
        self.is_open = True
        self.is_mapping = self.awaits_key = type(data) is dict
        self.key = ""
        self.keys: dict[str | int, Span] = {}
        self.nodes: dict[str | int, Node] = {}
        self.size = size
        self.height = 1

    @property
    def is_flow(self) -> bool:
        """Whether it is in braces or brackets, once it has been read."""
        return self.span[1] is not None

    def add(self, value: Any, node: Node) -> None:
        """Add the next value; in a mapping, its key comes first."""
        if self.is_mapping:
            self.data[self.key] = value
            self.nodes[self.key] = node
            self.awaits_key = True
        else:
            self.nodes[len(self.data)] = node
            self.data.append(value)


class Alias:
    """An alias of a mapping or a list."""

    __slots__ = ("span", "target")

    def __init__(self, span: Span, target: YamlCollection) -> None:
        self.span = span
        self.target = target


#: For a scalar, or an alias of one, only its place is kept.
Node = Span | YamlCollection | Alias


def start_of(node: Node) -> int:
    """Index of the first character of a node."""
    return node[0] if isinstance(node, tuple) else node.span[0]


def end_of(node: Node) -> int:
    """Index of the character after the last one of a node; of a block, that of its last entry."""
    end = node[1] if isinstance(node, tuple) else node.span[1]
    if end is not None:
        return end
    assert isinstance(node, YamlCollection)
    last, inner = list(node.nodes.items())[-1]
    _, key_end = node.keys.get(last, (0, 0))
    return max(end_of(inner), key_end or 0)


def json_pointer(steps: Sequence[str | int]) -> str:
    """JSON pointer (RFC 6901) of keys and indices."""
    return "".join("/" + str(step).replace("~", "~0").replace("/", "~1") for step in steps)
