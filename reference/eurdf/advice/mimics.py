"""Advice on mimic joints that version 1 lets move by themselves."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from eurdf.diagnostics import quoted

if TYPE_CHECKING:
    from eurdf.diagnostics import Diagnostics
    from eurdf.linking.robot_files import ReadRobot


def advise_on_mimics(read: ReadRobot, diagnostics: Diagnostics) -> None:
    """Report mimic joints that a description of version 1 leaves free (EU-ONE-009) and that no motor moves.

    One that is actuated, locked or replaced is meant to be a joint of its own. A description without actuators leaves
    open which joints move by themselves.

    Args:
        read: The robot as read.
        diagnostics: Gets what is found.
    """
    urdf, mechanism = read.urdf, read.mechanism
    if mechanism.version != "1" or not mechanism.actuators:
        return
    free = {joint.name for joint in mechanism.joints if joint.type.is_axial} - set(mechanism.actuators)
    found = [joint for joint in urdf.joints.values() if joint.mimic is not None and joint.name in free]
    if not found:
        return
    names = quoted([joint.name for joint in found])
    count = "1 joint has" if len(found) == 1 else f"{len(found)} joints have"
    diagnostics.report(
        "x-mimic-ignored",
        f"{count} a <mimic> but no actuator, and version 1 ignores <mimic>: {names}",
        partial(urdf.document.place, next(found[0].element.iterchildren("mimic"))),
        "actuate the joints that move freely, remove <mimic>, or use version 2, which respects it",
    )
