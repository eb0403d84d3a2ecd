"""One item of the suite and its result, which a worker process sends to the process that counts."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from pydantic import TypeAdapter

from eurdf_conformance.judging.verdict import Verdict
from eurdf_conformance.level import Level, Version
from eurdf_conformance.visible import cut

#: Name of a result among the user properties of a pytest report.
RESULT = "eurdf_conformance.result"

#: Unique key of an item: id and level.
Key = tuple[str, Level]


@dataclass(frozen=True, slots=True)
class Item:
    """One question: a case or a property, at one level. No two items have the same id and level."""

    #: Topic and id of a case (``closures/k3x9qz``), or name of a property (``properties/…``).
    id: str
    level: Level
    version: Version
    #: Ids of the clauses tested.
    clauses: tuple[str, ...]
    #: A sentence that says what is tested.
    title: str
    #: Whether the files are valid; None for a rule of the protocol.
    valid: bool | None = None

    @property
    def key(self) -> Key:
        """Unique key: id and level."""
        return self.id, self.level


@dataclass(frozen=True, slots=True)
class Result:
    """The result of an item."""

    item: Item
    verdict: Verdict
    #: What was expected and what was given, or what else went wrong: one text each, the most important first. They
    #: contain nothing that differs from run to run: no time, no process id.
    differences: tuple[str, ...] = ()
    #: Command line that runs this item alone.
    reproduce: str = ""
    #: Further details, such as the end of the parser's standard error, which may differ from run to run.
    log: str = ""
    #: Time of the whole item, s.
    seconds: float = 0.0
    #: Time of it spent waiting for the parser, s.
    seconds_in_parser: float = 0.0

    def __post_init__(self) -> None:
        # A line of a broken parser may contain a lone surrogate, which no encoding can represent.
        texts = tuple(cut(text).encode("utf-8", "backslashreplace").decode("utf-8") for text in self.differences)
        object.__setattr__(self, "differences", texts)

    def to_json(self) -> dict[str, Any]:
        """As a JSON object, which another process can read."""
        value: dict[str, Any] = _RESULT.dump_python(self, mode="json")
        return value

    @staticmethod
    def from_json(value: Mapping[str, Any]) -> Result:
        """From the JSON object that `to_json` gives."""
        return _RESULT.validate_python(value)


_RESULT: TypeAdapter[Result] = TypeAdapter(Result)
