"""A diagnostic: what is wrong, where, and what to do."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from functools import cached_property, partial

from eurdf.diagnostics.fix import Fix
from eurdf.diagnostics.lines import Lines
from eurdf.diagnostics.registry import REFUSED_PHASES, REGISTRY, Phase, Severity
from eurdf.diagnostics.wording import no_command, visible

#: Maximum number of listed diagnostics of one code; the last one says how many more there are.
LISTED = 100

#: Questions that a hint asks, at most.
ASKED = 2

#: Diagnostics whose proposals are tried, at most: each trial reads the robot again.
TRIED = 20

#: Length of a message or hint above which long names in it are shortened.
LONGEST = 1000

#: Characters kept at the start of a shortened name; half as many are kept at its end.
NAME_KEPT = 60

_LONG_NAME = re.compile(rf"'([^']{{{NAME_KEPT}}})[^']*([^']{{{NAME_KEPT // 2}}})'")

#: A hint, or a function that finds it if that takes time.
Hint = str | None | Callable[[], str | None]

#: Fixes to try, the likeliest first, or a function that finds them if that takes time.
Proposals = Iterable[Fix] | Callable[[], Iterable[Fix]]


@dataclass(frozen=True, slots=True)
class Place:
    """A place in a file (EU-DIA-009).

    Attributes:
        file: Path as the user gave it.
        line: Line, from 1; None for the whole file (EU-DIA-010).
        column: Column, from 1, in characters; None if only the line is known.
        end_column: Column after the last character of the place, on the same line; None if unknown.
        pointer: JSON pointer of the value in a YAML file, XPath of the element or attribute in a URDF.
        lines: The text that contains the place, to show its line; None if it must not be shown.
    """

    file: str
    line: int | None = None
    column: int | None = None
    end_column: int | None = None
    pointer: str = ""
    lines: Lines | None = field(default=None, compare=False, repr=False)

    def __str__(self) -> str:
        return ":".join(str(part) for part in (self.file, self.line, self.column) if part is not None)


class Diagnostic:
    """One diagnostic: a code of the registry, what is wrong, where, and what to do (EU-DIA-008).

    Attributes:
        code: Its code in the registry.
        message: What is wrong, in one sentence; names are shortened if it is longer than `LONGEST`.
        hint: What to do about it, or None; shortened likewise. It is an imperative if that is certain, else a question;
            by default, what the proposals ask.
        fix: The edits that do it; None unless a trial showed that they mend it, and that nothing else becomes worse.
        proposals: Fixes that have not been tried, the likeliest first.
        related: Another place in the same file that it is about.
    """

    def __init__(
        self,
        code: str,
        message: str,
        place: Place | Callable[[], Place],
        hint: str | None = None,
        *,
        fix: Fix | None = None,
        proposals: tuple[Fix, ...] = (),
        related: Place | None = None,
    ) -> None:
        self.code = code
        self.message = _bounded(message)
        hint = hint or " ".join([each.question for each in proposals if each.question][:ASKED]) or None
        self.hint = None if hint is None else _bounded(hint)
        self.fix, self.proposals, self.related = fix, proposals, related
        self._place = place

    @cached_property
    def place(self) -> Place:
        """The place, computed on first use: the line in an XML file needs a second pass over the file."""
        return self._place() if callable(self._place) else self._place

    def __getstate__(self) -> dict[str, object]:
        """What is pickled and copied: a place that is computed later needs the whole file."""
        return {**self.__dict__, "_place": self.place}

    def followed_by(self, more: int) -> Diagnostic:
        """The same diagnostic, with a hint that more like it are not listed."""
        untold = f"{more:,} more like it are not listed"
        hint = f"{self.hint}; {untold}" if self.hint else untold
        return Diagnostic(self.code, self.message, self._place, hint, fix=self.fix, proposals=self.proposals)

    def tried(self, is_right: Callable[[Fix], bool]) -> Diagnostic:
        """The same diagnostic without proposals, with the first one that a trial finds right as its fix and hint.

        If none is right, the hint stays.
        """
        if not self.proposals:
            return self
        right = filter(is_right, self.proposals)
        fix = next((each for each in right if each.summary), None)
        if fix is not None and fix.rivals and next(right, None) is not None:
            fix = None
        hint = fix.summary if fix else self.hint
        return Diagnostic(self.code, self.message, self._place, hint, fix=fix, related=self.related)

    @property
    def severity(self) -> Severity:
        """Error or warning, from the registry (EU-DIA-004)."""
        return REGISTRY[self.code].severity

    @property
    def phase(self) -> Phase:
        """Phase of the pipeline that reports it."""
        return REGISTRY[self.code].phase

    @property
    def clause(self) -> str | None:
        """Id of the violated clause of the specification; None for advice of this parser (EU-DIA-006)."""
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
        hint = f" ({self.hint})" if self.hint else ""
        return no_command(visible(f"{self.place}: {self.severity}: {self.message}{hint} [{self.code}]"))

    def __repr__(self) -> str:
        return f"<Diagnostic {self}>"

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Diagnostic):
            return NotImplemented
        mine = (self.code, self.message, self.hint, self.place)
        return mine == (other.code, other.message, other.hint, other.place)

    def __hash__(self) -> int:
        return hash((self.code, self.message, self.hint))


class FileError(Exception):
    """Stops reading a file; carries the diagnostic that says why."""

    def __init__(
        self, code: str, message: str, place: Place, hint: str | None = None, proposals: tuple[Fix, ...] = ()
    ) -> None:
        self.diagnostic = Diagnostic(code, message, place, hint, proposals=proposals)
        super().__init__(str(self.diagnostic))


class Diagnostics:
    """The diagnostics of one robot, in the order found; at most `LISTED` of each code (EU-DIA-007).

    A file can have the same error a hundred thousand times: nobody reads them all, and listing them would take more
    time and memory than reading the file.
    """

    def __init__(self) -> None:
        self._found: list[Diagnostic] = []
        self._count: Counter[str] = Counter()  # by code, listed or not
        self._total = 0
        self._last: dict[str, int] = {}  # by code, the index in `_found` of the last one listed

    def report(
        self,
        code: str,
        message: str,
        place: Place | Callable[[], Place],
        hint: Hint = None,
        proposals: Proposals = (),
    ) -> None:
        """Add a diagnostic with a code of the registry (EU-DIA-005).

        Functions for the hint and for the proposals are called only if it is listed.
        """
        if code not in REGISTRY:
            raise KeyError(code)
        if self._counts_in(code):
            hint = hint() if callable(hint) else hint
            fixes = tuple(proposals() if callable(proposals) else proposals)
            self._found.append(Diagnostic(code, message, place, hint, proposals=fixes))

    def add(self, diagnostic: Diagnostic) -> None:
        """Add an existing diagnostic."""
        if self._counts_in(diagnostic.code):
            self._found.append(diagnostic)

    def _counts_in(self, code: str) -> bool:
        """Count a diagnostic; return whether to list it."""
        self._count[code] += 1
        self._total += 1
        if self._count[code] > LISTED:
            return False
        self._last[code] = len(self._found)
        return True

    def __iter__(self) -> Iterator[Diagnostic]:
        more = {self._last[code]: count - LISTED for code, count in self._count.items() if count > LISTED}
        for index, found in enumerate(self._found):
            yield found.followed_by(more[index]) if index in more else found

    def tried(self, is_right: Callable[[Diagnostic, Fix], bool]) -> None:
        """Try the proposals of the diagnostics, of `TRIED` at most: see `Diagnostic.tried`."""
        proposing = [index for index, found in enumerate(self._found) if found.proposals]
        for index in proposing[:TRIED]:
            found = self._found[index]
            self._found[index] = found.tried(partial(is_right, found))

    def counts(self) -> Counter[str]:
        """The number of diagnostics of each code, listed or not."""
        return Counter(self._count)

    def __len__(self) -> int:
        """Number of diagnostics, listed or not."""
        return self._total

    @property
    def error_count(self) -> int:
        """Number of errors, listed or not."""
        return sum(count for code, count in self._count.items() if REGISTRY[code].severity is Severity.ERROR)

    @property
    def errors(self) -> list[Diagnostic]:
        """The listed errors."""
        return [found for found in self if found.severity is Severity.ERROR]

    @property
    def refused(self) -> bool:
        """Whether a robot with these errors could only be built by guessing."""
        rules = (REGISTRY[code] for code in self._count)
        return any(rule.phase in REFUSED_PHASES and rule.severity is Severity.ERROR for rule in rules)


def _bounded(text: str) -> str:
    """The text, with long names shortened if it is too long, and truncated if that is not enough."""
    if len(text) <= LONGEST:
        return text
    text = _LONG_NAME.sub(r"'\1...\2'", text)
    return text if len(text) <= LONGEST else text[: LONGEST - 3] + "..."
