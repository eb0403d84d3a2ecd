"""Which joint each velocity of a model belongs to."""

from __future__ import annotations

from typing import Any


def velocity_names(model: Any) -> list[str]:
    """For each velocity (nv) the name of its joint."""
    names = [""] * model.nv
    for name, first, width in zip(model.names, model.idx_vs, model.nvs, strict=True):
        names[first : first + width] = [name] * width
    # The coordinate of a leader that comes after one of its mimic joints belongs to a joint of its own.
    return [
        name.removesuffix("/coordinate") if name.endswith("/coordinate") and model.existJointName(name[:-11]) else name
        for name in names
    ]
