"""``python -m robots.quality [NAME|FOLDER …] [--json]``: run the quality checks of the collection."""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Iterable, Sequence
from typing import Any

# Before NumPy is loaded: the matrices are too small for a thread pool.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import eurdf
from eurdf.commands.terminal import Table, write_json, write_lines, write_shown
from eurdf.diagnostics.wording import visible
from eurdf.kinematics.sweep import MotionPath, Sweep
from robots.quality.candidate import Candidate
from robots.quality.motion import is_angular, is_endless, shown
from robots.quality.verdict import RULES, Verdict, judge


def main(arguments: Sequence[str] | None = None) -> int:
    """Check robots; return 0 if all pass, 1 if some do not, 2 if one is not found."""
    parser = argparse.ArgumentParser(
        "python -m robots.quality",
        description="Run the quality checks of the collection on robots.",
        epilog="Exit codes: 0 all robots pass, 1 errors found, 2 robot not found.",
    )
    parser.add_argument(
        "robots",
        nargs="*",
        metavar="ROBOT",
        help="a robot of the collection, or a folder; default: the whole collection",
    )
    parser.add_argument("--json", action="store_true", help="write one JSON object")
    options = parser.parse_args(arguments)
    try:
        candidates = [Candidate.find(robot) for robot in options.robots or eurdf.collection_names()]
    except eurdf.errors.RobotNotFound as reason:
        print(reason, file=sys.stderr)
        return 2
    verdicts = [judge(candidate) for candidate in candidates]
    if options.json:
        write_json({"robots": [_as_json(verdict) for verdict in verdicts]})
    else:
        _show(verdicts)
    return 0 if all(verdict.passes for verdict in verdicts) else 1


def _show(verdicts: Sequence[Verdict]) -> None:
    marks = {None: ("-", "dim"), True: ("ok", "green"), False: ("no", "bold red")}
    rows = (
        (
            (verdict.candidate.folder.name, "bold"),
            *(marks[None if errors is None else not errors] for errors in verdict.errors.values()),
        )
        for verdict in verdicts
    )
    write_shown(Table("robot", *RULES, rows=rows))
    if len(verdicts) == 1 and verdicts[0].errors["motion"] is not None:
        write_lines([[]], sys.stdout)
        write_shown(_sweeps(verdicts[0].candidate))
    for verdict in verdicts:
        for rule, errors in verdict.errors.items():
            where = [(f"{verdict.candidate.folder.name}: ", "bold"), (f"{rule}: ", "red")]
            write_lines([[*where, (visible(error), "")] for error in errors or ()], sys.stdout)


def _sweeps(candidate: Candidate) -> Table:
    """The range of motion of each actuator: its bounds, what ends it, and its worst numbers."""
    headings = ("actuator", "bounds", "reached", "lower end", "upper end", "residual", "correction", "singularity")
    rows = []
    for actuator, found in candidate.sweeps.items():
        if isinstance(found, str):
            continue
        angular, paths = is_angular(candidate.robot, actuator), (found.lower, found.upper)
        row = (
            (actuator, "bold"),
            "none" if is_endless(candidate.robot, actuator) else _range(found.bounds, angular),
            _range((path.reached for path in paths), angular),
            *(path.joint or path.end for path in paths),
            f"{max(path.residual for path in paths):.0e}",
            f"{max(path.correction for path in paths):.1e}",
            f"{min(path.singularity for path in paths):.2f}",
        )
        rows.append(row)
    return Table(*headings, rows=rows)


def _range(coordinates: Iterable[float], angular: bool) -> str:
    return " … ".join(shown(coordinate, angular) for coordinate in coordinates)


def _as_json(verdict: Verdict) -> dict[str, Any]:
    candidate = verdict.candidate
    sweeps = candidate.sweeps if verdict.errors["motion"] is not None else {}
    return {
        "name": candidate.folder.name,
        "folder": str(candidate.folder),
        "passes": verdict.passes,
        "rules": verdict.errors,
        "sweeps": [_sweep_as_json(found) for found in sweeps.values() if isinstance(found, Sweep)],
    }


def _sweep_as_json(found: Sweep) -> dict[str, Any]:
    return {
        "actuator": found.actuator,
        "bounds": found.bounds,
        "lower": _path_as_json(found.lower),
        "upper": _path_as_json(found.upper),
        "periodic": found.periodic,
    }


def _path_as_json(path: MotionPath) -> dict[str, Any]:
    return {
        "end": path.end,
        "joint": path.joint,
        "reached": path.reached,
        "residual": path.residual,
        "correction": path.correction,
        "singularity": path.singularity,
    }


if __name__ == "__main__":
    sys.exit(main())
