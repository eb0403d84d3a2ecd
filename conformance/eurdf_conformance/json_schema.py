"""JSON Schemas (2020-12) as this suite publishes them."""

from __future__ import annotations

import json
from typing import Any

Schema = dict[str, Any]


def published(name: str, schema: Schema, **words: str) -> Schema:
    """A schema with its head.

    Args:
        name: What follows ``urn:extended-urdf:`` in its id.
        schema: What it says.
        words: Its title and its description, where it has none.
    """
    head = {"$schema": "https://json-schema.org/draft/2020-12/schema", "$id": f"urn:extended-urdf:{name}"}
    return {**head, **words, **schema}


def schema_text(schema: Schema) -> str:
    """A schema as its file holds it."""
    return json.dumps(schema, indent=2, ensure_ascii=False) + "\n"
