"""What control and training get from this package, and from what is used without it.

Each row is measured by a function of its own; ``python -m benchmarks control NAME…`` prints single ones, and ``--page
docs/control.md`` writes the table of all. It needs Crocoddyl, Pink, quadprog, MuJoCo, matplotlib and a C compiler.
"""

from __future__ import annotations

import argparse
import importlib
import itertools
import re
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any
from unittest import mock

import mujoco
import numpy as np

import eurdf
from benchmarks.dynamics import Peers, states
from benchmarks.interleaved import least_times
from benchmarks.plain_newton import NotConverged, PlainNewton, Vector
from benchmarks.robots import ROBOTS, robot_called
from benchmarks.table import duration
from benchmarks.transmission import c_time
from eurdf.kinematics import calibrate
from eurdf.pinocchio.robot import build_robot
from robots import training_picture

_ANKLE, _JOINTS = "unitree_g1_ankle", ["free_pitch", "free_roll"]
_ROOT = Path(__file__).parents[1]
_PLACE = re.compile(r"(<!-- table: written by[^\n]*-->\n).*?(<!-- end of table -->)", re.DOTALL)


#: A claim, what this package gives, and what the other way gives.
Row = tuple[str, str, str]


def derivatives() -> Row:
    """Of the acceleration along closed motions, against differences of the sixth order."""
    robot = robot_called(_ANKLE)
    ((q, v),), random, tree = states(robot, 1), np.random.default_rng(0), robot.tree
    u, w, rate = random.normal(size=len(robot.actuation.idx_v)), *random.normal(size=(2, tree.nv))
    along = eurdf.project_velocity(robot, q, w)

    def at(t: float) -> tuple[Vector, Vector]:
        moved = eurdf.project_configuration(robot, tree.integrate(q, t * along))
        return moved, eurdf.project_velocity(robot, moved, v + t * rate)

    q_rate = _slope(lambda t: tree.difference(q, at(t)[0]))
    v_rate, expected = _slope(lambda t: at(t)[1]), _slope(lambda t: eurdf.forward_dynamics(robot, *at(t), u).a)
    exact = eurdf.dynamics_derivatives(robot, q, v, u)
    peers = Peers(robot).derivatives(q, v, u, np.zeros(tree.nv))
    ours, pins = (
        np.abs(by_q @ q_rate + by_v @ v_rate - expected).max() / np.abs(expected).max()
        for by_q, by_v in ((exact.a_q, exact.a_v), peers[:2])
    )
    return (
        "derivatives of the dynamics, ankle of the G1 (3d closures)",
        f"error {ours:.0e}",
        f"`computeConstraintDynamicsDerivatives`: error {pins:.0e}",
    )


def _slope(f: Callable[[float], Vector], step: float = 1e-3) -> Vector:
    one, two, three = (f(k * step) - f(-k * step) for k in (1, 2, 3))
    return (45.0 * one - 9.0 * two + three) / (60.0 * step)


def optimal_control() -> Row:
    """The problem of ``docs/crocoddyl.md``, with both derivatives."""
    loops = importlib.import_module("eurdf.crocoddyl")

    class PinsOwn(loops.DifferentialActionModelLoopFwdDynamics):  # type: ignore[misc, name-defined]
        """With the derivatives of Pinocchio."""

        def __init__(self, *arguments: Any, **options: Any) -> None:
            super().__init__(*arguments, **options)
            self.peers = Peers(self.robot, self.gains)

        def calcDiff(self, data: Any, x: Vector, u: Vector | None = None) -> None:  # noqa: N802
            super().calcDiff(data, x, u)
            if u is not None:
                q, v = x[: self.robot.model.nq], x[self.robot.model.nq :]
                by_q, by_v, by_tau = self.peers.derivatives(q, v, u, np.zeros(len(v)))
                data.Fx, data.Fu = np.hstack((by_q, by_v)), by_tau @ self.robot.actuation.selection

    page = (_ROOT / "docs" / "crocoddyl.md").read_text(encoding="utf-8")
    (code,) = re.findall(r"^```python\n(.*?)^```", page, re.M | re.S)
    found = []
    for model in (loops.DifferentialActionModelLoopFwdDynamics, PinsOwn):
        names: dict[str, Any] = {}
        with mock.patch.object(loops, "DifferentialActionModelLoopFwdDynamics", model):
            exec(code, names)
        found.append(f"{names['solver'].iter} iterations, cost {names['solver'].cost:.4f}")
    return ("optimal control of the delta robot, Crocoddyl", found[0], f"with Pinocchio's derivatives: {found[1]}")


