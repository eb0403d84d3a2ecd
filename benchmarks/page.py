"""Write what the measurements found to a page."""

from __future__ import annotations

import platform
import subprocess
import sys
import time
from collections.abc import Callable, Collection
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from benchmarks.table import MET, MISSED

SECTIONS = {
    "Dynamics": "dynamics",
    "Simulation": "simulation",
    "Forward kinematics": "forward_kinematics",
    "Inverse kinematics": "inverse_kinematics",
    "Derivatives": "derivatives",
    "Batches": "batch",
    "Array maps of transmissions": "array_map",
    "Growth": "growth",
    "What Python costs": "python_cost",
    "Commands": "commands",
    "Loading": "load",
    "Loading without checks": "reading",
}

_PACKAGES = ("pin", "mujoco", "numpy", "pin-pink", "mink")


def measured(name: str) -> str:
    """The section of a measurement in Markdown, from a process of its own, so that memory is its own, too."""
    command = [sys.executable, "-m", "benchmarks", "--markdown", name]
    return subprocess.run(command, check=True, stdout=subprocess.PIPE, encoding="utf-8").stdout.strip()


def write(path: Path, names: Collection[str] = (), measure: Callable[[str], str] = measured) -> None:
    """Run measurements and write what they found, with their times, versions and the kind of machine.

    Args:
        path: The file.
        names: The measurements to run, all by default; the sections of others stay as they are.
        measure: Returns the Markdown of a measurement.
    """
    text = path.read_text(encoding="utf-8") if names else ""
    old = {title: section for title, _, section in (part.partition("\n\n") for part in text.split("\n## ")[1:])}
    parts = []
    for title, name in SECTIONS.items():
        if names and name not in names:
            section = old.get(title, "").strip()
        else:
            section = f"{measure(name)}\n\nMeasured on {time.strftime('%Y-%m-%d')}."
        parts += [f"## {title}\n\n{section}"] * bool(section)
    path.write_text("\n\n".join([_head(), *parts]) + "\n", encoding="utf-8")


def _head() -> str:
    versions = ", ".join(f"{package} {_version(package)}" for package in _PACKAGES)
    return f"""# Benchmarks

How long `eurdf` takes, as ratios to named peers. This page is written by:

```sh
python -m benchmarks --page docs/benchmarks.md                # all of it; takes half an hour
python -m benchmarks --page docs/benchmarks.md dynamics       # one section
```

Measured on {_machine()}, with Python {platform.python_version()}, {versions}.

Each ratio comes from one run, in which the functions take turns. Times are the least times of the processor, on one
thread. A ratio is the time of `eurdf` divided by that of the peer: below 1, `eurdf` is faster. All peers have the
memory that they need beforehand. A function of `eurdf` checks its arguments and its result; a peer does not.

All robots of the collection are measured. A column with a goal says "≤"; {MET} is a goal that is met, {MISSED} one that
is missed. The package is pure Python: a call takes at least what its calls from Python take, whatever the robot
([What Python costs](#what-python-costs)), so that small robots have the largest ratios."""


def _version(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:
        return "absent"


def _machine() -> str:
    """The kind of machine, without its name."""
    model = platform.machine()
    if sys.platform == "linux":
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
        model = next((line.partition(":")[2].strip() for line in lines if line.startswith("model name")), model)
    return f"{model} ({platform.system()}, {platform.machine()})"
