"""Joints that are to move, and whose URDF gives them no range."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial

from eurdf.diagnostics import Diagnostics, quoted
from eurdf.format.urdf.data import Urdf, UrdfJoint
from eurdf.mechanism.joint import Joint, is_no_range


def check_ranges(urdf: Urdf, joints: Mapping[str, Joint], diagnostics: Diagnostics) -> None:
    """EU-URD-025: a joint that is to move has a range; URDF reads limits that are left out as 0.

    Args:
        urdf: The URDF.
        joints: The joints of the mechanism: those that the description merges, makes another type or gives limits need
            no range in the URDF.
        diagnostics: Gets what is found.
    """
    found = [
        joint
        for joint in urdf.joints.values()
        if (limit := joint.limit) is not None
        and is_no_range(limit.lower, limit.upper)
        and _has_no_range(joint, joints.get(joint.name))
    ]
    if not found:
        return
    names = quoted([joint.name for joint in found])
    count = "1 joint has" if len(found) == 1 else f"{len(found)} joints have"
    diagnostics.report(
        "urdf-no-range",
        f"{count} the position limits 0 and 0: {names}",
        partial(urdf.document.place, next(found[0].element.iterchildren("limit"))),
        "state 'lower' and 'upper', or use type 'continuous' if there are no limits",
    )


def _has_no_range(joint: UrdfJoint, made: Joint | None) -> bool:
    """Whether the range from 0 to 0 of a joint of the URDF is that of its joint in the mechanism."""
    return joint.type.is_ranged and made is not None and made.type.is_ranged and made.lacks_range
