"""How time grows with the size of a robot: reading and loading by links; all else by loops.

Links are in chains of ten; Pinocchio's own parser, which recurses, crashes on one chain of 10,000. Loops are those of
independent four-bars, side by side on the ground or each on the rocker of the one before: 100 to 1,000 for what is done
once, 10 to 300 for what is done at each configuration. The exponent p of time ~ loops^p is fitted: 1 is linear; the
steepest one is that of two neighbouring sizes. The models of Pinocchio are quadratic by themselves, and measured apart.
Its dynamics of chains in series are quadratic to cubic, and left out. Times are the least of the wall clock.

K is a dense array (nc, nv): at 300 four-bars, half of its time is that of 810,000 numbers. In inverse kinematics in
series all motors move by 0.05 rad: the few of 10 four-bars reach a target by Newton's method, that of 30 is so far away
that the search goes there, and above 60 velocities NumPy places the frame, joint by joint, as a `pin.Data` of the chain
would take 64 nv³ bytes.
"""

from __future__ import annotations

import itertools
import math
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from pathlib import Path

import numpy as np
import pinocchio as pin

import eurdf
from benchmarks.loops import four_bars
from benchmarks.robots import chain
from benchmarks.table import MET, MISSED, Table, duration, ratio
from eurdf.kinematics.evaluate import frames
from eurdf.linking.robot_files import read_robot
from eurdf.mechanism.constraint import Closure
from eurdf.mechanism.joint import Joint
from eurdf.mechanism.mechanism import Mechanism
from eurdf.pinocchio.configuration import slots
from eurdf.pinocchio.constraint import build_constraint_models
from eurdf.pinocchio.model import build_model
from eurdf.pinocchio.tree import build_tree

SIZES = (10, 100, 1000, 4000)
LOOPS = (100, 200, 500, 1000)
MOVING_LOOPS = (10, 30, 100, 300)

MOST = 1.2  # the exponent that is the goal of what is done at each configuration

_LAYOUT = {False: "side by side", True: "in series"}


def forest(links: int, length: int = 10) -> str:
    """A URDF of so many moving links, in chains of so many."""
    inertial = '<inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>'
    parts = ['<robot name="forest"><link name="l0"/>']
    for index in range(1, links + 1):
        parent = 0 if (index - 1) % length == 0 else index - 1
        parts.append(
            f'<link name="l{index}">{inertial}</link><joint name="j{index:06}" type="revolute"><origin xyz="0 0 0.1"/>'
            f'<parent link="l{parent}"/><child link="l{index}"/><axis xyz="0 0 1"/>'
            '<limit lower="-1" upper="1" effort="1" velocity="1"/></joint>'
        )
    return "".join(parts) + "</robot>"


def write_loops(mechanism: Mechanism, folder: Path) -> Path:
    """Write the files of four-bars: revolute joints about z, closures in 3d between poses on links."""
    inertial = '<inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>'

    def element(joint: Joint) -> str:
        xyz = " ".join(map(repr, joint.placement.xyz))
        return (
            f'<joint name="{joint.name}" type="revolute"><origin xyz="{xyz}"/><parent link="{joint.parent}"/>'
            f'<child link="{joint.child}"/><axis xyz="0 0 1"/><limit lower="-9" upper="9" effort="1" velocity="1"/>'
            "</joint>"
        )

    def entry(closure: Closure) -> str:
        ends = ", ".join(f"{{link: {end.body}, xyz: {list(end.pose.xyz)}}}" for end in (closure.a, closure.b))
        return f"- {{name: {closure.name}, type: 3d, frames: [{ends}]}}\n"

    links = "".join(f'<link name="{body.name}">{inertial}</link>' for body in mechanism.bodies)
    joints = "".join(map(element, mechanism.joints))
    (folder / "robot.urdf").write_text(f'<robot name="r">{links}{joints}</robot>', encoding="utf-8")
    closures, actuators = "".join(map(entry, mechanism.closures)), ", ".join(mechanism.actuators)
    (folder / "robot.yaml").write_text(
        f'extended_urdf: "2.0"\nactuators: [{actuators}]\nclosures:\n{closures}', encoding="utf-8"
    )
    return folder


def best(function: Callable[[], object], seconds: float = 1.0) -> float:
    """Shortest time of a function, in s."""
    shortest = float("inf")
    end = time.perf_counter() + seconds
    runs = 0
    while time.perf_counter() < end or runs < 2:
        start = time.perf_counter()
        function()
        shortest = min(shortest, time.perf_counter() - start)
        runs += 1
    return shortest


def exponent(sizes: Sequence[float], times: Sequence[float]) -> float:
    """The p of the line log time = p log size + c that fits best."""
    return float(np.polyfit(np.log(sizes), np.log(times), 1)[0])


