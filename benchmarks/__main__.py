"""Run measurements by name: ``python -m benchmarks load growth check``.

``python -m benchmarks fuzz`` runs the mutation campaign, ``… simulators`` other simulators on exported robots.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable

from benchmarks import (
    assembly,
    batch,
    check,
    conformance,
    derivatives,
    dynamics,
    forward_kinematics,
    growth,
    hostile,
    inverse_kinematics,
    load,
    loops,
    simulation,
    transmission,
)
from benchmarks.fuzz import campaign
from benchmarks.simulators import table as simulators

MEASUREMENTS: dict[str, Callable[[], None]] = {
    "load": load.main,
    "growth": growth.main,
    "check": check.main,
    "hostile": hostile.main,
    "assembly": assembly.main,
    "loops": loops.main,
    "forward_kinematics": forward_kinematics.main,
    "inverse_kinematics": inverse_kinematics.main,
    "derivatives": derivatives.main,
    "dynamics": dynamics.main,
    "simulation": simulation.main,
    "batch": batch.main,
    "transmission": transmission.main,
    "conformance": conformance.main,
}


def _first_line(run: Callable[[], None]) -> str:
    return (sys.modules[run.__module__].__doc__ or "").splitlines()[0]


def main() -> int:
    """Run the measurements named on the command line, all of them where none is named; or what has its own options."""
    if sys.argv[1:2] == ["fuzz"]:
        return campaign.main(sys.argv[2:])
    if sys.argv[1:2] == ["simulators"]:
        return simulators.main(sys.argv[2:])
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks",
        description="Measure, as ratios to a named peer in the same run.",
        formatter_class=argparse.RawDescriptionHelpFormatter,
        epilog="\n".join(f"{name:20}{_first_line(run)}" for name, run in MEASUREMENTS.items())
        + f"\n{'fuzz':20}{(campaign.__doc__ or '').splitlines()[0]} See `fuzz --help`."
        + f"\n{'simulators':20}{(simulators.__doc__ or '').splitlines()[0]} See `simulators --help`.",
    )
    parser.add_argument("names", nargs="*", choices=[*MEASUREMENTS, []], help="which to run; all by default")
    for name in parser.parse_args().names or MEASUREMENTS:
        MEASUREMENTS[name]()
    return 0


if __name__ == "__main__":
    sys.exit(main())
