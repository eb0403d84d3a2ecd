"""The rules on how a robot moves: closed where it stands, heavy, and led by each actuator through its range."""

from __future__ import annotations

import math

import numpy as np
import pinocchio as pin

import eurdf
from eurdf.kinematics.array import Matrix
from eurdf.kinematics.sweep import MotionPath, Sweep
from robots.quality.candidate import Candidate

_ASSEMBLED = 1e-12  # largest row of the residual at the assembled configuration, m or rad
_CLOSED = 1e-10  # and on the way, m or rad

# M is positive definite by this part of its diagonal: far above rounding, and far below what a light link between heavy
# ones brings it to.
_MARGIN = 1e-9
_EVERY = 10  # M changes slowly: of so many configurations on a way it is looked at in one


def is_assembled(candidate: Candidate) -> list[str]:
    """It has an assembled configuration, at which its loops are closed to 1e-12."""
    q = candidate.assembled
    if q is None:
        return ["there is no configuration 'assembled'"]
    largest = float(np.abs(eurdf.residual(candidate.robot, q)).max(initial=0.0))
    return [f"a loop is open by {largest:.1e} (m or rad) at 'assembled'"] if not largest <= _ASSEMBLED else []


def weighs(candidate: Candidate) -> list[str]:
    """Every body that moves has mass, and M(q) is positive definite where it is assembled and on all ways."""
    model = candidate.robot.model
    moving = zip(model.names[1:], model.inertias[1:], strict=True)
    massless = [f"what joint '{name}' carries has no mass" for name, inertia in moving if not inertia.mass > 0.0]
    if massless:
        return massless
    data = model.createData()
    places = {"where it is assembled": [pin.neutral(model) if candidate.assembled is None else candidate.assembled]}
    if candidate.closes:
        for actuator, found in candidate.sweeps.items():
            ways = (found.lower, found.upper) if isinstance(found, Sweep) else ()
            places[f"on the way of '{actuator}'"] = [q for way in ways for q in way.configurations[::_EVERY]]
    for place, configurations in places.items():
        if not all(_is_positive_definite(np.array(pin.crba(model, data, q))) for q in configurations):
            return [f"the mass matrix is not positive definite {place}"]
    return []


def _is_positive_definite(M: Matrix) -> bool:
    """Whether M (nv, nv), of which the upper triangle is given, is so by a margin relative to its diagonal."""
    M = np.triu(M) + np.triu(M, 1).T
    try:
        np.linalg.cholesky(M - _MARGIN * np.diag(np.diag(M)))
    except np.linalg.LinAlgError:
        return False
    return bool((np.diag(M) > 0.0).all())


def moves(candidate: Candidate) -> list[str] | None:
    """Each actuator comes to its own stop, or to that of a passive joint, on one branch; None if loops are open.

    One without stops comes round. So what the linkage does not allow is beyond a stop that is stated.
    """
    if not candidate.closes:
        return None
    faults = []
    for actuator, found in candidate.sweeps.items():
        if isinstance(found, str):
            faults.append(found)
            continue
        angular = is_angular(candidate.robot, actuator)
        for way, stop in zip((found.lower, found.upper), found.bounds, strict=True):
            faults += [f"'{actuator}' {fault}" for fault in _faults(way, stop, angular)]
        if found.periodic is False:
            faults.append(f"'{actuator}' does not come round: a full turn leads to another configuration")
        if is_endless(candidate.robot, actuator):
            faults += [
                f"'{actuator}' has no stops, but '{way.joint}' comes to its own at {shown(way.reached, angular)}"
                for way in (found.lower, found.upper)
                if way.end == "passive limit"
            ]
    return faults


def _faults(way: MotionPath, stop: float, angular: bool) -> list[str]:
    faults = []
    if way.end == "dead point":
        faults.append(f"has a dead point at {shown(way.reached, angular)}, before its stop at {shown(stop, angular)}")
    if not way.residual <= _CLOSED:
        faults.append(f"opens a loop by {way.residual:.1e} (m or rad) before {shown(way.reached, angular)}")
    return faults


def is_angular(robot: eurdf.Robot, joint: str) -> bool:
    """Whether the coordinate of a joint is an angle."""
    return _type(robot, joint) != "prismatic"


def is_endless(robot: eurdf.Robot, joint: str) -> bool:
    """Whether a joint turns without stops."""
    return _type(robot, joint) == "continuous"


def _type(robot: eurdf.Robot, joint: str) -> str:
    return next(found.type.value for found in robot.mechanism.joints if found.name == joint)


def shown(coordinate: float, angular: bool) -> str:
    """A coordinate (rad or m) for people."""
    return f"{math.degrees(coordinate):.1f}°" if angular else f"{coordinate * 1e3:.1f} mm"
