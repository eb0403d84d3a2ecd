"""The kinds of loop closure and of coupling, one file each: what they state, and the mathematics of it."""

from __future__ import annotations

from collections.abc import Iterator, MutableMapping
from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from eurdf.closures.kind import ClosureKind

#: A closure that is open by no more than this, m or rad, counts as closed (EU-CLO-005).
CLOSED = 1e-6

#: The module of each kind that files can state, by its type there.
MODULES = {"3d": "point", "6d": "frame", "hinge": "hinge", "distance": "distance"}


class _Registry(MutableMapping[str, "type[ClosureKind]"]):
    """The kinds by type; each is imported, and NumPy with it, when it is first used."""

    def __init__(self) -> None:
        self._found: dict[str, type[ClosureKind] | None] = dict.fromkeys(MODULES)

    def __getitem__(self, type_: str) -> type[ClosureKind]:
        kind = self._found[type_]
        if kind is None:
            kind = self._found[type_] = import_module(f"{__name__}.{MODULES[type_]}").KIND
        return kind

    def __setitem__(self, type_: str, kind: type[ClosureKind]) -> None:
        self._found[type_] = kind

    def __delitem__(self, type_: str) -> None:
        del self._found[type_]

    def __iter__(self) -> Iterator[str]:
        return iter(self._found)

    def __len__(self) -> int:
        return len(self._found)


#: The kinds of closure that files can state, by their type there.
REGISTRY = _Registry()
