"""Run measurements by name: ``python -m benchmarks load growth commands``.

``python -m benchmarks fuzz`` runs the mutation campaign, ``… simulators`` other simulators on exported robots,
``… claims`` what the comparison with other formats says was seen by running, ``… toolbox`` the published toolbox, and
``… control`` what control and training get otherwise.
"""

from __future__ import annotations

import argparse
import inspect
import sys
from pathlib import Path
from types import ModuleType

from benchmarks import (
    array_map,
    assembly,
    batch,
    commands,
    conformance,
    control,
    derivatives,
    dynamics,
    forward_kinematics,
    growth,
    hostile,
    inverse_kinematics,
    load,
    loops,
    page,
    python_cost,
    reading,
    simulation,
    transmission,
)
from benchmarks.claims import claims
from benchmarks.fuzz import campaign
from benchmarks.simulators import table as simulators
from benchmarks.toolbox import run as toolbox

MEASUREMENTS: dict[str, ModuleType] = {
    "load": load,
    "reading": reading,
    "growth": growth,
    "commands": commands,
    "hostile": hostile,
    "assembly": assembly,
    "loops": loops,
    "forward_kinematics": forward_kinematics,
    "inverse_kinematics": inverse_kinematics,
    "derivatives": derivatives,
    "dynamics": dynamics,
    "simulation": simulation,
    "batch": batch,
    "python_cost": python_cost,
    "transmission": transmission,
    "array_map": array_map,
    "conformance": conformance,
}

#: Those that have options of their own.
OTHERS: dict[str, ModuleType] = {
    "fuzz": campaign,
    "simulators": simulators,
    "claims": claims,
    "toolbox": toolbox,
    "control": control,
}


def _first_line(module: ModuleType) -> str:
    return (module.__doc__ or "").splitlines()[0]


def _run(module: ModuleType, markdown: bool) -> None:
    if not hasattr(module, "tables"):
        module.main()
        return
    if markdown:
        print(inspect.cleandoc(module.__doc__ or ""), end="\n\n")
    # A page names robots of the collection alone.
    for table in module.tables(published=False) if markdown and module in (load, reading) else module.tables():
        print(table.markdown() if markdown else table.text(), end="\n\n", flush=True)


def main() -> int:
    """Run the measurements named on the command line, all if none is; or write a page; or what has its own options."""
    if sys.argv[1:] and sys.argv[1] in OTHERS:
        return int(OTHERS[sys.argv[1]].main(sys.argv[2:]))
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks",
        description="Measure, as ratios to a named peer in the same run.",
        formatter_class=argparse.RawDescriptionHelpFormatter,
        epilog="\n".join(f"{name:20}{_first_line(module)}" for name, module in MEASUREMENTS.items())
        + "".join(f"\n{name:20}{_first_line(module)} See `{name} --help`." for name, module in OTHERS.items()),
    )
    parser.add_argument("names", nargs="*", choices=[*MEASUREMENTS, []], help="which to run; all by default")
    parser.add_argument("--markdown", action="store_true", help="print tables in Markdown, where there are any")
    parser.add_argument(
        "--page", type=Path, metavar="FILE", help="write these sections of the page of the documentation instead"
    )
    options = parser.parse_args()
    if options.page is not None:
        page.write(options.page, options.names)
        return 0
    for name in options.names or MEASUREMENTS:
        _run(MEASUREMENTS[name], options.markdown)
    return 0


if __name__ == "__main__":
    sys.exit(main())