def by_links() -> Table:
    """Reading and loading of links, in µs a link."""
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        for links in SIZES:
            urdf = Path(folder) / f"{links}.urdf"
            urdf.write_text(forest(links), encoding="utf-8")
            path = Path(folder) / f"{links}.yaml"
            path.write_text(f'extended_urdf: "2.0"\nurdf: {links}.urdf\nactuators: [j000001]\n', encoding="utf-8")
            read, load, peer = (
                best(function) / links
                for function in (
                    partial(read_robot, path),
                    partial(eurdf.load, path, geometry=False),
                    partial(pin.buildModelFromUrdf, str(urdf)),
                )
            )
            rows.append((f"{links:,}", *map(duration, (read, load, peer)), ratio(load, peer)))
    columns = ("links", "reading and checks", "`eurdf.load`", "`pin.buildModelFromUrdf`", "load to pin")
    return Table(columns, rows, "Chains of ten links, per link")


def by_loops(in_series: bool) -> Table:
    """What is done once for a robot, by numbers of loops."""
    times: dict[str, list[float]] = {}
    for count in LOOPS:
        with tempfile.TemporaryDirectory() as folder:
            mechanism = four_bars(count, in_series).mechanism
            path = write_loops(mechanism, Path(folder))
            robot = eurdf.load(path, geometry=False)

            def models(mechanism: Mechanism = mechanism) -> None:
                tree = build_tree(mechanism, build_model(mechanism), slots(mechanism))
                build_constraint_models(mechanism.constraints, tree)

            tasks: dict[str, Callable[[], object]] = {
                "reading": partial(read_robot, path),
                "models of Pinocchio": models,
                "load": partial(eurdf.load, path, geometry=False),
                "assemble": partial(eurdf.assemble, robot),
                "analyze": partial(eurdf.analyze, robot),
                "check": partial(eurdf.check, path),
            }
            for name, task in tasks.items():
                times.setdefault(name, []).append(best(task, 0.0))
    return _growing(LOOPS, times, in_series, "done once")


def motions(robot: eurdf.Robot, dynamics: bool) -> dict[str, Callable[[], object]]:
    """What is done at each configuration of a chain, by name."""
    q, random, nv = eurdf.assemble(robot).q, np.random.default_rng(0), robot.model.nv
    near = q + random.uniform(-0.05, 0.05, nv)
    others = itertools.cycle((q, near))  # that of the last call is remembered
    v = eurdf.project_velocity(robot, q, random.uniform(-1.0, 1.0, nv))
    given = q[robot.actuation.idx_q] + 0.05
    frame = robot.mechanism.bodies[-1].name
    there = frames(robot, [frame], few=True).at(eurdf.forward_kinematics(robot, given, q)[None])
    targets = {frame: pin.SE3(there.rotation[0, 0], there.position[0, 0])}
    found: dict[str, Callable[[], object]] = {
        "residual": lambda: eurdf.residual(robot, next(others)),
        "K": lambda: eurdf.residual_and_jacobian(robot, next(others)),
        "assemble": lambda: eurdf.assemble(robot, near),
        "forward": lambda: eurdf.forward_kinematics(robot, given, q),
        "inverse": lambda: eurdf.inverse_kinematics(robot, targets, q),
        "project q": lambda: eurdf.project_configuration(robot, near),
        "project v": lambda: eurdf.project_velocity(robot, q, v),
    }
    if dynamics:
        a = eurdf.forward_dynamics(robot, q, v).a
        found["forward dyn."] = lambda: eurdf.forward_dynamics(robot, q, v)
        found["inverse dyn."] = lambda: eurdf.inverse_dynamics(robot, q, v, a)
        found["10 steps"] = lambda: eurdf.simulate(robot, q, v, duration=1e-2)
    return found


def by_motion(in_series: bool) -> Table:
    """What is done at each configuration, by numbers of loops."""
    times: dict[str, list[float]] = {}
    for count in MOVING_LOOPS:
        for name, function in motions(chain(count, in_series), not in_series).items():
            times.setdefault(name, []).append(best(function, 0.3))
    return _growing(MOVING_LOOPS, times, in_series, "at each configuration", MOST)


def _growing(
    sizes: Sequence[int], times: dict[str, list[float]], in_series: bool, what: str, most: float = math.inf
) -> Table:
    """A row for each function: its times, the fitted exponent and the steepest one."""
    goal = f", ≤ {most:g}" if math.isfinite(most) else ""
    columns = (f"four-bars {_LAYOUT[in_series]}", *map(str, sizes), f"exponent{goal}", "steepest")
    rows = []
    for name, own in times.items():
        pairs = zip(itertools.pairwise(sizes), itertools.pairwise(own), strict=True)
        steepest = max(exponent(*pair) for pair in pairs)
        fitted = exponent(sizes, own)
        judged = f" {MET if fitted <= most else MISSED}" if goal else ""
        rows.append((name, *map(duration, own), f"{fitted:.2f}{judged}", f"{steepest:.2f}"))
    return Table(columns, rows, f"Four-bars {_LAYOUT[in_series]}, {what}")


def tables() -> Iterator[Table]:
    """By links, by loops that are read, and by loops that move."""
    yield by_links()
    for measure in (by_loops, by_motion):
        for in_series in (False, True):
            yield measure(in_series)
