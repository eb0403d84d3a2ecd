"""Time per link of reading, of `eurdf.load` and of `pin.buildModelFromUrdf`, for 10 to 10,000 links.

The links stand in chains of ten; Pinocchio's own parser, which recurses, crashes on one chain of 10,000.
"""

from __future__ import annotations

import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import pinocchio as pin

import eurdf
from eurdf.description import describe

SIZES = (10, 100, 1000, 10_000)


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


def main() -> None:
    """Print a table, in µs a link."""
    print(f"{'links':>7} {'reading and checks':>20} {'eurdf.load':>12} {'pin':>10} {'load/pin':>9}   (µs a link)")
    with tempfile.TemporaryDirectory() as folder:
        for links in SIZES:
            urdf = Path(folder) / f"{links}.urdf"
            urdf.write_text(forest(links), encoding="utf-8")
            (Path(folder) / f"{links}.yaml").write_text(
                f'extended_urdf: "2.0"\nurdf: {links}.urdf\nactuators: [j000001]\n', encoding="utf-8"
            )
            path = Path(folder) / f"{links}.yaml"
            read, load, peer = (
                best(function) / links * 1e6
                for function in (
                    lambda p=path: describe(p),
                    lambda p=path: eurdf.load(p, geometry=False),
                    lambda u=str(urdf): pin.buildModelFromUrdf(u),
                )
            )
            print(f"{links:7} {read:20.1f} {load:12.1f} {peer:10.1f} {load / peer:8.2f}x")
