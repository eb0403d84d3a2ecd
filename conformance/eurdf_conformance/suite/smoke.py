"""The smoke run: three cases of each version that show whether the adapter of a parser works."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from eurdf_conformance.corpus.read import CorpusCase
from eurdf_conformance.judging.result import Result
from eurdf_conformance.judging.verdict import OF_THE_ADAPTER, Verdict
from eurdf_conformance.level import Level, Version
from eurdf_conformance.level_spec import Compared, levels_comparing
from eurdf_conformance.suite.item import CaseItem


@dataclass(frozen=True, slots=True)
class Three:
    """Names of a valid case, of an invalid one, and of one that is evaluated."""

    valid: str
    invalid: str
    evaluated: str


#: Plain cases, within reach of the smallest parser: a loop with one closure; an obvious error, such as invalid XML or
#: an unknown name; and a tree.
SMOKE: dict[Version, Three] = {
    "1": Three(
        valid="frames/closure-behind-fixed-joints-v1", invalid="urdf/tag-not-closed-v1", evaluated="urdf/gantry-v1"
    ),
    "2": Three(
        valid="closures/parallelogram-3d-closure", invalid="frames/closure-at-unknown-frame", evaluated="urdf/gantry"
    ),
    "2.1": Three(
        valid="closures/hinge-in-parallelogram",
        invalid="schema/hinge-with-axis-and-axes",
        evaluated="closures/hinge-with-axis",
    ),
}


#: Lines shown of a log.
_LOG = 30

_LEVELS: Mapping[str, tuple[Level, ...]] = {
    name: levels
    for three in SMOKE.values()
    for name, levels in (
        (three.valid, levels_comparing(Compared.OUTCOME, Compared.ROBOT, Compared.ISSUES)),
        (three.invalid, levels_comparing(Compared.OUTCOME, Compared.ISSUES)),
        (three.evaluated, levels_comparing(Compared.VALUES)),
    )
}


def smoke_case(cases: Iterable[CorpusCase], name: str) -> CorpusCase:
    """The case with this name."""
    return next(case for case in cases if case.name == name)


def smoke_levels(item: CaseItem) -> tuple[Level, ...]:
    """The levels at which a case of the smoke run may be tested.

    It is tested at the first of them that the parser claims, so every parser with a claim is tested on something.
    """
    return _LEVELS.get(item.case.name, ())


def smoke_lines(wrong: Sequence[Result], asked: bool) -> Iterator[str]:
    """The lines of a smoke run: first what is wrong with the adapter, then what is wrong with the parser.

    Args:
        wrong: The results that did not pass.
        asked: Whether anything was tested.
    """
    if not asked:
        yield "nothing was tested: your parser claims none of the requested levels"
        return
    adapter = [result for result in wrong if result.verdict in OF_THE_ADAPTER]
    parser = [result for result in wrong if result.verdict not in OF_THE_ADAPTER]
    yield from _part("adapter", "it follows the protocol", adapter)
    if adapter and not parser:
        further = "" if all(result.verdict == Verdict.NOT_STARTED for result in adapter) else " any further"
        yield f"your parser was not tested{further}: fix the adapter first"
    else:
        yield from _part("parser", "its answers are correct", parser)


def _part(name: str, right: str, wrong: list[Result]) -> Iterator[str]:
    if not wrong:
        yield f"your {name} works so far: {right}"
        return
    yield f"your {name} fails:"
    groups: dict[str, list[Result]] = {}
    for result in wrong:
        why = "".join(result.differences[:1]).partition("\n")[0]
        groups.setdefault(f"{result.verdict}{f': {why}' if why else ''}", []).append(result)
    for how, alike in groups.items():
        # A case before the rules of the protocol, whose failure is mostly that of a case.
        first = min(alike, key=lambda result: result.item.id.startswith("protocol/"))
        more = len(alike) - 1
        yield f"  {first.item.id}/{first.item.level}: {how}"
        # The first line of a log names the verdict again.
        lines = (line.strip() for line in first.log.splitlines() if not line.startswith(f"{first.verdict}:"))
        yield from (f"    {line}" for line in list(lines)[-_LOG:])
        if more:
            yield f"    and so {'does' if more == 1 else 'do'} {more} more: {_names(alike, first)}"
        yield f"    {first.reproduce}"


def _names(alike: Sequence[Result], first: Result) -> str:
    return ", ".join(f"{each.item.id}/{each.item.level}" for each in alike if each is not first)
