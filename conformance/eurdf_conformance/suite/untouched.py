"""Whether a run left the corpus as it was: a parser runs as the user does, and could change what is expected of it."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Mapping
from pathlib import Path

from eurdf_conformance.carried import carried
from eurdf_conformance.corpus.read import CASES
from eurdf_conformance.properties.example import FROZEN

#: Of each file of the corpus, by its path, the hash of its content and the time of its last change (ctime), ns.
Snapshot = Mapping[Path, tuple[str, int]]

#: So many changed files are named.
_NAMED = 3


def snapshot() -> Snapshot:
    """The corpus as it is now: the cases, the frozen examples, the clauses."""
    return {path: _state(path) for path in sorted(_files())}


def void_text(before: Snapshot) -> str | None:
    """Why a run is void: a file of the corpus was changed since, even if it was changed back; None if none was."""
    now = snapshot()
    changed = sorted(path for path in before.keys() | now.keys() if before.get(path) != now.get(path))
    if not changed:
        return None
    more = f" and {len(changed) - _NAMED} more" if len(changed) > _NAMED else ""
    names = ", ".join(f"'{path}'" for path in changed[:_NAMED]) + more
    return f"the run is void: files of the corpus were changed while it ran: {names}; restore them and run it again"


def _files() -> Iterator[Path]:
    yield from (path for path in CASES.rglob("*") if path.is_file())
    yield from (FROZEN, carried("spec/clauses.json"))


def _state(path: Path) -> tuple[str, int]:
    # The time of its inode, which no program can set: what was changed back leaves no trace in the content.
    try:
        return hashlib.sha256(path.read_bytes()).hexdigest(), path.stat().st_ctime_ns
    except OSError as error:
        return str(error), 0
