"""User data, by JSON pointer (RFC 6901): chapter Extensions, clauses EU-CAN-002 and 003."""

from __future__ import annotations

from typing import Any

from eurdf_conformance.json_pointer import step


def own_data(value: Any, pointer: str = "") -> dict[str, Any]:
    """Every key that begins with `x-`, at any level, with its whole value."""
    found: dict[str, Any] = {}
    if isinstance(value, list):
        for i, item in enumerate(value):
            found |= own_data(item, pointer + step(i))
    elif isinstance(value, dict):
        for key, member in value.items():
            inner = pointer + step(key)
            found |= {inner: member} if key.startswith("x-") else own_data(member, inner)
    return found
