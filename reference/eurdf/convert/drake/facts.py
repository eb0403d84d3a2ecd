"""What the parser of Drake lacks, and the numbers that it needs and a description does not have."""

from __future__ import annotations

import math

from eurdf.convert.common_losses import CONVERSION, impossible_inertia, unequal
from eurdf.convert.conventions import LEAST
from eurdf.convert.losses import MotorJoint, approximate, by_writer, dropped, exact
from eurdf.convert.urdf.facts import EXACT as URDF_EXACT
from eurdf.convert.urdf.facts import URDF_ROWS
from eurdf.mechanism.constraint import Closure
from eurdf.mechanism.joint import Joint

#: Stiffness of a coupling, N/m or N·m/rad: Drake has no rigid ones of three joints, and softens what is stiffer than
#: its time step allows.
STIFFNESS = 1e12

#: The closures that are written.
CLOSURES = ("3d", "6d", "hinge")

#: Joints that are as in the description.
EXACT = (*URDF_EXACT, "helical joint")

_SAP = "less than 1e-3 m or rad in 1 s under gravity, on the robots of the tests; continuous time ignores it"
_DISCRETE = "simulate in discrete time, with the SAP solver"
_GIMBAL = "none in poses and dynamics; rates of coordinates are singular where the pitch is ±π/2"
_AWAY = "keep the joint away from where its pitch is ±π/2, or choose its zero otherwise"

#: Types whose coordinates are not those of revolute and prismatic joints in series.
_WHOLE = ("spherical", "planar", "floating")


def can_have_actuator(joint: Joint) -> bool:
    """Whether Drake has actuators of a joint: those of freedoms of their own, with an effort limit above 0."""
    return joint.type not in _WHOLE and min(joint.properties.effort, default=math.inf) > 0.0


def has_one_acceleration(joint: Joint) -> bool:
    """Whether the limits of acceleration and deceleration of a joint are equal: Drake has one number."""
    return joint.properties.rates.get("acceleration") == joint.properties.rates.get("deceleration")


def _lacks_rates(joint: Joint) -> bool:
    is_limited = not (joint.type in _WHOLE or joint.type == "helical")
    return not (is_limited and has_one_acceleration(joint) and "jerk" not in joint.properties.rates)


def _rod(closure: Closure) -> str:
    p, r = closure.a.pose.xyz, closure.b.pose.xyz
    bodies = f"body_A '{closure.a.body}', p_AP {list(p)}, body_B '{closure.b.body}', p_BQ {list(r)}"
    return f"is left out: {bodies}, distance {closure.own['length']}"


def _cannot_act(motor: MotorJoint) -> bool:
    return not can_have_actuator(motor.joint)


ROWS = (
    approximate("spherical joint", "becomes a 'ball', whose coordinates are roll, pitch and yaw", _AWAY, error=_GIMBAL),
    approximate(
        "floating joint",
        "becomes three prismatic joints and a 'ball', whose coordinates are roll, pitch and yaw",
        _AWAY,
        error=_GIMBAL,
    ),
    approximate("mimic joint", "becomes a free joint that a constraint couples to its leader", _DISCRETE, error=_SAP),
    approximate("3d closure", "becomes a 'drake:ball_constraint'", _DISCRETE, code="export-soft-3d", error=_SAP),
    approximate(
        "6d closure",
        "becomes three 'drake:ball_constraint': 9 rows of rank 6",
        "replace them with MultibodyPlant.AddWeldConstraint, which a file cannot state",
        code="export-soft-6d",
        error=_SAP,
    ),
    approximate(
        "hinge closure", "becomes two 'drake:ball_constraint' on the axis: 6 rows of rank 5", _DISCRETE, error=_SAP
    ),
    dropped(
        "distance closure",
        "is left out: Drake has no element for it",
        "call MultibodyPlant.AddDistanceConstraint with the points and the length of the message",
        message=_rod,
    ),
    approximate(
        "coupling",
        f"becomes a 'drake:tendon_constraint' of the stiffness {STIFFNESS:g}",
        _DISCRETE,
        code="export-soft-coupling",
        error=_SAP,
    ),
    dropped(
        "position limit",
        "limits of position and velocity are left out: Drake has none for this type of joint",
        "limit the motion in the controller",
        code="export-limits",
        only="planar and helical joints",
        types=("helical",),
        where=lambda joint: any(map(math.isfinite, joint.ranges[0])),
    ),
    dropped(
        "velocity limit",
        "is left out: Drake has none for this type of joint",
        "limit velocities in the controller",
        types=(*_WHOLE, "helical"),
    ),
    dropped(
        "acceleration limit",
        "limits of acceleration, deceleration and jerk are left out: Drake has one for both directions of q̈",
        "limit them where motions are planned",
        only="all but equal limits of acceleration and deceleration of joints with one axis",
        where=_lacks_rates,
    ),
    dropped(
        "effort limit",
        "is left out: in Drake, it is one of the actuator, which acts on a joint with one freedom",
        "limit efforts in the controller",
        types=_WHOLE,
    ),
    *unequal(("damping",), only="spherical joints with different values"),
    dropped("friction", "is left out: Drake has none of joints", "model it apart"),
    dropped(
        "armature",
        "is left out: in Drake, it is one of an actuator, which acts on a joint with one freedom",
        "make the joint an actuator, or add the inertia to its link",
        only="joints without an actuator",
        where=by_writer,
    ),
    exact(
        "gear ratio",
        "is written as 1, with the armature as rotor inertia: the armature is not gear ratio² · rotor inertia",
        "leave out the armature in the description",
        only="armature stated apart",
        where=by_writer,
    ),
    dropped(
        "actuator",
        "is left out: in Drake, one acts on a joint with one freedom and an effort limit above 0",
        "apply the forces from a program",
        only="spherical, planar and floating joints, and limits of 0",
        where=_cannot_act,
    ),
    dropped(
        "control range",
        "is left out: an actuator of Drake has the effort limit of its joint alone",
        "limit controls in the controller",
    ),
    approximate(
        "link without mass",
        f"gets {LEAST:g} kg and kg·m²: Drake replaces inertia without mass by 1 kg of water, and does not simulate a "
        "joint that moves no inertia, nor a mimic joint, which is free there, whose link has none",
        "give the link its mass",
        code="export-massless-link",
        error=f"{LEAST:g} kg and kg·m² in the mass matrix",
        only="links with inertia, with a mimic joint, or with a joint that moves no inertia",
    ),
    impossible_inertia("Drake replaces by a ball of water"),
    *CONVERSION,
    *URDF_ROWS,
)
