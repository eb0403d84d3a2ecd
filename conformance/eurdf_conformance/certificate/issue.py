"""Makes the certificate of a run of the suite."""

from __future__ import annotations

import os
import re
from collections import Counter, defaultdict
from collections.abc import Iterable
from datetime import datetime, timezone
from functools import cache

from eurdf_conformance.certificate.certificate import (
    Certificate,
    ClauseResult,
    Failure,
    Scope,
    Suite,
)
from eurdf_conformance.certificate.fingerprint import clauses_hash, properties_hash
from eurdf_conformance.corpus.release import corpus_hash, suite_version
from eurdf_conformance.judging.level_result import is_certified, level_results
from eurdf_conformance.judging.result import Result
from eurdf_conformance.judging.run import Run
from eurdf_conformance.judging.verdict import NO_FAILURE, Verdict
from eurdf_conformance.protocol.message import PROTOCOL

# Which number a request has depends on what the process was asked before it, and that on how a run is spread over
# processes. So does when a parser is given up that no longer starts.
_ID = re.compile(r'("id"\s*:\s*)-?\d+')
_UNSTABLE = (Verdict.MISPLACED, Verdict.NOT_STARTED)


@cache
def installed_suite() -> Suite:
    """The suite that is installed here, as this process read it."""
    return Suite(
        version=suite_version(),
        protocol=PROTOCOL,
        clauses=clauses_hash(),
        corpus=corpus_hash(),
        properties=properties_hash(),
    )


def issue(run: Run) -> Certificate:
    """The certificate of a run. Its date is that of the environment variable SOURCE_DATE_EPOCH, if that is set."""
    results = list(run.accounted())
    return Certificate(
        suite=installed_suite(),
        parser_option=run.parser,
        parser=run.started.parser if run.started else None,
        lacks=run.lacks,
        scope=Scope(
            levels=run.levels,
            versions=run.versions,
            smoke=run.smoke,
            explore=run.explore,
            seed=run.seed,
            fresh=run.fresh,
        ),
        date=_date(os.environ.get("SOURCE_DATE_EPOCH")),
        certified=is_certified(run),
        levels=level_results(run),
        clauses=tuple(_clause_results(results)),
        failures=tuple(_failure(result, run) for result in results if result.verdict not in NO_FAILURE),
        unexpected=tuple(run.known_failures.unexpected(results, run.planned)),
    )


def _date(epoch: str | None) -> str | None:
    if epoch is None or not epoch.isdecimal():
        return None
    return datetime.fromtimestamp(int(epoch), timezone.utc).date().isoformat()


def _clause_results(results: Iterable[Result]) -> Iterable[ClauseResult]:
    verdicts: defaultdict[str, Counter[bool]] = defaultdict(Counter)
    for result in results:
        for clause in result.item.clauses:
            if result.verdict != Verdict.EXCUSED:
                verdicts[clause][result.verdict == Verdict.PASSED] += 1
    for clause, counts in sorted(verdicts.items()):
        yield ClauseResult(id=clause, items=counts.total(), passed=counts[True])


def _failure(result: Result, run: Run) -> Failure:
    return Failure(
        id=result.item.id,
        level=result.item.level,
        version=result.item.version,
        title=result.item.title,
        clauses=result.item.clauses,
        verdict=result.verdict,
        known=run.known_failures.expects(result),
        difference=_difference(result, run),
        log=result.log or None if run.smoke else None,
        reproduce=result.reproduce,
    )


def _difference(result: Result, run: Run) -> str | None:
    if run.started is not None and result.verdict in _UNSTABLE:
        return None
    reason, first, *_ = (*result.differences, "", "")
    lines = [first] if reason in first else [reason, first]
    return _ID.sub(r"\1…", "\n".join(filter(None, lines))) or None
