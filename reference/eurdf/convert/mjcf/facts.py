"""What MuJoCo lacks, and the numbers that its format needs and a description does not have."""

from __future__ import annotations

import math
from pathlib import PurePosixPath

from eurdf.convert.common_losses import (
    ACCELERATION,
    BEYOND_LIMITS,
    COMMON,
    CONVERSION,
    NAMED_FILE,
    driven,
    impossible_inertia,
    no_configuration,
    unequal,
)
from eurdf.convert.conventions import LEAST
from eurdf.convert.losses import approximate, by_writer, dropped, exact
from eurdf.mechanism.constraint import Closure
from eurdf.mechanism.joint import Joint
from eurdf.mechanism.joint_types import JointType

#: Time step, s. The equalities below are as stiff as it allows: MuJoCo keeps their time constant at two steps or more.
TIMESTEP = 0.001

#: Where MuJoCo's solver stops. At its default, 1e-8, it leaves equalities of joints with little inertia unsolved: mimic
#: joints of links without mass open by 0.1 rad. It does as many iterations in other robots.
TOLERANCE = 1e-15

#: Time constant (s) and damping ratio, and impedances, of closures, couplings and mimic joints.
SOLREF, SOLIMP = (2.0 * TIMESTEP, 1.0), (0.9999, 0.9999, 0.001, 0.5, 2.0)

#: The bound of a side without limit, where the other side has one: rad or m.
UNLIMITED = 1e10

#: The types of joint that are one of MuJoCo, beside those of one axis.
WHOLE = (JointType.SPHERICAL,)

#: The kind of joint of MuJoCo that a joint is.
KINDS = {
    JointType.REVOLUTE: "hinge",
    JointType.CONTINUOUS: "hinge",
    JointType.PRISMATIC: "slide",
    JointType.SPHERICAL: "ball",
}

#: The element that holds a closure.
CLOSURES = {"3d": "connect", "6d": "weld", "hinge": "connect", "distance": "tendon"}

#: Joints and closures that are as in the description.
EXACT = tuple(f"{kind} joint" for kind in ("revolute", "continuous", "prismatic", "planar", "universal", "cylindrical"))

# What the tests hold robots to that have these elements.
_OPENING = "less than 1e-3 m or rad in 2 s under gravity, on the robots of the tests"

# A shorter time step helps some robots alone: those whose loops pass singular poses open as much, or diverge.
_MEASURE = "run `eurdf export --verify`: it shows how far the loops open in 2 s and, above 5 mm, what to do"

_KEYFRAME = "let the simulation start at a keyframe, which meets the equality"

_DRIVEN = ("motor", "position")

#: Of rows that occur where balls become hinges.
_HINGES = "--joints hinge"

# EᵀE of the axes E of the hinges has the eigenvalues 1 and 1 ± s: a number times it becomes one times its inverse.
_OF_IT = "up to s / (1 - s) of it, s the size of the sine of the second angle, if its axes have one value"

#: How far hinges differ from a ball that has the same number on its axes.
_ON_RATES = {
    "armature": f"{_OF_IT}, in the mass matrix; about armature · (rates)² in the force",
    "damping": _OF_IT,
    "friction": "none at the joint's zero; elsewhere the axes of its bounds are turned by the angles of the hinges",
}


def is_readable(file: str, content: bytes) -> bool:
    """Whether MuJoCo reads a mesh: a binary STL has 80 bytes, the number of triangles, and 50 bytes of each."""
    suffix = PurePosixPath(file).suffix.lower()
    if suffix == ".stl":
        return len(content) >= 84 and len(content) == 84 + 50 * int.from_bytes(content[80:84], "little")
    return suffix in (".obj", ".msh")


def _compliance(closure: Closure) -> str:
    linear, angular = closure.compliance.linear, closure.compliance.angular
    return f"{linear:g} m/N" + (f", {angular:g} rad/(N·m)" if angular else "") + " is left out"


def _velocity(joint: Joint) -> str:
    return f"{next(filter(math.isfinite, joint.properties.velocity)):g} is left out"


