"""JSON pointers (RFC 6901)."""

from __future__ import annotations


def step(key: str | int) -> str:
    """A key, or an index, as one step of a pointer."""
    return "/" + str(key).replace("~", "~0").replace("/", "~1")


def key_of(part: str) -> str:
    """The key that a part of a pointer, between two slashes, means."""
    return part.replace("~1", "/").replace("~0", "~")
