"""Which joint each velocity of a model belongs to."""

from __future__ import annotations

from typing import Any


def velocity_names(model: Any) -> list[str]:
    """For each velocity (nv) the name of its joint."""
    names, joints = [""] * model.nv, set(model.names)
    for name, first, width in zip(model.names, model.idx_vs, model.nvs, strict=True):
        # The coordinate of a leader that comes after one of its mimic joints belongs to a helper joint.
        leader = name.removesuffix("/coordinate")
        names[first : first + width] = [leader if leader in joints else name] * width
    return names
