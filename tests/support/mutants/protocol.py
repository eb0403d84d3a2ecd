"""Mutants that read correctly but violate the protocol. The protocol rules catch them, not the cases.

Most relay a correct process and change the lines it writes; the others are Python objects.
"""

from __future__ import annotations

import re
import shlex
import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from eurdf_conformance.adapters.reference import Reference
from eurdf_conformance.judging.verdict import Verdict
from eurdf_conformance.protocol import serve
from eurdf_conformance.protocol.message import Accepted, Rejected

TESTS = str(Path(__file__).parents[2])


@dataclass(frozen=True)
class ProtocolMutant:
    """A parser that violates the protocol.

    Attributes:
        wrong: Changes each line, or returns None to end the process; or the parser class itself.
        clause: The clause that it violates.
        verdicts: The verdicts that count as caught.
    """

    wrong: Callable[[bytes], bytes | None] | type[Reference]
    clause: str
    verdicts: frozenset[Verdict]

    @property
    def parser(self) -> str:
        """The parser as an argument of the suite."""
        name = self.wrong.__name__
        code = f"import sys; sys.path.insert(0, {TESTS!r}); from {__name__} import run; run({name!r})"
        return "cmd:" + shlex.join([sys.executable, "-c", code])


PROTOCOL_MUTANTS: dict[str, ProtocolMutant] = {}


def _violates(clause: str, *verdicts: Verdict) -> Callable[[Any], Any]:
    def register(wrong: Any) -> Any:
        PROTOCOL_MUTANTS[wrong.__name__] = ProtocolMutant(wrong, clause, frozenset(verdicts))
        return wrong

    return register


@_violates("EU-PRO-001", Verdict.MISPLACED)
def answers_without_the_id(line: bytes) -> bytes:
    """The answers have the id 0, whatever that of the request."""
    return re.sub(rb'"id":\s*\d+', b'"id":0', line, count=1)


@_violates("EU-PRO-001", Verdict.CHATTER)
def answers_twice(line: bytes) -> bytes:
    """Each request is answered twice."""
    return line + line


@_violates("EU-PRO-001", Verdict.CRASHED)
def ends_after_one_answer(line: bytes) -> bytes | None:
    """The process ends after its first answer."""
    return line if b'"started"' in line else None


@_violates("EU-PRO-002", Verdict.CHATTER, Verdict.MALFORMED)
def talks_while_it_reads(line: bytes) -> bytes:
    """What a library prints is on the standard output, too."""
    return b"Warning: no transmission found\n" + line if b'"issues"' in line else line


@_violates("EU-PRO-003", Verdict.MALFORMED)
def misspells_a_member(line: bytes) -> bytes:
    """A member of each answer is misspelt."""
    return line.replace(b'"outcome"', b'"result"')


@_violates("EU-PRO-003", Verdict.MALFORMED)
def writes_json_of_python(line: bytes) -> bytes:
    """The answers are what Python prints of a dictionary."""
    return line.replace(b'"', b"'")


@_violates("EU-PRO-004", Verdict.ERRORED)
class FailsInsteadOfRejecting(Reference):
    """Where the description is wrong, it answers `errored`."""

    def load(self, description: Path, urdf: Path) -> Accepted | Rejected:
        answer = super().load(description, urdf)
        if isinstance(answer, Rejected):
            raise ValueError(answer.issues[0].message)
        return answer


@_violates("EU-PRO-005", Verdict.ERRORED)
class GoneAfterRejecting(Reference):
    """Reads nothing after a rejection."""

    _rejected = False

    def load(self, description: Path, urdf: Path) -> Accepted | Rejected:
        if self._rejected:
            raise RuntimeError("the parser is not in a state to read")
        answer = super().load(description, urdf)
        self._rejected = isinstance(answer, Rejected)
        return answer


def run(name: str) -> None:
    """Be one of them, over standard input and output."""
    wrong = PROTOCOL_MUTANTS[name].wrong
    if isinstance(wrong, type):
        serve.main(f"{__name__}:{name}")
        return
    command = [sys.executable, "-m", serve.__name__, "eurdf_conformance.adapters.reference:PARSER"]
    with subprocess.Popen(command, stdin=sys.stdin, stdout=subprocess.PIPE) as child:
        for line in child.stdout or ():
            if (spoilt := wrong(line)) is None:
                child.kill()
                return
            sys.stdout.buffer.write(spoilt)
            sys.stdout.buffer.flush()
