"""Near names: chapter Scope and terms."""

from __future__ import annotations

from functools import cache


def is_near(name: str, known: str) -> bool:
    """Whether a name is near a known one: at most two edits away, or one if that has fewer than five characters."""
    a, b = ("".join(chr(ord(c) + 32) if "A" <= c <= "Z" else c for c in text) for text in (name, known))

    @cache
    def d(i: int, j: int) -> int:
        """The edits between the first i characters of the one and the first j of the other."""
        if i == 0 or j == 0:
            return i + j
        ways = [d(i - 1, j) + 1, d(i, j - 1) + 1]
        if a[i - 1] == b[j - 1]:
            ways.append(d(i - 1, j - 1))
        if i > 1 and j > 1 and a[i - 1] == b[j - 2] and a[i - 2] == b[j - 1]:
            ways.append(d(i - 2, j - 2) + 1)
        return min(ways)

    return abs(len(a) - len(b)) <= 2 and d(len(a), len(b)) <= (1 if len(b) < 5 else 2)
