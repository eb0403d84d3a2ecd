"""The nodes of a YAML file: what they are and where they stand."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from yaml.events import Event


class Collection:
    """A mapping or a list.

    Attributes:
        data: The plain ``dict`` or ``list``.
        start: Event that begins it.
        end: Event that ends it; None while it is being read.
        key: In a mapping, the key whose value comes next.
        keys: In a mapping, the event of each key.
        nodes: The node of each value, by key or index.
        size: Number of nodes in it, keys and itself included, aliases expanded; while it is being read, number of nodes
            in the file before it.
        height: Number of mappings and lists nested at the deepest, itself included, aliases expanded.
    """

    __slots__ = ("data", "end", "height", "is_mapping", "key", "keys", "nodes", "size", "start")

    def __init__(self, data: dict[str, Any] | list[Any], start: Event, size: int) -> None:
        self.data: Any = data
        self.start = start
        self.end: Event | None = None
        self.is_mapping = type(data) is dict
        self.key: str | None = None
        self.keys: dict[str | int, Event] = {}
        self.nodes: dict[str | int, Node] = {}
        self.size = size
        self.height = 1

    def add(self, value: Any, node: Node) -> None:
        """Put in the next value; in a mapping, its key must have come."""
        if self.key is not None:
            self.data[self.key] = value
            self.nodes[self.key] = node
            self.key = None
        else:
            self.nodes[len(self.data)] = node
            self.data.append(value)


class Alias:
    """An alias of a mapping or a list."""

    __slots__ = ("event", "target")

    def __init__(self, event: Event, target: Collection) -> None:
        self.event = event
        self.target = target


#: A scalar, or an alias of one, is nothing but its event.
Node = Event | Collection | Alias


def span(node: Node) -> tuple[int, int | None]:
    """Indices, in characters, of the first character of a node and of the one after its last.

    The end is None for a mapping or list in block style: libyaml puts it where the next node begins.
    """
    if isinstance(node, Alias):
        node = node.event
    start: Any = node
    end: Any = node
    if isinstance(node, Collection):
        start = node.start
        end = node.end if start.flow_style else None
    return start.start_mark.index, end.end_mark.index if end is not None else None


def json_pointer(steps: Sequence[str | int]) -> str:
    """JSON pointer (RFC 6901) of keys and indices."""
    return "".join("/" + str(step).replace("~", "~0").replace("/", "~1") for step in steps)
