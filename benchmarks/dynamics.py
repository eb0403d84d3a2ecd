"""`eurdf.forward_dynamics` against `pin.constraintDynamics`, and `eurdf.inverse_dynamics` against plain NumPy.

Both forward dynamics take motor torques and return the acceleration and the forces of the closures.
`pin.constraintDynamics` runs to 1e-14 with μ = 1e-8, its memory made beforehand; it judges neither ranks nor its
solution. The plain inverse dynamics take Pinocchio's Jacobian and bias, a basis of the free motions from a singular
value decomposition of K, and pseudoinverses; they check nothing. States are twenty closed ones along a path.

In a chain of 100 four-bars, a `pin.Data` would take 1.7 GB. There the peer is `mj_forward` of MuJoCo, whose closures
are soft (`connect`); it reads no XML that is nested as deeply as a chain of 1,000. Memory is what the first call adds
to the process.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from functools import partial
from typing import Any

import mujoco
import numpy as np
import numpy.typing as npt
import pinocchio as pin

import eurdf
from benchmarks.interleaved import least_times, peak_memory
from benchmarks.mujoco_model import move, mujoco_model
from benchmarks.robots import CHAINS, ROBOTS, chain, chains, robot_called
from benchmarks.table import Table, duration, ratio

Vector = npt.NDArray[np.float64]


# Of four-bars in series: MuJoCo reads no XML that is nested deeper.
_MOST_NESTED = 100


def states(robot: eurdf.Robot, count: int = 20) -> list[tuple[Vector, Vector]]:
    """Closed states (nq,) and (nv,), each 2e-3 rad or m from the one before."""
    q, random = eurdf.assemble(robot).q, np.random.default_rng(0)
    along, found = eurdf.project_velocity(robot, q, random.normal(size=robot.model.nv)), []
    along /= np.abs(along).max()
    for _ in range(count):
        along = eurdf.project_velocity(robot, q, along)
        found.append((q, along))
        q = eurdf.assemble(robot, pin.integrate(robot.model, q, 2e-3 * along)).q
    return found


class Peers:
    """The same by Pinocchio and NumPy, which are given the force of the springs: Pinocchio knows none."""

    def __init__(self, robot: eurdf.Robot) -> None:
        self._model, self._data = robot.model, robot.model.createData()
        self._models, self._datas = pin.StdVec_RigidConstraintModel(), pin.StdVec_RigidConstraintData()
        for constraint_model in robot.constraint_models:
            self._models.append(constraint_model)
            self._datas.append(constraint_model.createData())
        self._each = list(zip(robot.constraint_models, self._datas, strict=True))
        self._settings = pin.ProximalSettings(1e-14, 1e-14, 1e-8, 50)
        self._S = robot.actuation.selection
        pin.initConstraintDynamics(self._model, self._data, self._models, self._datas)

    def forward(self, q: Vector, v: Vector, u: Vector, passive: Vector) -> tuple[Vector, Vector]:
        """Acceleration (nv,) and λ (nc,)."""
        model, data = self._model, self._data
        tau = self._S @ u + passive
        a = pin.constraintDynamics(model, data, q, v, tau, self._models, self._datas, self._settings)
        return np.array(a), -data.lambda_c

    def inverse(self, q: Vector, v: Vector, a: Vector, passive: Vector) -> tuple[Vector, Vector]:
        """Motor torques (nu,) and λ (nc,)."""
        model, data = self._model, self._data
        required = np.array(pin.rnea(model, data, q, v, a)) - passive
        pin.computeJointJacobians(model, data, q)
        for constraint_model, constraint_data in self._each:
            constraint_model.calc(model, data, constraint_data)
        K = -pin.getConstraintsJacobian(model, data, self._models, self._datas)
        _, values, right = np.linalg.svd(K)
        free = right[int(np.count_nonzero(values > 1e-9 * values[0])) :]
        u = np.linalg.pinv(free @ self._S) @ (free @ required)
        return u, np.linalg.pinv(K.T) @ (required - self._S @ u)


def each(function: Callable[..., Any], arguments: list[tuple[Any, ...]]) -> None:
    """Call the function with all of these arguments, one after the other."""
    for given in arguments:
        function(*given)


def tables() -> Iterator[Table]:
    """Of forward dynamics, inverse dynamics and chains."""
    forward, inverse = zip(*[_rows(name) for name in (*ROBOTS, "five_bar", "four_bar", chains()[0])], strict=True)
    columns = ("robot", "nv", "eurdf, with `data=`", "pin", "ratio", "without `data=`", "ratio to with")
    yield Table(columns, forward, "Forward dynamics")
    yield Table(("robot", "nv", "eurdf", "NumPy", "ratio"), inverse, "Inverse dynamics")
    columns = ("chain of N four-bars", "nv", "first call", "later", "MuJoCo", "ratio", "memory")
    yield Table(columns, [_chain_row(count) for count in CHAINS], "Forward dynamics of chains")


def _rows(name: str) -> tuple[tuple[str, ...], tuple[str, ...]]:
    robot = robot_called(name)
    peers, data, u = Peers(robot), robot.model.createData(), np.ones(len(robot.actuation.idx_v))
    given = states(robot)
    motions, driven, moved = [], [], []
    for q, v in given:
        passive, a = eurdf.springs.spring_force(robot, q), eurdf.forward_dynamics(robot, q, v, u).a
        motions.append((robot, q, v, a))
        driven.append((q, v, u, passive))
        moved.append((q, v, a, passive))
        np.testing.assert_allclose(a, peers.forward(*driven[-1])[0], atol=1e-9 * np.abs(a).max())
    calls = (
        (lambda q, v: eurdf.forward_dynamics(robot, q, v, u, data=data), given),
        (lambda q, v: eurdf.forward_dynamics(robot, q, v, u), given),
        (peers.forward, driven),
        (eurdf.inverse_dynamics, motions),
        (peers.inverse, moved),
    )
    times = least_times([partial(each, *call) for call in calls], 60)
    ours, alone, pinocchio, inverse, plain = (taken / len(given) for taken in times)
    head = name, str(robot.model.nv)
    forward = duration(ours), duration(pinocchio), ratio(ours, pinocchio), duration(alone), ratio(alone, ours)
    return (*head, *forward), (*head, duration(inverse), duration(plain), ratio(inverse, plain))


def _chain_row(count: int) -> tuple[str, ...]:
    robot = chain(count)
    q = eurdf.assemble(robot).q
    v = eurdf.project_velocity(robot, q, np.ones(robot.model.nv))
    before, begin = peak_memory(), time.process_time()
    eurdf.forward_dynamics(robot, q, v)
    first, grown = time.process_time() - begin, peak_memory() - before
    calls = [partial(eurdf.forward_dynamics, robot, q, v)]
    if count <= _MOST_NESTED:
        model, data = mujoco_model(robot, 1e-3)
        move(robot, model, data, q, v)
        calls.append(partial(mujoco.mj_forward, model, data))
    later, *peer = least_times(calls, 5)
    shown = str(count), str(robot.model.nv), duration(first), duration(later)
    return *shown, *([duration(peer[0]), ratio(later, peer[0])] if peer else ["-", "-"]), f"{grown:.0f} MB"
