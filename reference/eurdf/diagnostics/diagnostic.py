"""What is found wrong, where, and what would be right."""

from __future__ import annotations

import difflib
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from functools import cached_property

from eurdf.diagnostics.registry import REFUSED_PHASES, REGISTRY, Phase, Severity


@dataclass(frozen=True, slots=True)
class Place:
    """A place in a file.

    Attributes:
        file: Path as the user gave it.
        line: Line, from 1; None for the file as a whole.
        column: Column, from 1, in characters; None where only the line is known.
        end_column: Column just after the last character meant, on the same line; None if not known.
        pointer: JSON pointer of the value in a YAML file, XPath of the element or attribute in a URDF.
    """

    file: str
    line: int | None = None
    column: int | None = None
    end_column: int | None = None
    pointer: str = ""


class Diagnostic:
    """One finding: a code of the registry, what is wrong, where, and what would be right.

    Attributes:
        code: Its code in the registry.
        message: What is wrong, in one sentence.
        hint: What would be right, or None.
    """

    def __init__(self, code: str, message: str, place: Place | Callable[[], Place], hint: str | None = None) -> None:
        self.code = code
        self.message = message
        self.hint = hint
        self._place = place

    @cached_property
    def place(self) -> Place:
        """Where it is; computed when first asked, since a line in an XML file takes another pass over it."""
        return self._place() if callable(self._place) else self._place

    @property
    def severity(self) -> Severity:
        """Error or warning, as the registry says."""
        return REGISTRY[self.code].severity

    @property
    def phase(self) -> Phase:
        """Phase of the pipeline that found it."""
        return REGISTRY[self.code].phase

    @property
    def clause(self) -> str:
        """Id of the clause of the specification that is not met."""
        return REGISTRY[self.code].clause

    @property
    def file(self) -> str:
        """Path of the file, as the user gave it."""
        return self.place.file

    @property
    def line(self) -> int | None:
        """Line, from 1."""
        return self.place.line

    @property
    def column(self) -> int | None:
        """Column, from 1, in characters."""
        return self.place.column

    @property
    def pointer(self) -> str:
        """JSON pointer (YAML) or XPath (URDF) of the place."""
        return self.place.pointer

    def __str__(self) -> str:
        where = ":".join(str(part) for part in (self.file, self.line, self.column) if part is not None)
        hint = f" ({self.hint})" if self.hint else ""
        return f"{where}: {self.severity}: {self.message}{hint} [{self.code}]"

    def __repr__(self) -> str:
        return f"<Diagnostic {self}>"

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Diagnostic):
            return NotImplemented
        mine = (self.code, self.message, self.hint, self.place)
        return mine == (other.code, other.message, other.hint, other.place)

    def __hash__(self) -> int:
        return hash((self.code, self.message, self.hint))


class Fault(Exception):  # noqa: N818 - it carries one finding; whether that is an error, the registry says
    """Ends the reading of a file at once, with the one diagnostic that says why."""

    def __init__(self, code: str, message: str, place: Place, hint: str | None = None) -> None:
        self.diagnostic = Diagnostic(code, message, place, hint)
        super().__init__(str(self.diagnostic))


class Diagnostics:
    """The findings on one robot, in the order found."""

    def __init__(self) -> None:
        self._found: list[Diagnostic] = []

    def report(self, code: str, message: str, place: Place | Callable[[], Place], hint: str | None = None) -> None:
        """Add a finding; ``code`` must be in the registry."""
        if code not in REGISTRY:
            raise KeyError(code)
        self._found.append(Diagnostic(code, message, place, hint))

    def add(self, diagnostic: Diagnostic) -> None:
        """Add a finding made elsewhere."""
        self._found.append(diagnostic)

    def __iter__(self) -> Iterator[Diagnostic]:
        return iter(self._found)

    def __len__(self) -> int:
        return len(self._found)

    @property
    def errors(self) -> list[Diagnostic]:
        """The findings of severity error."""
        return [found for found in self._found if found.severity is Severity.ERROR]

    @property
    def refused(self) -> bool:
        """Whether an error leaves nothing that could be built without guessing."""
        return any(found.phase in REFUSED_PHASES for found in self.errors)


def did_you_mean(wrong: str, known: Iterable[str]) -> str | None:
    """The hint for a misspelt name: the nearest of the known ones, or None if none is near."""
    candidates = list(known)
    folded = {name.casefold(): name for name in candidates}
    if wrong.casefold() in folded:
        return f"did you mean '{folded[wrong.casefold()]}'?"
    near = difflib.get_close_matches(wrong, candidates, n=1)
    return f"did you mean '{near[0]}'?" if near else None
