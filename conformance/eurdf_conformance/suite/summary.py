"""What a run comes to, as the last lines that pytest writes."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

from eurdf_conformance.suite.smoke import smoke_lines
from eurdf_conformance.verdict.run import Run
from eurdf_conformance.verdict.standing import Standing, standings
from eurdf_conformance.verdict.verdict import Verdict
from eurdf_conformance.visible import visible


def summary_lines(run: Run, unexpected: Sequence[str], certificate: Path | None) -> Iterator[str]:
    """What a run comes to.

    Args:
        run: The run.
        unexpected: What is not as the known failures say.
        certificate: Folder that a certificate was written into.
    """
    return map(visible, _lines(run, unexpected, certificate))


def _lines(run: Run, unexpected: Sequence[str], certificate: Path | None) -> Iterator[str]:
    if run.started is None:
        why = next((result.differences[0] for result in run.results if result.differences), "")
        yield f"{run.parser} could not be started" + (f": {why}" if why else "")
    else:
        reader = run.started.reader
        yield visible(f"{reader.name} {reader.version} ({reader.language})", kept="")
    if run.smoke:
        wrong = [result for result in run.results if result.verdict != Verdict.PASSED]
        yield from smoke_lines(wrong, asked=bool(run.results))
    else:
        asked = [standing for standing in standings(run) if standing.asked]
        yield from (_level(standing) for standing in asked if standing.claimed and _was_run(standing))
        yield from _others("not run", [standing for standing in asked if standing.claimed and not _was_run(standing)])
        if run.started is not None:
            yield from _others("not claimed", [standing for standing in asked if not standing.claimed])
    yield from (f"known failures: {line}" for line in unexpected)
    yield _times(run)
    if certificate is not None:
        yield f"certificate: {certificate}"


def _was_run(standing: Standing) -> bool:
    return any(count for verdict, count in standing.counts.items() if verdict != Verdict.NOT_RUN)


def _others(what: str, standings: Sequence[Standing]) -> Iterator[str]:
    if standings:
        yield f"{what}: " + ", ".join(f"{each.level} of version {each.version}" for each in standings)


def _level(standing: Standing) -> str:
    passed = standing.counts.get(Verdict.PASSED, 0)
    others = [f"{count} {verdict}" for verdict, count in standing.counts.items() if verdict != Verdict.PASSED and count]
    text = f"version {standing.version}, {standing.level}: {passed} of {sum(standing.counts.values())} passed"
    known = f", of which {standing.known_failures} known" if standing.known_failures else ""
    detail = f" ({', '.join(others)}{known})" if others else ""
    return text + detail + (": certified" if standing.certified else ": not certified")


def _times(run: Run) -> str:
    total = sum(result.seconds for result in run.results)
    reader = sum(result.seconds_in_reader for result in run.results)
    share = f", {reader / total:.0%} of it in the reader" if total else ""
    return f"{len(run.results)} items, {total:.1f} s of asking{share}"
