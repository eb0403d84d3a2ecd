"""What all rules together say of a robot."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import eurdf
from robots.quality.candidate import Candidate
from robots.quality.files import is_built, is_pictured, is_sound, is_the_same_in_version_1
from robots.quality.mirror import is_mirrored
from robots.quality.motion import is_assembled, moves, weighs
from robots.quality.readme import is_documented

#: What is wrong, one sentence a fault; None where there is nothing that the rule could look at.
Faults = list[str] | None

#: The rules by name.
RULES: Mapping[str, Callable[[Candidate], Faults]] = {
    "sound": is_sound,
    "assembled": is_assembled,
    "built": is_built,
    "version 1": is_the_same_in_version_1,
    "pictured": is_pictured,
    "documented": is_documented,
    "mirrored": is_mirrored,
    "weighs": weighs,
    "moves": moves,
}


@dataclass(frozen=True, slots=True)
class Verdict:
    """What was found of a robot.

    Attributes:
        candidate: The robot.
        faults: By rule; None where there was nothing to look at.
    """

    candidate: Candidate
    faults: Mapping[str, Faults]

    @property
    def passes(self) -> bool:
        """Whether it is good enough for the collection."""
        return not any(self.faults.values())


def judge(candidate: Candidate) -> Verdict:
    """Look at a robot by all rules; at one that cannot be built, by the first alone, which says why."""
    faults: dict[str, Faults] = dict.fromkeys(RULES)
    try:
        candidate.robot  # noqa: B018 - loaded here, for all rules
    except eurdf.InvalidRobot:
        faults["sound"] = is_sound(candidate)
        return Verdict(candidate, faults)
    return Verdict(candidate, {name: rule(candidate) for name, rule in RULES.items()})
