"""User-defined keys (EU-EXT-002)."""

#: What user-defined keys begin with, at any level of a version 2 file, as a pattern of JSON Schema.
OWN_KEY = "^x-"

_PREFIX = OWN_KEY.removeprefix("^")


def is_own_key(key: str) -> bool:
    """Whether a key of a version 2 file is user-defined."""
    return key.startswith(_PREFIX)


def may_have_own_keys(text: str) -> bool:
    """Whether a file can have a user-defined key: it contains what these begin with, or an escape."""
    return _PREFIX in text or "\\" in text
