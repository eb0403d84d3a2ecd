"""`eurdf.assemble` from 1,000 random starts a robot, and against `scipy.optimize.fmin_slsqp` with equality constraints.

The starts are drawn within ±0.5 rad, or half a characteristic length, of an assembled configuration. SLSQP is set up
in two ways, the residual of the closures its equality constraints and the distance from the start its objective: over a
step v in the tangent space at the start, and over q itself with rows for the lengths of quaternions. It differentiates
by finite differences, its default, and evaluates the residual of this package. Times are of the processor.
"""

from __future__ import annotations

import dataclasses
import importlib
import statistics
import sys
from typing import Any

import numpy as np
import numpy.typing as npt
import pinocchio as pin
from scipy.optimize import fmin_slsqp

import eurdf
from benchmarks.interleaved import timed
from benchmarks.load import ROOT, robots
from eurdf.kinematics.assembly import assemble
from eurdf.kinematics.residual import residual, residual_and_jacobian
from eurdf.kinematics.scale import characteristic_length, velocity_scale
from eurdf.mechanism.body import Anchor
from eurdf.pinocchio.robot import build_robot

Vector = npt.NDArray[np.float64]

STARTS = 1000
COMPARED = 20


def main() -> None:
    """Print two tables."""
    loaded = {folder.name: eurdf.load(folder, geometry=False) for folder in robots()}
    loaded["two digit_legs"] = two_legs()
    closing = {name: robot for name, robot in loaded.items() if robot.constraints and assemble(robot).closes}
    closing |= textbook_mechanisms()
    print(f"{'robot':32} {'neutral':>8} {'converged':>10} {'median':>7} {'99 %':>5} {'most':>5}   (evaluations)")
    for name, robot in closing.items():
        from_neutral = assemble(robot, pin.neutral(robot.model)).iterations
        found = [assemble(robot, start) for start in starts(robot, STARTS)]
        evaluations = [assembly.iterations for assembly in found]
        share = sum(assembly.converged for assembly in found) / STARTS
        most = np.percentile(evaluations, [50, 99, 100], method="higher").astype(int)
        print(f"{name:32} {from_neutral:8} {share:10.1%} {most[0]:7} {most[1]:5} {most[2]:5}")
    print(f"\n{'robot':32} {'from':8} {'eurdf':>9} {'residual':>9} {'over v':>9} {'residual':>9} {'over q':>9}", end="")
    print(f" {'residual':>9} {'v/eurdf':>8} {'q/eurdf':>8}")
    for name in ("digit_leg", "two digit_legs", "digit_like", "digit_like_2legs"):
        if name in closing:
            compare(name, "neutral", closing[name], [pin.neutral(closing[name].model)])
            compare(name, "random", closing[name], starts(closing[name], COMPARED))


def two_legs() -> eurdf.Robot:
    """Two legs `digit_leg` on one torso: 36 constraint rows."""
    one = eurdf.load("digit_leg", geometry=False).mechanism
    torso = one.bodies[0].name

    def other(name: str) -> str:
        return name if name == torso else f"{name}_2"

    def opposite(anchor: Anchor) -> Anchor:
        return dataclasses.replace(anchor, body=other(anchor.body), frame="")

    two = dataclasses.replace(
        one,
        bodies=one.bodies + tuple(dataclasses.replace(body, name=other(body.name)) for body in one.bodies[1:]),
        joints=one.joints
        + tuple(
            dataclasses.replace(joint, name=other(joint.name), parent=other(joint.parent), child=other(joint.child))
            for joint in one.joints
        ),
        frames=(),
        closures=one.closures
        + tuple(
            dataclasses.replace(closure, name=other(closure.name), a=opposite(closure.a), b=opposite(closure.b))
            for closure in one.closures
        ),
        actuators=one.actuators + tuple(other(name) for name in one.actuators),
        configurations={},
    )
    return build_robot(two, geometry=False)


def textbook_mechanisms() -> dict[str, Any]:
    """Those of the tests that move."""
    sys.path.insert(0, str(ROOT / "tests"))
    return {build.__name__: build() for build in importlib.import_module("support.linkage").MOVING}


def starts(robot: eurdf.Robot, count: int) -> list[Vector]:
    """Configurations (nq,) around an assembled one, the same every time."""
    random, model, closed = np.random.default_rng(1), robot.model, assemble(robot).q
    unit = velocity_scale(robot, characteristic_length(robot))
    return [pin.integrate(model, closed, unit * random.uniform(-0.5, 0.5, model.nv)) for _ in range(count)]


def compare(name: str, where: str, robot: eurdf.Robot, places: list[Vector]) -> None:
    """Print a row: median times over some starts, the worst residual of each way, the ratio of the times."""
    ways = (lambda q: assemble(robot, q).q, lambda q: slsqp_over_v(robot, q), lambda q: slsqp_over_q(robot, q))
    medians, worst = [], []
    for way in ways:
        calls = [timed(lambda way=way, q=q: way(q)) for q in places * (COMPARED // len(places))]  # type: ignore[misc]
        medians.append(statistics.median(taken for taken, _ in calls))
        worst.append(max(float(np.linalg.norm(residual(robot, end))) for _, end in calls))
    ours, over_v, over_q = medians
    columns = " ".join(f"{t * 1e3:6.2f} ms {r:9.0e}" for t, r in zip(medians, worst, strict=True))
    print(f"{name:32} {where:8} {columns} {over_v / ours:7.1f}x {over_q / ours:7.1f}x")
    q = places[0]
    one = min(timed(lambda: residual_and_jacobian(robot, q))[0] for _ in range(100))
    print(f"{'':32} {ours / one:8.1f} times one call of `residual_and_jacobian`, {one * 1e6:.0f} µs")


def slsqp_over_v(robot: eurdf.Robot, q: Vector) -> Vector:
    """The nearest closed configuration, by a step from q in its tangent space: ½ |v|² least, while r(q ⊕ v) = 0."""
    model = robot.model
    v = fmin_slsqp(
        lambda v: 0.5 * v @ v,
        np.zeros(model.nv),
        f_eqcons=lambda v: residual(robot, pin.integrate(model, q, v)),
        iter=200,
        iprint=0,
    )
    return np.asarray(pin.integrate(model, q, v))


def slsqp_over_q(robot: eurdf.Robot, q: Vector) -> Vector:
    """The nearest closed configuration by its coordinates: ½ |x - q|² least, while r(x) = 0, |quaternions| = 1."""
    model = robot.model
    spheres = [slice(j.idx_q, j.idx_q + j.nq) for j in list(model.joints)[1:] if j.nq in (2, 4) and j.nq > j.nv]

    def constraints(x: Vector) -> Vector:
        lengths = [x[sphere] @ x[sphere] - 1.0 for sphere in spheres]
        return np.concatenate([residual(robot, pin.normalize(model, x)), lengths])

    x = fmin_slsqp(lambda x: 0.5 * (x - q) @ (x - q), q, f_eqcons=constraints, iter=200, iprint=0)
    return np.asarray(pin.normalize(model, x))
