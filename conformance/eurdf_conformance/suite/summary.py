"""The summary of a run, as the last lines that pytest prints."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path

from eurdf_conformance.certificate.summary import tallies
from eurdf_conformance.feature import Feature
from eurdf_conformance.judging.level_result import LevelResult, level_results
from eurdf_conformance.judging.run import Run
from eurdf_conformance.judging.verdict import NO_FAILURE, Verdict
from eurdf_conformance.suite.smoke import smoke_lines
from eurdf_conformance.visible import visible

#: So many names of processes are listed.
_NAMED = 10


def summary_lines(run: Run, unexpected: Sequence[str], certificate: Path | None) -> Iterator[str]:
    """The summary of a run.

    Args:
        run: The run.
        unexpected: Where the results differ from the known failures.
        certificate: Folder that a certificate was written into.
    """
    return map(visible, _lines(run, unexpected, certificate))


def _lines(run: Run, unexpected: Sequence[str], certificate: Path | None) -> Iterator[str]:
    if run.started is None:
        why = next((result.differences[0] for result in run.results if result.differences), "")
        yield f"{run.parser} could not be started" + (f": {why}" if why else "")
    else:
        parser = run.started.parser
        yield visible(f"{parser.name} {parser.version} ({parser.language})", kept="")
    if run.smoke:
        wrong = [result for result in run.results if result.verdict not in NO_FAILURE]
        yield from smoke_lines(wrong, asked=bool(run.results))
    else:
        asked = [result for result in level_results(run) if result.asked]
        yield from (_level(result, run.lacks) for result in asked if result.claimed and _was_run(result))
        yield from _others("not run", [result for result in asked if result.claimed and not _was_run(result)])
        if run.started is not None:
            yield from _others("not claimed", [result for result in asked if not result.claimed])
    yield from (f"known failures: {line}" for line in unexpected)
    if run.left:
        names = ", ".join(f"{name} ({count})" for name, count in sorted(Counter(run.left).items())[:_NAMED])
        yield f"the parser left {len(run.left)} processes running outside its process group, which were ended: {names}"
    if not run.smoke:
        yield f"seed: {run.seed}"
    yield _times(run)
    if certificate is not None:
        yield f"certificate: {certificate}"


def _was_run(result: LevelResult) -> bool:
    return any(count for verdict, count in result.counts.items() if verdict != Verdict.NOT_RUN)


def _others(what: str, level_results: Sequence[LevelResult]) -> Iterator[str]:
    if level_results:
        yield f"{what}: " + ", ".join(f"{each.level} of version {each.version}" for each in level_results)


def _level(result: LevelResult, lacks: Sequence[Feature]) -> str:
    passed = result.counts.get(Verdict.PASSED, 0)
    others = [f"{count} {verdict}" for verdict, count in result.counts.items() if verdict != Verdict.PASSED and count]
    text = f"version {result.version}, {result.level}: {passed} of {sum(result.counts.values())} passed"
    text += f", {apart}" if (apart := tallies(result)) else ""
    known = f"; known failures: {result.known_failures}" if result.known_failures else ""
    detail = f" ({', '.join(others)}{known})" if others else ""
    without = f", but for {', '.join(lacks)}" if lacks else ""
    return text + detail + (f": certified{without}" if result.certified else ": not certified")


def _times(run: Run) -> str:
    total = sum(result.seconds for result in run.results)
    parser = sum(result.seconds_in_parser for result in run.results)
    share = f", {parser / total:.0%} of it in the parser" if total else ""
    return f"{len(run.results)} items in {total:.1f} s{share}"
