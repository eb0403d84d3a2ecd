"""YAML as cases and lists of known failures are written in: no key twice, and ``1e-3`` is a number."""

from __future__ import annotations

import re
from collections.abc import Hashable
from typing import Any

import yaml

# The one of libyaml, where PyYAML was built with it, is ten times as quick.
_SafeLoader: type[yaml.SafeLoader] = getattr(yaml, "CSafeLoader", yaml.SafeLoader)


class _Loader(_SafeLoader):  # type: ignore[misc, valid-type]
    """PyYAML takes the last of two equal keys in silence, and ``1e-3`` for a word."""

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> dict[Hashable, Any]:
        mapping: dict[Hashable, Any] = super().construct_mapping(node, deep=deep)
        if len(mapping) != len(node.value):
            raise yaml.constructor.ConstructorError(None, None, "duplicate key in a mapping", node.start_mark)
        return mapping


_Loader.add_implicit_resolver(
    "tag:yaml.org,2002:float",
    re.compile(r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?$"),
    list("-+.0123456789"),
)


def load_strictly(text: str) -> Any:
    """The value of a YAML text.

    Raises:
        yaml.YAMLError: It is none, or duplicate key in a mapping.
    """
    return yaml.load(text, _Loader)
