"""Frames of a model by name."""

from __future__ import annotations

import difflib
from typing import Any


def frame_index(model: Any, name: str) -> int:
    """Index in ``model.frames`` of the frame with this name.

    A link and a joint can have the same name if they have the same frame (EU-FRM-002).

    Raises:
        ValueError: The frame is unknown, or two different frames have this name.
    """
    found = [(index, frame) for index, frame in enumerate(model.frames) if frame.name == name]
    if not found:
        near = difflib.get_close_matches(name, [frame.name for frame in model.frames], n=1)
        raise ValueError(f"the model has no frame '{name}'" + (f"; did you mean '{near[0]}'?" if near else ""))
    index, first = found[0]
    for _, other in found[1:]:
        if other.parentJoint != first.parentJoint or not other.placement.isApprox(first.placement, 1e-12):
            raise ValueError(f"frame name '{name}' is ambiguous: two different frames of the model have it")
    return index
