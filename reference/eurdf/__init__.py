"""Extended URDF: robots with closed kinematic chains, from a URDF and one YAML file.

The public names are those of ``__init__.pyi``. Each is loaded when first used, so that checking a file does not wait
for a simulator.
"""

from __future__ import annotations

import ast
import importlib
from pathlib import Path
from typing import Any

__version__ = "0.1.0"

_STUB = ast.parse(Path(__file__).with_suffix(".pyi").read_text(encoding="utf-8"))
_MODULES = {
    name.name: imported.module
    for imported in _STUB.body
    if isinstance(imported, ast.ImportFrom)
    for name in imported.names
}

__all__ = sorted(["__version__", *_MODULES])


def __getattr__(name: str) -> Any:
    module = _MODULES.get(name)
    if module is None:
        raise AttributeError(f"module 'eurdf' has no attribute '{name}'")
    if module == __name__:  # a public submodule
        return importlib.import_module(f"{module}.{name}")
    value = getattr(importlib.import_module(module), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
