"""What each simulator makes of exported robots with loops.

Each robot moves under gravity for 2 s from its assembled configuration. Simulators that are not installed are left out.
"""

from __future__ import annotations

import argparse
import os
import platform
import re
import sys
from collections.abc import Callable, Iterator, Sequence
from datetime import datetime, timezone
from functools import partial
from importlib.metadata import PackageNotFoundError, version
from importlib.util import find_spec
from pathlib import Path

import eurdf
from benchmarks.simulators.exported_robot import ROBOTS, plain_robot
from benchmarks.simulators.newton_run import HOW, SOLVERS, VARIABLE, ask_newton, run_newton
from benchmarks.simulators.run import Refused, Run, energy_changes, worst_opening

#: s.
STEP, DURATION = 1e-3, 2.0

#: Openings up to which a loop counts as closed, m and rad.
CLOSED = 1e-3, 1e-2

_HEAD = (
    "| robot | simulator | freedoms | loop opens by | energy gained | energy lost | time for 1 s |",
    "| --- | --- | --- | --- | --- | --- | --- |",
)
_PLACE = re.compile(r"(<!-- table: [^\n]*-->\n).*?(<!-- end of table -->)", re.DOTALL)

Simulator = Callable[[eurdf.Robot], Run | Refused]


def main(argv: Sequence[str]) -> int:
    """Run every simulator that is installed on every robot, and print the table or write it to a page."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks simulators", description=__doc__)
    parser.add_argument("--robots", nargs="+", choices=ROBOTS, default=ROBOTS, help="default: all of these")
    parser.add_argument("--newton", default=os.environ.get(VARIABLE), help=f"Python with Newton; default: ${VARIABLE}")
    parser.add_argument(
        "--solvers", nargs="*", choices=SOLVERS, default=SOLVERS, help="of Newton; default: all of these"
    )
    parser.add_argument("--seconds", type=float, default=100.0, help="processor time that a run may take; default: 100")
    parser.add_argument("--write", metavar="PAGE", type=Path, help="write the table to a page, between its two marks")
    args = parser.parse_args(argv)
    simulators = dict(_simulators(args.newton, args.solvers, args.seconds))
    lines = []
    for line in table(args.robots, simulators, _versions(args.newton)):
        lines.append(line)
        print(line, flush=True)
    if args.write is not None:
        args.write.write_text(with_table(args.write.read_text(encoding="utf-8"), lines), encoding="utf-8")
    if args.newton is None:
        print(f"Newton is left out: {HOW}", file=sys.stderr)
    return 0


def table(robots: Sequence[str], simulators: dict[str, Simulator], versions: str) -> Iterator[str]:
    """The lines of the table in Markdown, and where it was made."""
    yield f"{datetime.now(timezone.utc):%d %B %Y}; {versions}; one thread of {_processor()}; {platform.system()}."
    yield ""
    yield from _HEAD
    for name in robots:
        robot = plain_robot(name)
        for simulator, run in simulators.items():
            yield f"| {name} | {simulator} | {' | '.join(cells(run(robot), robot))} |"


def cells(found: Run | Refused, robot: eurdf.Robot) -> Iterator[str]:
    """The cells of a row after the names."""
    if isinstance(found, Refused):
        yield "refused"
        yield _one_line(found.reason)
        yield from [""] * 3
        return
    mechanism = robot.mechanism
    rows = sum(closure.rows for closure in mechanism.closures)
    if found.freedoms == robot.model.nv and found.rows >= rows:
        yield "right"
    else:
        yield f"**{found.freedoms}, not {robot.model.nv}; {found.rows} rows, not {rows}**"
    at = found.diverges_at
    if at is None:
        distance, angle = worst_opening(found, mechanism)
        text = f"{_short(1e3 * distance)} mm" + (f", {_short(1e3 * angle)} mrad" if angle else "")
        text = text if distance < CLOSED[0] and angle < CLOSED[1] else f"**{text}**"
        stopped = found.duration < DURATION - STEP / 2
        yield text + (f" (until {found.duration:.2g} s)" if stopped else "")
        gained, lost = energy_changes(found, mechanism)
        yield f"{_short(100 * gained)} %"
        yield f"{_short(100 * lost)} %"
    else:
        yield f"**diverges at {at:.2g} s**"
        yield from [""] * 2
    yield f"{_short(found.seconds)} s"


def with_table(page: str, lines: Sequence[str]) -> str:
    """The page with other lines between its marks."""
    return _PLACE.sub(lambda found: found[1] + "\n".join(lines) + "\n" + found[2], page)


def _simulators(newton: str | None, solvers: Sequence[str], seconds: float) -> Iterator[tuple[str, Simulator]]:
    steps = round(DURATION / STEP)
    if find_spec("mujoco"):
        from benchmarks.simulators.mujoco_run import run_mujoco

        yield "MuJoCo, from MJCF", partial(run_mujoco, step=STEP, steps=steps)
    if find_spec("pydrake"):
        from benchmarks.simulators.drake_run import run_drake

        yield "Drake, from its URDF", partial(run_drake, step=STEP, steps=steps)
    if newton is not None:
        for solver in solvers:
            run = partial(run_newton, newton, solver=solver, step=STEP, steps=steps, seconds=seconds)
            yield f"Newton {solver}, from USD", run


def _versions(newton: str | None) -> str:
    packages = {"mujoco": "MuJoCo", "drake": "Drake", "eurdf": "eurdf"}
    found = []
    for package, name in packages.items():
        try:
            found.append(f"{name} {version(package)}")
        except PackageNotFoundError:
            continue
    if newton is not None:
        answer = ask_newton(newton, None)
        found.append(f"Newton {answer['newton']} with MuJoCo {answer['mujoco']}")
    return ", ".join(found)


def _processor() -> str:
    try:
        (name, *_) = re.findall(r"model name\s*: (.*)", Path("/proc/cpuinfo").read_text())
    except (OSError, ValueError):
        return platform.machine()
    return str(name)


def _short(value: float) -> str:
    """Two significant digits, or more before the point."""
    return f"{value:.2g}" if abs(value) < 99.5 else f"{value:.0f}"


def _one_line(text: str) -> str:
    """A message that fits in a cell."""
    line = " ".join(text.split()).replace("|", "\\|")
    return line if len(line) <= 150 else line[:149] + "…"
