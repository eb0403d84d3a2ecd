"""The result of all rules for a robot."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import eurdf
from robots.quality.candidate import Candidate
from robots.quality.files import is_built, is_pictured, is_sound, is_the_same_in_version_1
from robots.quality.mirror import is_mirrored
from robots.quality.motion import has_mass, is_assembled, reaches_limits
from robots.quality.readme import is_documented

#: Errors, one sentence each; None if the rule does not apply.
Errors = list[str] | None

#: The rules by name.
RULES: Mapping[str, Callable[[Candidate], Errors]] = {
    "sound": is_sound,
    "assembled": is_assembled,
    "built": is_built,
    "version 1": is_the_same_in_version_1,
    "pictured": is_pictured,
    "documented": is_documented,
    "mirrored": is_mirrored,
    "mass": has_mass,
    "motion": reaches_limits,
}


@dataclass(frozen=True, slots=True)
class Verdict:
    """The errors of a robot.

    Attributes:
        candidate: The robot.
        errors: By rule; None if the rule does not apply.
    """

    candidate: Candidate
    errors: Mapping[str, Errors]

    @property
    def passes(self) -> bool:
        """Whether the robot meets all rules."""
        return not any(self.errors.values())


def judge(candidate: Candidate) -> Verdict:
    """Apply all rules to a robot; only the first one, which says why, if it cannot be built."""
    errors: dict[str, Errors] = dict.fromkeys(RULES)
    try:
        candidate.robot  # noqa: B018 - loaded here, for all rules
    except eurdf.InvalidRobot:
        errors["sound"] = is_sound(candidate)
        return Verdict(candidate, errors)
    return Verdict(candidate, {name: rule(candidate) for name, rule in RULES.items()})
