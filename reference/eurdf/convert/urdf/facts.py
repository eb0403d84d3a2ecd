"""What URDF lacks, and what its plain form, without extensions, lacks too."""

from __future__ import annotations

import math

from eurdf.closures import REGISTRY
from eurdf.convert.common_losses import ACCELERATION, COMMON, NAMED_FILE
from eurdf.convert.losses import LossKind, approximate, dropped, exact

#: Joints that are as in the description.
EXACT = tuple(f"{kind} joint" for kind in ("revolute", "continuous", "prismatic", "planar", "floating", "fixed"))

#: Losses of every URDF.
URDF_ROWS = (
    exact("universal joint", "becomes two joints with a link without mass between them", "use Export.coordinates"),
    exact(
        "cylindrical joint",
        "becomes a prismatic joint and one that turns, with a link without mass between them",
        "use Export.coordinates",
    ),
    dropped("spring", "is left out", "add the spring in the simulator"),
    dropped("configuration", "is left out", "keep the description beside the URDF", code="export-configurations"),
    dropped("compliance", "is left out", "set the compliance of the loop in the simulator"),
    dropped("texture", "is left out; the color is kept", "add it to the URDF"),
    NAMED_FILE,
    *COMMON,
)


def _on_axes(concept: str, values: str) -> tuple[LossKind, LossKind]:
    """Of a number of each axis of a joint with several."""
    return (
        dropped(
            concept,
            "is left out: the three joints that the joint becomes have none",
            "choose values for the three joints",
            code=f"export-ball-{values}",
            types=("spherical",),
        ),
        approximate(
            concept,
            "the axes of the joint have different values: that of the first is written",
            "give the axes of the joint one value",
            code=f"export-unequal-{values}",
            error="difference of the values to that of the first axis",
            types=("planar", "floating"),
            only="planar and floating joints with different values",
            where=lambda joint: len(set(getattr(joint.properties, values))) > 1,
        ),
    )


#: Losses of a tree that has only the joint types of URDF.
PLAIN_ROWS = (
    dropped(
        "coupling",
        "is left out: URDF has mimic joints alone",
        "where it relates two joints, let one of them mimic the other in the URDF",
        code="export-coupling-dropped",
    ),
    dropped("floating root", "is left out: in URDF, who reads the file decides", "load the URDF with a floating root"),
    approximate(
        "spherical joint",
        "becomes three continuous joints about x, y and z",
        "keep the joint away from where its second angle is ±π/2, or export to a format with spherical joints",
        error="none in poses; angular velocities are singular where the second angle is ±π/2",
    ),
    exact(
        "helical joint",
        "becomes a joint that turns and a prismatic one that mimics it",
        "read the URDF with its mimic joints",
    ),
    dropped("armature", "is left out", "set the armature in the simulator"),
    *_on_axes("velocity limit", "velocity"),
    *_on_axes("effort limit", "effort"),
    *_on_axes("damping", "damping"),
    *_on_axes("friction", "friction"),
    dropped(
        "acceleration limit",
        "limits of acceleration, deceleration and jerk are left out: joints of one axis alone have them",
        ACCELERATION.hint,
        types=("spherical", "planar", "floating"),
    ),
    dropped(
        "position limit",
        "is left out: planar and floating joints have none",
        "use prismatic and revolute joints",
        types=("planar", "floating"),
        where=lambda joint: any(math.isfinite(limit) for limits in joint.ranges for limit in limits),
    ),
    exact("frame", "becomes a link without mass on a fixed joint", "read the pose of the link"),
    dropped("gear ratio", "is left out", "set the gear in the simulator"),
    dropped("actuator", "is left out", "name the actuated joints in the simulator", code="export-actuators"),
    dropped("control range", "is left out", "limit controls in the controller"),
    *URDF_ROWS,
)

ROWS = (
    *(
        dropped(
            f"{kind} closure",
            "is left out: URDF has no loops",
            "keep the description beside the URDF, or export to a format with loops",
            code=f"export-{kind}-dropped",
        )
        for kind in REGISTRY
    ),
    *PLAIN_ROWS,
)
