"""Motors and G at many positions of the joints: an array map in NumPy, torch and JAX beside `eurdf.batch`, per pose.

Positions are random ones of the workspace; those of Kangaroo's three joints are within 0.5 rad of zero. The other way
is `eurdf.batch.forward_kinematics` from the assembled pose, then `eurdf.transmission` at what it finds. All run in
turns, in double precision, on one thread; JAX has compiled its function before, which takes minutes for three joints:
it is left out there. So is a namespace that is not installed.
"""

from __future__ import annotations

import importlib
import os
from collections.abc import Callable, Iterator
from functools import partial
from typing import Any

import numpy as np

import eurdf
from benchmarks.interleaved import least_times
from benchmarks.table import Goal, Table, duration

_ROBOTS = {
    "unitree_g1_ankle": ("free_pitch", "free_roll"),
    "tesla_optimus_ankle": ("free_pitch", "free_roll"),
    "kangaroo_leg": ("free_knee", "free_ankle_y", "free_ankle_x"),
}
_SIZES = (4_096, 100_000)
_GOAL = Goal(0.33)


def tables() -> Iterator[Table]:
    """One table, with a row for each robot and size."""
    functions = _namespaces()
    columns = (
        "robot",
        "poses",
        "`eurdf.batch`",
        *(each for name in functions for each in (name, _GOAL.of(f"{name}: ratio"))),
    )
    rows = [_row(name, size, functions) for name in _ROBOTS for size in _SIZES]
    yield Table(columns, rows, "Motors and G, per pose")


def _namespaces() -> dict[str, Callable[[Any, np.ndarray], Callable[[], object]]]:
    """By the name of a namespace what makes a call of a prepared transmission at positions (N, nJ)."""
    os.environ.setdefault("XLA_FLAGS", "--xla_cpu_multi_thread_eigen=false intra_op_parallelism_threads=1")
    found: dict[str, Callable[[Any, np.ndarray], Callable[[], object]]] = {
        "NumPy": lambda prepared, positions: partial(prepared.array_map(np).at_joints, positions)
    }
    for name, make in (("torch", _torch), ("jax", _jax)):
        try:
            found[name] = partial(make, importlib.import_module(name))
        except ImportError:
            continue
    return found


def _torch(torch: Any, prepared: Any, positions: np.ndarray) -> Callable[[], object]:
    torch.set_num_threads(1)
    return partial(prepared.array_map(torch).at_joints, torch.asarray(positions))


def _jax(jax: Any, prepared: Any, positions: np.ndarray) -> Callable[[], object]:
    jax.config.update("jax_enable_x64", True)
    call = jax.jit(prepared.array_map(importlib.import_module("jax.numpy")).at_joints)
    given = jax.numpy.asarray(positions)
    return lambda: jax.block_until_ready(call(given))


def _row(name: str, size: int, functions: dict[str, Callable[..., Callable[[], object]]]) -> tuple[str, ...]:
    robot, joints = eurdf.load(name, geometry=False), _ROBOTS[name]
    ranges = dict.fromkeys(joints, (-0.5, 0.5)) if len(joints) > 2 else {}
    prepared = eurdf.transmissions.prepare_transmission(robot, joints, ranges=ranges)
    space = eurdf.transmissions.workspace(robot, joints, grid=13 if len(joints) < 3 else 7, ranges=ranges)
    positions = np.random.default_rng(0).choice(space.positions, size)
    calls: list[Callable[[], object]] = [partial(_by_batch, robot, joints, positions, space.first)]
    measured = [each for each in functions if each != "jax" or len(joints) < 3]
    calls += [functions[each](prepared, positions) for each in measured]
    by_batch, *times = least_times(calls, 3 if size == min(_SIZES) else 1)
    cells = dict(zip(measured, times, strict=True))
    shown = [
        (duration(cells[each] / size), _GOAL.cell(cells[each], by_batch)) if each in cells else ("-", "-")
        for each in functions
    ]
    return name, f"{size:,}", duration(by_batch / size), *(cell for pair in shown for cell in pair)


def _by_batch(robot: eurdf.Robot, joints: tuple[str, ...], positions: np.ndarray, q: np.ndarray) -> object:
    given = dict(zip(joints, positions.T, strict=True))
    return eurdf.transmission(robot, joints, eurdf.batch.forward_kinematics(robot, given, q).q)
