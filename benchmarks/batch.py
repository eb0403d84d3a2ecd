"""`eurdf.batch` against calls of the functions for one element, in time of the processor for each element.

Motors are within 0.05 rad or 1 mm of the assembled configuration; tolerances are the default ones of both. Batches have
10,000 elements, or 1,000 for chains of four-bars; of the single functions 40 calls are measured. Both run in turns, and
the least time of three counts.
"""

from __future__ import annotations

import os
import time
from collections.abc import Callable

import numpy as np
import pinocchio as pin

import eurdf
from benchmarks.loops import four_bars

ROBOTS = ("digit_leg", "digit_2legs", "kangaroo_leg", "stewart_platform", "cassie_leg")
CHAINS = (10, 100)
ELEMENTS = 10_000
ELEMENTS_OF_A_CHAIN = 1_000
SINGLES = 40
TURNS = 3


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


def rows(robot: eurdf.Robot, count: int) -> None:
    """Print the rows of one robot."""
    q0 = eurdf.assemble(robot).q
    q = configurations(robot, q0, count)
    values = q[:, robot.actuation.idx_q]
    found = eurdf.batch.forward_kinematics(robot, values, q0)
    closable = np.flatnonzero(found.converged)
    few = closable[:SINGLES]
    print(f"  {len(closable)} of {count} closable")
    row(
        "forward_kinematics",
        lambda: eurdf.batch.forward_kinematics(robot, values, q0),
        count,
        lambda: [eurdf.forward_kinematics(robot, each, q0) for each in values[few]],
        len(few),
    )
    row(
        "residual_and_jacobian",
        lambda: eurdf.batch.residual_and_jacobian(robot, q),
        count,
        lambda: [eurdf.residual_and_jacobian(robot, each) for each in q[:SINGLES]],
        SINGLES,
    )
    link, data, places = robot.mechanism.bodies[-1].name, robot.model.createData(), []
    index = robot.model.getFrameId(link, pin.FrameType.BODY)
    for each in found.q[closable[: count // 10]]:
        pin.framesForwardKinematics(robot.model, data, each)
        places.append(np.array(data.oMf[index].translation))
    row(
        "inverse_kinematics",
        lambda: eurdf.batch.inverse_kinematics(robot, {link: np.array(places)}, q0),
        len(places),
        lambda: [eurdf.inverse_kinematics(robot, {link: place}, q0) for place in places[: SINGLES // 4]],
        len(places[: SINGLES // 4]),
    )


def row(name: str, batch: Callable[[], object], count: int, singles: Callable[[], object], calls: int) -> None:
    """Print the time of an element in a batch, and of a call for one."""
    together, apart = least(batch, singles)
    each, one = together / count, apart / calls
    print(f"  {name:24} {each * 1e6:10.1f} µs {one * 1e6:10.1f} µs {one / each:8.1f}x")


def main() -> None:
    """Print a table."""
    print(f"{'':26} {'in a batch':>13} {'one call':>13} {'ratio':>9}   ({os.cpu_count()} processors, 1 thread)")
    for name in ROBOTS:
        print(name)
        rows(eurdf.load(name, geometry=False), ELEMENTS)
    for count in CHAINS:
        print(f"{count} four-bars in series")
        robot = four_bars(count, in_series=True)
        q = np.tile([0.9, -0.7, 1.9], count)
        start = eurdf.assemble(robot, q).q
        motors = start + np.random.default_rng(0).uniform(-0.05, 0.05, (ELEMENTS_OF_A_CHAIN, len(start)))
        values = motors[:, robot.actuation.idx_q]
        row(
            "forward_kinematics",
            lambda r=robot, v=values, s=start: eurdf.batch.forward_kinematics(r, v, s),  # type: ignore[misc]
            len(values),
            lambda r=robot, v=values, s=start: [eurdf.forward_kinematics(r, each, s) for each in v[:4]],  # type: ignore[misc]
            4,
        )
