"""User-defined keys (EU-EXT-002)."""

#: What user-defined keys begin with, at any level of a version 2 file, as a pattern of JSON Schema.
OWN_KEY = "^x-"


def is_own_key(key: str) -> bool:
    """Whether a key of a version 2 file is user-defined."""
    return key.startswith("x-")
