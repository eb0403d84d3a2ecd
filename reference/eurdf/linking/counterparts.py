"""Names of the same part elsewhere on a robot: of the other side, or with another number; and frames that pair so."""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Collection, Iterable, Mapping
from typing import NamedTuple

# 'leftHip_2' has the words left, Hip and 2.
_WORD = re.compile(r"[A-Z]?[a-z]+|[A-Z]+(?![a-z])|\d+")

_OPPOSITE = frozenset(
    frozenset(pair.split())
    for pair in ("left right", "l r", "fl fr", "rl rr", "bl br", "hl hr", "lf rf", "lr rr", "lb rb", "lh rh")
)

_SIDES = frozenset().union(*_OPPOSITE)

#: The words for left and right, each with the other one.
OTHER_SIDE = {"left": "right", "right": "left", "l": "r", "r": "l"}

# Those that number parts; x, y and z are directions.
_LETTERS = frozenset("abcdefgh")

# The two ends of a cut.
_ENDS = (frozenset("12"), frozenset("ab"))

#: By the number of a word in a name, that word and another one in its place, in lower case.
Changes = Mapping[int, tuple[str, str]]

Frames = tuple[str, str]


class LikePair(NamedTuple):
    """Two frames that no closure uses, named like those of one.

    Attributes:
        frames: Their names.
        like: Those of the closure.
        changes: How the former differ from the latter; empty if only the two frames differ from one another as those of
            the closure do.
    """

    frames: Frames
    like: Frames
    changes: Changes


def words_of(name: str) -> list[str]:
    """The words and numbers of a name, in lower case."""
    return [word.lower() for word in _WORD.findall(name)]


def changes_between(name: str, other: str) -> Changes:
    """The words with which the first name becomes the other; empty if they differ in more than words."""
    pairs = enumerate(zip(words_of(name), words_of(other), strict=False))
    changes = {index: pair for index, pair in pairs if pair[0] != pair[1]}
    return changes if renamed(name, changes) == other else {}


def renamed(name: str, changes: Changes) -> str:
    """The name with other words in the place of some; a name of other words has them wherever they are."""
    words = words_of(name)
    if all(index < len(words) and words[index] == old for index, (old, _) in changes.items()):
        new = {index: to for index, (_, to) in changes.items()}
    else:
        by_word = dict(changes.values())
        new = {index: by_word[word] for index, word in enumerate(words) if word in by_word}
    parts, end = [], 0
    for index, found in enumerate(_WORD.finditer(name)):
        word = found[0]
        parts += [name[end : found.start()], cased_as(word, new[index]) if index in new else word]
        end = found.end()
    return "".join((*parts, name[end:]))


def is_alike(name: str, other: str) -> bool:
    """Whether names differ in one word, and have others in common."""
    return len(changes_between(name, other)) == 1 and len(words_of(name)) > 1


def is_opposite(name: str, other: str) -> bool:
    """Whether names differ in the word for their side: left and right, FL and FR, or none and one."""
    changes = changes_between(name, other)
    if len(changes) == 1 and frozenset(*changes.values()) in _OPPOSITE:
        return True
    one, two = ([word for word in words_of(each) if word not in _SIDES] for each in (name, other))
    return name != other and one == two and len(words_of(name)) != len(words_of(other))


def is_elsewhere(changes: Changes) -> bool:
    """Whether words are one, and it is that of the other side, or a number or letter in the place of another."""
    if len(changes) != 1:
        return False
    (pair,) = changes.values()
    return frozenset(pair) in _OPPOSITE or all(map(str.isdigit, pair)) or all(word in _LETTERS for word in pair)


def unused_pairs(used: Iterable[Frames], names: Iterable[str]) -> list[LikePair]:
    """The pairs of names that no closure uses and that differ from a used pair in the same words, in few first.

    Last come those of which one name becomes the other as in a used pair.
    """
    used = list(dict.fromkeys(used))
    taken = {name for pair in used for name in pair}
    unused: dict[str, list[str]] = defaultdict(list)
    for name in dict.fromkeys(names):
        if name not in taken:
            unused[_WORD.sub("*", name)].append(name)
    free = {name for alike in unused.values() for name in alike}
    found: list[LikePair] = []
    for like in used:
        for a in unused[_WORD.sub("*", like[0])]:
            changes = changes_between(like[0], a)
            b = renamed(like[1], changes)
            if b in free and b != a:
                found.append(LikePair((a, b), like, changes))
    found.sort(key=lambda pair: (len(pair.changes), not is_elsewhere(pair.changes)))
    apart = {tuple(changes.items()): like for like in used if len(changes := changes_between(*like)) == 1}
    last = ((a, renamed(a, dict(changes)), like) for changes, like in apart.items() for a in free)
    return found + [LikePair((a, b), like, {}) for a, b, like in sorted(last) if b in free and b != a]


def other_frame(name: str, used: Iterable[Frames], names: Collection[str]) -> str | None:
    """The frame that pairs with one as those of another closure do, or as 1 with 2, or a with b; if there is one."""
    for a, b in used:
        for this, other in ((a, b), (b, a)):
            changes = changes_between(this, name)
            found = renamed(other, changes)
            if changes and found in names and found not in (name, other):
                return found
    pairs = ((each, changes_between(name, each)) for each in names)
    beside = [each for each, changes in pairs if len(changes) == 1 and frozenset(*changes.values()) in _ENDS]
    return beside[0] if len(beside) == 1 else None


def cased_as(word: str, new: str) -> str:
    """A word in lower case, with capital letters as another one has them."""
    return new.upper() if word.isupper() else new.capitalize() if word[0].isupper() else new
