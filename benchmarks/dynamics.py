"""`eurdf.forward_dynamics` against `pin.constraintDynamics`, and `eurdf.inverse_dynamics` against plain NumPy.

Both forward dynamics take motor torques and return the acceleration and the forces of the closures.
`pin.constraintDynamics` runs to 1e-14 with μ = 1e-8, its memory made beforehand; it judges neither ranks nor its
solution, and has no model of a distance or a coupling. A hinge is two 3d models. The difference is that of the
accelerations, relative to the largest one. The plain inverse dynamics take Pinocchio's Jacobian and bias, a basis of
the free motions from a singular value decomposition of K, and pseudoinverses; they check nothing. States are twenty
closed ones along a path. In bennett the redundant combinations of rows differ from one state to the next, so that each
needs a decomposition of K, 8 µs from Python, to know the rank and the least forces; in most planar loops they do not.

Then robots with hinges, distances and couplings of version 2.1 against the same robots with a 3d closure in place of
each hinge and distance, at the point of frame B, and without their couplings; and Kangaroo's two legs against one leg.
Forward kinematics move the motors by 0.05 rad or 1 mm; a dash is where the loops do not let them, as those of Tello do
not without its couplings.

In a chain of 100 four-bars, a `pin.Data` would take 1.7 GB. There the peer is `mj_forward` of MuJoCo, whose closures
are soft (`connect`); it reads no XML that is nested as deeply as a chain of 1,000. Memory is what the first call adds
to the process.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from functools import partial
from typing import Any

import mujoco
import numpy as np
import numpy.typing as npt
import pinocchio as pin

import eurdf
from benchmarks.interleaved import least_times, peak_memory
from benchmarks.mujoco_model import MuJoCoRobot
from benchmarks.nearby import motors_nearby
from benchmarks.plain_newton import PlainNewton
from benchmarks.robots import CHAINS, ROBOTS, chain, chains, robot_called
from benchmarks.table import Goal, Table, duration, largest, ratio
from eurdf.closures.distance import DistanceClosure
from eurdf.closures.hinge import HingeClosure
from eurdf.closures.point import PointClosure
from eurdf.mechanism.body import Anchor
from eurdf.mechanism.constraint import Closure, Coupling
from eurdf.mechanism.pose import Pose
from eurdf.pinocchio.robot import build_robot

Vector = npt.NDArray[np.float64]

_PIN, _TWIN, _LEGS = Goal(2.0, 25e-6), Goal(3.0), Goal(4.0)
_OF_2_1 = (HingeClosure, DistanceClosure, Coupling)

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

    def __init__(self, robot: eurdf.Robot, gains: tuple[float, float] | None = None) -> None:
        self._model, self._data = robot.model, robot.model.createData()
        self._models, self._datas = pin.StdVec_RigidConstraintModel(), pin.StdVec_RigidConstraintData()
        for constraint_model in robot.constraint_models:
            self._models.append(constraint_model)
            if gains is not None:
                own = self._models[-1].m_baumgarte_parameters
                own.Kp, own.Kd = gains
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

    def derivatives(self, q: Vector, v: Vector, u: Vector, passive: Vector) -> tuple[Vector, Vector, Vector]:
        """The derivatives of the acceleration by q, v and τ, each (nv, nv)."""
        self.forward(q, v, u, passive)
        pin.computeConstraintDynamicsDerivatives(self._model, self._data, self._models, self._datas, self._settings)
        return np.array(self._data.ddq_dq), np.array(self._data.ddq_dv), np.array(self._data.ddq_dtau)

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
    """Of forward dynamics, inverse dynamics, closures of version 2.1, two legs and chains."""
    forward, inverse = zip(*[_rows(name) for name in (*ROBOTS, chains()[0])], strict=True)
    yield Table(("robot", "nv", "eurdf", "pin", _PIN.of("to pin"), "difference"), forward, "Forward dynamics")
    yield Table(("robot", "nv", "eurdf", "NumPy", "ratio"), inverse, "Inverse dynamics")
    with_2_1 = [name for name in ROBOTS if any(kind in _OF_2_1 for kind in map(type, robot_called(name).constraints))]
    yield _against("with 3d", _TWIN, {name: (robot_called(name), in_3d(robot_called(name))) for name in with_2_1})
    yield _against("one leg", _LEGS, {"kangaroo_2legs": (robot_called("kangaroo_2legs"), robot_called("kangaroo_leg"))})
    columns = ("chain of N four-bars", "nv", "first call", "later", "MuJoCo", "ratio", "memory")
    yield Table(columns, [_chain_row(count) for count in CHAINS], "Forward dynamics of chains")


def in_3d(robot: eurdf.Robot) -> eurdf.Robot:
    """The robot with a 3d closure in place of each hinge and distance, and without couplings."""
    data, q = robot.model.createData(), eurdf.assemble(robot).q
    pin.framesForwardKinematics(robot.model, data, q)

    def closure(each: Closure) -> Closure:
        if type(each) not in _OF_2_1:
            return each
        site, body = robot.tree.site(each.b), robot.model.getFrameId(each.a.body, pin.FrameType.BODY)
        point = data.oMf[body].actInv((data.oMi[site.joint] * site.placement).translation)
        return PointClosure(each.name, Anchor(each.a.body, Pose(tuple(point.tolist()))), each.b)

    mechanism = robot.mechanism
    closures = tuple(map(closure, mechanism.closures))
    return build_robot(replace(mechanism, closures=closures, couplings=()), geometry=False)


def _against(peer: str, goal: Goal, pairs: Mapping[str, tuple[eurdf.Robot, eurdf.Robot]]) -> Table:
    """Robots against similar ones, from rest at the assembled configuration."""
    rows = []
    for name, robots in pairs.items():
        cells: list[str] = []
        for calls in zip(*map(_functions, robots), strict=True):
            made = [call for call in calls if call is not None]
            times = iter(least_times(made))
            one, other = (None if call is None else next(times) for call in calls)
            cells += [duration(one), duration(other), "-" if one is None else goal.cell(one, other)]
        rows.append((name, *cells))
    words = ("dynamics", "10 steps", "forward kinematics")
    columns = [head for word in words for head in (word, f"{peer}, {word}", goal.of(f"ratio, {word}"))]
    return Table(("robot", *columns), rows, f"Against the same {peer}")


def _functions(robot: eurdf.Robot) -> Iterator[partial[Any] | None]:
    """Forward dynamics, ten steps and forward kinematics; None where the motors cannot move."""
    q, u = eurdf.assemble(robot).q, np.ones(len(robot.actuation.idx_v))
    yield partial(eurdf.forward_dynamics, robot, q, np.zeros(robot.model.nv), u)
    yield partial(eurdf.simulate, robot, q, duration=10e-3)
    q, positions = motors_nearby(robot, PlainNewton(robot), 1)
    yield partial(eurdf.forward_kinematics, robot, positions[0], q) if positions else None


def _rows(name: str) -> tuple[tuple[str, ...], tuple[str, ...]]:
    robot = robot_called(name)
    u, given = np.ones(len(robot.actuation.idx_v)), states(robot)
    accelerations = [eurdf.forward_dynamics(robot, q, v, u).a for q, v in given]
    motions = [(robot, q, v, a) for (q, v), a in zip(given, accelerations, strict=True)]
    calls: list[partial[None]] = [
        partial(each, lambda q, v: eurdf.forward_dynamics(robot, q, v, u), given),
        partial(each, eurdf.inverse_dynamics, motions),
    ]
    errors: list[float] = []
    try:
        peers = Peers(robot)
    except eurdf.errors.NoConstraintModel:
        pass
    else:
        springs = [eurdf.springs.spring_force(robot, q) for q, _ in given]
        driven = [(q, v, u, passive) for (q, v), passive in zip(given, springs, strict=True)]
        moved = [(q, v, a, passive) for (_, q, v, a), passive in zip(motions, springs, strict=True)]
        for a, at in zip(accelerations, driven, strict=True):
            errors.append(float(np.abs(a - peers.forward(*at)[0]).max() / np.abs(a).max()))
        calls += [partial(each, peers.forward, driven), partial(each, peers.inverse, moved)]
    forward, inverse, *peer = (taken / len(given) for taken in least_times(calls, 30))
    to_pin, to_numpy = peer or (None, None)
    head = name, str(robot.model.nv)
    first = (*head, duration(forward), duration(to_pin), _PIN.cell(forward, to_pin), largest(errors))
    return first, (*head, duration(inverse), duration(to_numpy), ratio(inverse, to_numpy) if to_numpy else "-")


def _chain_row(count: int) -> tuple[str, ...]:
    robot = chain(count)
    q = eurdf.assemble(robot).q
    v = eurdf.project_velocity(robot, q, np.ones(robot.model.nv))
    before, begin = peak_memory(), time.process_time()
    eurdf.forward_dynamics(robot, q, v)
    first, grown = time.process_time() - begin, peak_memory() - before
    calls = [partial(eurdf.forward_dynamics, robot, q, v)]
    if count <= _MOST_NESTED:
        peer_robot = MuJoCoRobot(robot)
        peer_robot.move(q, v)
        calls.append(partial(mujoco.mj_forward, peer_robot.model, peer_robot.data))
    later, *peer = least_times(calls, 5)
    shown = str(count), str(robot.model.nv), duration(first), duration(later)
    return *shown, *([duration(peer[0]), ratio(later, peer[0])] if peer else ["-", "-"]), f"{grown:.0f} MB"