ROWS = (
    exact(
        "fixed joint",
        "its name is left out: its link becomes a body without a joint, or a site if it has no mass",
        "name the link in its place",
    ),
    *(
        approximate(
            f"{kind} joint",
            "its ball becomes three hinges about x, y and z of the joint's frame, in this order",
            "keep the second hinge away from ±π/2, or export with --joints stated",
            code=f"export-{kind}-hinges",
            error="none in poses and accelerations; singular where the second angle is ±π/2",
            only=_HINGES,
            where=by_writer,
        )
        for kind in ("spherical", "floating")
    ),
    exact(
        "spherical joint",
        "becomes a 3d closure, in place of the 6d closure that holds its link: the link is fixed to what held it",
        "use Export.robot, which q and v of Export.coordinates are of",
        code="export-rod-closure",
        only=_HINGES,
        where=by_writer,
    ),
    approximate(
        "spherical joint",
        "becomes a universal joint without limits: the rod that it carries no longer turns about its own line",
        "use Export.robot, which q and v of Export.coordinates are of",
        code="export-rod-universal",
        error="none in poses of other links; forces of the size of those of the rod's inertia about its line",
        only=_HINGES,
        where=by_writer,
    ),
    approximate("helical joint", "becomes a slide and a hinge that a soft equality couples", _KEYFRAME, error=_OPENING),
    approximate(
        "mimic joint", "becomes a free joint that a soft equality couples to its leader", _KEYFRAME, error=_OPENING
    ),
    approximate("3d closure", "becomes a 'connect', which is soft", _MEASURE, code="export-soft-3d", error=_OPENING),
    approximate("6d closure", "becomes a 'weld', which is soft", _MEASURE, code="export-soft-6d", error=_OPENING),
    approximate("hinge closure", "becomes two 'connect' on the axis: 6 soft rows of rank 5", _MEASURE, error=_OPENING),
    approximate("distance closure", "becomes the soft equality of a spatial tendon", _MEASURE, error=_OPENING),
    approximate(
        "coupling",
        "becomes a soft equality of two joints, or of a fixed tendon of three or more",
        _KEYFRAME,
        code="export-soft-coupling",
        error=_OPENING,
    ),
    dropped(
        "compliance",
        "is left out: MuJoCo relates the softness of an equality to the inertia that it holds",
        f"set solref of the equality to '-s -2√s', s = {1.0 - SOLIMP[1]:.0e} · w / compliance, where w is the sum of "
        "model.body_invweight0[:, 0] of the two bodies",
        message=_compliance,
    ),
    dropped(
        "velocity limit",
        "is left out: MuJoCo has no velocity limits of joints",
        "limit velocities in the controller",
        message=_velocity,
    ),
    dropped(
        "effort limit",
        "is left out: MuJoCo has none for a ball joint, and none of 0",
        "limit efforts in the controller",
        only="spherical joints, and limits of 0",
        where=by_writer,
    ),
    approximate(
        "position limit",
        "both limits are equal, which MuJoCo refuses: becomes a soft equality",
        "make the joint 'fixed' in the description",
        code="export-equal-limits",
        error=_OPENING,
        only="equal limits that are not 0",
        where=lambda joint: any(lower == upper for lower, upper in joint.ranges),
    ),
    *(
        approximate(
            concept,
            "acts on the rates of three hinges, not on the angular velocity of the ball",
            "keep the second hinge near 0, or export with --joints stated",
            code=f"export-hinge-{concept}",
            error=error,
            only=_HINGES,
            where=by_writer,
        )
        for concept, error in _ON_RATES.items()
    ),
    *unequal(("armature", "damping", "friction"), only="axes with different values"),
    approximate(
        "armature",
        "acts along the axes of the joint at rest, not along those of the child: centrifugal terms differ",
        "leave out the armature of planar and floating joints",
        code="export-turning-armature",
        error="up to armature · (joint velocity)² in the force; none at rest",
        types=("planar", "floating"),
        where=lambda joint: any(joint.properties.armature[: len(joint.type.steps) - 1]),  # slides come first
    ),
    exact(
        "gear ratio",
        "controls are on the side of the joint; the rotor is in the armature, gear ratio² · rotor inertia",
        "to control the motor side, multiply 'gear' and divide 'ctrlrange' by the gear ratio",
        actuators=_DRIVEN,
        where=lambda motor: motor.is_actuated,
    ),
    approximate(
        "actuator",
        "acts along the axes of the joint at rest, not along those of the child",
        "turn the forces with Export.coordinates.rates",
        code="export-force-axes",
        error="none at the joint's zero; elsewhere the force is turned by the joint's angle",
        types=("planar", "floating"),
        actuators=_DRIVEN,
    ),
    approximate(
        "actuator",
        "acts about the axes of three hinges, with its limits, not along the axes of the child",
        "turn the forces with Export.coordinates.rates",
        code="export-hinge-actuator",
        error="none at the joint's zero; elsewhere the axes are turned by the angles of the hinges",
        only=_HINGES,
        where=by_writer,
        actuators=_DRIVEN,
    ),
    *driven("'kp' and 'dampratio' of the actuator"),
    approximate(
        "link without mass",
        f"moves without inertia, which MuJoCo refuses: gets {LEAST:g} kg and kg·m²",
        "give the link its mass or its joint an armature, or merge its joints into one of a type with several axes",
        code="export-massless-link",
        error=f"{LEAST:g} kg and kg·m² in the mass matrix; the simulation diverges where three joints with such links "
        "between them have their axes in a plane",
        only="links that move",
    ),
    impossible_inertia("MuJoCo asks for"),
    dropped("texture", "is left out; the color is kept", "add a texture and a material to the file"),
    BEYOND_LIMITS,
    no_configuration(", so there is no keyframe"),
    *CONVERSION,
    NAMED_FILE,
    ACCELERATION,
    *COMMON,
)
