"""`eurdf.load(geometry=False)` against bare `pin.buildModelFromUrdf` on the same URDF.

Inertias, and whether the loops close in the configuration `assembled`, are checked when `robot.diagnostics` is first
used: the last column is the ratio with them.

How Python was compiled matters, since the peer is compiled code: of the robots with 10 joints or more, on one machine
on 2026-11-23, the Python 3.11.2 of Debian 12 took 1.23 to 1.97 of the peer's time, and a Python 3.11.7 compiled without
profile-guided and link-time optimization 1.41 to 2.15.

Then whole processes, imports included, against processes that only import what `eurdf` needs. All are times of the
processor, in the turn that took both the least. OpenBLAS has one thread. By default it has more, and an import of
pinocchio takes up to twice as long; `eurdf check` chooses one thread itself.
"""

from __future__ import annotations

import os
import resource
import subprocess
import sys
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


#: Whole processes as arguments of Python, each with its peer.
PROCESSES: tuple[tuple[str, tuple[str, ...], str, tuple[str, ...]], ...] = (
    (
        '`eurdf.load("digit_leg", geometry=False)`',
        ("-c", "import eurdf; eurdf.load('digit_leg', geometry=False)"),
        "importing pinocchio, lxml, yaml, pydantic",
        ("-c", "import pinocchio, lxml.etree, yaml, pydantic"),
    ),
    *(
        (
            f"`eurdf check {folder.name}`",
            ("-m", "eurdf", "check", str(folder)),
            "importing pinocchio",
            ("-c", "import pinocchio"),
        )
        for folder in (ROOT / "robots" / "digit_leg", ROOT.parent / "shared" / "wild" / "digit_like")
        if folder.exists()
    ),
)


def alternate(
    one: Callable[[], object],
    other: Callable[[], object],
    seconds: float = 1.5,
    clock: Callable[[], float] = time.process_time,
) -> tuple[float, float]:
    """Times of two functions run by turns, in s: of the turn that took the least, since processors change speed."""
    times: tuple[list[float], list[float]] = ([], [])
    one(), other()
    end = time.perf_counter() + seconds
    while time.perf_counter() < end or len(times[0]) < 5:
        for function, taken in zip((one, other), times, strict=True):
            start = clock()
            function()
            taken.append(clock() - start)
    return min(zip(*times, strict=True), key=sum)


def of_children() -> float:
    """Time of the processor that child processes have taken, s."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def run(arguments: tuple[str, ...], compiled: str) -> None:
    """Run Python in a process of its own, with a folder for compiled modules, as an installed package has them."""
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
    environment["PYTHONPYCACHEPREFIX"] = compiled
    subprocess.run([sys.executable, *arguments], check=False, capture_output=True, env=environment)


def tables(published: bool = True) -> Iterator[Table]:
    """Of robots, of chains and of whole processes.

    Args:
        published: Whether to measure published robots, too, where they are present beside the checkout.
    """
    columns: tuple[str, ...] = ("robot", "joints", "`eurdf.load`", "pin", "ratio", "with diagnostics")
    folders = [folder for folder in robots() if published or folder.parent == ROOT / "robots"]
    yield Table(columns, [_row(folder) for folder in folders])
    with tempfile.TemporaryDirectory() as folder:
        paths = [(Path(folder) / name, chain(count)) for name, count in zip(chains(), CHAINS, strict=True)]
        yield Table(columns, [_row(write_loops(robot.mechanism, _made(path))) for path, robot in paths])
    columns = ("process", "eurdf", "peer", "its time", "ratio")
    yield Table(
        columns, [_process_row(*process) for process in PROCESSES if published or "digit_like" not in process[0]]
    )


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


def _process_row(
    name: str, arguments: tuple[str, ...], peer_name: str, peer_arguments: tuple[str, ...]
) -> tuple[str, ...]:
    with tempfile.TemporaryDirectory() as compiled:
        one, other = partial(run, arguments, compiled), partial(run, peer_arguments, compiled)
        ours, peer = alternate(one, other, 10.0, of_children)
    return name, duration(ours), peer_name, duration(peer), ratio(ours, peer)
