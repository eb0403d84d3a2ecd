"""Write what the measurements found to a page."""

from __future__ import annotations

import platform
import subprocess
import sys
import time
from collections.abc import Callable, Mapping
from importlib.metadata import version
from pathlib import Path

SECTIONS = {
    "Dynamics": "dynamics",
    "Simulation": "simulation",
    "Forward kinematics": "forward_kinematics",
    "Inverse kinematics": "inverse_kinematics",
    "Derivatives": "derivatives",
    "Batches": "batch",
    "Loading": "load",
    "Loading without checks": "reading",
}

_PACKAGES = ("pin", "mujoco", "numpy")


def measured(name: str) -> str:
    """The section of a measurement in Markdown, from a process of its own, so that memory is its own, too."""
    command = [sys.executable, "-m", "benchmarks", "--markdown", name]
    return subprocess.run(command, check=True, stdout=subprocess.PIPE, encoding="utf-8").stdout.strip()


def write(path: Path, sections: Mapping[str, str] = SECTIONS, measure: Callable[[str], str] = measured) -> None:
    """Run measurements and write what they found, with date, versions and the kind of machine.

    Args:
        path: The file.
        sections: For each title the name of the measurement.
        measure: Returns the Markdown of a measurement.
    """
    parts = [_head(), *(f"## {title}\n\n{measure(name)}" for title, name in sections.items())]
    path.write_text("\n\n".join(parts) + "\n", encoding="utf-8")


def _head() -> str:
    versions = ", ".join(f"{package} {version(package)}" for package in _PACKAGES)
    return f"""# Benchmarks

How long `eurdf` takes, as ratios to named peers. This page is written by:

```sh
python -m benchmarks --page docs/benchmarks.md
```

Measured on {time.strftime("%Y-%m-%d")} on {_machine()}, with Python {platform.python_version()}, {versions}.

Each ratio comes from one run, in which the functions take turns. Times are the least times of the processor, on one
thread. A ratio is the time of `eurdf` divided by that of the peer: below 1, `eurdf` is faster. All peers have the
memory that they need beforehand. A function of `eurdf` checks its arguments and its result; a peer does not."""


def _machine() -> str:
    """The kind of machine, without its name."""
    model = platform.machine()
    if sys.platform == "linux":
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
        model = next((line.partition(":")[2].strip() for line in lines if line.startswith("model name")), model)
    return f"{model} ({platform.system()}, {platform.machine()})"
