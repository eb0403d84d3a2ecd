"""Which names are left and right of each other: 'left_knee' and 'right_knee', 'LThigh' and 'RThigh', 'fl' and 'fr'."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence

from eurdf.linking.counterparts import OTHER_SIDE, cased_as

_WORD = re.compile("left|right", re.IGNORECASE)

# One or two letters for a side, as in 'l_hip', 'LF_hip', 'hipR' and 'LHipYaw', and the first letter of a word: 'LARM'.
_LETTERS = re.compile(
    r"(?<![A-Za-z])[A-Za-z]{1,2}(?![A-Za-z])|(?<![A-Z])[A-Z]{1,2}(?=[A-Z][a-z])|(?<=[a-z])[LR](?![A-Za-z])"
)
_FIRST = re.compile(r"(?<![A-Za-z])[LRlr](?=[A-Za-z])")

# Longer names have no side: the time grows with the square of the length.
_LONGEST = 200

_Span = tuple[int, int]


def mirrored_names(names: Iterable[str]) -> dict[str, str]:
    """For each name of a side, the one of the other side among the names; both ways."""
    known = dict.fromkeys(name for name in names if len(name) <= _LONGEST)  # in their order
    image = {name: next((other for other in _candidates(name) if other in known), "") for name in known}
    return {name: other for name, other in image.items() if other and image[other] == name}


def _candidates(name: str) -> Iterator[str]:
    """The names that a name may have on the other side, the likeliest first."""
    words = [found.span() for found in _WORD.finditer(name)]
    yield from _changed(name, words)
    sides = [[at for at in range(*found.span()) if name[at] in "lLrR"] for found in _LETTERS.finditer(name)]
    for last in (True, False):  # 'rl' is rear left rather than the right leg
        yield from _changed(name, [*words, *((at[-last], at[-last] + 1) for at in sides if at)])
    yield from _changed(name, [found.span() for found in _FIRST.finditer(name)])


def _changed(name: str, spans: Sequence[_Span]) -> Iterator[str]:
    """The name with all of the sides in it changed, then with one of them."""
    for chosen in (spans, *([span] for span in spans)) if spans else ():
        text = name
        for start, end in sorted(chosen, reverse=True):
            side = name[start:end]
            text = text[:start] + cased_as(side, OTHER_SIDE[side.lower()]) + text[end:]
        yield text
