"""Three hinges for a ball: what they change, and where they are singular."""

from __future__ import annotations

import math
from collections.abc import Mapping

from eurdf.convert.coordinates import Coordinates
from eurdf.convert.export_format import ExportInput
from eurdf.convert.losses import Losses
from eurdf.errors import CannotExport
from eurdf.mechanism.joint import Joint

#: Least cosine of the angle of the second hinge at which simulations may start.
_SINGULAR = 1e-3


def report(joint: Joint, given: ExportInput, losses: Losses) -> None:
    """Add the losses of a joint whose ball becomes hinges."""
    losses.add(f"export-{joint.type}-hinges", joint.name)
    for number in ("armature", "damping", "friction"):
        if any(getattr(joint.properties, number)[-3:]):
            losses.add(f"export-hinge-{number}", joint.name)
    if joint.name in given.mechanism.actuators and given.actuators != "none":
        losses.add("export-hinge-actuator", given.mechanism.motor(joint.name).name)


def check_start(coordinates: Coordinates, start: Mapping[str, tuple[float, ...]]) -> None:
    """Check that no hinges for a ball are singular at the configuration to start from, as files have it.

    Raises:
        CannotExport: Some are: the angle of the second is ±π/2, to 1e-3 rad.
    """
    values, end = coordinates.from_files(start).tolist(), 0
    for part in coordinates.parts:
        end += part.nq
        if part.rotation == "xyz" and abs(math.cos(values[end - 2])) < _SINGULAR:
            raise CannotExport(
                f"the hinges of '{part.joint}' are singular at the configuration to start from, where the second is at "
                f"{values[end - 2]:.4g} rad; choose another configuration, or keep the ball joints"
            )
