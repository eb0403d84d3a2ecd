"""Public names that are loaded when first used, so that checking a file does not wait for a simulator.

The stub beside a module, its ``.pyi``, lists the names, each with the module that defines it.
"""

from __future__ import annotations

import ast
import importlib
import sys
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any


def public_names(module: str, file: str) -> tuple[Callable[[str], Any], Callable[[], list[str]]]:
    """``__getattr__`` and ``__dir__`` of a module, by its name and file; its stub is read when they are first used."""

    @cache
    def defined_in() -> dict[str, str]:
        stub = ast.parse(Path(file).with_suffix(".pyi").read_text(encoding="utf-8"))
        imports = (each for each in stub.body if isinstance(each, ast.ImportFrom))
        return {name.name: str(each.module) for each in imports for name in each.names}

    def get(name: str) -> Any:
        if name == "__all__":
            return sorted(defined_in())
        source = None if name.startswith("__") else defined_in().get(name)
        if source is None:
            raise AttributeError(f"module '{module}' has no attribute '{name}'")
        if source == module:  # a public submodule
            return importlib.import_module(f"{module}.{name}")
        value = getattr(importlib.import_module(source), name)
        setattr(sys.modules[module], name, value)
        return value

    return get, lambda: sorted(defined_in())
