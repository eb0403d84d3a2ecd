"""`eurdf.load(geometry=False)`, all checks included, against bare `pin.buildModelFromUrdf` on the same URDF."""

from __future__ import annotations

import statistics
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


def alternate(one: Callable[[], object], other: Callable[[], object], seconds: float = 1.5) -> tuple[float, float]:
    """Median times of two functions run by turns, in s, so that a busy machine slows both."""
    times: tuple[list[float], list[float]] = ([], [])
    one(), other()
    end = time.perf_counter() + seconds
    while time.perf_counter() < end or len(times[0]) < 5:
        for function, taken in zip((one, other), times, strict=True):
            start = time.perf_counter()
            function()
            taken.append(time.perf_counter() - start)
    return statistics.median(times[0]), statistics.median(times[1])


def main() -> None:
    """Print a table."""
    print(f"{'robot':24} {'eurdf.load':>12} {'pin':>10} {'ratio':>7}")
    for folder in robots():
        urdf = str(folder / "robot.urdf")
        assert find_robot(folder).description is not None
        ours, peer = alternate(lambda f=folder: eurdf.load(f, geometry=False), lambda u=urdf: pin.buildModelFromUrdf(u))  # type: ignore[misc]
        print(f"{folder.name:24} {ours * 1e3:9.2f} ms {peer * 1e3:7.2f} ms {ours / peer:6.2f}x")