def quadratic_program() -> Row:
    """Robots whose loops Pink can be given: by rows that span those of K, and by its own tasks of whole frames."""
    import pink

    import eurdf.pink

    spanned, by_hand = 0, 0
    for robot in map(robot_called, ROBOTS):
        by_hand += {type(each).__name__ for each in robot.constraints} <= {"FrameClosure", "Coupling"}
        q = robot.configurations["assembled"]
        _, K = eurdf.residual_and_jacobian(robot, q)
        try:
            J = eurdf.pink.ClosureTask(robot).compute_jacobian(pink.Configuration(robot.model, robot.data, q))
        except ValueError:  # Pink makes no configuration of a helical joint
            continue
        spanned += bool(np.abs(K - K @ J.T @ J).max() < 1e-6) and len(J) == np.linalg.matrix_rank(J)
    return (
        f"loops as equalities of a quadratic program, {len(ROBOTS)} robots",
        f"`ClosureTask`: {spanned} robots, closures of every kind, independent rows",
        f"`RelativeFrameTask`, `JointCouplingTask`: {by_hand} robots, whose closures are all 6d or couplings",
    )


def first_guess() -> Row:
    """From joints to motors at 50 poses."""
    robot = robot_called(_ANKLE)
    prepared = eurdf.transmissions.prepare_transmission(robot, _JOINTS)
    driven = build_robot(replace(robot.mechanism, actuators=tuple(_JOINTS), motors={}), geometry=False)
    newton, q0 = PlainNewton(driven), eurdf.assemble(robot).q
    motors = [robot.slots[name].idx_q for name in prepared.motors]
    closed, failed, error = 0, 0, 0.0
    for pose in np.random.default_rng(0).uniform((-0.4, -0.2), (0.3, 0.2), (50, 2)):
        exact = eurdf.transmissions.actuator_values(robot, dict(zip(_JOINTS, pose.tolist(), strict=True))).q[motors]
        off = float(np.abs(prepared.at_joints(pose)[0] - exact).max())
        closed, error = closed + (off < 1e-8), max(error, off)
        try:
            failed += np.abs(newton.forward_kinematics(pose, q0)[motors] - exact).max() > 1e-6
        except NotConverged:
            failed += 1
    return (
        "any pose of the G1's ankle in one call",
        f"{closed} of 50 poses, to {error:.0e} rad",
        f"Newton from the level pose fails at {failed} of 50",
    )


def in_c() -> Row:
    """Time of a call."""
    robot = robot_called(_ANKLE)
    prepared = eurdf.transmissions.prepare_transmission(robot, _JOINTS)
    positions = eurdf.transmissions.workspace(robot, _JOINTS, grid=13).positions
    each = itertools.cycle(positions)
    (python,) = least_times((lambda: prepared.at_joints(next(each)),), 200)
    return (
        "motors, G and its inverse in a controller",
        f"C: {duration(c_time(prepared, positions, 'double')[0])}",
        f"the same in Python: {duration(python)}",
    )


def calibration() -> Row:
    """All that is unknown of the G1's ankle, from exact readings."""
    robot = robot_called(_ANKLE)
    poses = eurdf.batch.forward_kinematics(robot, np.random.default_rng(0).uniform(-0.2, 0.2, (48, 2))).q
    unknown = ["motor_a", "motor_b", *(f"{closure.name}/{end}" for closure in robot.mechanism.closures for end in "ab")]
    counts = []
    for encoders in (["motor_a", "motor_b", *_JOINTS], ["motor_a", "motor_b"]):
        samples = {name: poses[:, robot.slots[name].idx_q] for name in encoders}
        found = calibrate(robot, samples, unknown)
        counts.append(f"{len(found.parameters) - len(found.unidentifiable)} of {len(found.parameters)}")
    return (
        "motor offsets and rod ends from encoders",
        f"{counts[0]} are determined one by one, {counts[1]} without encoders of the joints; the others are named",
        "plain least squares return a number for each, and do not say which are arbitrary",
    )


