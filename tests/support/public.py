"""The public names of the package, in all of its public modules."""

from __future__ import annotations

import inspect
from types import ModuleType
from typing import Any

import eurdf

#: The public modules; those of `eurdf.batch` have the names of those of `eurdf`.
MODULES = ("errors", "results", "kinematics", "springs", "transmissions", "convert", "viewing", "batch")


def own_names(module: ModuleType) -> dict[str, Any]:
    """The functions, classes and types of a public module, by name."""
    found = {name: getattr(module, name) for name in dir(module) if not name.startswith("_") and name != "annotations"}
    if module is eurdf.errors:
        kinds = {name: value for name, value in found.items() if inspect.isclass(value)}
        return {name: kind for name, kind in kinds.items() if issubclass(kind, eurdf.errors.Portable)}
    return {name: value for name, value in found.items() if not inspect.ismodule(value)}


def public_names() -> dict[str, Any]:
    """Those of all modules by name, those for batches by ``batch.NAME``."""
    found = own_names(eurdf)
    for name in MODULES:
        prefix = f"{name}." if name == "batch" else ""
        found |= {f"{prefix}{own}": value for own, value in own_names(getattr(eurdf, name)).items()}
    return found


def public_functions() -> dict[str, Any]:
    """The functions among them."""
    return {name: value for name, value in public_names().items() if inspect.isfunction(value)}
