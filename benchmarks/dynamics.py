"""`eurdf.forward_dynamics` against `pin.constraintDynamics`, and `eurdf.inverse_dynamics` against plain NumPy.

Both forward dynamics take motor torques and return the acceleration and the forces of the closures.
`pin.constraintDynamics` runs to 1e-14 with μ = 1e-8, its memory made beforehand; it judges neither ranks nor its
solution. The plain inverse dynamics take Pinocchio's Jacobian and bias, a basis of the free motions from a singular
value decomposition of K, and pseudoinverses; they check nothing. States are twenty closed ones along a path. Then the
time and memory of 100 four-bars, where a `pin.Data` would take 1.7 GB.
"""

from __future__ import annotations

import resource
import time
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
import numpy.typing as npt
import pinocchio as pin

import eurdf
from benchmarks.interleaved import least_times
from benchmarks.loops import four_bars
from eurdf.mechanism.body import Inertia
from eurdf.mechanism.pose import Pose
from eurdf.pinocchio.robot import build_robot

Vector = npt.NDArray[np.float64]

ROBOTS = ("digit_leg", "digit_2legs", "kangaroo_leg", "stewart_platform", "cassie_leg", "five_bar", "four_bar")


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
    """The same by Pinocchio and NumPy."""

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

    def forward(self, q: Vector, v: Vector, u: Vector) -> tuple[Vector, Vector]:
        """Acceleration (nv,) and λ (nc,)."""
        model, data = self._model, self._data
        a = pin.constraintDynamics(model, data, q, v, self._S @ u, self._models, self._datas, self._settings)
        return np.array(a), -data.lambda_c

    def inverse(self, q: Vector, v: Vector, a: Vector) -> tuple[Vector, Vector]:
        """Motor torques (nu,) and λ (nc,)."""
        model, data = self._model, self._data
        required = np.array(pin.rnea(model, data, q, v, a))
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


def compare(name: str) -> None:
    """Print a row."""
    robot = eurdf.load(name, geometry=False)
    peers, data, u = Peers(robot), robot.model.createData(), np.ones(len(robot.actuation.idx_v))
    given = states(robot)
    motions = []
    for q, v in given:
        a = eurdf.forward_dynamics(robot, q, v, u).a
        np.testing.assert_allclose(a, peers.forward(q, v, u)[0], atol=1e-9 * np.abs(a).max())
        motions.append((robot, q, v, a))
    calls = (
        (lambda q, v: eurdf.forward_dynamics(robot, q, v, u, data=data), given),
        (lambda q, v: eurdf.forward_dynamics(robot, q, v, u), given),
        (peers.forward, [(*state, u) for state in given]),
        (eurdf.inverse_dynamics, motions),
        (peers.inverse, [motion[1:] for motion in motions]),
    )
    times = least_times([partial(each, *call) for call in calls], 60)
    ours, alone, pinocchio, inverse, plain = (taken / len(given) for taken in times)
    print(
        f"{name:18} {robot.model.nv:4} {ours * 1e6:8.0f} µs {pinocchio * 1e6:6.0f} µs {ours / pinocchio:6.1f} "
        f"{alone / ours:10.2f}   {inverse * 1e6:8.0f} µs {plain * 1e6:6.0f} µs {inverse / plain:6.1f}"
    )


def many_loops(count: int, in_series: bool) -> None:
    """Print a row."""
    mechanism = four_bars(count, in_series).mechanism
    inertia = Inertia(1.0, Pose((0.5, 0.0, 0.0)), (0.1, 0.0, 0.0, 0.1, 0.0, 0.1))
    bodies = tuple(replace(body, inertia=inertia) for body in mechanism.bodies)
    robot = build_robot(replace(mechanism, bodies=bodies), geometry=False)
    q = eurdf.assemble(robot, np.tile([0.9, -0.7, 1.9], count)).q
    v = eurdf.project_velocity(robot, q, np.ones(robot.model.nv))
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    begin = time.process_time()
    eurdf.forward_dynamics(robot, q, v)
    first = time.process_time() - begin
    (later,) = least_times([lambda: eurdf.forward_dynamics(robot, q, v)], 5)
    more = (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before) / 1024.0
    kind = "in series" if in_series else "side by side"
    print(f"{count:4} {kind:13} {robot.model.nv:5} {first * 1e3:8.1f} ms {later * 1e3:8.1f} ms {more:8.0f} MB")


def main() -> None:
    """Print tables, of the least processor times."""
    print("four-bars               nv      first      later   memory")
    for in_series in (True, False):
        many_loops(100, in_series)
    head = f"{'robot':18} {'nv':>4} {'forward':>11} {'pin':>9} {'ratio':>6} {'no data':>10}"
    print(f"\n{head}   {'inverse':>11} {'NumPy':>9} {'ratio':>6}")
    for name in ROBOTS:
        compare(name)
