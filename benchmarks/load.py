"""`eurdf.load(geometry=False)`, all checks included, against bare `pin.buildModelFromUrdf` on the same URDF.

Then whole processes, imports included, against processes that only import what `eurdf` needs. All are times of the
processor, the least of several that run in turns.
"""

from __future__ import annotations

import os
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pinocchio as pin

import eurdf
from eurdf.collection import find_robot

ROOT = Path(__file__).parents[1]


def robots() -> list[Path]:
    """Folders of the collection, and of published robots where they are present beside the checkout."""
    roots = (ROOT / "robots", ROOT.parent / "shared" / "wild")
    return [path.parent for root in roots for path in sorted(root.glob("*/robot.yaml"))]


#: Whole processes as arguments of Python, each with its peer.
PROCESSES = (
    (
        'eurdf.load("digit_leg")',
        ("-c", "import eurdf; eurdf.load('digit_leg', geometry=False)"),
        "importing pinocchio, lxml, yaml, pydantic",
        ("-c", "import pinocchio, lxml.etree, yaml, pydantic"),
    ),
    (
        "eurdf check digit_like",
        ("-m", "eurdf", "check", str(ROOT.parent / "shared" / "wild" / "digit_like")),
        "importing pinocchio",
        ("-c", "import pinocchio"),
    ),
)


def alternate(
    one: Callable[[], object],
    other: Callable[[], object],
    seconds: float = 1.5,
    clock: Callable[[], float] = time.process_time,
) -> tuple[float, float]:
    """Least times of two functions run by turns, in s."""
    times: tuple[list[float], list[float]] = ([], [])
    one(), other()
    end = time.perf_counter() + seconds
    while time.perf_counter() < end or len(times[0]) < 5:
        for function, taken in zip((one, other), times, strict=True):
            start = clock()
            function()
            taken.append(clock() - start)
    return min(times[0]), min(times[1])


def of_children() -> float:
    """Time of the processor that child processes have taken, s."""
    times = os.times()
    return times.children_user + times.children_system


def run(arguments: tuple[str, ...]) -> None:
    """Run Python in a process of its own."""
    subprocess.run([sys.executable, *arguments], check=False, capture_output=True)


def main() -> None:
    """Print two tables."""
    print(f"{'robot':24} {'joints':>7} {'eurdf.load':>12} {'pin':>10} {'ratio':>7}")
    for folder in robots():
        urdf = str(folder / "robot.urdf")
        assert find_robot(folder).description is not None
        joints = eurdf.load(folder, geometry=False).model.njoints - 1
        ours, peer = alternate(lambda f=folder: eurdf.load(f, geometry=False), lambda u=urdf: pin.buildModelFromUrdf(u))  # type: ignore[misc]
        print(f"{folder.name:24} {joints:7} {ours * 1e3:9.2f} ms {peer * 1e3:7.2f} ms {ours / peer:6.2f}x")
    print()
    for name, arguments, peer_name, peer_arguments in PROCESSES:
        if arguments[-2] == "check" and not Path(arguments[-1]).exists():
            continue
        ours, peer = alternate(lambda a=arguments: run(a), lambda a=peer_arguments: run(a), 10.0, of_children)  # type: ignore[misc]
        print(f"{name:24} {ours * 1e3:9.0f} ms; {peer_name} {peer * 1e3:.0f} ms {ours / peer:6.2f}x")
