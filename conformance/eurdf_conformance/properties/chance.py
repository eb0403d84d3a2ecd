"""Random choices that are the same on every machine and in every version of Python, for one seed."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from random import Random
from typing import TypeVar

Item = TypeVar("Item")


class Chance:
    """A sequence of random choices. Of `random.Random` only `random()` is the same in all versions of Python."""

    def __init__(self, seed: int) -> None:
        self._random = Random(seed)

    def is_so(self, probability: float) -> bool:
        """True with this probability."""
        return self._random.random() < probability

    def one_of(self, items: Sequence[Item]) -> Item:
        """One of the values."""
        return items[int(self._random.random() * len(items))]

    def between(self, low: float, high: float) -> float:
        """A number with three decimals."""
        return round(low + self._random.random() * (high - low), 3)

    def shuffled(self, items: Iterable[Item]) -> list[Item]:
        """The values in random order."""
        return [item for _, _, item in sorted((self._random.random(), i, item) for i, item in enumerate(items))]
