"""`eurdf.inverse_kinematics` of one pose of a frame against plain Newton on Pinocchio, Pink, mink and placo.

The frame's target is its pose with the motors 0.05 rad or 1 mm from an assembled configuration, where all start.

Each ends where the loops are closed to 1e-10 and the frame is within 1e-8 (m, rad), or where it gets no nearer: the
errors at its end are in the second table, and one that ends above 1e-6 is not compared. Only `eurdf` respects the joint
limits and checks that it stays on the branch; the columns without limits compare like with like. A dash is where a
solver cannot do a robot.

`eurdf` takes about as many steps as plain Newton, and evaluates only the loops that carry the frame, so that it takes
less time for large robots. For a small one, the calls of Pinocchio and LAPACK in these steps take about a third of the
time of plain Newton, and the checks of arguments and limits, with the result, a sixth. The rest is Python: one code
evaluates each kind of closure, for one configuration and for many. Where Newton's steps do not stay on the branch
beyond doubt, as near a singular configuration (`digit_leg`, some targets of `cassie_leg`), the search of `eurdf` takes
over.

Pink and mink have the loops as equality constraints of their quadratic program, or, where that has no solution
(redundant rows), as a task of cost 100; they take the whole step that it says. Pink has the rows of plain Newton
(`benchmarks/plain_newton.py`), mink those of the MJCF. placo runs in an environment of its own, whose Python
`EURDF_PLACO_PYTHON` names, on robots of revolute and prismatic joints with 3d and 6d closures, as it has no others.

Times are medians over targets; the frame is that of the link that the motors move most, in a chain the last one.
"""

from __future__ import annotations

import statistics
import sys
from collections.abc import Iterator
from functools import partial
from typing import Any

import numpy as np
import pinocchio as pin

import eurdf
from benchmarks.interleaved import least_times
from benchmarks.inverse_kinematics_peers import PEERS
from benchmarks.nearby import motors_nearby
from benchmarks.placo_peer import placo_time_and_errors
from benchmarks.plain_newton import NotConverged, PlainNewton
from benchmarks.robots import ROBOTS, chains, robot_called
from benchmarks.table import Goal, Table, duration, largest, ratio

COUNT = 4

_NEWTON, _OTHERS = Goal(1.5), Goal(1.0)
_NAMES = ("Pink", "mink")

# Errors at which a solver has solved the same problem, m and rad.
_REACHED = 1e-6


def tables() -> Iterator[Table]:
    """Times and errors of all robots."""
    rows = [_row(name) for name in (*ROBOTS, chains()[0])]
    others = [cell for name in (*_NAMES, "placo") for cell in (name, _OTHERS.of(f"to {name}"))]
    columns = "robot", "frame", "eurdf", "without limits", "Newton", _NEWTON.of("to Newton"), "without limits "
    yield Table((*columns, *others), [times for times, _ in rows], "Times")
    ends = [f"{what}, {name}" for name in ("eurdf", "Newton", *_NAMES, "placo") for what in ("loops", "frame")]
    yield Table(("robot", *ends), [errors for _, errors in rows], "Errors at the end")


def _row(name: str) -> tuple[tuple[str, ...], tuple[str, ...]]:
    robot = robot_called(name)
    newton = PlainNewton(robot)
    q, positions = motors_nearby(robot, newton, COUNT)
    frame = robot.mechanism.bodies[-1].name if name in chains() else most_mobile_link(robot, q)
    index, targets = robot.model.getFrameId(frame, pin.FrameType.BODY), []
    peers = {peer: made for peer in PEERS if (made := _made(peer, robot, newton, frame, q)) is not None}
    times: list[list[float]] = []
    errors: dict[str, list[tuple[float, float]]] = {solver: [] for solver in ("eurdf", "Newton", *_NAMES, "placo")}
    for values in positions:
        try:
            there = eurdf.forward_kinematics(robot, values, q)
            pin.framesForwardKinematics(robot.model, newton.data, there)
            target = pin.SE3(newton.data.oMf[index])
            end = newton.inverse_kinematics(index, target, q)
        except (NotConverged, eurdf.errors.NotClosable):
            continue
        ours = partial(eurdf.inverse_kinematics, robot, {frame: target}, q)
        found = ours()
        if not found.converged:
            continue
        targets.append(target)
        plain: partial[Any] = partial(newton.inverse_kinematics, index, target, q)
        others = [partial(peer.solve, target, q) for peer in peers.values()]
        times.append(least_times([ours, partial(ours, limits=False), plain, *others], seconds=0.15))
        errors["eurdf"].append(newton.errors(index, target, found.q))
        errors["Newton"].append(newton.errors(index, target, end))
        for peer, solver in peers.items():
            errors[peer].append(solver.errors)
    if not times:
        return (name, f"`{frame}`", *["-"] * 11), (name, *["-"] * 10)
    own, free, newtons, *taken = (statistics.median(column) for column in zip(*times, strict=True))
    placo, errors["placo"] = placo_time_and_errors(robot, frame, targets, q)
    seconds: dict[str, float | None] = {**dict.fromkeys(_NAMES), **dict(zip(peers, taken, strict=True)), "placo": placo}
    cells = [duration(own), duration(free), duration(newtons), _NEWTON.cell(own, newtons), ratio(free, newtons)]
    for peer, other in seconds.items():
        reached = max(map(max, errors[peer]), default=0.0) <= _REACHED
        cells += [duration(other), _OTHERS.cell(own, other if reached else None)]
    ends = [largest(column) for each in errors.values() for column in (zip(*each, strict=True) if each else ((), ()))]
    return (name, f"`{frame}`", *cells), (name, *ends)


def _made(peer: str, robot: eurdf.Robot, newton: PlainNewton, frame: str, q: np.ndarray) -> Any:
    """A peer, or None where it cannot do the robot."""
    try:
        made = PEERS[peer](robot, newton, frame)
        made.solve(pin.SE3.Identity(), q)
    except (ValueError, ArithmeticError, RuntimeError) as reason:
        print(f"{peer} cannot do {robot.model.name}: {reason}", file=sys.stderr)
        return None
    return made


def most_mobile_link(robot: eurdf.Robot, q: np.ndarray) -> str:
    """The link with a mass that the actuators move most; an export has the others as frames alone."""
    links = [body.name for body in robot.mechanism.bodies if body.inertia is not None and body.inertia.mass]
    jacobians = [eurdf.actuated_jacobian(robot, name, q)[:3] for name in links]
    return links[int(np.argmax([np.linalg.norm(J, "nuc") for J in jacobians]))]
