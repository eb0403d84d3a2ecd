"""Whole processes, imports included, against one that imports pinocchio.

Times are those of the processor, in the turn that took both the least. OpenBLAS has one thread: by default it has more,
and an import of pinocchio takes up to twice as long; the commands choose one thread themselves. Modules are compiled
beforehand, as those of an installed package are, and the output is no terminal.
"""

from __future__ import annotations

import os
import resource
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from functools import partial

from benchmarks.load import alternate
from benchmarks.robots import ROBOTS
from benchmarks.table import Goal, Table, duration, ratio

_PEER = ("-c", "import pinocchio")
_LIST, _SHOW = Goal(0.6), Goal(2.0)


def tables() -> Iterator[Table]:
    """Of commands on no robot, and on all robots."""
    columns = "process", "time", "import pinocchio"
    load = "-c", "import eurdf; eurdf.load('digit_leg', geometry=False)"
    with tempfile.TemporaryDirectory() as compiled:
        listed = _measured(("-m", "eurdf", "robots"), compiled)
        row = ("`eurdf robots`", *map(duration, listed), _LIST.cell(*listed))
        yield Table((*columns, _LIST.of("ratio")), [row])
        loaded = _measured(load, compiled)
        row = ('`eurdf.load("digit_leg", geometry=False)`', *map(duration, loaded), ratio(*loaded))
        yield Table((*columns, "ratio"), [row])
        shown = {name: _measured(("-m", "eurdf", "info", name), compiled) for name in ROBOTS}
        rows = [(name, *map(duration, times), _SHOW.cell(*times)) for name, times in shown.items()]
        yield Table((*columns, _SHOW.of("ratio")), rows, "`eurdf info`")
        checked = {name: _measured(("-m", "eurdf", "check", name), compiled) for name in ROBOTS}
        rows = [(name, *map(duration, times), ratio(*times)) for name, times in checked.items()]
        yield Table((*columns, "ratio"), rows, "`eurdf check`")


def _measured(arguments: tuple[str, ...], compiled: str) -> tuple[float, float]:
    one, other = (partial(_run, each, compiled) for each in (arguments, _PEER))
    return alternate(one, other, 0.0, 3, _of_children)


def _of_children() -> float:
    """Time of the processor that child processes have taken, s."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def _run(arguments: tuple[str, ...], compiled: str) -> None:
    """Run Python in a process of its own, with a folder for compiled modules."""
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
    environment["PYTHONPYCACHEPREFIX"] = compiled
    subprocess.run([sys.executable, *arguments], check=False, capture_output=True, env=environment)
