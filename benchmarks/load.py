"""`eurdf.load(geometry=False)` against bare `pin.buildModelFromUrdf` on the same URDF.

Inertias, and whether the loops close in the configuration `assembled`, are checked when `robot.diagnostics` is first
used: the last column is the ratio with them.

How Python was compiled matters, since the peer is compiled code: of the robots with 10 joints or more, on one machine
on 2026-11-23, the Python 3.11.2 of Debian 12 took 1.23 to 1.97 of the peer's time, and a Python 3.11.7 compiled without
profile-guided and link-time optimization 1.41 to 2.15.
"""

from __future__ import annotations

import tempfile
import time
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path

import pinocchio as pin

import eurdf
from benchmarks.growth import write_loops
from benchmarks.robots import CHAINS, chain, chains
from benchmarks.table import Table, duration, ratio

ROOT = Path(__file__).parents[1]


def robots() -> list[Path]:
    """Folders of the collection, and of published robots where they are present beside the checkout."""
    roots = (ROOT / "robots", ROOT.parent / "shared" / "wild")
    return [path.parent for root in roots for path in sorted(root.glob("*/robot.yaml"))]


def alternate(
    one: Callable[[], object],
    other: Callable[[], object],
    seconds: float = 1.0,
    fewest: int = 5,
    clock: Callable[[], float] = time.process_time,
) -> tuple[float, float]:
    """Times of two functions run by turns, in s: of the turn that took the least, since processors change speed."""
    times: tuple[list[float], list[float]] = ([], [])
    one(), other()
    end = time.perf_counter() + seconds
    while time.perf_counter() < end or len(times[0]) < fewest:
        for function, taken in zip((one, other), times, strict=True):
            start = clock()
            function()
            taken.append(clock() - start)
    return min(zip(*times, strict=True), key=sum)


def tables(published: bool = True) -> Iterator[Table]:
    """Of robots and of chains.

    Args:
        published: Whether to measure published robots, too, where they are present beside the checkout.
    """
    columns: tuple[str, ...] = ("robot", "joints", "`eurdf.load`", "pin", "ratio", "with diagnostics")
    folders = [folder for folder in robots() if published or folder.parent == ROOT / "robots"]
    yield Table(columns, [_row(folder) for folder in folders])
    with tempfile.TemporaryDirectory() as folder:
        paths = [(Path(folder) / name, chain(count)) for name, count in zip(chains(), CHAINS, strict=True)]
        yield Table(columns, [_row(write_loops(robot.mechanism, _made(path))) for path, robot in paths])


def _made(folder: Path) -> Path:
    folder.mkdir()
    return folder


def _row(folder: Path) -> tuple[str, ...]:
    load = partial(eurdf.load, folder, geometry=False)
    joints = load().model.njoints - 1
    bare = partial(pin.buildModelFromUrdf, str(folder / "robot.urdf"))
    ours, peer = alternate(load, bare)
    diagnosed = alternate(lambda: load().diagnostics, bare)
    return folder.name, str(joints), duration(ours), duration(peer), ratio(ours, peer), ratio(*diagnosed)
