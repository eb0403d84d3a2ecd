"""`eurdf.batch` against calls of the functions for one element, in time of the processor for each element.

Motors are within 0.05 rad or 1 mm of the assembled configuration; tolerances are the default ones of both. Batches have
10,000 elements, 1,000 for inverse kinematics and chains of four-bars; of the single functions 40 calls are measured.
Both run in turns, and the least time of three counts. The last column says how many times as long a call takes.

The second table has forward kinematics of all robots of the collection for several sizes of a batch: the mean time of
an element, and the ratio of that in a batch of 4,096 to that in one of 100,000. What takes over a minute is left out.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator

import numpy as np
import pinocchio as pin

import eurdf
from benchmarks.robots import ROBOTS, chains, robot_called
from benchmarks.table import Table, duration, ratio

ELEMENTS = 10_000
ELEMENTS_OF_A_CHAIN = 1_000
SINGLES = 40
TURNS = 3
SIZES = (100, 1_000, 4_096, 10_000, 100_000)
#: So many elements of the second table differ; larger batches repeat them.
DIFFERENT = 4_096
LONGEST = 60.0  # s


def least(one: Callable[[], object], other: Callable[[], object]) -> tuple[float, float]:
    """Least times of the processor of two functions that run in turns, s."""
    times: tuple[list[float], list[float]] = ([], [])
    for _ in range(TURNS):
        for function, taken in zip((one, other), times, strict=True):
            start = time.process_time()
            function()
            taken.append(time.process_time() - start)
    return min(times[0]), min(times[1])


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
    """Of single robots and of chains; then of all robots by the size of the batch."""
    columns = ("robot", "function", "elements", "time", "per element", "one call", "one call to element")
    yield Table(columns, [row for name in (*ROBOTS, *chains()[:2]) for row in _rows(name)])
    heads = ("robot", *(f"{size:,}" for size in SIZES), "4,096 to 100,000")
    yield Table(heads, [_sizes(name) for name in eurdf.collection_names()], "Forward kinematics, time of an element")


def _sizes(name: str) -> tuple[str, ...]:
    robot = robot_called(name)
    q0 = eurdf.assemble(robot).q
    different = configurations(robot, q0, DIFFERENT)[:, robot.actuation.idx_q]
    taken: dict[int, float] = {}
    for size in SIZES:
        if size * min(taken.values(), default=0.0) > LONGEST:
            break
        values = np.resize(different, (size, different.shape[1]))
        eurdf.batch.forward_kinematics(robot, values[:1], q0)
        start, calls = time.process_time(), 0
        while time.process_time() - start < 0.3:
            eurdf.batch.forward_kinematics(robot, values, q0)
            calls += 1
        taken[size] = (time.process_time() - start) / calls / size
    cells = [duration(taken[size]) if size in taken else "-" for size in SIZES]
    return name, *cells, ratio(taken[4_096], taken[100_000]) if len(taken) == len(SIZES) else "-"


def _rows(name: str) -> Iterator[tuple[str, ...]]:
    robot = robot_called(name)
    count = ELEMENTS_OF_A_CHAIN if "four-bars" in name else ELEMENTS
    q0 = eurdf.assemble(robot).q
    q = configurations(robot, q0, count)
    values = q[:, robot.actuation.idx_q]
    found = eurdf.batch.forward_kinematics(robot, values, q0)
    closable = np.flatnonzero(found.converged)
    few = closable[:SINGLES]
    yield (
        name,
        *_row(
            "forward_kinematics",
            lambda: eurdf.batch.forward_kinematics(robot, values, q0),
            count,
            lambda: [eurdf.forward_kinematics(robot, each, q0) for each in values[few]],
            len(few),
        ),
    )
    if "four-bars" in name:
        return
    yield (
        name,
        *_row(
            "residual_and_jacobian",
            lambda: eurdf.batch.residual_and_jacobian(robot, q),
            count,
            lambda: [eurdf.residual_and_jacobian(robot, each) for each in q[:SINGLES]],
            SINGLES,
        ),
    )
    link, data, places = robot.mechanism.bodies[-1].name, robot.model.createData(), []
    index = robot.model.getFrameId(link, pin.FrameType.BODY)
    for each in found.q[closable[: count // 10]]:
        pin.framesForwardKinematics(robot.model, data, each)
        places.append(np.array(data.oMf[index].translation))
    yield (
        name,
        *_row(
            "inverse_kinematics",
            lambda: eurdf.batch.inverse_kinematics(robot, {link: np.array(places)}, q0),
            len(places),
            lambda: [eurdf.inverse_kinematics(robot, {link: place}, q0) for place in places[: SINGLES // 4]],
            len(places[: SINGLES // 4]),
        ),
    )


def _row(
    name: str, batch: Callable[[], object], count: int, singles: Callable[[], object], calls: int
) -> tuple[str, ...]:
    together, apart = least(batch, singles)
    each, one = together / count, apart / calls
    return f"`{name}`", str(count), duration(together), duration(each), duration(one), ratio(one, each)
