"""The rules on the motion of a robot: closed when assembled, massive, and each actuator moves through its range."""

from __future__ import annotations

import math

import numpy as np
import pinocchio as pin

import eurdf
from eurdf.array import Matrix
from eurdf.kinematics.sweep import MotionPath, Sweep
from robots.quality.candidate import Candidate

_ASSEMBLED = 1e-12  # largest row of the residual at the assembled configuration, m or rad
_CLOSED = 1e-10  # largest row of the residual on paths, m or rad

# M must be positive definite with this margin, relative to its diagonal: far above rounding, and far below the effect
# of a light link between heavy ones.
_MARGIN = 1e-9
_EVERY = 10  # M changes slowly: check it at every tenth configuration of a path


def is_assembled(candidate: Candidate) -> list[str]:
    """The loops are closed to 1e-12 at the configuration 'assembled'."""
    q = candidate.assembled
    if q is None:
        return ["the configuration 'assembled' is missing"]
    largest = float(np.abs(eurdf.residual(candidate.robot, q)).max(initial=0.0))
    return [f"a loop is open by {largest:.1e} (m or rad) at 'assembled'"] if not largest <= _ASSEMBLED else []


def has_mass(candidate: Candidate) -> list[str]:
    """Every moving body has mass, and M(q) is positive definite at 'assembled' and on all paths."""
    robot, model = candidate.robot, candidate.robot.model
    carried = set(range(1, model.njoints)) - robot.tree.in_series.keys()
    massless = [
        f"the body of joint '{model.names[joint]}' has no mass"
        for joint in sorted(carried)
        if not model.inertias[joint].mass > 0.0
    ]
    if massless:
        return massless
    data = model.createData()
    places = {"at 'assembled'": [pin.neutral(model) if candidate.assembled is None else candidate.assembled]}
    if candidate.closes:
        for actuator, found in candidate.sweeps.items():
            paths = (found.lower, found.upper) if isinstance(found, Sweep) else ()
            places[f"on the path of '{actuator}'"] = [q for path in paths for q in path.configurations[::_EVERY]]
    for place, configurations in places.items():
        if not all(_is_positive_definite(np.array(pin.crba(model, data, q))) for q in configurations):
            return [f"the mass matrix is not positive definite {place}"]
    return []


def _is_positive_definite(M: Matrix) -> bool:
    """Whether M (nv, nv), given by its upper triangle, is positive definite with a margin relative to its diagonal."""
    M = np.triu(M) + np.triu(M, 1).T
    try:
        np.linalg.cholesky(M - _MARGIN * np.diag(np.diag(M)))
    except np.linalg.LinAlgError:
        return False
    return bool((np.diag(M) > 0.0).all())


def reaches_limits(candidate: Candidate) -> list[str] | None:
    """Each actuator reaches its own limit, or that of a passive joint, on one branch; None if loops are open.

    An actuator without limits makes a full turn. So the stated limits exclude what the linkage does not allow.
    """
    if not candidate.closes:
        return None
    errors = []
    for actuator, found in candidate.sweeps.items():
        if isinstance(found, str):
            errors.append(found)
            continue
        angular = is_angular(candidate.robot, actuator)
        for path, bound in zip((found.lower, found.upper), found.bounds, strict=True):
            errors += [f"'{actuator}' {error}" for error in _errors(path, bound, angular)]
        if found.periodic is False:
            errors.append(f"'{actuator}' is not periodic: a full turn leads to a different configuration")
        if is_endless(candidate.robot, actuator):
            errors += [
                f"'{actuator}' has no limits, but '{path.joint}' reaches its own at {shown(path.reached, angular)}"
                for path in (found.lower, found.upper)
                if path.end == "passive limit"
            ]
    return errors


def _errors(path: MotionPath, bound: float, angular: bool) -> list[str]:
    errors = []
    if path.end == "dead point":
        errors.append(
            f"has a dead point at {shown(path.reached, angular)}, before its limit at {shown(bound, angular)}"
        )
    if not path.residual <= _CLOSED:
        errors.append(f"opens a loop by {path.residual:.1e} (m or rad) before {shown(path.reached, angular)}")
    return errors


def is_angular(robot: eurdf.Robot, joint: str) -> bool:
    """Whether the coordinate of a joint is an angle."""
    return _type(robot, joint) != "prismatic"


def is_endless(robot: eurdf.Robot, joint: str) -> bool:
    """Whether a joint turns without limits."""
    return _type(robot, joint) == "continuous"


def _type(robot: eurdf.Robot, joint: str) -> str:
    return next(str(found.type) for found in robot.mechanism.joints if found.name == joint)


def shown(coordinate: float, angular: bool) -> str:
    """A coordinate (rad or m) as text, in degrees or mm."""
    return f"{math.degrees(coordinate):.1f}°" if angular else f"{coordinate * 1e3:.1f} mm"
