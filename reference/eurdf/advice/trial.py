"""Whether a robot is as good after a fix as it says itself: a fix that is not is no fix."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from eurdf.kinematics.analysis import Analysis


@dataclass(frozen=True)
class Evidence:
    """What a robot says of itself.

    Attributes:
        counts: The number of diagnostics of each code.
        analysis: How it moves; None if that is not known, as of one with errors.
    """

    counts: Counter[str]
    analysis: Analysis | None

    def is_as_good_as(self, before: Evidence, code: str) -> bool:
        """Whether after a fix of one diagnostic, whose code is given, the robot is at least as good as before.

        That diagnostic is gone, and there is no new one; no actuator has lost its independence, and the robot has not
        fewer motions than its actuators have.
        """
        if self.counts[code] >= before.counts[code] or self.counts - before.counts:
            return False
        if self.analysis is None:
            return before.analysis is None
        actuated = sum(loop.actuated for loop in self.analysis.loops)
        moving = sum(loop.mobility for loop in self.analysis.loops)
        return self._bound <= before._bound and moving >= actuated

    @property
    def _bound(self) -> set[str]:
        """The actuators that cannot move independently."""
        loops = () if self.analysis is None else self.analysis.loops
        return {name for loop in loops for together in loop.dependent_actuators for name in together}
