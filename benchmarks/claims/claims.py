"""Rerun what the comparison with other formats says was seen by running."""

from __future__ import annotations

import argparse
import importlib
import importlib.util
import re
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Literal

from benchmarks.claims.expectation import OtherwiseError

PAGE = Path(__file__).parents[2] / "spec" / "comparison.md"

#: The mark of a claim that was seen by running.
MARK = "▸"

_DISTRIBUTIONS = {"mujoco": "mujoco", "drake": "drake", "pinocchio": "pin", "usd": "usd-core"}
_MODULES = {"mujoco": "mujoco", "drake": "pydrake", "pinocchio": "pinocchio", "usd": "pxr"}


@dataclass(frozen=True, slots=True)
class Claim:
    """A claim of the page.

    Attributes:
        words: Words of the page, which contain its mark; one claim may have several.
        reruns: What reruns it: names of a program and of a function of ``benchmarks.claims.PROGRAM_claims``.
    """

    words: tuple[str, ...]
    reruns: tuple[tuple[str, str], ...]


CLAIMS = (
    Claim(("| Drake | yes ▸ | yes ▸ | yes ▸ |", "linear ▸"), (("drake", "joint_types"),)),
    Claim(("in URDF `transmission`; in SDF each joint with a non-zero effort limit ▸",), (("drake", "actuators"),)),
    Claim(("▸ (in schemas of vendors)",), (("usd", "mimic_joints"),)),
    Claim(("the compiler: unknown elements, impossible inertias ▸",), (("mujoco", "compiler_checks"),)),
    Claim(
        ("Pinocchio 4.1 reads `connect` and `weld` between sites, and no joint equality ▸",),
        (("pinocchio", "equalities_of_mjcf"),),
    ),
    Claim(
        ("and ignores `connect` between sites, `weld` and joint equalities with a warning ▸",),
        (("drake", "equalities_of_mjcf"),),
    ),
    Claim(
        ("**Drake** reads a ball constraint from a file ▸", "silently ignored in URDF ▸"),
        (("drake", "weld_in_files"),),
    ),
    Claim(("TAMSI rejects a ball constraint; the default solver accepts it ▸",), (("drake", "solvers"),)),
    Claim(("Drake rejects such a file with an error ▸",), (("drake", "loop_in_sdf"),)),
    Claim(("this pin opens by up to 1.6 mm within two seconds ▸",), (("mujoco", "pin_opens"),)),
    Claim(
        ("The loop of the four-bar then becomes ▸",),
        (("pinocchio", "loops_in_urdf"), ("mujoco", "loops_in_urdf"), ("drake", "loops_in_urdf")),
    ),
    Claim(("and MuJoCo and Drake reject it ▸",), (("mujoco", "two_parents"), ("drake", "two_parents"))),
    Claim(("four gave an error about a body that exists ▸",), (("pinocchio", "two_parents"),)),
)


@dataclass(frozen=True, slots=True)
class Rerun:
    """The outcome of one rerun.

    Attributes:
        program: What was run, with its version.
        outcome: Whether the claim holds; ``not run`` if the program is not installed.
        seen: What was seen.
    """

    program: str
    outcome: Literal["holds", "does not hold", "not run"]
    seen: str


def rerun(program: str, function: str) -> Rerun:
    """Rerun one claim in a process of its own, since a program under test may crash."""
    if importlib.util.find_spec(_MODULES[program]) is None:
        return Rerun(program, "not run", f"{program} is not installed: pip install -e '.[drake,mujoco,usd]'")
    shown = f"{program} {_version(program)}"
    command = [sys.executable, "-m", "benchmarks.claims.claims", program, function]
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=300)
    if done.returncode in (0, 1) and done.stdout:
        return Rerun(shown, "holds" if done.returncode == 0 else "does not hold", done.stdout.strip())
    last = (done.stderr.strip().splitlines() or [""])[-1]
    return Rerun(shown, "does not hold", f"ended with {done.returncode}: {last}")


def _version(program: str) -> str:
    try:
        return version(_DISTRIBUTIONS[program])
    except PackageNotFoundError:
        return ""


def unclaimed(page: str) -> list[str]:
    """What a page and `CLAIMS` do not share: marks without a rerun, and words that the page does not contain."""
    text = " ".join(page.split())
    errors = []
    marked = {match.start() for match in re.finditer(MARK, text)}
    marked -= {text.index(f"Facts marked {MARK}") + len("Facts marked ")}
    for claim in CLAIMS:
        for words in claim.words:
            if text.count(words) != 1:
                errors.append(f"the page contains {text.count(words)} times: {words}")
            else:
                start = text.index(words)
                marked -= set(range(start, start + len(words)))
    return errors + [f"no rerun of: …{text[max(0, at - 60) : at + 1]}" for at in sorted(marked)]


def reruns() -> Iterator[tuple[Claim, Rerun]]:
    """The claims, each with each of its reruns."""
    for claim in CLAIMS:
        for program, function in claim.reruns:
            yield claim, rerun(program, function)


def main(arguments: list[str]) -> int:
    """Print each claim and whether it still holds; 1 if one does not."""
    argparse.ArgumentParser(prog="python -m benchmarks claims", description=__doc__).parse_args(arguments)
    failed = 0
    for error in unclaimed(PAGE.read_text(encoding="utf-8")):
        failed = 1
        print(f"error: {error}")
    for claim, found in reruns():
        failed |= found.outcome == "does not hold"
        print(f"{found.outcome:14}{' … '.join(claim.words)}\n{'':14}{found.program}: {found.seen}", flush=True)
    return failed


def _one(program: str, function: str) -> int:
    """Rerun one claim in this process and print what was seen; 1 if it is not what the page says."""
    module = importlib.import_module(f"benchmarks.claims.{program}_claims")
    try:
        print(getattr(module, function)())
    except OtherwiseError as otherwise:
        print(otherwise)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(_one(*sys.argv[1:]))