def hinge_mjcf() -> Row:
    """The leg of Digit in MuJoCo."""
    cells, models = [], []
    for joints in ("hinge", "stated"):
        model = mujoco.MjModel.from_xml_string(eurdf.export("digit_leg", "mjcf", joints=joints).main.decode())
        models.append((model, mujoco.MjData(model)))
        mujoco.mj_resetDataKeyframe(*models[-1], 0)
        balls = int((model.jnt_type == mujoco.mjtJoint.mjJNT_BALL).sum())
        cells.append(f"{model.nv} velocities, {balls} ball joints")
    times = least_times([partial(mujoco.mj_forward, *each) for each in models], 200)
    ours, other = (f"{cell}, `mj_forward` {duration(time)}" for cell, time in zip(cells, times, strict=True))
    return ("MJCF for programs without ball joints, leg of Digit", f"`--joints hinge`: {ours}", f"with balls: {other}")


def four_bar() -> Row:
    """A crank that moves a rocker, over what the rocker can reach from its drawn pose."""
    robot = robot_called("four_bar")
    space = eurdf.transmissions.workspace(robot, "free_rocker")
    motor = np.unwrap([robot.joint_positions(q)["motor_crank"][0] for q in space.q])
    rocker, ratio = space.positions[:, 0], np.abs(space.transmissions_at(space.q).G[:, 0, 0])
    line = np.polynomial.Polynomial.fit(motor, rocker, 1)
    return (
        "a four-bar in ros2_control",
        f"`--ros2`: exact; the ratio is {ratio.min():.1f} to {ratio.max():.1f}",
        "`FourBarLinkageTransmission` has constant ratios: with the best, the rocker errs by "
        f"{np.abs(line(motor) - rocker).max():.2f} of {np.ptp(rocker):.2f} rad",
    )


def serial_model() -> Row:
    """The ankle of the G1 as it is trained with; see ``docs/training.md``."""
    found = training_picture.costs(21)
    (pitch, roll), (more_pitch, more_roll) = found.inertia.min(axis=0), found.inertia.max(axis=0)
    missing = 100.0 - 100.0 * len(found.positions) / 21**2
    return (
        "armature and reach of the G1's ankle in training",
        "exact at each pose",
        f"`ARMATURE * 2`: the exact one is {pitch:.1f} to {more_pitch:.1f} times it for pitch, {roll:.1f} to "
        f"{more_roll:.1f} for roll; {missing:.0f} % of the box of joint limits is out of reach",
    )


_ROWS = (
    derivatives,
    optimal_control,
    quadratic_program,
    hinge_mjcf,
    first_guess,
    in_c,
    serial_model,
    four_bar,
    calibration,
)
ROWS: dict[str, Callable[[], Row]] = {each.__name__: each for each in _ROWS}


def main(arguments: list[str]) -> int:
    """Print the rows that are asked for, or write them all to a page."""
    parser = argparse.ArgumentParser("python -m benchmarks control", description=__doc__)
    parser.add_argument("names", nargs="*", choices=[*ROWS, []], help="which to measure; all by default")
    parser.add_argument("--page", type=Path, metavar="FILE", help="write the table of all to the page instead")
    options = parser.parse_args(arguments)
    found = {name: ROWS[name]() for name in (not options.page and options.names) or ROWS}
    lines = ["| claim | with `eurdf` | the other way | `python -m benchmarks control` |", "| --- | --- | --- | --- |"]
    lines += [f"| {' | '.join(row)} | `{name}` |" for name, row in found.items()]
    if options.page is None:
        print("\n".join(lines))
        return 0
    text = options.page.read_text(encoding="utf-8")
    written = _PLACE.sub(lambda at: "\n".join((at[1], *lines, "", at[2])), text)
    options.page.write_text(written, encoding="utf-8")
    return 0
