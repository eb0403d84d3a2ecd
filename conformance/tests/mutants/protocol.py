"""Mutants that read correctly but violate the protocol. The protocol rules catch them, not the cases.

Those of `parsers.relay` change the lines of a correct process; the others are Python objects.
"""

from __future__ import annotations

import shlex
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from eurdf_conformance.adapters.reference import Reference
from eurdf_conformance.judging.verdict import Verdict
from eurdf_conformance.protocol import serve
from eurdf_conformance.protocol.message import Accepted, Rejected
from parsers import relay

TESTS = str(Path(__file__).parents[1])


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
        if isinstance(self.wrong, type):
            code = f"import sys; sys.path.insert(0, {TESTS!r}); from {__name__} import be; be({name!r})"
            return "cmd:" + shlex.join([sys.executable, "-c", code])
        right = [sys.executable, "-m", serve.__name__, "eurdf_conformance.adapters.reference:PARSER"]
        return "cmd:" + shlex.join([sys.executable, relay.__file__, name, *right])


PROTOCOL_MUTANTS: dict[str, ProtocolMutant] = {}


def _violates(clause: str, *verdicts: Verdict) -> Callable[[Any], Any]:
    def register(wrong: Any) -> Any:
        PROTOCOL_MUTANTS[wrong.__name__] = ProtocolMutant(wrong, clause, frozenset(verdicts))
        return wrong

    return register


_violates("EU-PRO-001", Verdict.MISPLACED)(relay.answers_without_the_id)
_violates("EU-PRO-001", Verdict.CHATTER)(relay.answers_twice)
_violates("EU-PRO-001", Verdict.CRASHED)(relay.ends_after_one_answer)
_violates("EU-PRO-002", Verdict.CHATTER, Verdict.MALFORMED)(relay.talks_while_it_reads)
_violates("EU-PRO-003", Verdict.MALFORMED)(relay.misspells_a_member)
_violates("EU-PRO-003", Verdict.MALFORMED)(relay.writes_json_of_python)


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


@_violates("EU-PRO-005", Verdict.FAILED)
class RepeatsRejecting(Reference):
    """Gives the answer of a rejected `load` to the next one too."""

    _rejected: Rejected | None = None

    def load(self, description: Path, urdf: Path) -> Accepted | Rejected:
        if self._rejected:
            answer, self._rejected = self._rejected, None
            return answer
        answer = super().load(description, urdf)
        self._rejected = answer if isinstance(answer, Rejected) else None
        return answer


def be(name: str) -> None:
    """Be one of the Python objects, over standard input and output."""
    serve.main(f"{__name__}:{name}")
