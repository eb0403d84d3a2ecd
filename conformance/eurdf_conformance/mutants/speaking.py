"""Readers that read well, and speak badly; ``python -m eurdf_conformance.mutants NAME`` lets them speak."""

from __future__ import annotations

from typing import Any

from eurdf_conformance.mutants.deviation import Deviation, around, instead, result
from eurdf_conformance.mutants.mutant import mutant
from eurdf_conformance.protocol import serve
from eurdf_conformance.verdict.verdict import Verdict


def _line(change: Any) -> Deviation:
    """The line of each answer is another."""
    return result(serve, "_written", change)


@mutant("EU-PRO-001", as_process=True, caught_by=frozenset({Verdict.MISPLACED}))
def answers_without_the_id() -> Deviation:
    """The answers are numbered from 0, whatever the request's id."""

    def answer(original: Any, *arguments: Any) -> Any:
        return original(*arguments).model_copy(update={"id": 0})

    return around(serve, "_answer", answer)


@mutant("EU-PRO-001", as_process=True, caught_by=frozenset({Verdict.CHATTER}))
def answers_twice() -> Deviation:
    """Each request is answered twice."""
    return _line(lambda line: line + b"\n" + line)


@mutant("EU-PRO-002", as_process=True, caught_by=frozenset({Verdict.CHATTER, Verdict.MALFORMED}))
def talks_while_it_reads() -> Deviation:
    """What a library below the reader prints as it reads is on the standard output, too."""
    return _line(lambda line: b"Warning: no transmission found\n" + line if b'"issues"' in line else line)


@mutant("EU-PRO-003", as_process=True, caught_by=frozenset({Verdict.MALFORMED}))
def misspelt_member() -> Deviation:
    """A member of each answer is misspelt."""
    return _line(lambda line: line.replace(b'"outcome"', b'"result"'))


@mutant("EU-PRO-003", as_process=True, caught_by=frozenset({Verdict.MALFORMED}))
def json_of_python() -> Deviation:
    """The answers are what Python prints of a dictionary."""
    return _line(lambda line: line.replace(b'"', b"'"))


@mutant("EU-PRO-001", as_process=True, caught_by=frozenset({Verdict.CRASHED}))
def ends_after_one_answer() -> Deviation:
    """The process ends after its first answer."""

    def once(reader: Any, requests: Any, answers: Any) -> None:
        for line in requests:
            answers.write(serve._written(serve._answer_to(reader, line)) + b"\n")
            return

    return instead(serve, "serve", once)
