"""Computes what is expected of the valid cases, with the oracle.

``python -m eurdf_conformance.corpus.expect [CASE…]`` writes the `expected.json` of all valid cases, or of those named;
``--check`` writes nothing and says which differ. One that is written by hand is never overwritten.
"""

from __future__ import annotations

import argparse
import math
import sys
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, get_args

from pydantic import ValidationError

from eurdf_conformance.comparison.canonical import canonical_differences
from eurdf_conformance.comparison.values import values_differences
from eurdf_conformance.corpus.case import ValidCase
from eurdf_conformance.corpus.expected import Expected, expected_text
from eurdf_conformance.corpus.read import CorpusCase, read_cases
from eurdf_conformance.oracle import NotRead, OracleRobot, read
from eurdf_conformance.protocol.message import Quantity, Values

#: Digits kept of a number, relative to the largest of its kind; further digits depend on the processor.
_DIGITS = 12


def expect(case: CorpusCase) -> Expected:
    """The oracle's expectation for a valid case.

    Raises:
        NotRead: The oracle is not sure of the files.
    """
    assert isinstance(case.case, ValidCase)
    robot = read(case.description, case.urdf, case.case.version)
    return expected_of(robot, case.case.configurations, case.case.frames)


def expected_of(
    robot: OracleRobot, configurations: Sequence[Mapping[str, Sequence[float]]], frames: Sequence[str]
) -> Expected:
    """What is expected of a parser that reads a robot.

    Args:
        robot: The robot as the oracle reads it.
        configurations: Where it is evaluated.
        frames: Names of the frames whose poses are asked for.
    """
    return Expected(
        bodies=sorted(sorted(body, key=str.encode) for body in robot.bodies),
        robot=robot.canonical(),
        values=[_rounded(robot.evaluate(q, frames, get_args(Quantity))) for q in configurations],
        sizes=[_round(robot.size(q)) for q in configurations],
    )


def stale(case: CorpusCase) -> Iterator[str]:
    """Why an `expected.json` differs from the oracle's; numbers may differ as much as those of two parsers."""
    assert isinstance(case.case, ValidCase)
    try:
        found, now = case.expected, expect(case)
    except (OSError, ValidationError, NotRead) as error:
        yield f"{type(error).__name__}: {error}"
        return
    if sorted(map(sorted, found.bodies)) != sorted(map(sorted, now.bodies)):
        yield f"bodies: expected {now.bodies}, given {found.bodies}"
    yield from map(str, canonical_differences(now.robot, found.robot, now.bodies))
    if len(found.values) != len(now.values) or len(found.sizes) != len(now.sizes):
        yield f"values: {len(found.values)}, sizes: {len(found.sizes)}, configurations: {len(now.values)}"
        return
    by_hand = case.case.provenance.expectation == "hand"
    for index, (one, other, size) in enumerate(zip(now.values, found.values, now.sizes, strict=True)):
        if by_hand:  # values by hand may be some of all
            one = one.model_copy(update={name: None for name in Values.model_fields if getattr(other, name) is None})
        yield from (str(each.within(f"/values/{index}")) for each in values_differences(one, other, size))
    for index, (now_size, size) in enumerate(zip(now.sizes, found.sizes, strict=True)):
        if not math.isclose(now_size, size, rel_tol=1e-6, abs_tol=1e-9):
            yield f"/sizes/{index}: expected {now_size}, given {size}"


def main(arguments: Sequence[str] | None = None) -> int:
    """Write, or check, the expectations of valid cases.

    Returns:
        0 where all is well, 1 where an expectation is not, or could not be written.
    """
    parser = argparse.ArgumentParser(prog="python -m eurdf_conformance.corpus.expect", description=__doc__)
    parser.add_argument("names", nargs="*", metavar="CASE", help="topic/name of a valid case; all of them if left out")
    parser.add_argument("--check", action="store_true", help="write nothing, say which differ")
    options = parser.parse_args(arguments)
    cases = [case for case in read_cases() if isinstance(case.case, ValidCase)]
    if unknown := set(options.names) - {case.name for case in cases}:
        parser.error(f"there is no valid case {', '.join(sorted(unknown))}")
    failed = False
    for case in cases:
        if options.names and case.name not in options.names:
            continue
        path, by_hand = case.expectation, case.case.provenance.expectation == "hand"
        if options.check or (by_hand and path.exists()):
            errors = list(stale(case))
            failed |= bool(errors)
            sys.stdout.writelines(f"{path}: {error}\n" for error in errors)
            continue
        try:
            text = expected_text(expect(case))
        except NotRead as error:
            failed = True
            sys.stdout.write(f"{path}: the oracle does not read the files: {error}\n")
            continue
        # An expectation that says the same is left as it is, whatever the last digit of this machine.
        if not path.exists() or any(stale(case)):
            path.write_text(text, encoding="utf-8")
            sys.stdout.write(f"{path}: written\n")
    return int(failed)


def _rounded(values: Values) -> Values:
    return Values.model_validate(_round(values.model_dump(mode="python", exclude_none=True)), strict=False)


def _round(value: Any, scale: float | None = None) -> Any:
    """Round numbers; those in one list or mapping of numbers are of one kind."""
    if isinstance(value, dict):
        return {key: _round(each) for key, each in value.items()}
    if isinstance(value, list | tuple):
        scale = scale or _largest(value)
        return [_round(each, scale) for each in value]
    if isinstance(value, float):
        scale = scale or abs(value)
        digits = _DIGITS - (math.ceil(math.log10(scale)) if scale else 0)
        return round(value, digits) + 0.0
    return value


def _largest(value: Any) -> float:
    if isinstance(value, list | tuple):
        return max((_largest(each) for each in value), default=0.0)
    return abs(value) if isinstance(value, float) else 0.0


if __name__ == "__main__":
    sys.exit(main())
