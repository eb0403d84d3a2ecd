"""`eurdf.batch`, in time of the processor for each element, at several sizes and against calls for one element.

Motors are within 0.05 rad or 1 mm of the assembled configuration; tolerances are the default ones of both. A batch
of 100,000 elements runs once; it is left out if that would take more than a minute. Smaller batches, and 40 calls for
one element, run twice, and the shorter time counts. Residual and K are those of 10,000 elements, inverse kinematics
those of 1,000 places of a link, and of 10 calls. An earlier version is another process, with the same motor positions;
the goal is that of the median.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from functools import partial

import numpy as np
import pinocchio as pin

import eurdf
from benchmarks.earlier import earlier_forward_kinematics
from benchmarks.robots import ROBOTS, chains, robot_called
from benchmarks.table import Goal, Table, duration, ratio

SIZES = (1_000, 4_096, 10_000, 100_000)
ELEMENTS = 10_000
SINGLES = 40
TURNS = 2

_SMALL, _SMALLER = Goal(1.5), Goal(0.67)
_MOST_SECONDS = 60.0  # that a batch may take


def least(function: Callable[[], object], turns: int = TURNS) -> float:
    """Least time of the processor of a function, s."""
    times = []
    for _ in range(turns):
        start = time.process_time()
        function()
        times.append(time.process_time() - start)
    return min(times)


def configurations(robot: eurdf.Robot, q0: np.ndarray, count: int) -> np.ndarray:
    """Configurations (count, nq) whose motors are within 0.05 rad or 1 mm of q0; the loops are open."""
    random, v = np.random.default_rng(0), np.zeros((count, robot.model.nv))
    translates = np.zeros(robot.model.nv, dtype=bool)
    for joint, velocities in enumerate(robot.tree.own_velocities):
        translates[list(velocities)] = robot.tree.translates(joint)[: len(velocities)] if len(velocities) else False
    spread = np.where(translates, 0.001, 0.05)[robot.actuation.idx_v]
    v[:, robot.actuation.idx_v] = random.uniform(-1.0, 1.0, (count, len(spread))) * spread
    return np.array([pin.integrate(robot.model, q0, each) for each in v])


def tables() -> Iterator[Table]:
    """Of forward kinematics by sizes, and of the other functions."""
    sizes = tuple(f"{size:,}" for size in SIZES)
    columns = ("robot", "nv", *sizes, _SMALL.of("4,096 to 100,000"), "one call", "one call to 10,000")
    yield Table(columns, [_forward_row(name, SIZES) for name in ROBOTS], "Forward kinematics, per element")
    if rows := [row for name in ROBOTS for row in _earlier_rows(name)]:
        columns = ("robot", "10,000", "earlier version", "its commit", _SMALLER.of("ratio"))
        yield Table(columns, rows, "The same against an earlier version")
    rows = [_forward_row(name, SIZES[:1]) for name in chains()[:1]]
    yield Table(("chain of four-bars", "nv", sizes[0], "one call", "one call to it"), rows, "The same, of chains")
    columns = ("robot", "function", "per element", "one call", "one call to element")
    yield Table(columns, [row for name in ROBOTS for row in _rows(name)], "Other functions, per element")


def _forward_row(name: str, sizes: tuple[int, ...]) -> tuple[str, ...]:
    robot = robot_called(name)
    q0 = eurdf.assemble(robot).q
    values = configurations(robot, q0, max(sizes))[:, robot.actuation.idx_q]
    move = eurdf.batch.forward_kinematics
    closable = np.flatnonzero(move(robot, values[:SINGLES], q0).converged)
    each: dict[int, float] = {}
    for size in sizes:
        if size * min(each.values(), default=0.0) < _MOST_SECONDS:
            turns = 1 if size > ELEMENTS else TURNS
            each[size] = least(partial(move, robot, values[:size], q0), turns) / size
    shown = [duration(each.get(size)) for size in sizes]
    if len(sizes) > 1:
        shown.append(_SMALL.cell(each[4_096], each.get(100_000)))
    if not len(closable):
        return name, str(robot.model.nv), *shown, "-", "-"
    one = least(lambda: [eurdf.forward_kinematics(robot, values[index], q0) for index in closable]) / len(closable)
    return (
        name,
        str(robot.model.nv),
        *shown,
        duration(one),
        ratio(one, each[max(size for size in each if size <= ELEMENTS)]),
    )


def _earlier_rows(name: str) -> Iterator[tuple[str, ...]]:
    robot = robot_called(name)
    q0 = eurdf.assemble(robot).q
    values = configurations(robot, q0, ELEMENTS)[:, robot.actuation.idx_q]
    earlier = earlier_forward_kinematics(name, values, q0)
    if earlier is not None:
        commit, peer = earlier
        now = least(partial(eurdf.batch.forward_kinematics, robot, values, q0))
        yield name, duration(now / ELEMENTS), duration(peer / ELEMENTS), commit, _SMALLER.cell(now, peer)


def _rows(name: str) -> Iterator[tuple[str, ...]]:
    robot = robot_called(name)
    q0 = eurdf.assemble(robot).q
    q = configurations(robot, q0, ELEMENTS)
    one = least(lambda: [eurdf.residual_and_jacobian(robot, each) for each in q[:SINGLES]]) / SINGLES
    each = least(partial(eurdf.batch.residual_and_jacobian, robot, q)) / ELEMENTS
    yield name, "`residual_and_jacobian`", duration(each), duration(one), ratio(one, each)
    found = eurdf.batch.forward_kinematics(robot, q[: ELEMENTS // 10, robot.actuation.idx_q], q0)
    link, data, places = robot.mechanism.bodies[-1].name, robot.model.createData(), []
    index = robot.model.getFrameId(link, pin.FrameType.BODY)
    for closed in found.q[found.converged]:
        pin.framesForwardKinematics(robot.model, data, closed)
        places.append(np.array(data.oMf[index].translation))
    few = places[: SINGLES // 4]
    if few:
        each = least(partial(eurdf.batch.inverse_kinematics, robot, {link: np.array(places)}, q0)) / len(places)
        one = least(lambda: [eurdf.inverse_kinematics(robot, {link: place}, q0) for place in few]) / len(few)
        yield name, "`inverse_kinematics`", duration(each), duration(one), ratio(one, each)
