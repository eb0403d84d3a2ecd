"""What SDFormat lacks, and the numbers that its simulators need and a description does not have."""

from __future__ import annotations

from collections.abc import Callable

from eurdf.convert.common_losses import ACCELERATION, BEYOND_LIMITS, COMMON, NAMED_FILE, impossible_inertia
from eurdf.convert.conventions import LIGHT
from eurdf.convert.losses import LossKind, approximate, by_writer, dropped, exact
from eurdf.convert.steps import is_skew
from eurdf.mechanism.joint import Joint

VERSION = "1.11"

#: The type of joint of SDFormat that a closure is.
CLOSURES = {"3d": "ball", "6d": "fixed", "hinge": "continuous"}

#: Joints and closures that are as in the description.
EXACT = (
    *(f"{kind} joint" for kind in ("revolute", "continuous", "prismatic", "spherical", "helical", "fixed")),
    *(f"{kind} closure" for kind in CLOSURES),
)


def _in_series(concept: str, title: str, only: str = "", where: Callable[[Joint], bool] | None = None) -> LossKind:
    error = f"{LIGHT:g} kg and kg·m² for each link between them in the mass matrix"
    return approximate(
        concept, title, "use Export.coordinates", error=error, only=only, where=where or (lambda joint: True)
    )


def _ball(concept: str, hint: str, values: str, none: float) -> LossKind:
    """Of a number of the rotations of a joint that become a ball joint."""
    return dropped(
        concept,
        "is left out: a ball joint has none",
        hint,
        types=("spherical", "floating"),
        where=lambda joint: any(value != none for value in getattr(joint.properties, values)[-3:]),
    )


ROWS = (
    _in_series("planar joint", "becomes two prismatic joints and one that turns"),
    _in_series("floating joint", "becomes three prismatic joints and a ball joint"),
    _in_series("cylindrical joint", "becomes a prismatic joint and one that turns"),
    _in_series(
        "universal joint", "its axes are not perpendicular: becomes two joints", "axes not perpendicular", is_skew
    ),
    exact(
        "configuration",
        "is where the links are: coordinates of joints are zero there",
        "use Export.coordinates",
        code="export-zero",
        only="the one where the links are",
        where=by_writer,
    ),
    dropped(
        "configuration",
        "is left out: a file has one configuration, where its links are",
        "export with another --configuration, or keep the description beside the file",
        code="export-configurations",
        only="all but one",
        where=by_writer,
    ),
    dropped(
        "distance closure",
        "is left out: SDFormat has no such joint",
        "describe the rod as a link, with a joint at each end",
        code="export-distance-dropped",
    ),
    exact(
        "coupling",
        "becomes the mimic of one joint by the other",
        "simulate with a physics engine that has mimic joints",
        only="two joints",
        where=by_writer,
    ),
    dropped(
        "coupling",
        "is left out: SDFormat relates two joints, of which one has no other relation",
        "add a plugin that couples the joints",
        code="export-coupling-dropped",
        only="three joints or more, or joints that mimic",
        where=by_writer,
    ),
    dropped("compliance", "is left out", "set 'cfm' and 'erp' of the joint by hand"),
    _ball("velocity limit", "limit velocities in the controller", "velocity", float("inf")),
    _ball("effort limit", "limit efforts in the controller", "effort", float("inf")),
    _ball("damping", "add a plugin", "damping", 0.0),
    _ball("friction", "add a plugin", "friction", 0.0),
    dropped("armature", "is left out", "add the inertia of the rotor to a link by hand"),
    dropped("gear ratio", "is left out", "multiply in the controller"),
    dropped(
        "actuator",
        "is left out: SDFormat has plugins",
        "add the plugin of a controller for the joint",
        code="export-actuators",
    ),
    dropped("control range", "is left out", "limit controls in the controller"),
    approximate(
        "link without mass",
        f"gets {LIGHT:g} kg and kg·m²: physics engines refuse 0",
        "give the link its mass",
        code="export-massless-link",
        error=f"{LIGHT:g} kg and kg·m² in the mass matrix",
    ),
    impossible_inertia("SDFormat asks for"),
    dropped("texture", "is left out; the color is kept", "add a material"),
    BEYOND_LIMITS,
    NAMED_FILE,
    ACCELERATION,
    *COMMON,
)
