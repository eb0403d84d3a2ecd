"""A diagnostic: what is wrong, where, and what to do."""

from __future__ import annotations

import difflib
import re
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property

from eurdf.diagnostics.lines import Lines
from eurdf.diagnostics.registry import REFUSED_PHASES, REGISTRY, Phase, Severity
from eurdf.diagnostics.visible import no_command, visible

#: Maximum number of listed diagnostics of one code; the last one says how many more there are.
LISTED = 100

#: Length of a message or hint above which long names in it are shortened.
LONGEST = 1000

#: Characters kept at the start of a shortened name; half as many are kept at its end.
NAME_KEPT = 60

#: Number of similar names that are compared with the name of the element.
_CLOSE = 20

#: Names whose difflib ratios differ by at most this are about equally similar.
_ABOUT = 0.1

#: Maximum number of pairs of letters that the search for the intended name compares.
COMPARED = 40_000

_LONG_NAME = re.compile(rf"'([^']{{{NAME_KEPT}}})[^']*([^']{{{NAME_KEPT // 2}}})'")

#: A hint, or a function that finds it if that takes time.
Hint = str | None | Callable[[], str | None]


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


class Diagnostic:
    """One diagnostic: a code of the registry, what is wrong, where, and what to do (EU-DIA-008).

    Attributes:
        code: Its code in the registry.
        message: What is wrong, in one sentence; names are shortened if it is longer than `LONGEST`.
        hint: What to do about it, or None; shortened likewise.
    """

    def __init__(self, code: str, message: str, place: Place | Callable[[], Place], hint: str | None = None) -> None:
        self.code = code
        self.message = _bounded(message)
        self.hint = None if hint is None else _bounded(hint)
        self._place = place

    @cached_property
    def place(self) -> Place:
        """The place, computed on first use: the line in an XML file needs a second pass over the file."""
        return self._place() if callable(self._place) else self._place

    def __getstate__(self) -> dict[str, object]:
        """What is pickled and copied: a place that is computed later needs the whole file."""
        return {"code": self.code, "message": self.message, "hint": self.hint, "_place": self.place}

    def followed_by(self, more: int) -> Diagnostic:
        """The same diagnostic, with a hint that more like it are not listed."""
        untold = f"{more:,} more like it are not listed"
        return Diagnostic(self.code, self.message, self._place, f"{self.hint}; {untold}" if self.hint else untold)

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
        where = ":".join(str(part) for part in (self.file, self.line, self.column) if part is not None)
        hint = f" ({self.hint})" if self.hint else ""
        return no_command(visible(f"{where}: {self.severity}: {self.message}{hint} [{self.code}]"))

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

    def __init__(self, code: str, message: str, place: Place, hint: str | None = None) -> None:
        self.diagnostic = Diagnostic(code, message, place, hint)
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

    def report(self, code: str, message: str, place: Place | Callable[[], Place], hint: Hint = None) -> None:
        """Add a diagnostic with a code of the registry (EU-DIA-005). A hint function is called only if it is listed."""
        if code not in REGISTRY:
            raise KeyError(code)
        if self._counts_in(code):
            self._found.append(Diagnostic(code, message, place, hint() if callable(hint) else hint))

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


def quoted(names: Sequence[str], most: int = 3) -> str:
    """Quoted names for a message: the first ones, and dots if there are more than ``most``."""
    return ", ".join(f"'{name}'" for name in names[:most]) + (", ..." if len(names) > most else "")


def enumerated(names: Sequence[str], most: int = 6) -> str:
    """Quoted names for a sentence: the first ones, and how many more there are: "'a', 'b' and 2 more"."""
    items = [f"'{name}'" for name in names[:most]]
    if len(names) > most:
        items.append(f"{len(names) - most} more")
    return " and ".join(filter(None, (", ".join(items[:-1]), items[-1])))


def did_you_mean(wrong: str, known: Iterable[str], beside: str = "") -> str | None:
    """The hint for a misspelt name: the most similar known name, or None if none is similar.

    If several names are about equally similar, it is the one most similar to ``beside``: if joint 'right_knee' mimics
    'hip', the hint is 'right_hip', although 'left_hip' needs fewer added letters.

    The time is bounded. If there are too many names, only those that share the first or second half of the wrong name
    are compared; this includes every name that differs in one place.

    Args:
        wrong: The unknown name.
        known: The known names.
        beside: Name of the element that contains the wrong name.
    """
    if " - " in wrong:
        known = list(known)
        if wrong.partition(" - ")[0] in known:
            return "an item that is indented more than the one before continues it; indent each '-' of a list equally"
    size = len(wrong)
    # By difflib's ratio, a name shorter than 3/7 of another cannot be similar to it.
    candidates = [name for name in known if 3 * len(name) <= 7 * size and 3 * size <= 7 * len(name)]
    folded = wrong.casefold()
    nearest = next((name for name in candidates if name.casefold() == folded), None)
    if nearest is None:
        most = COMPARED // max(size * size, 1)
        if len(candidates) > most:
            half = size // 2
            first, second = wrong[:half], wrong[size - half :]
            candidates = [name for name in candidates if name.startswith(first) or name.endswith(second)][:most]
        close = difflib.get_close_matches(wrong, candidates, n=_CLOSE)
        nearest = _most_alike(beside, _about_as_near(wrong, close)) if beside else next(iter(close), None)
    return None if nearest is None else f"did you mean '{nearest}'?"


def _about_as_near(wrong: str, close: list[str]) -> list[str]:
    """Of similar names, sorted by similarity, those about as similar as the first."""
    ratios = [_ratio(wrong, name) for name in close]
    return [name for name, ratio in zip(close, ratios, strict=True) if ratio >= ratios[0] - _ABOUT]


def _most_alike(beside: str, names: list[str]) -> str | None:
    return max(names, key=lambda name: _ratio(beside, name), default=None)


def _ratio(one: str, other: str) -> float:
    return difflib.SequenceMatcher(None, one, other).ratio()
