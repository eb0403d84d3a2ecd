"""What URDF with the loop joints of Isaac Sim lacks."""

from __future__ import annotations

from eurdf.convert.losses import dropped
from eurdf.convert.urdf.facts import EXACT as JOINTS
from eurdf.convert.urdf.facts import PLAIN_ROWS

#: The type of the loop joint that a closure is.
CLOSURES = {"3d": "spherical", "6d": "fixed", "hinge": "revolute"}

#: Joints and closures that are as in the description.
EXACT = (*JOINTS, *(f"{kind} closure" for kind in CLOSURES))

ROWS = (
    dropped(
        "distance closure",
        "is left out: there is no such loop joint",
        "describe the rod as a link, with a joint at each end",
        code="export-distance-dropped",
    ),
    *PLAIN_ROWS,
)
